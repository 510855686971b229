"""What a picture's file shows of its light: exposure, tone and filters of what is shown, as the command has them."""
import re
import subprocess
import os

import numpy as np
import pytest

import trilens

from conftest import SOURCE, SMALL, size_options

SCENE = SOURCE / "scenes/sphere.json"
BRIGHT = {**SMALL, "/film/width": 48, "/film/height": 36, "/film/spp": 3, "/film/filter": "mitchell",
          "/background/color": [90, 90, 90]}


@pytest.fixture(scope="module")
def bright():
    """A sky far beyond the screen's white, several samples a pixel, a filter with negative lobes."""
    return trilens.Renderer(trilens.load_scene(SCENE, BRIGHT))


def luminance(image):
    return image.rgb() @ np.array([0.2126, 0.7152, 0.0722], np.float32)


def test_a_filter_of_what_is_shown_leaves_no_dark_rings(bright):
    light, shown = bright.render(resolution=4), bright.render(resolution=4, filter_shown=True)
    assert light.rgb().min() < -1 and light.rgb().max() > 10
    assert shown.rgb().min() > -0.15 and shown.rgb().max() < 1.15
    # Where nothing is brighter than the screen's white all around, both show the same.
    height, width = luminance(light).shape
    rooms = np.pad(light.rgb().max(axis=2), 2, constant_values=9) < 1
    calm = np.all([rooms[y:y + height, x:x + width] for y in range(5) for x in range(5)], axis=0)
    calm &= np.abs(light.rgb()).max(axis=2) < 0.8
    if calm.any():
        assert np.abs(light.rgb() - shown.rgb())[calm].max() < 1e-5


def test_trace_filters_what_is_shown_too(bright):
    shown = bright.trace(filter_shown=True)
    assert shown.rgb().min() > -0.15 and shown.rgb().max() < 1.15


@pytest.mark.parametrize("words, arguments", [
    ([], {}), (["--tone", "neutral", "--exposure", "-2"], {"tone": "neutral", "exposure": -2}),
    (["--tone", "reinhard", "--white", "8", "--filter-shown"], {"tone": "reinhard", "white": 8, "filter_shown": True})])
def test_a_png_is_the_commands(bright, command, tmp_path, words, arguments):
    sets = [word for key in ("/film/filter", "/background/color")
            for word in ("--set", f"{key}={str(BRIGHT[key]) if isinstance(BRIGHT[key], list) else BRIGHT[key]}")]
    code, _ = command("render", SCENE, "-n", 4, *size_options(BRIGHT), *sets, *words, "-o", tmp_path / "theirs.png")
    assert code == 0
    bright.render(resolution=4, file=tmp_path / "ours.png", **arguments)
    assert (tmp_path / "ours.png").read_bytes() == (tmp_path / "theirs.png").read_bytes()


def test_light_that_stays_what_it_is_takes_no_tones(bright, tmp_path):
    for arguments in ({"exposure": 1}, {"tone": "aces"}, {"filter_shown": True}):
        with pytest.raises(trilens.UsageError, match="exr holds the light"):
            bright.render(resolution=2, file=tmp_path / "a.exr", **arguments)
    with pytest.raises(trilens.UsageError, match="Image.save"):
        bright.trace(tone="neutral")
    with pytest.raises(trilens.UsageError, match="tone"):
        bright.render(resolution=2, tone="sepia", filter_shown=True)
    assert not list(tmp_path.iterdir())


# How Python says each option of `trilens render`: an argument of Renderer.render, or what does it.
ELSEWHERE = {
    "--size": "overrides", "--spp": "overrides", "--filter": "overrides", "--set": "overrides",
    "--max-depth": "overrides", "--crop": "window", "--aov": "layers", "--output": "file",
    "--pixel": trilens.Renderer.explain, "--frames": trilens.Scene.at_frame, "--turntable": trilens.Scene.at_frame,
    "--slices": "pieces", "--tessellate": "pieces", "--format": "file", "--wire": trilens.Renderer.draw_lines,
    "--folds": trilens.Renderer.draw_lines, "--help": "help()", "--version": trilens.version,
    "--quiet": "warn", "--verbose": "warn", "--threads": trilens.set_threads, "--json": "statistics",
    "--color": "none", "--certify": "max_error",
}


def test_every_option_of_render_is_had_in_python():
    program = os.environ.get("TRILENS_COMMAND")
    if not program:
        pytest.skip("TRILENS_COMMAND names no trilens to compare with")
    told = subprocess.run([program, "render", "--help"], capture_output=True, text=True, check=True).stdout
    options = set(re.findall(r"^ +(?:-\w,)?(--[a-z-]+)", told, re.M))
    assert {"--resolution", "--filter-shown", "--threads"} <= options
    had = set(re.findall(r"(\w+):", trilens.Renderer.render.__doc__.split("\n\n")[0]))
    for option in sorted(options - set(ELSEWHERE)):
        assert option[2:].replace("-", "_") in had, f"{option}: no argument of Renderer.render, nor said elsewhere"
