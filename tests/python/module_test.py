"""The module as a whole: its names, its types, its doors."""
import ast
import inspect
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest

import trilens
from conftest import SOURCE

STUB = ast.parse((SOURCE / "python/trilens/__init__.pyi").read_text())
PRIVATE_BUT_MEANT = {"_repr_png_", "_repr_svg_", "__version__", "__all__"}
STANDARD = {"__init__", "__getitem__", "__iter__", "__len__", "__contains__", "__copy__", "__deepcopy__"}


def public(names):
    return {name for name in names if not name.startswith("_") or name in PRIVATE_BUT_MEANT}


def defined_names(body):
    for node in body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            yield node.name, node
        elif isinstance(node, ast.AnnAssign):
            yield node.target.id, node


def test_the_stub_and_the_module_have_the_same_names():
    assert public(dict(defined_names(STUB.body))) == set(trilens.__all__) | {"__version__", "__all__"}


@pytest.mark.parametrize("name", [name for name, node in defined_names(STUB.body) if isinstance(node, ast.ClassDef)])
def test_the_stub_and_each_class_have_the_same_members(name):
    node, kind = dict(defined_names(STUB.body))[name], getattr(trilens, name)
    in_stub = set(dict(defined_names(node.body)))
    in_module = public(vars(kind)) - {"exit_code"}
    assert public(in_stub) - {"exit_code"} == in_module
    assert in_stub - public(in_stub) <= STANDARD and all(hasattr(kind, special) for special in in_stub)
    for member, definition in defined_names(node.body):
        if isinstance(definition, ast.FunctionDef) and public([member]):
            is_property = any(getattr(one, "id", "") == "property" for one in definition.decorator_list)
            assert is_property == isinstance(inspect.getattr_static(kind, member), property), member


def functions_of_the_stub():
    for name, node in defined_names(STUB.body):
        if isinstance(node, ast.FunctionDef):
            yield name, node, getattr(trilens, name)
        elif isinstance(node, ast.ClassDef):
            for member, definition in defined_names(node.body):
                is_plain = isinstance(definition, ast.FunctionDef) and not definition.decorator_list
                if is_plain and public([member]) | ({member} & {"__init__"}):
                    yield f"{name}.{member}", definition, getattr(getattr(trilens, name), member)


def test_the_stub_and_each_function_have_the_same_arguments():
    checked = 0
    for name, node, function in functions_of_the_stub():
        signature = function.__doc__.split("\n")[0]
        plain, inner = signature[signature.index("(") :].split(" -> ")[0], None
        while plain != inner:  # types' own brackets say nothing of arguments
            plain, inner = re.sub(r"\[[^\[\]]*\]", "", plain), plain
        arguments = re.findall(r"(?:^|[(,] ?)(\*|\w+)(?=:|,|\)| =)", plain)
        expected = [one.arg for one in node.args.args]
        if node.args.kwonlyargs:
            expected += ["*"] + [one.arg for one in node.args.kwonlyargs]
        if expected[:1] == ["self"]:
            expected, arguments = expected[1:], arguments[1:]
        assert arguments == expected, name
        checked += 1
    assert checked > 40


def test_everything_public_says_what_it_is():
    for name in trilens.__all__:
        thing = getattr(trilens, name)
        if isinstance(thing, type):
            assert thing.__doc__ and thing.__module__ == "trilens", name
        elif callable(thing):
            assert len(thing.__doc__.split("\n\n", 1)[1].strip()) > 20, name


def test_the_version_is_the_packages():
    assert trilens.__version__ == trilens.version()
    assert re.fullmatch(r"\d+\.\d+\.\d+", trilens.version()) and len(trilens.library_versions()) == 3


def test_the_bindings_stand_on_the_public_headers_alone():
    own = {path.name for path in (SOURCE / "python").glob("*.h")}
    included = {}
    for path in list((SOURCE / "python").glob("*.h")) + list((SOURCE / "python").glob("*.cpp")):
        for bracket, target in re.findall(r'#include ([<"])([^>"]+)', path.read_text()):
            included.setdefault((bracket, target), path.name)
    for (bracket, target), where in included.items():
        if bracket == '"':
            assert target in own, where
        else:
            assert re.fullmatch(r"trilens/\w+\.h|pybind11/.+|\w+", target), where
    assert ("<", "trilens/trilens.h") in included


def run_example(example, tmp_path):
    pytest.importorskip("matplotlib", reason="python3-matplotlib draws the example's plot")
    result = subprocess.run(
        [sys.executable, example, "--size", "96x72", "-o", tmp_path / "plot.png"],
        capture_output=True, text=True, env={"PYTHONPATH": ":".join(sys.path), "MPLCONFIGDIR": str(tmp_path)})
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "plot.png").read_bytes()[:4] == b"\x89PNG"
    return result.stdout


def test_the_example_runs(tmp_path):
    out = run_example(SOURCE / "examples/python/error_against_resolution.py", tmp_path)
    orders = [float(value) for value in re.findall(r"order (\d+\.\d+)", out)]
    assert orders and all(1.5 < order < 2.6 for order in orders)
    assert np.all(np.diff([float(value) for value in re.findall(r"mean (\S+) px", out)]) < 0)


def test_the_example_runs_where_no_scenes_are_near(tmp_path):
    example = shutil.copy(SOURCE / "examples/python/error_against_resolution.py", tmp_path)
    assert len(re.findall(r"order \d+\.\d+", run_example(example, tmp_path))) == 3
