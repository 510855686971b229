#!/usr/bin/python3
"""How fast the viewer is: its first picture, pictures a second of a camera that orbits, how long a heavy scene's coarse picture takes.

    python3 bench/view.py BUILD FOLDER

Each by a script, in memory and, where Xvfb is, in a window of OpenGL by software (llvmpipe) of 1280 x 800. Median, least and most
of five runs; the seconds are those of the viewer's own --json. Writes FOLDER/table.md.
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

REPEATS = 5
SOURCE = pathlib.Path(__file__).resolve().parent.parent


def display():
    """An Xvfb and its number."""
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1400x900x24", "-nolisten", "tcp"], pass_fds=[write],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(write)
    return server, os.fdopen(read).readline().strip()


def run(build, folder, scene, steps, number):
    """What the viewer says of itself, and its processor seconds."""
    (folder / "steps.json").write_text(json.dumps(steps))
    words = [build / "trilens", "view", scene, "--script", "steps.json", "--window-size", "1280x800", "--json"]
    environment = dict(os.environ)
    if number is not None:
        words.append("--window")
        environment |= {"DISPLAY": ":" + number, "LIBGL_ALWAYS_SOFTWARE": "1"}
    before = os.times()
    answer = json.loads(subprocess.run(words, check=True, cwd=folder, env=environment, capture_output=True, text=True).stdout)
    after = os.times()
    answer["processor"] = after.children_user + after.children_system - before.children_user - before.children_system
    return answer


def spread(values, digits=3):
    return f"{statistics.median(values):.{digits}f} ({min(values):.{digits}f} to {max(values):.{digits}f})"


def rows_of(build, folder, number, where):
    orbit = [{"show": {"n": 16}}, {"wait": "picture"}, {"orbit": [60, 10], "frames": 60}]
    runs = [run(build, folder, "ball.json", orbit, number) for _ in range(REPEATS)]
    turns = [one["steps"][-1] for one in runs]
    yield where, "mirror ball 640x480, n = 16", "first picture, s", spread([one["first_picture_seconds"] for one in runs])
    yield where, "the same, orbiting", "pictures a second", spread([one["frames"] / one["seconds"] for one in turns], 1)
    runs = [run(build, folder, SOURCE / "scenes/paths/wine-glass.json", [{"wait": "picture"}], number) for _ in range(REPEATS)]
    yield where, "wine glass 480x360", "first coarse picture, s", spread([one["first_picture_seconds"] for one in runs])


def main():
    build, out = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        ball = subprocess.run([build / "trilens", "scene", "example", "mirror-sphere"], check=True, capture_output=True, text=True).stdout
        ball = json.loads(re.sub(r"^\s*//.*$", "", ball, flags=re.M))
        ball["film"] = {"width": 640, "height": 480}
        (folder / "ball.json").write_text(json.dumps(ball))
        rows += rows_of(build, folder, None, "in memory")
        if shutil.which("Xvfb"):
            server, number = display()
            try:
                rows += rows_of(build, folder, number, "in a window")
            finally:
                server.terminate()
                server.wait()
        else:
            print("in a window: left out, there is no Xvfb", file=sys.stderr)
    out.mkdir(parents=True, exist_ok=True)
    lines = ["| | what | | median of 5 (least to most) |", "|---|---|---|---|"] + ["| " + " | ".join(row) + " |" for row in rows]
    (out / "table.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))
    print(out / "table.md")


main()
