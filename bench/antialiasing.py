#!/usr/bin/python3
"""Error against time of antialiased pictures: shaded by fragment, shaded by sample, traced.

    bench/antialiasing.py OUT.csv [--plot OUT.svg] [--size WxH] [--spp 1,2,4,8] [--truth 16] [--trilens PROGRAM] SCENE.json ...

The error is the root mean square over R, G and B against `trace` with --truth x --truth samples per pixel, so what the facets are
off by is in it; seconds are the processor's in user mode, of the whole command on one thread, the least of --repeat runs.
Scenes that are in the CSV already are not measured again; without scenes the CSV is only plotted.
"""
import argparse
import csv
import pathlib
import tempfile

from timed_command import run

WAYS = {"by fragment": ["render", "--shading", "fragment"], "by sample": ["render", "--shading", "sample"], "traced": ["trace"]}
COLOURS = {"by fragment": "#1f5fa8", "by sample": "#7a9fc9", "traced": "#c4572e"}


def measure(options, scene):
    with tempfile.TemporaryDirectory() as folder:
        truth, image = folder + "/truth.exr", folder + "/image.exr"
        common = ["--size", options.size] if options.size else []
        run([options.trilens, "trace", scene, "-o", truth, "--spp", str(options.truth), "--aov", "Z", *common])
        for way, words in WAYS.items():
            for spp in options.spp:
                command = [options.trilens, words[0], scene, "-o", image, "--spp", str(spp), "-t", "1", "--aov", "Z", *words[1:], *common]
                seconds = min(run(command)[1].ru_utime for _ in range(options.repeat))
                found, _ = run([options.trilens, "compare", truth, image], allowed=(0, 1))
                yield {"scene": pathlib.Path(scene).stem, "way": way, "spp": spp, "seconds": round(seconds, 4),
                       "rmse": found["metrics"]["RGB"]["rmse"]}


def plot(rows, options):
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "trilens"
    import matplotlib.pyplot as plt
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    figure, axes = plt.subplots(1, len(scenes), figsize=(2.6 * len(scenes) + 0.6, 3.2), squeeze=False)
    for axis, scene in zip(axes[0], scenes):
        for way in WAYS:
            points = [row for row in rows if row["scene"] == scene and row["way"] == way]
            axis.plot([float(row["seconds"]) for row in points], [float(row["rmse"]) for row in points], "o-", color=COLOURS[way],
                      markersize=3.5, linewidth=1.2, label=way)
        axis.set_xscale("log")
        axis.set_yscale("log")
        for scale in (axis.xaxis, axis.yaxis):
            scale.set_major_locator(LogLocator(subs=(1, 2, 5)))
            scale.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            scale.set_minor_formatter(NullFormatter())
        axis.set_title(scene, fontsize=9)
        axis.set_xlabel("processor's seconds", fontsize=8)
        axis.tick_params(labelsize=7, which="both")
        axis.grid(True, which="both", linewidth=0.3)
    axes[0][0].set_ylabel(f"rms error against {options.truth} x {options.truth} samples", fontsize=8)
    axes[0][0].legend(fontsize=7, frameon=False)
    figure.tight_layout()
    figure.savefig(options.plot, metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv", type=pathlib.Path)
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--plot", type=pathlib.Path)
    parser.add_argument("--size")
    parser.add_argument("--spp", type=lambda text: [int(one) for one in text.split(",")], default=[1, 2, 4, 8])
    parser.add_argument("--truth", type=int, default=16)
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--trilens", default="build/release/trilens")
    options = parser.parse_intermixed_args()

    rows = list(csv.DictReader(open(options.csv, encoding="utf-8"))) if options.csv.exists() else []
    for scene in options.scenes:
        if any(row["scene"] == pathlib.Path(scene).stem for row in rows):
            continue
        rows.extend(measure(options, scene))
        with open(options.csv, "w", encoding="utf-8", newline="") as out:
            writer = csv.DictWriter(out, ["scene", "way", "spp", "seconds", "rmse"], lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    if options.plot:
        plot(rows, options)


if __name__ == "__main__":
    main()
