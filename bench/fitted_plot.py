#!/usr/bin/env python3
"""Plots what bench_fitted printed: displacement over n, fitted against interpolated corner rays.

    for s in scenes/sphere.json scenes/torus.json; do bench_fitted rays 4,8,16,32 $s; done > rays.csv
    bench/fitted_plot.py rays.csv rays.svg
"""
import csv
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def main(source, target):
    curves = {}
    with open(source, newline="") as file:
        for row in csv.reader(file):
            if row[0] == "scene":  # each run prints its header
                continue
            name = os.path.splitext(os.path.basename(row[0].split(" ")[0]))[0]
            curves.setdefault((name, row[3]), {}).setdefault(row[1], []).append(
                (int(row[2]), float(row[4]), float(row[5]))
            )
    figure, plots = plt.subplots(1, 2, figsize=(11, 5), sharex=True)
    for colour, (key, ways) in enumerate(sorted(curves.items())):
        for way, points in ways.items():
            points.sort()
            style = "-" if way == "fitted" else "--"
            for plot, column in zip(plots, (1, 2)):
                plot.plot(
                    [p[0] for p in points],
                    [p[column] for p in points],
                    style,
                    color=f"C{colour}",
                    marker="o",
                    label=f"{key[0]}, {key[1]}, {way}",
                )
    for plot, title in zip(plots, ("mean", "99th percentile")):
        plot.set(xscale="log", yscale="log", xlabel="n", ylabel="displacement [pixels]", title=title)
        plot.set_xticks([4, 8, 16, 32], ["4", "8", "16", "32"])
        plot.grid(True, which="both", alpha=0.3)
    plots[1].legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(target)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
