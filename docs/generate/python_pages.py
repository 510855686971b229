"""The reference of the Python module, from its stub, with docstrings where the module is built."""
import ast
import importlib
import re
import sys

from program import SOURCE, table


def write_python(folder, out):
    """The names of the module, from its stub, with docstrings where the module is there."""
    module = None
    sys.path.insert(0, str(folder))
    try:
        module = importlib.import_module("trilens")
    except ImportError:
        print("generate: the Python module is not built; its page has no docstrings", file=sys.stderr)
    tree = ast.parse((SOURCE / "python/trilens/__init__.pyi").read_text())

    def doc(*names):
        found = module
        for name in names:
            found = getattr(found, name, None)
        words = (getattr(found, "__doc__", None) or "").strip()
        words = re.sub(r"^\w+\(.*?\)( -> .*)?\n\n", "", words)
        return re.sub(r"([*_<>`|])", r"\\\1", words)

    def listed(text):
        """A docstring's parameters as a list."""
        text = re.sub(r"\n[ \t]+", " ", text)
        text = re.sub(r"(?m)^(Raises|Returns) ", r"\n\1 ", text)
        return re.sub(r"(?m)^([\w\\]+(?:, [\w\\]+)*: )", r"\n- \1", text)

    def signature(node, width=10000):
        arguments = ast.unparse(node.args).replace("self, ", "").replace("self", "")
        returned = f" -> {ast.unparse(node.returns)}" if node.returns else ""
        if len(node.name) + len(arguments) + len(returned) > width:
            depth, broken = 0, ""
            for letter in arguments:  # one argument a line; commas inside of brackets stay
                depth += (letter in "[(") - (letter in "])")
                broken += letter if letter != "," or depth else ",\n   "
            arguments = f"\n    {broken}\n"
        return f"{node.name}({arguments}){returned}"

    text = ("# Python reference\n\nEvery public name of the module `trilens`, from its stub `__init__.pyi`, which editors and "
            "type checkers read too.\n\n")
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    classes = [node for node in tree.body if isinstance(node, ast.ClassDef)]
    text += "## Functions\n"
    for node in functions:
        text += f"\n### {node.name}\n\n```python\n{signature(node, 80)}\n```\n\n{listed(doc(node.name))}\n"
    text += "\n## Classes\n"
    for node in classes:
        bases = ", ".join(ast.unparse(base) for base in node.bases)
        text += f"\n### {node.name}\n\n{'A subclass of `' + bases + '`. ' if bases else ''}{doc(node.name)}\n\n"
        rows, methods = [], ""
        for member in node.body:
            if isinstance(member, ast.FunctionDef) and not (member.name.startswith("__") and member.name != "__getitem__"):
                is_property = any(ast.unparse(one) == "property" for one in member.decorator_list)
                if is_property:
                    rows.append((f"`{member.name}: {ast.unparse(member.returns)}`", doc(node.name, member.name)))
                else:
                    methods += (f"\n#### {node.name}.{member.name}\n\n```python\n{signature(member, 80)}\n```\n\n"
                                f"{listed(doc(node.name, member.name))}\n")
        text += (table(("attribute", "meaning"), rows) if rows else "") + methods
    (out / "python-reference.md").write_text(text)
