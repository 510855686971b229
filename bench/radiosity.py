#!/usr/bin/python3
"""The light of a matt box by `trilens bake` and by POV-Ray's radiosity, both against paths at random of our own.

    PYTHONPATH=build/release/python /usr/bin/python3 bench/radiosity.py TRILENS FOLDER SAMPLES

The box is that of scenes/radiosity/cornell.json without its balls. Looked at are places all over the picture, a pixel
and more away from edges and from the lamp. The truth is a path tracer in NumPy, with no line of trilens' code: SAMPLES
paths from each place, each of whose turns asks one point of the lamp. POV-Ray 3.7 has the same lamp: points on a
square (area_light with area_illumination) that shine as Lambert's law has it (a spotlight of tightness 1 and 90
degrees) and fall off with the square of the distance. Its walls have an ambient light of 0 and are lit by its radiosity.

How far each is off the truth is a share of the truth's mean; the truth's own error, from the scatter of its paths, is
told beside. Times are those of whole commands: of trilens `bake` and `render`. Writes FOLDER/radiosity.csv and pictures.
"""
import csv
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import time

SOURCE = pathlib.Path(__file__).resolve().parent.parent
SIZE, STEP = 160, 8  # pixels; places lie so far apart
LIGHT_SAMPLES = 36
BAKES = {"trilens bake, patches 0.2": ["--patch-size", "0.2", "--contrast", "2"],
         "trilens bake, patches 0.1": ["--patch-size", "0.1", "--contrast", "2"],
         "trilens bake, patches 0.05": ["--patch-size", "0.05", "--contrast", "2"]}
RADIOSITIES = {"POV-Ray, its defaults": "recursion_limit 6",
               "POV-Ray, count 400": "count 400 error_bound 0.5 nearest_count 10 recursion_limit 6 pretrace_end 0.01",
               "POV-Ray, count 1600": "count 1600 error_bound 0.25 nearest_count 20 recursion_limit 6 pretrace_end 0.01"}


class Box:
    """The scene as NumPy sees it: matt polygons, each a plane with its edges' planes, and the lamp."""

    def __init__(self, np, scene):
        self.np = np
        colors = {m["name"]: m["baseColorFactor"] for m in scene["materials"] if "baseColorFactor" in m}
        self.polygons, self.albedo = [], []
        for mesh in scene["meshes"]:
            at = 0
            for count in mesh["faceVertexCounts"]:
                corners = np.array([mesh["points"][k] for k in mesh["faceVertexIndices"][at:at + count]], float)
                at += count
                self.polygons.append(corners)
                self.albedo.append(colors[mesh["material"]])
        self.albedo = np.array(self.albedo, float)
        lamp = scene["lights"][0]
        self.lamp_middle, self.lamp_size = np.array(lamp["position"], float), lamp["size"]
        self.lamp_radiance = lamp["intensity"] * np.array(lamp["color"], float)
        low, high = self.lamp_middle.copy(), self.lamp_middle.copy()
        x, z = self.lamp_size[0] / 2, self.lamp_size[1] / 2
        self.lamp = np.array([low + [-x, 0, -z], low + [x, 0, -z], high + [x, 0, z], high + [-x, 0, z]])
        self.normals = np.array([self.normal(p) for p in self.polygons])

    def normal(self, corners):
        n = self.np.cross(corners[1] - corners[0], corners[2] - corners[0])
        return n / self.np.linalg.norm(n)

    def hits(self, corners, origin, way):
        """How far along each ray a polygon is met; infinite: it is not."""
        np, n = self.np, self.normal(corners)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (corners[0] - origin) @ n / (way @ n)
        point = origin + t[:, None] * way
        inside = t > 1e-9
        for a, b in zip(corners, np.roll(corners, -1, 0)):
            inside &= (point - a) @ np.cross(n, b - a) >= 0
        return np.where(inside, t, np.inf)

    def first(self, origin, way):
        """Nearest distance and polygon; -1: the lamp, -2: nothing."""
        np = self.np
        best, which = self.hits(self.lamp, origin, way), None
        which = np.where(np.isfinite(best), -1, -2)
        for k, corners in enumerate(self.polygons):
            t = self.hits(corners, origin, way)
            which = np.where(t < best, k, which)
            best = np.minimum(t, best)
        return best, which

    def from_lamp(self, random, at, up):
        """Irradiance over pi from one point of the lamp."""
        np = self.np
        end = self.lamp_middle + (random.random((len(at), 3)) - 0.5) * [self.lamp_size[0], 0, self.lamp_size[1]]
        way = end - at
        square = (way * way).sum(1)
        facing, under = (way * up).sum(1), way[:, 1]
        shine = np.maximum(facing, 0) * np.maximum(under, 0) / (square * square)
        blocked = np.zeros(len(at), bool)
        for corners in self.polygons:
            blocked |= self.hits(corners, at, way) < 1
        area = self.lamp_size[0] * self.lamp_size[1]
        return np.where(blocked, 0, shine)[:, None] * self.lamp_radiance * area / math.pi

    def light_at(self, random, point, up, paths):
        """Irradiance over pi at a place, and its standard error."""
        np = self.np
        at, normal = np.tile(point, (paths, 1)), np.tile(up, (paths, 1))
        weight, total, alive = np.ones((paths, 3)), np.zeros((paths, 3)), np.arange(paths)
        for depth in range(30):
            total[alive] += weight * self.from_lamp(random, at, normal)
            turn, height = 2 * math.pi * random.random(len(alive)), random.random(len(alive))
            along = np.where(np.abs(normal[:, :1]) < 0.5, [[1.0, 0, 0]], [[0.0, 1, 0]])
            u = np.cross(along, normal)
            u /= np.linalg.norm(u, axis=1)[:, None]
            v = np.cross(normal, u)
            out = np.sqrt(height)
            way = (out * np.cos(turn))[:, None] * u + (out * np.sin(turn))[:, None] * v + np.sqrt(1 - height)[:, None] * normal
            t, which = self.first(at, way)
            on = which >= 0
            at, way, which, weight = at[on] + t[on, None] * way[on], way[on], which[on], weight[on] * self.albedo[which[on]]
            normal, alive = self.normals[which], alive[on]
            normal = np.where((normal * way).sum(1)[:, None] > 0, -normal, normal)
            if len(alive) == 0:
                break
        return total.mean(0), total.std(0) / math.sqrt(paths)


