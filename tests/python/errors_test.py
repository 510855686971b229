"""Every exception, and who may catch it."""
import os
import signal
import threading
import warnings

import numpy as np
import pytest

import trilens
from conftest import SOURCE

LONG = {"/film/width": 320, "/film/height": 240, "/film/spp": 8}  # many bands of samples


@pytest.fixture(scope="module")
def long_work():
    return trilens.Renderer(trilens.load_scene(SOURCE / "scenes/sphere.json", LONG))


def test_the_exceptions_are_one_family_with_the_commands_exit_codes():
    codes = {"UsageError": 2, "InputError": 3, "OutputError": 4, "ComputationError": 5, "Interrupted": 130}
    for name, code in codes.items():
        kind = getattr(trilens, name)
        assert issubclass(kind, trilens.Error) and kind.exit_code == code and kind.__module__ == "trilens"
    assert issubclass(trilens.Error, Exception) and not issubclass(trilens.Error, ValueError)


def test_usage_errors_name_the_nearest_word(renderer):
    with pytest.raises(trilens.UsageError, match="did you mean 'main'"):
        renderer.render(camera="mian")
    with pytest.raises(trilens.UsageError, match="did you mean 'classic'"):
        renderer.render(engine="clasic")
    with pytest.raises(trilens.UsageError, match="did you mean 'facets'"):
        renderer.trace("facet")
    with pytest.raises(trilens.UsageError):
        renderer.render(layers=["reflct"])


@pytest.mark.parametrize(
    "arguments",
    [
        {"window": (0, 0, 0, 0)},
        {"window": (5, 5, 5, 9)},
        {"window": (0, 0, 9999, 9)},
        {"layers": []},
        {"resolution": 1025},
        {"resolution": -1},
        {"pieces": 4},
        {"engine": "classic", "curves": "slices", "pieces": 0},
        {"engine": "classic", "tolerance": float("nan")},
        {"progress": 3},
        {"warn": "loud"},
    ],
)
def test_arguments_that_make_no_sense_are_usage_errors(renderer, arguments):
    with pytest.raises(trilens.UsageError):
        renderer.render(**arguments)


def test_input_errors_name_file_and_place(tmp_path):
    missing = tmp_path / "missing.json"
    with pytest.raises(trilens.InputError, match="missing.json"):
        trilens.load_scene(missing)
    with pytest.raises(trilens.InputError, match="/film/width"):
        trilens.load_scene(SOURCE / "scenes/sphere.json", {"/film/width": -3})
    with pytest.raises(trilens.InputError):
        trilens.parse_scene("{")
    (tmp_path / "no.exr").write_bytes(b"nothing")
    with pytest.raises(trilens.InputError, match="no.exr"):
        trilens.read_image(tmp_path / "no.exr")


def test_a_message_survives_a_file_name_that_is_no_utf_8(tmp_path):
    with pytest.raises(trilens.InputError) as caught:
        trilens.load_scene(os.fsdecode(os.fsencode(tmp_path) + b"/\xff.json"))
    assert "\udcff.json" in str(caught.value)


def test_output_errors(image, renderer, tmp_path):
    for save in (image.save, renderer.draw_lines().save):
        with pytest.raises(trilens.OutputError):
            save(tmp_path / "no" / "folder" / ("out.exr" if save == image.save else "out.svg"))


def test_computation_errors():
    """A light so near to what the only pixel sees that no double holds its irradiance."""
    scene = trilens.parse_scene({
        "version": 1,
        "film": {"width": 1, "height": 1},
        "cameras": [{"name": "main", "type": "perspective", "yfov": 40,
                     "lookAt": {"eye": [0, 0, 1], "at": [0, 0, 0], "up": [0, 1, 0]}}],
        "materials": [{"name": "white"}],
        "meshes": [{"name": "wall", "role": "object", "material": "white",
                    "points": [[-1, -1, 0], [1, -1, 0], [0, 1, 0]],
                    "faceVertexCounts": [3], "faceVertexIndices": [0, 1, 2]}],
        "lights": [{"type": "point", "position": [0, 0, 1e-150], "intensity": 1e30}],
    }, warn=lambda message: None)
    with pytest.raises(trilens.ComputationError, match="not finite"):
        trilens.Renderer(scene).render()


def test_progress_that_returns_false_interrupts(long_work):
    told = []
    with pytest.raises(trilens.Interrupted):
        long_work.render(resolution=1, progress=lambda done, job: (told.append((done, job)), False)[1])
    assert len(told) == 1 and 0 < told[0][0] < 1 and told[0][1] == "render"


def test_an_exception_of_the_callback_stops_the_work_and_arrives_itself(long_work):
    told = []

    def progress(done, job):
        told.append(done)
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        long_work.trace(progress=progress)
    assert len(told) == 1 and told[0] < 1


def told_until_ctrl_c(work):
    """The progress of a render that is interrupted once it has told of some."""
    told = {}
    finished = threading.Event()

    def press():
        while not told and not finished.wait(0.001):
            pass
        os.kill(os.getpid(), signal.SIGINT)

    presser = threading.Thread(target=press)
    presser.start()
    # A built-in callback runs no Python code, so only the work itself can notice the signal.
    try:
        with pytest.raises(KeyboardInterrupt):
            work.render(resolution=16, progress=told.__setitem__)
    finally:
        finished.set()
        presser.join()
    return told


def test_ctrl_c_stops_a_long_render(long_work):
    # A busy machine may wake the thread that interrupts too late.
    assert any(max(told_until_ctrl_c(long_work), default=1) < 1 for _ in range(5))


def test_progress_runs_from_above_0_to_1(long_work):
    told = []
    long_work.trace(layers=["Z"], progress=lambda done, job: told.append((done, job)))
    shares = [done for done, _ in told]
    assert shares == sorted(shares) and len(shares) > 4 and shares[0] > 0 and shares[-1] == 1
    assert {job for _, job in told} == {"trace"}


def objects_only(sphere):
    scene = sphere.to_dict()
    scene["meshes"] = [mesh for mesh in scene["meshes"] if mesh["role"] == "object"]
    return trilens.Renderer(trilens.parse_scene(scene, sphere.folder, warn=lambda message: None))


def test_warnings_go_to_the_warnings_module_or_to_a_callable(sphere):
    renderer = objects_only(sphere)
    with pytest.warns(trilens.TrilensWarning, match="no optic"):
        renderer.render()
    told = []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        renderer.render(warn=told.append)
    assert len(told) == 1 and "no optic" in told[0]


def test_a_warning_made_an_error_arrives(sphere):
    renderer = objects_only(sphere)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(trilens.TrilensWarning):
            renderer.render()


@pytest.mark.parametrize("bad", [np.zeros(3), np.zeros((2, 2)), np.zeros((1, 2, 3)), 5.0])
def test_points_have_three_coordinates(renderer, bad):
    with pytest.raises(trilens.UsageError, match="N x 3"):
        renderer.project(bad)


def test_points_are_finite(renderer):
    with pytest.raises(trilens.InputError, match="points/1"):
        renderer.project([[0, 0, 0], [0, np.nan, 0]])


def test_what_is_no_number_is_a_type_error(renderer):
    with pytest.raises((TypeError, ValueError)):
        renderer.project([["a", "b", "c"]])
    with pytest.raises(TypeError):
        renderer.render(resolution="4")
    with pytest.raises(TypeError):
        trilens.Renderer("scene.json")
