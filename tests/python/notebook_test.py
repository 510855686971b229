"""What people meet who type: numbers of numpy, pictures and bars in notebooks, signatures, a camera's matrix."""
import inspect
import io
import json
import pathlib
import re
import sys
import types

import numpy as np
import pytest

import trilens
from conftest import SMALL, SOURCE
from module_test import functions_of_the_stub
from trilens import progress_bar


def floor_scene(number=float, array=list):
    """A mirror ball over a floor, its numbers and lists made by these."""
    return {
        "version": 1, "film": {"width": 32, "height": 24},
        "cameras": [{"name": "main", "yfov": number(40), "lookAt": {"eye": array([0, 1, 4]), "at": array([0, 0.5, 0])}}],
        "materials": [{"name": "chrome", "metallicFactor": 1}, {"name": "red", "baseColorFactor": array([0.5, 0.1, 0.1])}],
        "meshes": [
            {"name": "ball", "role": "optic", "material": "chrome",
             "primitive": {"type": "sphere", "center": array([0, 0.6, 0]), "radius": number(0.5)}},
            {"name": "floor", "role": "object", "material": "red",
             "points": array([[-3, 0, 3], [3, 0, 3], [3, 0, -3], [-3, 0, -3]]),
             "faceVertexCounts": array([4]), "faceVertexIndices": array([0, 1, 2, 3])}],
        "lights": [{"type": "ambient", "color": array([1, 1, 1])}]}


@pytest.mark.parametrize("number", [np.float64, np.float32, np.int64, np.uint8, np.array])
def test_numbers_and_arrays_of_numpy_stand_anywhere_in_a_scene(number):
    given = {**floor_scene(float, np.array), "film": {"width": number(32), "height": number(24)}}
    assert trilens.parse_scene(given, warn=print).to_dict()["meshes"] == trilens.parse_scene(floor_scene(), warn=print).to_dict()["meshes"]
    assert trilens.parse_scene(given, warn=print).film.width == 32


def test_numbers_and_arrays_of_numpy_stand_in_overrides():
    sphere = SOURCE / "scenes/sphere.json"
    eye = np.array([0.5, 1, 4], dtype=np.float32)
    scene = trilens.load_scene(sphere, {"/film/width": np.int32(40), "/cameras/0/lookAt/eye": eye,
                                        "/lights/0/shadows": np.bool_(False)}, np.int64(3))
    assert scene.cameras[0].eye == tuple(eye.tolist()) and scene.film.width == 40
    assert scene.meshes[0].resolution == 3 and scene.to_dict()["lights"][0]["shadows"] is False
    with pytest.raises(TypeError, match="complex is not JSON"):
        trilens.load_scene(sphere, {"/film/width": np.complex128(3)})
    with pytest.raises(TypeError, match="object is not JSON"):
        trilens.load_scene(sphere, {"/film/width": object()})


def test_paths_stand_for_files(tmp_path):
    (tmp_path / "floor.obj").write_text("v -3 0 3\nv 3 0 3\nv 3 0 -3\nf 1 2 3\n")
    scene = floor_scene()
    scene["meshes"][1] = {"name": "floor", "role": "object", "material": "red", "file": pathlib.Path("floor.obj")}
    assert trilens.parse_scene(scene, tmp_path, warn=print).meshes[1].triangles == 1


def test_axes_of_a_sweep_are_numbers_of_numpy_too(tmp_path):
    (tmp_path / "floor.json").write_text(json.dumps(floor_scene()))
    summary = trilens.sweep(tmp_path / "floor.json", tmp_path / "out", {"resolution": np.array([1, 2]), "/cameras/0/yfov": [np.float64(30)]},
                            warn=lambda text: None)
    assert {run.state for run in summary.runs} == {"done"} and len(summary.runs) == 2


def test_notebooks_show_the_beauty_as_the_png_that_save_writes(image, tmp_path):
    image.save(tmp_path / "saved.png")
    assert image._repr_png_() == (tmp_path / "saved.png").read_bytes()
    assert trilens.Image.from_arrays({"Z": np.zeros((2, 3))})._repr_png_() is None


def test_a_bar_in_a_notebook_is_one_display_that_is_updated(renderer, monkeypatch):
    shown = []

    class Handle:
        def update(self, html):
            shown.append(("update", html))

    def display(html, display_id):
        shown.append(("display", html))
        return Handle()

    ipython = types.ModuleType("IPython")
    ipython.get_ipython = lambda: types.SimpleNamespace(kernel=object())
    ipython.display = types.ModuleType("IPython.display")
    ipython.display.HTML, ipython.display.display = str, display
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", ipython.display)
    monkeypatch.setattr(progress_bar, "_INTERVAL", 0)
    renderer.render(resolution=4, progress=True)
    assert [how for how, _ in shown][:1] == ["display"] and {how for how, _ in shown[1:]} <= {"update"}
    assert "render 100 %" in shown[-1][1] and 'value="1.000"' in shown[-1][1]


