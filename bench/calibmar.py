#!/usr/bin/env python3
"""Runs Calibmar's own test of housings through examples/ceres, and says what it finds beside what Calibmar's test accepts:

    bench/calibmar.py SOURCE_OF_CALIBMAR build/release/tests/ceres/calibrate_port

The dome's pixels stand in its tests/calibrators/housing_calibrator_test.cpp. Those of the flat port are drawn there by its
own projection at ten poses with noise of an eighth of a pixel; here by rays refracted by hand at the same poses.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

INDICES = (1.003, 1.473, 1.333)
FLAT = {"focal": 864.91, "middle": (640, 512), "size": (1280, 1024), "normal": (0.1, 0.1, 1), "distance": 0.02,
        "thickness": 0.014}


def numbers_after(text, name):
    """The rows of the braces that `name` is set to, as lists of numbers, by depth."""
    begin = text.index("{", text.index(name + " = "))
    depth, end = 0, begin
    while True:
        depth += {"{": 1, "}": -1}.get(text[end], 0)
        end += 1
        if depth == 0:
            return eval(text[begin:end].replace("{", "[").replace("}", "]"), {"__builtins__": {}})


def calibration(model, parameters, port, port_numbers, size):
    return (f"model: {model}\nparameters: {list(parameters)}\nnon_svp_model: {port}\n"
            f"non_svp_parameters: {list(port_numbers)}\nwidth: {size[0]}\nheight: {size[1]}\n")


def refracted(direction, normal, ratio):
    cosine = direction @ normal
    return ratio * direction + (np.sqrt(1 - ratio ** 2 * (1 - cosine ** 2)) - ratio * cosine) * normal


def ray_in_water(pixel):
    normal = np.array(FLAT["normal"]) / np.linalg.norm(FLAT["normal"])
    direction = np.append((pixel - FLAT["middle"]) / FLAT["focal"], 1)
    direction /= np.linalg.norm(direction)
    origin, index = np.zeros(3), INDICES[0]
    for distance, behind in ((FLAT["distance"], INDICES[1]), (FLAT["distance"] + FLAT["thickness"], INDICES[2])):
        origin = origin + (distance - origin @ normal) / (direction @ normal) * direction
        direction, index = refracted(direction, normal, index / behind), behind
    return origin, direction


def pixel_of(point):
    """By Newton's method with differences, as refractive COLMAP has it."""
    pixel = FLAT["focal"] * point[:2] / point[2] + FLAT["middle"]
    for _ in range(50):
        def miss(at):
            origin, direction = ray_in_water(at)
            return np.cross(point - origin, direction)
        step = 1e-4
        slopes = np.stack([(miss(pixel + step * e) - miss(pixel - step * e)) / (2 * step) for e in np.eye(2)], axis=1)
        change = np.linalg.lstsq(slopes, -miss(pixel), rcond=None)[0]
        pixel = pixel + change
        if np.linalg.norm(change) < 1e-10:
            break
    return pixel


def turned(quaternion, point):
    axis, real = np.array(quaternion[:3]), quaternion[3]
    scale = np.linalg.norm(quaternion)
    axis, real = axis / scale, real / scale
    return point + 2 * np.cross(axis, np.cross(axis, point) + real * point)


def flat_rows(poses, points, seed):
    draw, rows = np.random.default_rng(seed), []
    for view, pose in enumerate(poses):
        for point in points:
            way = draw.normal(0, 0.125, 2)
            pixel = pixel_of(turned(pose[:4], np.array(point)) + pose[4:])
            pixel = pixel + way / np.linalg.norm(way) * draw.normal(0, 0.125)
            if np.all(pixel >= 0) and np.all(pixel <= FLAT["size"]):
                rows.append((view, *pixel, point[0], point[1]))
    return rows


def run(program, scene, rows):
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "port.yaml").write_text(scene)
        (pathlib.Path(folder) / "pairs.csv").write_text("".join("%d,%.9g,%.9g,%.9g,%.9g\n" % row for row in rows))
        done = subprocess.run([program, f"{folder}/port.yaml", f"{folder}/pairs.csv"], text=True, check=True,
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    print(done.stdout, end="")
    return [float(word) for word in re.findall(r"-?\d+\.\d+(?:e-?\d+)?", done.stdout.split("\n")[0])], done.stdout


def main(source, program):
    text = (pathlib.Path(source) / "tests/calibrators/housing_calibrator_test.cpp").read_text()
    points = numbers_after(text, "std::vector<Eigen::Vector3d> points3D")
    views = numbers_after(text, "point2DSetsDome")
    poses = numbers_after(text, "test_poses")

    rows = [(v, *pixel, 0.04 * point[0], 0.04 * point[1]) for v, view in enumerate(views)
            for pixel, point in zip(view, points)]
    dome = calibration("OPENCV", (1024, 1024, 1024, 768, 0, 0, 0, 0), "DOMEPORT", (0, 0, 0, 0.0501, 0.007, *INDICES),
                       (2048, 1536))
    centre, said = run(program, dome, rows)
    print(f"dome: off (0, 0, -0.03) by {np.linalg.norm(np.array(centre) - (0, 0, -0.03)):.2g}; Calibmar's test takes 0.001 an "
          f"axis, rms 0.24221")

    normal = np.array(FLAT["normal"]) / np.linalg.norm(FLAT["normal"])
    flat = calibration("SIMPLE_PINHOLE", (FLAT["focal"], *FLAT["middle"]), "FLATPORT", (0, 0, 1, 0.04, 0.014, *INDICES),
                       FLAT["size"])
    for seed in (1, 2, 3):
        found, said = run(program, flat, flat_rows(poses, points, seed))
        angle = np.degrees(np.linalg.norm(np.cross(normal, found[:3])))
        print(f"flat, seed {seed}: normal off by {angle:.4f} degrees (Calibmar's test takes 0.04), distance by "
              f"{1000 * abs(found[3] - FLAT['distance']):.2f} mm (10)")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
