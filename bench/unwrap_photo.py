#!/usr/bin/python3
"""What a real photograph's conditions do to a mirror ball's panorama: noise, vignetting, 8 bits, JPEG, a pose that was calibrated.

    PYTHONPATH=build/release/python bench/unwrap_photo.py [FOLDER] [--side 1024]

A ball before painted tiles all around, infinitely far, is ray traced, made worse as a camera does, and unwrapped. Truth: the tiles
themselves, of which nothing was traced. Prints a table, and with FOLDER writes unwrap_photo.csv, the photographs and the panoramas:
PSNR in dB over sRGB where a pixel of the photograph is at most half a degree, and how much too bright the panorama is in the
mean. Poses are fitted to 40 pairs of a place on the photograph and a world point, with Gaussian noise (seeded).
"""
import argparse
import csv
import pathlib
import subprocess
import tempfile

import numpy as np

import trilens

PANORAMA = (1024, 512)
TILE = 10  # degrees
RESOLVED = 2  # pixels of the photograph a degree
DISTANCE = 8.0
POSE = ["/meshes/ball/primitive/center", "/meshes/ball/primitive/radius"]


def painted_tiles(width):
    """Tiles of random colours on a grid of longitude and latitude, their joints grey: (width / 2, width, 3), linear."""
    y, x = np.mgrid[0 : width // 2, 0:width] * (360 / width)
    colours = np.random.default_rng(7).uniform(0.05, 0.9, (180 // TILE, 360 // TILE, 3))
    tiles = colours[(y // TILE).astype(int), (x // TILE).astype(int)]
    joint = (np.minimum(y % TILE, TILE - y % TILE) < 0.4) | (np.minimum(x % TILE, TILE - x % TILE) < 0.4)
    return np.where(joint[..., None], 0.4, tiles)


def image_of(colours):
    return trilens.Image.from_arrays({name: np.ascontiguousarray(colours[..., k], np.float32) for k, name in enumerate("RGB")})


def scene_with(folder, side):
    return trilens.parse_scene({
        "version": 1, "film": {"width": side, "height": side, "spp": 3}, "background": {"file": str(folder / "tiles.exr")},
        "cameras": [{"name": "main", "type": "perspective", "yfov": 2.1 * float(np.degrees(np.arcsin(1 / DISTANCE))),
                     "lookAt": {"eye": [0, 0, DISTANCE], "at": [0, 0, 0]}}],
        "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0}],
        "meshes": [{"name": "ball", "role": "optic", "material": "chrome", "resolution": 8,
                    "primitive": {"type": "sphere", "center": [0, 0, 0], "radius": 1}}],
        "render": {"maxDepth": 0}}, warn=lambda message: None)


def srgb(linear):
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def with_noise(photo, share):
    """Of a sensor: the root of the light, and a fifth of it in the dark; `share` of white."""
    random = np.random.default_rng(11)
    return photo + share * np.sqrt(np.clip(photo, 0, None) + 0.04) * random.standard_normal(photo.shape)


def with_vignetting(photo, at_corner):
    """Darker towards the corners by the fourth power of the cosine."""
    side = photo.shape[0]
    y, x = (np.mgrid[0:side, 0:side] + 0.5) / side * 2 - 1
    tangent2 = (x * x + y * y) / 2 * ((1 - at_corner) ** -0.5 - 1)
    return photo / (1 + tangent2[..., None]) ** 2


def kept_as_jpeg(photo, folder, quality):
    """A file of 8 bits in sRGB."""
    image_of(photo).save(folder / "photo.exr")
    file = folder / f"photo-{quality}.jpg"
    subprocess.run(["oiiotool", folder / "photo.exr", "--colorconvert", "linear", "sRGB", "-d", "uint8", "--compression",
                    f"jpeg:{quality}", "-o", file], check=True)
    return file


def fitted_pose(scene, noise):
    """The scene with the ball where 40 pairs with so many pixels of noise put it, from a start that is 1 % off."""
    random = np.random.default_rng(5)
    points = random.uniform(-1, 1, (400, 3)) * 6
    points = points[np.linalg.norm(points, axis=1) > 3]
    images = trilens.Renderer(scene).project(points, path="R")
    images = images[images["inside"] & images["visible"]][:40]
    pixels = np.stack([images["x"], images["y"]], axis=1) + noise * random.standard_normal((len(images), 2))
    start = scene.with_overrides({"/meshes/0/primitive/center": [0.01, -0.01, 0.01], "/meshes/0/primitive/radius": 1.01})
    return trilens.fit(start, pixels, points[images["point"]], POSE, path="R").scene


def conditions(scene, photo, folder):
    """(name, scene, photograph) each."""
    yield "as traced", scene, image_of(photo)
    for quality in (95, 80, 50):
        yield f"JPEG of quality {quality}", scene, kept_as_jpeg(photo, folder, quality)
    for share in (0.01, 0.03, 0.1):
        yield f"noise, {100 * share:g} % of white", scene, image_of(with_noise(photo, share))
    for dark in (0.1, 0.4):
        yield f"vignetting, corners {100 * dark:g} % darker", scene, image_of(with_vignetting(photo, dark))
    for noise in (0.3, 1, 3):
        yield f"pose from 40 pairs, {noise:g} px of noise", fitted_pose(scene, noise), image_of(photo)
    all_of_it = with_noise(with_vignetting(photo, 0.1), 0.01)
    yield "10 % darker, 1 % noise, JPEG 80, pose of 1 px", fitted_pose(scene, 1), kept_as_jpeg(all_of_it, folder, 80)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=pathlib.Path)
    parser.add_argument("--side", type=int, default=1024)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.folder or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        tiles = painted_tiles(4 * PANORAMA[0])
        image_of(tiles).save(folder / "tiles.exr")
        truth = tiles.reshape(PANORAMA[1], 4, PANORAMA[0], 4, 3).mean(axis=(1, 3))
        scene = scene_with(folder, options.side)
        photo = trilens.Renderer(scene).trace().rgb().astype(float)
        rows = []
        print("| photograph | PSNR, dB | too bright | of all directions |\n|---|---|---|---|")
        for k, (name, seen, kept) in enumerate(conditions(scene, photo, folder)):
            panorama = trilens.Renderer(seen).unwrap(kept, f"equirect:{PANORAMA[0]}x{PANORAMA[1]}", proxy="infinity")
            found, used = panorama.rgb(), (panorama["A"] > 0) & (panorama["res.min"] >= RESOLVED)
            off = (srgb(found) - srgb(truth))[used]
            psnr = -10 * np.log10(np.mean(off * off))
            bias = np.mean(found[used]) / np.mean(truth[used]) - 1
            latitude = np.cos(((np.arange(PANORAMA[1]) + 0.5) / PANORAMA[1] - 0.5) * np.pi)[:, None]
            share = float((used * latitude).sum() / (latitude.sum() * PANORAMA[0]))
            rows.append({"photograph": name, "psnr_db": f"{psnr:.1f}", "too_bright": f"{bias:.4f}", "share": f"{share:.3f}"})
            print(f"| {name} | {psnr:.1f} | {100 * bias:.1f} % | {100 * share:.0f} % |", flush=True)
            if options.folder:
                panorama.save(folder / f"panorama-{k}.png")
        if options.folder:
            with open(folder / "unwrap_photo.csv", "w", newline="") as file:
                writer = csv.DictWriter(file, rows[0])
                writer.writeheader()
                writer.writerows(rows)


if __name__ == "__main__":
    main()
