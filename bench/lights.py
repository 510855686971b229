#!/usr/bin/python3
"""Lights of more than one point, against quadrature: how far off they are with so many samples.

    PYTHONPATH=build/release/python /usr/bin/python3 bench/lights.py TRILENS FOLDER

Each light alone over a floor on which a wall throws its shadow; the floor is matt, or half metal of roughness 0.5. The
reference knows nothing of trilens: a wall is a rectangle, the lights are some 16 000 to 33 000 points or directions on a
fine grid, and the BRDF is written down again. Writes FOLDER/lights.csv: the root of the mean squared difference over the
floor's pixels as a share of their mean brightness, of `trilens trace` for each number of samples; how far `trilens render`
is from that at most; and how far the reference is from one with a quarter of the points.
"""
import csv
import json
import math
import pathlib
import subprocess
import sys

import numpy as np

WIDTH, HEIGHT, YFOV = 32, 24, 40
EYE = np.array([0.0, 3.0, 5.0])
SAMPLES = (4, 16, 64, 256, 1024)
BASE, METALLIC, ROUGHNESS = np.array([0.7, 0.5, 0.3]), 0.5, 0.5
WALL_X, WALL_HIGH, WALL_HALF = -0.5, 1.0, 1.0  # stands on x = WALL_X, over |z| < WALL_HALF
NEAR = 1.5  # within which ambient light is occluded
PICTURE = (256, 128)
LAMP_AT, LAMP_TO = np.array([-2.0, 2.5, -1.0]), np.array([2.0, -2.5, 1.0]) / math.sqrt(11.25)


def scene(light, samples, material, sky):
    return {"version": 1, "film": {"width": WIDTH, "height": HEIGHT},
            "cameras": [{"yfov": YFOV, "lookAt": {"eye": EYE.tolist(), "at": [0, 0, 0], "up": [0, 1, 0]}}],
            "background": {"file": "sky.hdr"} if sky else {"color": [0, 0, 0]},
            "materials": [{"name": "floor", "baseColorFactor": BASE.tolist(), **material}, {"name": "wall"}],
            "lights": [{**light, "shadows": True, "samples": samples}],
            "meshes": [{"name": "floor", "role": "object", "material": "floor", "faceVertexCounts": [4],
                        "faceVertexIndices": [0, 1, 2, 3], "points": [[-40, 0, 40], [40, 0, 40], [40, 0, -40], [-40, 0, -40]]},
                       {"name": "wall", "role": "object", "material": "wall", "faceVertexCounts": [4],
                        "faceVertexIndices": [0, 1, 2, 3],
                        "points": [[WALL_X, 0, 1], [WALL_X, 0, -1], [WALL_X, 1, -1], [WALL_X, 1, 1]]}]}


def grid(n, m):
    """The middles of n x m cells of the unit square."""
    u, v = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(m) + 0.5) / m)
    return u.ravel(), v.ravel()


def on_disk(fine):
    """Points of equal area on the unit disk."""
    u, v = grid(fine, fine)
    return np.sqrt(u) * np.cos(2 * math.pi * v), np.sqrt(u) * np.sin(2 * math.pi * v)


def across(axis):
    side = np.cross([0, 1, 0], axis)
    side /= np.linalg.norm(side)
    return side, np.cross(axis, side)


class AreaLight:
    """Points on a surface of this area, each with its normal; they shine alike in all directions."""

    def __init__(self, points, normals, area, radiance):
        self.points, self.normals, self.strength = points, normals, area * radiance / len(points)

    def arrive(self, at):
        """Directions to the light, its distances, and radiance times solid angle."""
        way = self.points - at
        distance = np.linalg.norm(way, axis=1)
        direction = way / distance[:, None]
        facing = np.maximum(-(direction * self.normals).sum(1), 0)
        return direction, distance, (self.strength * facing / distance ** 2)[:, None] * np.ones(3)


class FarLight:
    """Directions, each with radiance times solid angle."""

    def __init__(self, directions, light):
        self.directions, self.light = directions, light

    def arrive(self, _):
        return self.directions, np.full(len(self.directions), np.inf), self.light


