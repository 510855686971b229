#!/usr/bin/python3
"""Rough mirrors: how far pictures of few ways of light are from one of many.

    /usr/bin/python3 bench/rough_optics.py TRILENS FOLDER

One steel ball of four roughnesses, 120 x 120 pixels of one sample each: alone in the environment of scenes/textures/sky.exr, and
on a chequered floor between posts in it, which plain light without shadows lights. Writes FOLDER/rough_optics.csv: PSNR over the film of RGB in dB and FLIP of
`trilens render` with 16 and 64 ways a fragment and of `trilens trace` with 128 ways a pixel, against `trilens trace` with 2048;
and prints it as a table of Markdown.
"""
import csv
import json
import pathlib
import subprocess
import sys

SKY = pathlib.Path(__file__).resolve().parent.parent / "scenes/textures/sky.exr"
ROUGHNESSES = (0.05, 0.1, 0.2, 0.3)
TRUTH = 2048
# column: command, the setting, ways
PICTURES = {"render 16": ("render", "roughSamples", 16), "render 64": ("render", "roughSamples", 64),
            "trace 128": ("trace", "roughTruthSamples", 128)}


def post(name, material, x, z):
    return {"name": name, "role": "object", "material": material,
            "primitive": {"type": "cylinder", "center": [x, 0.5, z], "radius": 0.12, "height": 1}}


FLOOR = [{"name": "floor", "role": "object", "material": "floor",
          "primitive": {"type": "plane", "center": [0, 0, 0], "normal": [0, 1, 0], "tangent": [1, 0, 0], "size": [12, 12]}},
         post("left", "red", -1.1, 0.6), post("right", "blue", 1.1, 0.6), post("behind", "red", 0.4, -1.4)]
SCENES = {"in an environment": [], "on a chequered floor, between posts": FLOOR}


def scene(objects, roughness):
    return {"version": 1, "film": {"width": 120, "height": 120, "spp": 1},
            "cameras": [{"yfov": 26, "lookAt": {"eye": [0, 1.6, 5], "at": [0, 0.75, 0]}}],
            "background": {"file": str(SKY)},
            "materials": [{"name": "steel", "baseColorFactor": [0.93, 0.93, 0.94], "metallicFactor": 1, "roughnessFactor": roughness},
                          {"name": "floor", "baseColorTexture": {"pattern": "checker", "count": [24, 24],
                                                                 "colors": [[0.75, 0.73, 0.68], [0.22, 0.24, 0.28]]}},
                          {"name": "red", "baseColorFactor": [0.75, 0.1, 0.06]}, {"name": "blue", "baseColorFactor": [0.08, 0.2, 0.65]}],
            "meshes": [{"name": "ball", "role": "optic", "material": "steel", "resolution": 48,
                        "primitive": {"type": "sphere", "center": [0, 0.75, 0], "radius": 0.75}}] + objects,
            "lights": [{"type": "directional", "direction": [-0.5, -1, -0.6], "intensity": 2}, {"type": "ambient", "intensity": 0.4}]}


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)

    def run(*words):
        return subprocess.run([program, *map(str, words)], check=True, capture_output=True, text=True).stdout

    def picture(command, setting, ways):
        out = folder / f"{command}.exr"
        run(command, folder / "scene.json", "--set", f"/render/{setting}={ways}", "-q", "-o", out)
        return out

    rows = []
    for name, objects in SCENES.items():
        for roughness in ROUGHNESSES:
            (folder / "scene.json").write_text(json.dumps(scene(objects, roughness)))
            truth = folder / "truth.exr"
            picture("trace", "roughTruthSamples", TRUTH).rename(truth)
            row = {"scene": name, "roughness": roughness}
            for column, (command, setting, ways) in PICTURES.items():
                told = json.loads(run("compare", truth, picture(command, setting, ways), "--warn", 1, "--fail", 1, "--json", "-q"))
                metrics = told["metrics"]["RGB"]
                row |= {f"{column} PSNR": round(metrics["psnr_db"], 1), f"{column} FLIP": round(metrics["flip"], 4)}
            rows.append(row)
            print(f"| {name} | {roughness} | " + " | ".join(f"{row[c + ' PSNR']:.1f}, {row[c + ' FLIP']:.4f}" for c in PICTURES) + " |", flush=True)
    with open(folder / "rough_optics.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


main()
