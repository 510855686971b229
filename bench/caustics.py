#!/usr/bin/python3
"""Caustics beside what others do: a light tracer with Embree, the complete search, POV-Ray's photons.

    bench/caustics.py FOLDER [--rays 1e7] [--points 1000] [--size 640x480] [--program build/release/trilens]
                      [--bench build/release/bench/bench_caustics]

Writes FOLDER/caustics.json and caustics.md: seconds of pictures with and without caustics; density at random cells of the
floor against the tracer, in its standard deviations; paths at random points that beams or the search miss; and with finer
and finer beams the root mean square of what their map is off by (against beams divided by exact rays) beside the tracer's
noise after the same time, plotted in equal-time.svg. Where POV-Ray is installed it draws the crystal ball with photons: povray.png, and beside.jpg, ours on
the left. Seconds are the processor's.
"""
import argparse
import json
import math
import os
import pathlib
import re
import shutil
import subprocess

SOURCE = pathlib.Path(__file__).resolve().parent.parent
SCENES = {"ring": "table", "crystal-ball": "table", "pool": "floor"}
CELLS = "200x150"
FADE = 0.01


def seconds_of(words, **options):
    before = os.times()
    done = subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True, **options)
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system, done.stdout


def read_scene(name):
    text = (SOURCE / f"scenes/caustics/{name}.json").read_text()
    return json.loads(re.sub(r"^\s*//.*$", "", text, flags=re.M))


def lights_with_caustics(scene):
    return [i for i, light in enumerate(scene["lights"]) if light.get("caustics")]


def pictures(options, name):
    scene = SOURCE / f"scenes/caustics/{name}.json"
    off = [word for i in lights_with_caustics(read_scene(name)) for word in ("--set", f"/lights/{i}/caustics=false")]
    command = [options.program, "render", scene, "--size", options.size, "-q", "-o", options.folder / f"{name}.png"]
    without, _ = seconds_of([*command[:-1], options.folder / f"{name}-off.png", *off])
    with_caustics, _ = seconds_of(command)
    return {"without": round(without, 3), "with": round(with_caustics, 3), "ratio": round(with_caustics / without, 2)}


def write_povray(scene, file, photons):
    def vector(v):
        return "<" + ",".join(f"{x:.12g}" for x in v) + ">"

    camera, eye_at = scene["cameras"][0], scene["cameras"][0]["lookAt"]
    eye, at = eye_at["eye"], eye_at["at"]
    way = [a - e for a, e in zip(at, eye)]
    far = math.hypot(*way)
    forward = [x / far for x in way]
    right = [-forward[2], 0, forward[0]]  # forward x up
    across = math.hypot(*right)
    right = [x / across for x in right]
    up = [right[1] * forward[2] - right[2] * forward[1], right[2] * forward[0] - right[0] * forward[2],
          right[0] * forward[1] - right[1] * forward[0]]
    high = 2 * math.tan(math.radians(camera["yfov"] / 2))
    width, height = scene["film"]["width"], scene["film"]["height"]
    materials = {one["name"]: one for one in scene["materials"]}
    lines = ["#version 3.7;",
             f"global_settings {{ assumed_gamma 1.0 max_trace_level 10 photons {{ count {photons} }} }}",
             f"background {{ rgb {vector(scene['background']['color'])} }}",
             f"camera {{ perspective location {vector(eye)} direction {vector(forward)} "
             f"right {vector([high * width / height * x for x in right])} up {vector([high * x for x in up])} }}"]
    ambient = next(light["color"] for light in scene["lights"] if light["type"] == "ambient")
    for light in scene["lights"]:
        if light["type"] == "point":  # POV-Ray's surfaces leave the 1 / pi of Lambert's law out
            # Its light fades as 2 / (1 + (distance / fade_distance)^2).
            colour = [light["intensity"] / math.pi / 2 / FADE**2 * x for x in light["color"]]
            lines.append(f"light_source {{ {vector(light['position'])} rgb {vector(colour)} fade_distance {FADE} fade_power 2 "
                         "photons { reflection on refraction on } }")
    for mesh in scene["meshes"]:
        material = materials[mesh["material"]]
        if mesh["role"] == "optic":
            ball = mesh["primitive"]
            lines.append(f"sphere {{ {vector(ball['center'])}, {ball['radius']} pigment {{ rgbt 1 }} finish {{ ambient 0 diffuse 0 "
                         f"reflection {{ 0, 1 fresnel on }} conserve_energy }} interior {{ ior {material['ior']} }} "
                         "photons { target reflection on refraction on } }")
            continue
        points = [mesh["points"][i] for i in mesh["faceVertexIndices"]]
        base = material["baseColorFactor"]
        glow = [b * a for b, a in zip(base, ambient)]
        for a, b, c in ((0, 1, 2), (0, 2, 3)):
            lines.append(f"triangle {{ {vector(points[a])}, {vector(points[b])}, {vector(points[c])} pigment {{ rgb {vector(base)} }} "
                         f"finish {{ ambient 0 emission {vector([g / b if b else 0 for g, b in zip(glow, base)])} diffuse 1 }} }}")
    file.write_text("\n".join(lines) + "\n")