def plain_scene():
    """The shipped box, without balls."""
    text = (SOURCE / "scenes/radiosity/cornell.json").read_text()
    scene = json.loads("\n".join(line for line in text.split("\n") if not line.strip().startswith("//")))
    scene["meshes"] = [mesh for mesh in scene["meshes"] if mesh["role"] == "object"]
    scene["film"] = {"width": SIZE, "height": SIZE}
    return scene


def camera_rays(np, scene):
    look, yfov = scene["cameras"][0]["lookAt"], scene["cameras"][0]["yfov"]
    eye, forward = np.array(look["eye"], float), np.array(look["at"], float) - look["eye"]
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0, 1, 0])
    right /= np.linalg.norm(right)
    up, half = np.cross(right, forward), math.tan(math.radians(yfov / 2))
    column, row = np.meshgrid((np.arange(SIZE) + 0.5) / SIZE * 2 - 1, 1 - (np.arange(SIZE) + 0.5) / SIZE * 2)
    return eye, forward + half * (column[..., None] * right + row[..., None] * up)


def places(np, box, scene):
    """Pixels that lie with those around them on one polygon, with its place."""
    eye, ways = camera_rays(np, scene)
    flat = ways.reshape(-1, 3)
    t, which = box.first(np.tile(eye, (len(flat), 1)), flat)
    t, which = t.reshape(SIZE, SIZE), which.reshape(SIZE, SIZE)
    found = []
    for y in range(STEP // 2, SIZE - 1, STEP):
        for x in range(STEP // 2, SIZE - 1, STEP):
            k = which[y, x]
            if k < 0 or (which[y - 2:y + 3, x - 2:x + 3] != k).any():
                continue
            normal = box.normals[k]
            up = -normal if normal @ ways[y, x] > 0 else normal
            found.append((y, x, k, eye + t[y, x] * ways[y, x], up))
    return found


def povray_text(np, box, scene, radiosity):
    def vector(v):
        return "<" + ",".join(f"{x:.9g}" for x in v) + ">"

    eye, ways = camera_rays(np, scene)
    middle = (ways[0, 0] + ways[-1, -1]) / 2
    right, up = (ways[0, -1] - ways[0, 0]) * SIZE / (SIZE - 1), (ways[0, 0] - ways[-1, 0]) * SIZE / (SIZE - 1)
    near = 0.01  # of the light's fall: 2 / (1 + (r / near)^2)
    area = box.lamp_size[0] * box.lamp_size[1]
    color = box.lamp_radiance * area / math.pi / (2 * near * near)
    side = round(math.sqrt(LIGHT_SAMPLES))
    lines = ["#version 3.7;",
             f"global_settings {{ assumed_gamma 1.0 ambient_light 0 max_trace_level 20 radiosity {{ brightness 1 {radiosity} }} }}",
             f"camera {{ perspective location {vector(eye)} direction {vector(middle)} right {vector(right)} up {vector(up)} }}",
             f"light_source {{ {vector(box.lamp_middle)} color rgb {vector(color)} spotlight point_at "
             f"{vector(box.lamp_middle - [0, 1, 0])} radius 90 falloff 90 tightness 1 area_light <{box.lamp_size[0]},0,0>, "
             f"<0,0,{box.lamp_size[1]}>, {side}, {side} area_illumination on fade_distance {near} fade_power 2 }}",
             "#default { finish { ambient 0 diffuse 1 } }"]
    for corners, albedo in [*zip(box.polygons, box.albedo), (box.lamp + [0, 1e-4, 0], (0, 0, 0))]:
        for a, b, c in ((0, 1, 2), (0, 2, 3)):
            lines.append(f"triangle {{ {vector(corners[a])}, {vector(corners[b])}, {vector(corners[c])} "
                         f"pigment {{ rgb {vector(albedo)} }} }}")
    return "\n".join(lines) + "\n"


def timed(commands, folder):
    before, start = os.times(), time.perf_counter()
    for command in commands:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(map(str, command))} failed:\n{done.stderr}")
    wall, after = time.perf_counter() - start, os.times()
    return wall, after.children_user + after.children_system - before.children_user - before.children_system


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    try:
        import numpy as np
        import trilens as module
    except ImportError as missing:
        sys.exit(f"skipped: {missing}")
    if not shutil.which("povray"):
        sys.exit("skipped: POV-Ray is not installed")
    trilens, folder = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    scene = plain_scene()
    box = Box(np, scene)
    (folder / "box.json").write_text(json.dumps(scene))
    asked = places(np, box, scene)
    random, start = np.random.default_rng(1), time.perf_counter()
    found = [box.light_at(random, point, up, int(sys.argv[3])) for _, _, _, point, up in asked]
    truth_time = time.perf_counter() - start
    albedo = np.array([box.albedo[k] for _, _, k, _, _ in asked])
    truth, scatter = albedo * [light for light, _ in found], albedo * [error for _, error in found]
    mean = truth.mean()
    rows = [{"method": f"paths at random, {sys.argv[3]} for each of {len(asked)} places", "wall_s": round(truth_time, 1),
             "processor_s": round(truth_time, 1), "mean_off_percent": round(100 * scatter.mean() * math.sqrt(2 / math.pi) / mean, 2)}]

    def compare(name, file, commands):
        wall, processor = timed(commands, folder)
        picture = module.read_image(folder / file)
        pixels = np.stack([picture[channel] for channel in "RGB"], axis=-1)
        seen = np.array([pixels[y, x] for y, x, *_ in asked], float)
        off = np.abs(seen - truth).mean(1) / mean * 100
        rows.append({"method": name, "wall_s": round(wall, 2), "processor_s": round(processor, 2),
                     "mean_off_percent": round(off.mean(), 2), "median_off_percent": round(float(np.median(off)), 2),
                     "p95_off_percent": round(float(np.percentile(off, 95)), 2),
                     "light_percent": round(100 * seen.mean() / mean, 2)})

    for k, (name, options) in enumerate(BAKES.items()):
        compare(name, f"bake{k}.exr", [[trilens, "bake", "box.json", *options, "-q", "-o", f"baked{k}.json"],
                                       [trilens, "render", f"baked{k}.json", "-q", "-o", f"bake{k}.exr"]])
    for k, (name, words) in enumerate(RADIOSITIES.items()):
        (folder / f"povray{k}.pov").write_text(povray_text(np, box, scene, words))
        compare(name, f"povray{k}.exr", [["povray", "-D", "-GA", f"+Ipovray{k}.pov", f"+Opovray{k}.exr", "+FE", f"+W{SIZE}",
                                          f"+H{SIZE}", "-A", "File_Gamma=1.0"]])
    with open(folder / "radiosity.csv", "w", newline="") as file:
        table = csv.DictWriter(file, list(rows[1]))
        table.writeheader()
        table.writerows(rows)
    print((folder / "radiosity.csv").read_text())


if __name__ == "__main__":
    main()
