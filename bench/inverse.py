#!/usr/bin/env python3
"""Measures projection and the inverse problems on it, in this process, and prints one table:

    PYTHONPATH=build/release/python bench/inverse.py [--threads T] [--points N] [--json FILE] [NAME...]

Each row is a function named row_NAME: what was done, microseconds of processor time a point (the best of three), and
how far it is from an independent answer. Rows of inverse_others.py run other programs' own code. Published figures beside
them: a projection by quadrics on a sphere 10 us, catadioptric cameras 20 to 50 us (Agrawal, Taguchi and Ramalingam, Beyond
Alhazen's problem, CVPR 2011).
"""
import argparse
import json
import pathlib

import numpy as np

import trilens
from inverse_others import (row_ball_beside_omnidir, row_fisheye_beside_opencv,  # noqa: F401
                            row_unwrap_beside_pfspanoramic)
from timed_command import best_of

FILM = {"width": 1024, "height": 768}
CAMERA = {"name": "main", "type": "perspective", "yfov": 40, "lookAt": {"eye": [0.2, 0.3, 4.5], "at": [0, 0, 0]}}
BOX = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [2, 3, 7, 6], [0, 4, 7, 3], [1, 2, 6, 5]]


def scene(meshes, materials, depth=0):
    return trilens.Renderer(trilens.parse_scene(
        {"version": 1, "film": FILM, "cameras": [CAMERA], "materials": materials, "meshes": meshes,
         "render": {"maxDepth": depth}}, warn=lambda message: None))


def box(name, low, high, material):
    x, y, z = zip(low, high)
    points = [[x[0], y[0], z[0]], [x[1], y[0], z[0]], [x[1], y[1], z[0]], [x[0], y[1], z[0]],
              [x[0], y[0], z[1]], [x[1], y[0], z[1]], [x[1], y[1], z[1]], [x[0], y[1], z[1]]]
    return {"name": name, "role": "optic", "material": material, "points": points, "faceVertexCounts": [4] * 6,
            "faceVertexIndices": sum(BOX, []), "subdivisionScheme": "bilinear", "resolution": 4}


def creased_cage():
    """A bar of 3 x 1 x 1 cubes, 14 faces, its front edge creased."""
    grid = {}
    points, faces = [], []

    def corner(x, y, z):
        if (x, y, z) not in grid:
            grid[x, y, z] = len(points)
            points.append([x / 1.5 - 1, y * 1.2 - 0.6, z * 1.2 - 0.6])
        return grid[x, y, z]

    for x in range(3):
        for a, b, c, d in (((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)), ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
                           ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)), ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0))):
            faces.append([corner(x + p[0], p[1], p[2]) for p in (a, b, c, d)])
    faces.append([corner(0, *p) for p in ((0, 0), (0, 1), (1, 1), (1, 0))])
    faces.append([corner(3, *p) for p in ((0, 0), (1, 0), (1, 1), (0, 1))])
    return {"name": "bar", "role": "optic", "material": "chrome", "points": points, "faceVertexCounts": [4] * 14,
            "faceVertexIndices": sum(faces, []), "creaseIndices": [corner(x, 1, 1) for x in range(4)],
            "creaseLengths": [4], "creaseSharpnesses": [2], "resolution": 8}