def rectangle(fine):
    side, up = across(LAMP_TO)
    u, v = grid(fine, fine)
    points = LAMP_AT + 1.5 * (u - 0.5)[:, None] * side + 1.0 * (v - 0.5)[:, None] * up
    return AreaLight(points, LAMP_TO, 1.5, 6)


def disk(fine):
    side, up = across(LAMP_TO)
    x, y = on_disk(fine)
    return AreaLight(LAMP_AT + 0.6 * (x[:, None] * side + y[:, None] * up), LAMP_TO, math.pi * 0.36, 6)


def sphere(fine):
    u, v = grid(fine, fine)
    z, turn = 2 * u - 1, 2 * math.pi * v
    flat = np.sqrt(1 - z * z)
    normals = np.stack([flat * np.cos(turn), z, flat * np.sin(turn)], 1)
    return AreaLight(LAMP_AT + 0.6 * normals, normals, 4 * math.pi * 0.36, 6)


def sun(fine):
    x, y = on_disk(fine)
    sine = math.sin(math.radians(5))
    side, up = across(LAMP_TO)
    # Points of equal area on the disk below a cap are directions of equal projected solid angle about its axis.
    cosine = np.sqrt(1 - sine ** 2 * (x ** 2 + y ** 2))
    directions = sine * (x[:, None] * side + y[:, None] * up) - cosine[:, None] * LAMP_TO
    return FarLight(directions, (3 / len(x) / cosine)[:, None] * np.ones(3))


def sky_of(width, height):
    """Directions and radiance at the middles of a latitude-longitude picture's texels, a glow of 15 degrees in a blue sky."""
    u, v = grid(width, height)
    up, around = math.pi * (0.5 - v), 2 * math.pi * (u - 0.5)
    directions = np.stack([np.cos(up) * np.sin(around), np.sin(up), -np.cos(up) * np.cos(around)], 1)
    glow = np.exp(-0.5 * (np.arccos(np.clip(directions @ -LAMP_TO, -1, 1)) / math.radians(15)) ** 2)
    return directions, (0.2 + 0.3 * (1 + directions[:, 1]))[:, None] * [0.5, 0.7, 1.0] + 8 * glow[:, None] * [1.0, 0.9, 0.7]


def texel_angles(width, height):
    edges = np.sin(math.pi * (0.5 - np.arange(height + 1) / height))
    return np.repeat((edges[:-1] - edges[1:]) * 2 * math.pi / width, width)


def environment(fine):
    width, height = 2 * fine, fine
    directions, radiance = sky_of(width, height)
    return FarLight(directions, radiance * texel_angles(width, height)[:, None])


def ambient(fine):
    directions, _ = sky_of(2 * fine, fine)
    return FarLight(directions, texel_angles(2 * fine, fine)[:, None] * 0.8 * np.ones(3))


def write_sky(file):
    """As Radiance's RGBE, rows from the top."""
    _, radiance = sky_of(*PICTURE)
    _, exponent = np.frexp(radiance.max(1))
    mantissa = np.clip(np.round(radiance * np.exp2(8.0 - exponent)[:, None]), 0, 255)
    rgbe = np.concatenate([mantissa, exponent[:, None] + 128], 1).astype(np.uint8)
    file.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % PICTURE[::-1] + rgbe.tobytes())


LAMP = {"position": LAMP_AT.tolist(), "direction": LAMP_TO.tolist(), "intensity": 6, "visible": False}
# name: what the scene says of it, the reference's light
LIGHTS = {"rectangle": ({"type": "rectangle", "size": [1.5, 1], **LAMP}, rectangle),
          "disk": ({"type": "disk", "radius": 0.6, **LAMP}, disk),
          "sphere": ({"type": "sphere", "radius": 0.6, **{k: v for k, v in LAMP.items() if k != "direction"}}, sphere),
          "sun, 10 degrees": ({"type": "directional", "direction": LAMP_TO.tolist(), "angle": 10, "intensity": 3}, sun),
          "environment": ({"type": "environment"}, environment),
          "ambient occlusion": ({"type": "ambient", "intensity": 0.8, "distance": NEAR}, ambient)}
MATERIALS = {"matt": {}, "rough": {"metallicFactor": METALLIC, "roughnessFactor": ROUGHNESS}}


