"""What the docstrings say, held against what the functions do."""
import re

import numpy as np
import pytest

import trilens


def quoted(text):
    return set(re.findall(r'"(\w+)"', text))


def test_render_says_which_layers_it_leaves_out(renderer):
    usual = set(renderer.render(resolution=2).names)
    left_out = set()
    for layer in set(trilens.layer_names()) - {"reflect"}:
        own = set(renderer.render(resolution=2, layers=["reflect", layer]).names)
        own -= set(renderer.render(resolution=2, layers=["reflect"]).names)
        if own and not own & usual:
            left_out.add(layer)
    said = re.search(r"None: all but(.*?)\.\n", trilens.Renderer.render.__doc__, re.S).group(1)
    assert left_out and quoted(said) == left_out


def test_statistics_are_all_named(image):
    for key in image.statistics:
        assert key in trilens.Image.statistics.__doc__, key


def test_a_largest_error_of_zero_still_divides():
    """Glass at n = 1 shows much of the scene far from where it is: facets are divided, whatever is asked for."""
    scene = trilens.parse_scene(trilens.scene_examples()["crystal-ball"],
                                overrides={"/film/width": 64, "/film/height": 48, "/film/spp": 1}, warn=lambda message: None)
    told = trilens.Renderer(scene).render(resolution=1, max_error=0, facets="all", warn=lambda message: None).statistics
    assert told["subdivided_pixels"] > 0
    assert "0: only those off by more than (32 / n)^2 pixels" in trilens.Renderer.render.__doc__


def test_explain_names_every_engine(renderer):
    said = re.search(r"\nengine:(.*?)\.", trilens.Renderer.explain.__doc__, re.S).group(1)
    assert quoted(said) == {"exact", "classic", "envmap", "planar", "limit", "facets"}
    for engine in quoted(said):
        assert renderer.explain(64, 48, resolution=2, engine=engine)["engine"] == engine


def test_errors_are_those_that_are_said(sphere, image):
    with pytest.raises(trilens.UsageError):
        trilens.FilmCamera(sphere, "nobody")
    with pytest.raises(trilens.UsageError):
        trilens.compare(image, image, fail=-1)
    with pytest.raises(trilens.UsageError):
        sphere.at_frame(float("nan"), turntable=8)
    with pytest.raises(trilens.UsageError):
        sphere.at_frame(0, turntable=-1)


CAMERA = trilens.make_perspective(width=64, height=48)


@pytest.mark.parametrize("window, side", [
    ((0, 0, 64, 48), 65536), ((0, 0, 50000, 1), 50000), ((-2147483648, 0, 2147483647, 1), 1),
    ((0, 0, 65536, 65536), 1), ((0, 0, 64, 48), 0), ((0, 0, 64, 48), -1), ((4, 0, 4, 48), 1)])
def test_windows_without_or_with_too_many_samples_are_input_errors(window, side):
    mesh = trilens.camera_mesh(CAMERA, 64, 48)
    with pytest.raises(trilens.InputError, match="grid"):
        trilens.draw_through(mesh, [[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], window, side)


@pytest.mark.parametrize("width, height", [(-1, 4), (0, 480), (4, np.nan), (np.inf, 4)])
def test_a_film_without_pixels_is_an_input_error(width, height):
    with pytest.raises(trilens.InputError, match="film"):
        trilens.camera_mesh(CAMERA, width, height)


@pytest.mark.parametrize("number", [np.nan, np.inf, 1e300])
def test_points_beyond_numbers_are_input_errors(number):
    with pytest.raises(trilens.InputError):
        trilens.camera_mesh(CAMERA, 64, 48).images([[number, 0, 0]])