def test_a_bar_on_a_terminal_is_one_line_and_elsewhere_nothing(renderer, monkeypatch):
    terminal = io.StringIO()
    terminal.isatty = lambda: True
    monkeypatch.setattr(sys, "stderr", terminal)
    renderer.render(resolution=2, progress=True)
    assert terminal.getvalue().count("\n") == 1 and terminal.getvalue().endswith("\rrender 100 %\n")
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    renderer.render(resolution=2, progress=True)
    renderer.render(resolution=2, progress=False)
    assert sys.stderr.getvalue() == ""


def test_every_function_has_the_signature_of_the_stub():
    checked = 0
    for name, node, function in functions_of_the_stub():
        if name.endswith("__init__"):
            function = getattr(trilens, name.split(".")[0])
        rest = [node.args.kwarg] if node.args.kwarg else []
        expected = [one.arg for one in [*node.args.args, *node.args.kwonlyargs, *rest]]
        arguments = inspect.signature(function).parameters
        assert [one for one in arguments if one != "self"] == [one for one in expected if one != "self"], name
        kinds = {one.arg: inspect.Parameter.KEYWORD_ONLY for one in node.args.kwonlyargs}
        for argument, kind in kinds.items():
            assert arguments[argument].kind == kind, name
        with_default = {one.arg for one in node.args.args[len(node.args.args) - len(node.args.defaults):]}
        for one in node.args.args:
            if one.arg != "self":
                has_default = arguments[one.arg].default is not inspect.Parameter.empty
                assert has_default == (one.arg in with_default), f"{name}: {one.arg}"
        checked += 1
    assert checked > 40
    assert str(inspect.signature(trilens.Image.save)) == "(self, file, *, exposure=0.0, tone='none', white=4.0)"
    assert str(inspect.signature(trilens.Renderer)) == "(scene, *, warn=None)"


def test_what_is_bound_has_the_signature_without_self(renderer, image):
    assert str(inspect.signature(renderer.facet_count)) == "(resolution=0)"
    assert str(inspect.signature(image.rgb)) == "(layer='')"


def test_layers_and_their_channels_are_named():
    scene = trilens.load_scene(SOURCE / "scenes/water.json", SMALL, 2, warn=lambda text: None)
    renderer, said = trilens.Renderer(scene), trilens.layer_names.__doc__
    listed = {line.split(":")[0]: line for line in said.split("\n") if ":" in line}
    assert set(trilens.layer_names()) <= set(listed)
    for layer in trilens.layer_names():
        asked = ["reflect", layer] if layer in ("magnification", "ray") else [layer]
        names = set(renderer.render(layers=asked, warn=lambda text: None).names) - set("RGBA")
        if layer != "reflect" and "reflect" in asked:
            names -= set(renderer.render(layers=["reflect"], warn=lambda text: None).names)
        missing = {name for name in names if name.replace("refract", "reflect") not in said}
        assert names and not missing, layer
    assert set(re.findall(r"\bstat\.\w+", said)) == {one for one in renderer.render(layers=["stat"], warn=print).names if "." in one}


def points_before(camera, count=50):
    """In the camera's frame, x right, y down, z forward, and in the world's."""
    random = np.random.default_rng(3)
    depth = 10 ** random.uniform(-2, 3, count)
    local = np.stack([random.uniform(-0.3, 0.3, count) * depth, random.uniform(-0.3, 0.3, count) * depth, depth], axis=1)
    forward = np.subtract(camera.at, camera.eye)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, camera.up)
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    return local, np.array(camera.eye) + local @ np.stack([right, down, forward])


@pytest.mark.parametrize("change", [{}, {"shift": [0.25, -0.5]}, {"yfov": 100}])
def test_intrinsics_project_as_the_camera_does(sphere, change):
    scene = sphere.with_overrides({f"/cameras/0/{key}": value for key, value in change.items()})
    local, world = points_before(scene.cameras[0])
    x, y, w = scene.cameras[0].intrinsics @ local.T
    seen = trilens.FilmCamera(scene).project(world)
    assert np.array_equal(seen["point"], np.arange(len(world)))
    assert np.allclose(seen["x"], x / w, atol=1e-8) and np.allclose(seen["y"], y / w, atol=1e-8)


def test_a_camera_shows_its_settings():
    scene = trilens.load_scene(SOURCE / "scenes/cameras.json", {"/cameras/main/yfov": 33}, warn=lambda text: None)
    cameras = {camera.name: camera for camera in scene.cameras}
    assert cameras["main"].settings == {"yfov": 33, "shift": [0, 0], "near": 0}
    assert repr(cameras["main"]) == "<trilens.Camera 'main': perspective, yfov 33, near 0>"
    fisheye = cameras["fisheye"].settings
    assert fisheye["mapping"] == "equisolid" and fisheye["fov"] == 200 and fisheye["tolerance"] == 0.25
    assert "yfov" not in fisheye and "facets" not in fisheye and cameras["fisheye"].intrinsics is None
    lens = cameras["lens"]
    assert np.array_equal(lens.intrinsics, [[420, 0, 320], [0, 420, 240], [0, 0, 1]])
    assert lens.settings["distortion"] == [-0.22, 0.06, 0.0008, -0.0005, -0.008]
    for camera in scene.cameras:
        assert camera.type in repr(camera)
