#!/usr/bin/python3
"""Plots what max_error.py measured: facets and seconds of facets chosen for an error over those of the uniform grid of the same error.

    bench/max_error_plot.py MAX-ERROR.csv OUT.svg
"""
import csv
import sys

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["svg.hashsalt"] = "trilens"
import matplotlib.pyplot as plt


def main():
    rows = [row for row in csv.DictReader(open(sys.argv[1], encoding="utf-8")) if row["uniform_n"]]
    figure, axes = plt.subplots(figsize=(8, 0.32 * len(rows) + 1.2))
    for offset, key, colour, label in ((-0.18, "facets", "#1f5fa8", "facets"), (0.18, "seconds", "#c4572e", "processor's time")):
        ratio = [float(row[key]) / float(row["uniform_" + key]) for row in rows]
        axes.barh([i + offset for i in range(len(rows))], [x - 1 for x in ratio], left=1, height=0.34, color=colour, label=label)
    axes.axvline(1, color="black", linewidth=0.8)
    axes.set_xscale("log", base=2)
    axes.set_yticks(range(len(rows)), [row["scene"] for row in rows])
    axes.invert_yaxis()
    axes.set_xlabel("chosen for the error, over the uniform grid of the same 99th percentile")
    axes.legend(loc="best", frameon=False)
    figure.tight_layout()
    figure.savefig(sys.argv[2], metadata={"Date": None})


if __name__ == "__main__":
    main()
