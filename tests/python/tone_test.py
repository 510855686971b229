"""What a picture's file shows of its light: exposure, tone and filters of what is shown, as the command has them."""
import os
import re
import subprocess

import numpy as np
import pytest

import trilens

# A sky far beyond the screen's white behind a dim wall and a mirror ball, filtered with negative lobes.
BRIGHT = """{
  "version": 1, "film": {"width": 48, "height": 36, "spp": 3, "filter": "mitchell"},
  "cameras": [{"name": "main", "yfov": 40, "lookAt": {"eye": [0, 0, 4], "at": [0, 0, 0]}}],
  "background": {"color": [90, 90, 90]},
  "materials": [{"name": "dim", "baseColorFactor": [0.1, 0.2, 0.3], "unlit": true},
                {"name": "chrome", "baseColorFactor": [0.9, 0.9, 0.9], "metallicFactor": 1}],
  "meshes": [
    {"name": "ball", "role": "optic", "material": "chrome", "primitive": {"type": "sphere", "center": [0.6, 0, 0], "radius": 0.5}},
    {"name": "wall", "role": "object", "material": "dim", "points": [[-9, -9, -1], [0.13, -9, -1], [0.13, 9, -1], [-9, 9, -1]],
     "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]}],
  "lights": [{"type": "ambient", "color": [1, 1, 1]}]
}"""


@pytest.fixture(scope="module")
def bright():
    return trilens.Renderer(trilens.parse_scene(BRIGHT, warn=lambda message: None))


def test_a_filter_of_what_is_shown_leaves_no_dark_rings(bright):
    light, shown = bright.render(resolution=4), bright.render(resolution=4, filter_shown=True)
    assert light.rgb().min() < -0.3 and light.rgb().max() > 10
    assert shown.rgb().min() > -0.15 and shown.rgb().max() < 1.15
    # Away from the sky and the ball both show the same.
    assert np.abs(light.rgb() - shown.rgb())[:, :18].max() < 1e-5


def test_trace_filters_what_is_shown_too(bright):
    shown = bright.trace(filter_shown=True)
    assert shown.rgb().min() > -0.15 and shown.rgb().max() < 1.15


@pytest.mark.parametrize("words, arguments", [
    ([], {}), (["--tone", "neutral", "--exposure", "-2"], {"tone": "neutral", "exposure": -2}),
    (["--tone", "reinhard", "--white", "8", "--filter-shown"], {"tone": "reinhard", "white": 8, "filter_shown": True})])
def test_a_png_is_the_commands(bright, command, tmp_path, words, arguments):
    (tmp_path / "scene.json").write_text(BRIGHT)
    code, _ = command("render", tmp_path / "scene.json", "-n", 4, *words, "-o", tmp_path / "theirs.png")
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


# Options of `trilens render` that are no arguments of Renderer.render: what does the same in Python.
ELSEWHERE = {
    "overrides of load_scene": {"--size", "--spp", "--filter", "--set", "--max-depth"},
    "optics, time and animation of load_scene": {"--optic", "--time", "--animation"},
    "other names": {"--crop", "--aov", "--output", "--format", "--slices", "--tessellate"},
    "Renderer.explain, Scene.at_frame, Renderer.draw_lines": {"--pixel", "--frames", "--turntable", "--wire", "--folds"},
    "the whole module": {"--help", "--version", "--threads", "--json", "--color", "--quiet", "--verbose"},
}


def test_every_option_of_render_is_had_in_python():
    program = os.environ.get("TRILENS_COMMAND")
    if not program:
        pytest.skip("TRILENS_COMMAND names no trilens to compare with")
    told = subprocess.run([program, "render", "--help"], capture_output=True, text=True, check=True).stdout
    options = set(re.findall(r"^ +(?:-\w,)?(--[a-z-]+)", told, re.M))
    assert {"--resolution", "--filter-shown", "--threads"} <= options
    had = set(re.findall(r"(\w+):", trilens.Renderer.render.__doc__.split("\n\n")[0]))
    for option in sorted(options - set().union(*ELSEWHERE.values())):
        assert option[2:].replace("-", "_") in had, f"{option}: no argument of Renderer.render, nor said elsewhere"
