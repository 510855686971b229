#!/usr/bin/python3
"""Plots what bench_fitted printed: displacement over n, fitted and interpolated corner rays, and the usual approximations.

    for s in scenes/sphere.json scenes/torus.json; do bench_fitted rays 4,8,16 $s; done > rays.csv
    bench/fitted_plot.py rays.csv rays.svg

One plot for each scene and layer: the mean over its pixels, on logarithmic scales.
"""
import csv
import os
import sys

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["svg.hashsalt"] = "trilens"
import matplotlib.pyplot as plt

WAYS = {
    "planar": ("flat facets", "#a05a2c", ":"),
    "envmap": ("environment map", "#7a7a7a", ":"),
    "interpolated": ("exact corner rays", "#1f5fa8", "--"),
    "fitted": ("fitted corner rays", "#c0392b", "-"),
}


def read(source):
    """Per (scene, layer) and way the points (n, mean)."""
    curves = {}
    with open(source, newline="") as file:
        for row in csv.DictReader(file):
            if row["scene"] == "scene":  # each run prints its header
                continue
            name = os.path.splitext(os.path.basename(row["scene"].split(" ")[0]))[0]
            ways = curves.setdefault((name, row["layer"]), {})
            ways.setdefault(row["way"], []).append((int(row["n"]), float(row["mean"])))
    return curves


def main(source, target):
    curves = read(source)
    ticks = sorted({n for ways in curves.values() for points in ways.values() for n, _ in points})
    columns = min(4, len(curves))
    rows = (len(curves) + columns - 1) // columns
    figure, plots = plt.subplots(rows, columns, figsize=(3.1 * columns, 3.0 * rows), sharex=True, sharey=True, squeeze=False)
    for plot in plots.flat[len(curves) :]:
        plot.axis("off")
    for plot, ((name, layer), ways) in zip(plots.flat, curves.items()):
        for way, (label, colour, style) in WAYS.items():
            points = sorted(ways.get(way, []))
            plot.plot([p[0] for p in points], [p[1] for p in points], style, color=colour, marker="o", markersize=4, label=label)
        plot.set(xscale="log", yscale="log", title=f"{name}, {layer}")
        plot.set_xticks(ticks, [str(n) for n in ticks])
        plot.minorticks_off()
        plot.grid(True, alpha=0.3)
    for plot in plots[-1]:
        plot.set_xlabel("n")
    for row in plots:
        row[0].set_ylabel("displacement [pixels]")
    handles, labels = plots[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", ncol=4, frameon=False)
    figure.tight_layout(rect=(0, 0, 1, 0.94))
    figure.savefig(target, metadata={"Date": None})


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