CHROME = {"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0}
SPHERE = {"name": "ball", "role": "optic", "material": "chrome", "primitive": {"type": "sphere", "center": [0, 0, 0], "radius": 1}}


def points_around(count, seed=1):
    draw = np.random.default_rng(seed)
    way = draw.normal(size=(count, 3))
    return way / np.linalg.norm(way, axis=1)[:, None] * draw.uniform(1.8, 6, (count, 1))


def last_rays(renderer, images, path):
    """Rays of the images' places after as many events as the word has: (N, 3) origins and directions, nan where none."""
    rays, events = renderer.shoot(np.stack([images["x"], images["y"]], axis=1), path=None if path else "R")
    origins, directions = np.full((len(rays), 3), np.nan), np.full((len(rays), 3), np.nan)
    letters = len(path or "R")
    for i, ray in enumerate(rays):
        met = events[ray["first_event"]:ray["first_event"] + ray["event_count"]]
        met = met[met["event"] != "pass"]
        if len(met) < letters:
            continue
        origins[i] = met["point"][letters - 1]
        way = met["point"][letters] - origins[i] if len(met) > letters else ray["direction"]
        directions[i] = way / np.linalg.norm(way)
    return origins, directions


def miss_of(renderer, points, images, path=None):
    """How far the rays of images' places pass by their points, times what a pixel moves by them: pixels, the worst."""
    some = images[np.linspace(0, len(images) - 1, min(2000, len(images))).astype(int)]
    some = some[(some["step_count"] > 0) & some["inside"]]
    origins, directions = last_rays(renderer, some, path)
    to = points[some["point"]] - origins
    miss = to - np.sum(to * directions, axis=1)[:, None] * directions
    moved = np.einsum("nij,nj->ni", some["derivative"], miss)
    good = some["has_derivative"] & (np.linalg.norm(miss, axis=1) < 0.01)
    return float(np.linalg.norm(moved[good], axis=1).max()), int(good.sum())


def projected(what, renderer, points, path=None):
    renderer.project(points[:10], path=path, visibility=False)
    seconds, images = best_of(lambda: renderer.project(points, path=path, visibility=False))
    error, count = miss_of(renderer, points,
                           renderer.project(points[:4000], path=path, derivatives=True, visibility=False), path)
    return {"what": what, "us": 1e6 * seconds / len(points), "error": error, "unit": "px",
            "note": f"{len(images)} images, {count} checked by rays"}


def row_sphere(count):
    return projected("projection, mirror sphere", scene([SPHERE], [CHROME]), points_around(count))


def row_cage(count):
    return projected("projection, creased cage of 14 faces", scene([creased_cage()], [CHROME]),
                     points_around(max(count // 10, 1)))


def port(window):
    """A camera in air behind glass, water beyond: what a flat or a dome port of an underwater housing does."""
    glass = {"name": "glass", "transmissionFactor": 1, "ior": 1.52}
    water = {"name": "water", "transmissionFactor": 1, "ior": 1.335}
    return scene([window, box("water", [-40, -40, -40], [40, 40, 3.9], "water")], [glass, water], 2)


def row_flat_port(count):
    draw = np.random.default_rng(2)
    points = np.stack([draw.uniform(-1, 1, count // 10), draw.uniform(-0.7, 0.7, count // 10),
                       draw.uniform(-3, 2, count // 10)], axis=1)
    return projected("projection, flat port (air, glass, water)", port(box("port", [-2, -2, 3.9], [2, 2, 4], "glass")),
                     points, "TT")


def row_warm_sphere(count):
    renderer, points = scene([SPHERE], [CHROME]), points_around(count)
    start = renderer.project(points, visibility=False)
    start = start[start["path"] == "reflect"]
    moved = points + 1e-3
    seconds, warm = best_of(lambda: renderer.project(moved, start=start, visibility=False))
    cold = renderer.project(moved, visibility=False)
    cold = cold[cold["path"] == "reflect"]
    key = {(image["point"], image["steps"]["front"][0]): image for image in cold[:3000]}
    errors = [np.hypot(a["x"] - b["x"], a["y"] - b["y"]) for a in warm[:2000] if a["refined"]
              for b in [key.get((a["point"], a["steps"]["front"][0]))] if b is not None]
    return {"what": "warm start, mirror sphere", "us": 1e6 * seconds / len(start), "error": float(max(errors)),
            "unit": "px", "note": f"{len(start)} images, a step of 1.7e-3"}


def row_derivatives(count):
    renderer, points = scene([SPHERE], [CHROME]), points_around(count)
    pointers = ["/meshes/0/primitive/center", "/meshes/0/primitive/radius", "/cameras/0/yfov"]
    plain, _ = best_of(lambda: renderer.project(points, visibility=False))
    seconds, images = best_of(lambda: renderer.project(points, visibility=False, derivatives=pointers))
    step, few = 1e-4, points[:2000]
    places = []
    for sign in (1, -1):
        ball = {**SPHERE, "primitive": {"type": "sphere", "radius": 1 + sign * step}}
        start = renderer.project(few, visibility=False)
        moved = scene([ball], [CHROME]).project(few, start=start, visibility=False)
        places.append(np.stack([moved["x"], moved["y"]], axis=1))
    difference = (places[0] - places[1]) / (2 * step)
    exact = renderer.project(few, visibility=False, derivatives=pointers)["by_parameter"][:, :, 3]
    error = np.linalg.norm(exact - difference, axis=1) / np.maximum(np.linalg.norm(difference, axis=1), 1)
    return {"what": "derivatives by 5 numbers, mirror sphere", "us": 1e6 * seconds / len(points),
            "error": float(np.nanquantile(error, 0.99)), "unit": "relative, p99",
            "note": f"{seconds / plain:.2f} of the projection alone"}


def row_shoot(count):
    renderer = scene([SPHERE], [CHROME])
    pixels = np.random.default_rng(4).uniform([0, 0], [FILM["width"], FILM["height"]], (count, 2))
    seconds, (rays, events) = best_of(lambda: renderer.shoot(pixels))
    return {"what": "shoot, mirror sphere", "us": 1e6 * seconds / count, "note": f"{len(events)} events"}


def row_dome_port(count):
    """The port of a housing as its calibration is read: a ball of air in a ball of glass, in water."""
    def ball(name, radius, priority):
        return {"name": name, "role": "optic", "material": name, "priority": priority, "resolution": 16,
                "primitive": {"type": "sphere", "center": [0.2, 0.3, 4.52], "radius": radius}}

    def glass(name, ior):
        return {"name": name, "transmissionFactor": 1, "ior": ior}

    renderer = scene([ball("air", 0.0501, 1), ball("glass", 0.0571, 0)],
                     [glass("air", 1.003 / 1.333), glass("glass", 1.473 / 1.333)], 1)
    draw = np.random.default_rng(2)
    points = np.stack([draw.uniform(-1, 1, count // 10), draw.uniform(-0.7, 0.7, count // 10),
                       draw.uniform(-3, 2, count // 10)], axis=1)
    return projected("projection, dome port (air, glass, water)", renderer, points, "TT")


def row_fit_cage_pose(count):
    """Six numbers of a cage's pose from 60 pairs, cold: nothing of the scene is built before."""
    mesh = {**creased_cage(), "transform": {"translate": [0, 0, 0], "rotate": [0, 0, 0, 1]}}
    whole = trilens.parse_scene({"version": 1, "film": FILM, "cameras": [CAMERA], "materials": [CHROME],
                                 "meshes": [mesh], "render": {"maxDepth": 0}}, warn=lambda message: None)
    images = trilens.Renderer(whole).project(points_around(400), path="R")
    images = images[images["inside"]][:60]
    pixels = np.stack([images["x"], images["y"]], axis=1)
    start = whole.with_overrides({"/meshes/0/transform/translate": [0.05, -0.03, 0.04],
                                  "/meshes/0/transform/rotate": [0.02, -0.01, 0.015, 1]})
    seconds, found = best_of(lambda: trilens.fit(
        start, pixels, points_around(400)[images["point"]],
        ["/meshes/0/transform/translate", "/meshes/0/transform/rotate"], path="R"))
    off = max(abs(value) for pointer, value in found.values.items() if "translate" in pointer)
    return {"what": "fit of a cage's pose, 60 pairs, cold", "us": 1e6 * seconds, "error": off, "unit": "units of length",
            "note": f"{1e3 * seconds:.1f} ms in all, rms {found.rms:.2g} px"}


def row_rigid_move(count):
    """A cage of 14 faces moved in a renderer, and 60 points asked for again: from nothing, and from where they were."""
    mesh = {**creased_cage(), "transform": {"translate": [0, 0, 0]}}
    whole = trilens.parse_scene({"version": 1, "film": FILM, "cameras": [CAMERA], "materials": [CHROME],
                                 "meshes": [mesh], "render": {"maxDepth": 0}}, warn=lambda message: None)
    renderer, points = trilens.Renderer(whole), points_around(60)
    start = renderer.project(points, visibility=False)
    start = start[start["path"] == "reflect"]
    steps = iter(range(1, 100))

    def moved(**how):
        renderer.change(whole.with_overrides({"/meshes/0/transform/translate": [1e-3 * next(steps), 0, 0]}))
        return renderer.project(points, visibility=False, **how)

    cold, _ = best_of(moved)
    warm, _ = best_of(lambda: moved(start=start))
    return {"what": "a cage moved in a renderer, 60 points", "us": 1e6 * cold,
            "note": f"{1e3 * cold:.0f} ms searched anew, {1e3 * warm:.2f} ms from where they were"}


def row_warp_mesh(count):
    """A projector, a mirror ball and a dome: how far between its nodes the mesh is off, against rays of its cells."""
    dome = pathlib.Path(__file__).resolve().parent.parent / "scenes/inverse/dome.json"
    renderer = trilens.Renderer(trilens.load_scene(dome, warn=lambda message: None))
    seconds, mesh = best_of(lambda: renderer.warp_mesh("fisheye:1024", proxy="sphere:3", center=(0, 0, 0),
                                                       grid="target", max_error=0.01), 1)
    return {"what": "warp mesh of a mirror dome, 0.01 px of the film", "us": 1e6 * seconds,
            "error": mesh["error_p99"], "unit": "px, p99", "note": f"{mesh['nodes'].shape[1]} x {mesh['nodes'].shape[0]} nodes"}


def row_there_and_back(count):
    """From a panorama's pixels to the film by one map and back by the other, at 4K."""
    renderer = scene([SPHERE], [CHROME])
    size = (2048, 1024) if count < 100_000 else (4096, 2048)
    target = f"equirect:{size[0]}x{size[1]}"
    seconds, there = best_of(lambda: renderer.map(target, proxy="infinity"), 1)
    more, back = best_of(lambda: renderer.map(target, way="view", proxy="infinity"), 1)
    rows, columns = np.nonzero(there["valid"])
    some = np.random.default_rng(3).choice(len(rows), 20000, replace=False)
    rows, columns = rows[some], columns[some]
    x, y = there["x"][rows, columns] - 0.5, there["y"][rows, columns] - 0.5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    inside = (i >= 1) & (j >= 1) & (i + 2 < FILM["width"]) & (j + 2 < FILM["height"])
    reach = [(a, b) for a in range(-1, 3) for b in range(-1, 3)]
    for a, b in reach:
        inside[inside] &= back["valid"][j[inside] + b, i[inside] + a]
    # Nothing is interpolated over the panorama's seam.
    across = np.stack([back["x"][np.clip(j + b, 0, FILM["height"] - 1), np.clip(i + a, 0, FILM["width"] - 1)]
                       for a, b in reach])
    inside &= np.ptp(across, axis=0) < size[0] / 2
    rows, columns, x, y, i, j = (v[inside] for v in (rows, columns, x, y, i, j))

    def cubic(t):
        return np.stack([-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
                         (t + 1) * t * (t - 1) / 6], axis=1)
    wx, wy = cubic(x - i), cubic(y - j)
    off = np.stack([sum(wx[:, a + 1] * wy[:, b + 1] * back[name][j + b, i + a] for a, b in reach) - place - 0.5
                    for name, place in (("x", columns), ("y", rows))], axis=1)
    on_film = np.linalg.norm(np.linalg.solve(back["jacobian"][j, i], off[:, :, None])[:, :, 0], axis=1)
    return {"what": f"there and back through maps, {size[0]} x {size[1]}", "us": 1e6 * (seconds + more),
            "error": float(np.quantile(on_film, 0.99)), "unit": "px of the film, p99",
            "note": f"{seconds:.2f} s there, {more:.2f} s back; median {np.median(on_film):.2g}"}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--points", type=int, default=100_000)
    parser.add_argument("--json")
    options = parser.parse_args()
    trilens.set_threads(options.threads)
    rows = {name[4:]: row for name, row in globals().items() if name.startswith("row_")}
    unknown = set(options.names) - set(rows)
    if unknown:
        parser.error(f"there is no row {', '.join(sorted(unknown))}: there are {', '.join(rows)}")
    measured = []
    for name in options.names or rows:
        measured.append({"name": name, **rows[name](options.points)})
        one = measured[-1]
        error = f"{one['error']:.2g} {one['unit']}" if "error" in one else ""
        print(f"{one['what']:45s} {one.get('us', float('nan')):9.2f} us  {error:24s} {one.get('note', '')}", flush=True)
    if options.json:
        with open(options.json, "w") as file:
            json.dump(measured, file, indent=1)


if __name__ == "__main__":
    main()
