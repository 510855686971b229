#!/usr/bin/python3
"""How fast the viewer is: its first picture, pictures a second of a camera that orbits, how long a heavy scene's coarse picture takes.

    python3 bench/view.py BUILD FOLDER

The ball is lit by one sample of its window. Each by a script, in memory and, where Xvfb is, in a window of OpenGL by software
(llvmpipe) of 1280 x 800. Median, least and most of five runs; the seconds are those of the viewer's own --json. Writes
FOLDER/table.md.
"""
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(SOURCE / "tests/view"))
from xvfb import NO_DISPLAY, display

REPEATS = 5


def run(build, folder, scene, steps, environment):
    """What the viewer says of itself, and its processor seconds."""
    (folder / "steps.json").write_text(json.dumps(steps))
    words = [build / "trilens", "view", scene, "--script", "steps.json", "--window-size", "1280x800", "--json"]
    if "DISPLAY" in environment:
        words.append("--window")
    before = os.times()
    answer = json.loads(subprocess.run(words, check=True, cwd=folder, env=environment, capture_output=True, text=True).stdout)
    after = os.times()
    answer["processor"] = after.children_user + after.children_system - before.children_user - before.children_system
    return answer


def spread(values, digits=3):
    return f"{statistics.median(values):.{digits}f} ({min(values):.{digits}f} to {max(values):.{digits}f})"


def rows_of(build, folder, environment, where):
    orbit = [{"show": {"n": 16}}, {"wait": "picture"}, {"orbit": [60, 10], "frames": 60}]
    runs = [run(build, folder, "ball.json", orbit, environment) for _ in range(REPEATS)]
    turns = [one["steps"][-1] for one in runs]
    yield where, "mirror ball 640x480, n = 16", "first picture, s", spread([one["first_picture_seconds"] for one in runs])
    yield where, "the same, orbiting", "pictures a second", spread([one["frames"] / one["seconds"] for one in turns], 1)
    runs = [run(build, folder, SOURCE / "scenes/paths/wine-glass.json", [{"wait": "picture"}], environment) for _ in range(REPEATS)]
    yield where, "wine glass 480x360", "first coarse picture, s", spread([one["first_picture_seconds"] for one in runs])


def main():
    build, out = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        ball = subprocess.run([build / "trilens", "scene", "example", "mirror-sphere"], check=True, capture_output=True, text=True).stdout
        ball = json.loads(re.sub(r"^\s*//.*$", "", ball, flags=re.M))
        ball["film"] = {"width": 640, "height": 480}
        for light in ball["lights"]:  # one shadow ray a place
            light.update(samples=1, shadows=light["type"] == "rectangle")
        (folder / "ball.json").write_text(json.dumps(ball))
        rows += rows_of(build, folder, NO_DISPLAY, "in memory")
        if shutil.which("Xvfb"):
            with display() as environment:
                rows += rows_of(build, folder, environment, "in a window")
        else:
            print("in a window: left out, there is no Xvfb", file=sys.stderr)
    out.mkdir(parents=True, exist_ok=True)
    lines = ["| | what | | median of 5 (least to most) |", "|---|---|---|---|"] + ["| " + " | ".join(row) + " |" for row in rows]
    (out / "table.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))
    print(out / "table.md")


main()