def povray(options):
    if not shutil.which("povray"):
        return "not installed"
    scene = read_scene("crystal-ball")
    width, height = options.size.split("x")
    write_povray(scene, options.folder / "ball.pov", 200_000)
    seconds, _ = seconds_of(["povray", "-D", "-GA", "+Iball.pov", "+Opovray.png", "+FN8", f"+W{width}", f"+H{height}", "-A",
                             "File_Gamma=srgb"], cwd=options.folder)
    return {"seconds": round(seconds, 3), "photons": 200_000}


def table(found):
    lines = ["| scene | without, s | with, s | times | cells within 1, 2, 3 sigma of the tracer | paths | missed by beams | "
             "missed by the search |", "|---|---|---|---|---|---|---|---|"]
    for name, one in found["scenes"].items():
        pictures_of, against = one["pictures"], one["against_tracer"]
        within = ", ".join(f"{100 * against[f'within_{k}_sigma']:.1f} %" for k in (1, 2, 3))
        paths = one.get("paths", {})
        lines.append(f"| {name} | {pictures_of['without']} | {pictures_of['with']} | {pictures_of['ratio']} | {within} | "
                     f"{paths.get('images', '')} | {paths.get('missed_by_beams', '')} | {paths.get('missed_by_search', '')} |")
    lines += ["", "| scene | tolerance | beams | s | rms | tracer's rms in equal time | times |", "|---|---|---|---|---|---|---|"]
    for name, one in found["scenes"].items():
        lines += [f"| {name} | {row['tolerance']:.3g} | {row['beams']} | {row['seconds']:.2f} | {row['rms']:.3g} | "
                  f"{row['tracer_rms']:.3g} | {row['ratio']:.0f} |" for row in one["equal_time"]]
    return "\n".join(lines) + "\n"


def plot(found, target):
    """What a map is off by over the processor's seconds: beams, and the tracer's noise."""
    import matplotlib
    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = "trilens"
    import matplotlib.pyplot as plt
    figure, plots = plt.subplots(1, len(found["scenes"]), figsize=(3.1 * len(found["scenes"]), 3.2), squeeze=False)
    for axes, (name, one) in zip(plots[0], found["scenes"].items()):
        rows, mean = one["equal_time"], one["against_tracer"]["mean"]
        for field, label, style in (("rms", "beams", "-o"), ("tracer_rms", "light tracer", "--o")):
            axes.plot([row["seconds"] for row in rows], [row[field] / mean for row in rows], style, label=label, markersize=4)
        axes.set(xscale="log", yscale="log", title=name, xlabel="seconds of processor")
        axes.grid(True, alpha=0.3)
    plots[0][0].set_ylabel("rms, of the mean irradiance")
    plots[0][0].legend(frameon=False)
    figure.tight_layout()
    figure.savefig(target, metadata={"Date": None})
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--rays", default="1e7")
    parser.add_argument("--points", default="1000")
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--scenes", default=",".join(SCENES))
    parser.add_argument("--program", default=SOURCE / "build/release/trilens")
    parser.add_argument("--bench", default=SOURCE / "build/release/bench/bench_caustics")
    options = parser.parse_args()
    options.folder = options.folder.resolve()
    options.folder.mkdir(parents=True, exist_ok=True)
    found = {"scenes": {}, "povray": povray(options)}
    for name in options.scenes.split(","):
        scene = SOURCE / f"scenes/caustics/{name}.json"
        light = lights_with_caustics(read_scene(name))[0]
        _, answer = seconds_of([options.bench, scene, light, SCENES[name], CELLS, options.rays, options.points])
        found["scenes"][name] = {"pictures": pictures(options, name), **json.loads(answer)}
        (options.folder / "caustics.json").write_text(json.dumps(found, indent=2) + "\n")
        (options.folder / "caustics.md").write_text(table(found))
        plot(found, options.folder / "equal-time.svg")
    if (options.folder / "povray.png").exists() and "crystal-ball" in found["scenes"]:
        subprocess.run(["oiiotool", options.folder / "crystal-ball.png", options.folder / "povray.png", "--mosaic", "2x1", "--ch", "R,G,B",
                        "--nosoftwareattrib", "--compression", "jpeg:88", "-o", options.folder / "beside.jpg"], check=True)
    print(table(found))


if __name__ == "__main__":
    main()
