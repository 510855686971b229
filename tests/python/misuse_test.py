"""What is no use of the module is refused with a Python error, never with a crash, and nothing is dropped in silence."""
import copy
import threading

import numpy as np
import pytest

import trilens
from conftest import SOURCE

BOUND = sorted(name for name in dir(trilens)
               if isinstance(getattr(trilens, name), type) and getattr(trilens, name).__module__.startswith("trilens")
               and not issubclass(getattr(trilens, name), BaseException)
               and type(getattr(trilens, name)).__name__ == "pybind11_type")


def sphere(**film):
    sets = {"/film/width": 48, "/film/height": 36, "/film/spp": 1}
    sets.update({f"/film/{key}": value for key, value in film.items()})
    return trilens.load_scene(SOURCE / "scenes/sphere.json", overrides=sets)


@pytest.mark.parametrize("name", BOUND)
def test_no_object_is_made_without_its_constructor(name):
    kind = getattr(trilens, name)
    with pytest.raises(TypeError):
        kind.__new__(kind)


def test_constructors_still_work():
    assert len(BOUND) > 20
    renderer = trilens.Renderer(sphere())
    assert renderer.render(2).size == (48, 36)
    with pytest.raises(TypeError):
        trilens.Image()


def test_none_is_no_image():
    image = trilens.Renderer(sphere()).render(2)
    for pair in ((None, image), (image, None), (None, None)):
        with pytest.raises(TypeError):
            trilens.compare(*pair)


def test_a_picture_is_written_as_its_name_says(tmp_path):
    renderer = trilens.Renderer(sphere())
    with pytest.raises(trilens.UsageError, match="must end in .exr"):
        renderer.render(2, file=tmp_path / "x.foo")
    assert not list(tmp_path.iterdir())
    image = renderer.render(2, file=tmp_path / "x.png")
    assert (tmp_path / "x.png").read_bytes()[:4] == b"\x89PNG"
    image.save(tmp_path / "same.png")
    assert (tmp_path / "x.png").read_bytes() == (tmp_path / "same.png").read_bytes()
    renderer.render(2, file=tmp_path / "x.exr")
    assert (tmp_path / "x.exr").read_bytes()[:4] == b"\x76\x2f\x31\x01"


def test_masked_values_are_refused():
    points = np.ma.masked_array(np.zeros((3, 3)), np.eye(3) > 0)
    with pytest.raises(trilens.UsageError, match="masked"):
        trilens.Renderer(sphere()).project(points)
    with pytest.raises(trilens.UsageError, match="masked"):
        trilens.Image.from_arrays({"R": points.astype(np.float32)})
    assert trilens.Image.from_arrays({"R": np.ma.masked_array(np.ones((2, 2), np.float32))}).size == (2, 2)


def test_texts_are_no_numbers():
    renderer = trilens.Renderer(sphere())
    with pytest.raises(TypeError, match="texts"):
        renderer.project([["1", "1", "2"]])
    with pytest.raises(TypeError, match="texts"):
        renderer.project(np.array([[b"1", b"1", b"2"]]))


def test_complex_numbers_are_refused():
    renderer = trilens.Renderer(sphere())
    with pytest.raises(trilens.UsageError, match="complex"):
        renderer.project(np.array([[0.1 + 1j, 0, 0]]))
    with pytest.raises(trilens.UsageError, match="complex"):
        trilens.fit_power_law(np.array([1, 2, 4 + 1j]), np.array([1, 0.25, 0.06]))


def test_a_scene_does_not_change_under_a_drawing_thread():
    renderer = trilens.Renderer(sphere(width=320, height=240, spp=2))
    started, go_on = threading.Event(), threading.Event()

    def progress(done, job):
        started.set()
        go_on.wait(20)

    drawn = []
    thread = threading.Thread(target=lambda: drawn.append(renderer.render(4, progress=progress)))
    thread.start()
    assert started.wait(20)
    with pytest.raises(trilens.UsageError, match="another thread draws"):
        renderer.change(sphere())
    go_on.set()
    thread.join()
    assert drawn[0].size == (320, 240)
    assert renderer.change(sphere())["optics"] >= 0
    assert renderer.render(2).size == (48, 36)


def test_copying_is_refused_in_words():
    with pytest.raises(TypeError):
        copy.copy(trilens.Renderer(sphere()))