def brdf(view, light, is_rough):
    """Of the floor, for many directions of light: appendix B of glTF 2.0."""
    if not is_rough:
        return BASE / math.pi * np.ones((len(light), 1))
    half = view + light
    half /= np.linalg.norm(half, axis=1)[:, None]
    a2 = ROUGHNESS ** 4
    masking = [2 * c / (c + np.sqrt(a2 + (1 - a2) * c * c)) for c in (light[:, 1], view[1])]
    lobe = a2 / (math.pi * (half[:, 1] ** 2 * (a2 - 1) + 1) ** 2) * masking[0] * masking[1] / (4 * light[:, 1] * view[1])
    power = (1 - half @ view) ** 5
    fresnel = (0.04 + 0.96 * power)[:, None]
    dielectric = (1 - fresnel) * BASE / math.pi + fresnel * lobe[:, None]
    return (1 - METALLIC) * dielectric + METALLIC * lobe[:, None] * (BASE + (1 - BASE) * power[:, None])


def hits_wall(at, direction, distance):
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (WALL_X - at[0]) / direction[..., 0]
        y, z = at[1] + t * direction[..., 1], at[2] + t * direction[..., 2]
    return (t > 1e-6) & (t < distance) & (y > 0) & (y < WALL_HIGH) & (np.abs(z) < WALL_HALF)


def floor_pixels():
    """Of each pixel whose middle shows the floor: its column and row, the place, and the direction back to the eye."""
    ahead = -EYE / np.linalg.norm(EYE)
    right = np.array([1.0, 0, 0])
    up, half = np.cross(right, ahead), math.tan(math.radians(YFOV / 2))
    for y in range(HEIGHT):
        for x in range(WIDTH):
            way = ahead + (2 * (x + 0.5) / WIDTH - 1) * half * WIDTH / HEIGHT * right + (1 - 2 * (y + 0.5) / HEIGHT) * half * up
            way /= np.linalg.norm(way)
            reach = -EYE[1] / way[1]
            if not hits_wall(EYE, way, reach):
                yield x, y, EYE + reach * way, -way


def reference(light, is_rough, near):
    colours = []
    for _, _, at, view in floor_pixels():
        direction, distance, arriving = light.arrive(at)
        seen = direction[:, 1] > 0
        direction, distance, arriving = direction[seen], distance[seen], arriving[seen]
        free = ~hits_wall(at, direction, np.minimum(distance, near))
        weight = (direction[:, 1] * free)[:, None] * arriving
        colours.append((brdf(view, direction, is_rough) * weight).sum(0))
    return np.array(colours)


def draw(module, trilens, folder, command):
    subprocess.run([trilens, command, "scene.json", "--spp", "1", "-q", "-o", f"{command}.exr"], cwd=folder, check=True)
    picture = module.read_image(folder / f"{command}.exr")
    pixels = np.stack([picture[channel] for channel in "RGB"], axis=-1)
    return np.array([pixels[y, x] for x, y, *_ in floor_pixels()], float)


def off(picture, truth):
    return 100 * math.sqrt(((picture - truth) ** 2).mean()) / truth.mean()


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    import trilens as module
    trilens, folder = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    write_sky(folder / "sky.hdr")
    rows = []
    for name, (light, make) in LIGHTS.items():
        for surface, material in MATERIALS.items():
            if name == "ambient occlusion" and surface != "matt":
                continue
            near = NEAR if name == "ambient occlusion" else np.inf
            truth, coarse = (reference(make(fine), surface == "rough", near) for fine in (128, 64))
            row, apart = {"light": name, "floor": surface}, 0
            for samples in SAMPLES:
                (folder / "scene.json").write_text(json.dumps(scene(light, samples, material, name == "environment")))
                traced, rendered = (draw(module, trilens, folder, command) for command in ("trace", "render"))
                row[f"off_{samples}_percent"] = f"{off(traced, truth):.2f}"
                apart = max(apart, np.abs(traced - rendered).max() / truth.mean())
            row |= {"render_apart_percent": f"{100 * apart:.4f}", "reference_percent": f"{off(coarse, truth):.2f}"}
            rows.append(row)
            print(*row.values(), flush=True)
    with open(folder / "lights.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()
