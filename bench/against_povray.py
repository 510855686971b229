#!/usr/bin/python3
"""Times `trilens render` beside POV-Ray as a user would: whole commands, one scene, a PNG of each.

    python3 bench/against_povray.py TRILENS FOLDER [WIDTHxHEIGHT [REPEATS]]

The scene: a mirror ball in a room of checkers, 96 unlit squares. The three commands take turns; the table has
each one's median seconds of wall and processor time and the share of pixels that are not POV-Ray's to 2/255.
Writes FOLDER/povray.md and the pictures.
"""
import json
import math
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import time

import matplotlib.image
import numpy as np

EYE, AT, YFOV = np.array([0.3, 0.8, 4.5]), np.array([0.0, 0.1, 0.0]), 40.0
CENTRE, RADIUS = [0.0, 0.1, 0.0], 1.0
LOW, HIGH, CELLS = np.array([-4, -1.5, -5]), np.array([4, 4, 6.0]), 4


def squares():
    """Corners and colour of every square of the room."""
    made = []
    for axis in range(3):
        for side in (LOW, HIGH):
            for i in range(CELLS):
                for j in range(CELLS):
                    corners = []
                    for u, v in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        p = np.empty(3)
                        p[axis] = side[axis]
                        for other, at in (((axis + 1) % 3, u), ((axis + 2) % 3, v)):
                            p[other] = LOW[other] + (HIGH[other] - LOW[other]) * at / CELLS
                        corners.append(p)
                    k = len(made)
                    made.append((corners, [(k % 5 + 1) / 5, (k // 5 % 5 + 1) / 5, (k // 25 + 1) / 5]))
    return made


def write_trilens(file, size):
    materials = [{"name": "mirror", "metallicFactor": 1}]
    meshes = [{"name": "ball", "role": "optic", "material": "mirror",
               "primitive": {"type": "sphere", "center": CENTRE, "radius": RADIUS}}]
    for k, (corners, colour) in enumerate(squares()):
        materials.append({"name": f"square{k}", "baseColorFactor": colour, "unlit": True})
        meshes.append({"name": f"square{k}", "role": "object", "material": f"square{k}",
                       "points": [list(p) for p in corners], "faceVertexCounts": [4],
                       "faceVertexIndices": [0, 1, 2, 3]})
    scene = {"version": 1, "film": {"width": size[0], "height": size[1]},
             "cameras": [{"name": "main", "yfov": YFOV,
                          "lookAt": {"eye": list(EYE), "at": list(AT), "up": [0, 1, 0]}}],
             "materials": materials, "meshes": meshes, "render": {"fresnel": False}}
    file.write_text(json.dumps(scene))


def write_povray(file, size):
    def vector(v):
        return "<" + ",".join(f"{x:.17g}" for x in v) + ">"

    forward = (AT - EYE) / np.linalg.norm(AT - EYE)
    right = np.cross(forward, [0, 1, 0])
    right /= np.linalg.norm(right)
    high = 2 * math.tan(math.radians(YFOV / 2))
    lines = ["#version 3.7;",
             "global_settings { assumed_gamma 1.0 max_trace_level 10 }",
             f"camera {{ perspective location {vector(EYE)} direction {vector(forward)} "
             f"right {vector(high * size[0] / size[1] * right)} up {vector(high * np.cross(right, forward))} }}",
             f"sphere {{ {vector(CENTRE)}, {RADIUS} pigment {{ rgb 0 }} "
             "finish { ambient 0 diffuse 0 reflection { 1 } } }"]
    for corners, colour in squares():
        for a, b, c in ((0, 1, 2), (0, 2, 3)):
            lines.append(f"triangle {{ {vector(corners[a])}, {vector(corners[b])}, {vector(corners[c])} "
                         f"pigment {{ rgb {vector(colour)} }} finish {{ ambient 1 diffuse 0 }} }}")
    file.write_text("\n".join(lines) + "\n")


def timed(command, folder):
    before, start = os.times(), time.perf_counter()
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    wall, after = time.perf_counter() - start, os.times()
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)} failed:\n{done.stderr}")
    return wall, after.children_user + after.children_system - before.children_user - before.children_system


def main():
    if not 3 <= len(sys.argv) <= 5:
        sys.exit(__doc__)
    if not shutil.which("povray"):
        sys.exit("skipped: POV-Ray is not installed")
    trilens, folder = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]).resolve()
    size = tuple(int(n) for n in (sys.argv[3] if len(sys.argv) > 3 else "1920x1080").split("x"))
    repeats = int(sys.argv[4]) if len(sys.argv) > 4 else 5
    folder.mkdir(parents=True, exist_ok=True)
    write_trilens(folder / "ball.json", size)
    write_povray(folder / "ball.pov", size)
    threads = str(os.cpu_count())
    commands = {
        "trilens render, n = 16": [trilens, "render", "ball.json", "-n", "16", "-t", threads, "-q", "-o", "render.png"],
        "trilens trace": [trilens, "trace", "ball.json", "-t", threads, "-q", "-o", "trace.png"],
        "POV-Ray": ["povray", "-D", "-GA", "+Iball.pov", "+Opovray.png", "+FN8", f"+W{size[0]}", f"+H{size[1]}",
                    "-A", f"+WT{threads}", "File_Gamma=srgb"],
    }
    times = {name: [] for name in commands}
    for _ in range(repeats):
        for name, command in commands.items():
            times[name].append(timed(command, folder))
    truth = matplotlib.image.imread(folder / "povray.png")[..., :3]
    pictures = {"trilens render, n = 16": "render.png", "trilens trace": "trace.png", "POV-Ray": "povray.png"}
    lines = [f"{size[0]} x {size[1]}, {threads} threads, medians of {repeats}", "",
             "| command | wall s | processor s | pixels unlike POV-Ray's |", "|---|---|---|---|"]
    for name, values in times.items():
        picture = matplotlib.image.imread(folder / pictures[name])[..., :3]
        unlike = np.mean(np.abs(picture - truth).max(axis=-1) > 2.5 / 255)
        wall, cpu = (statistics.median(column) for column in zip(*values))
        lines.append(f"| {name} | {wall:.3f} | {cpu:.3f} | {100 * unlike:.3f} % |")
    (folder / "povray.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
