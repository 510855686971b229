#!/usr/bin/python3
"""Draws what bench_race_workloads measured: python3 bench/tables.py FILE.csv... FOLDER

Writes FOLDER/table.md (today beside the aim), plots of the ratio over triangles, over n, over the film, over the
samples of a facet and over the layers of the scene, one line per combination of the others, and where the engine
goes from one facet's vectors to shared ones.
"""
import collections
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# triangles -> (aim at n = 16, at least at n = 16, at least at n = 64), hits written per sample
AIMS = {12: (6, 3.5, 2), 972: (4, 2.4, 1.4), 10092: (3.5, 2.4, 1.1), 99372: (2.5, 1.8, 1), 1002252: (2, 1.4, 1)}


def aim(row):
    if row["workload"] != "room" or int(row["triangles"]) not in AIMS:
        return "", ""
    best, least, least_fine = AIMS[int(row["triangles"])]
    return {16: (best, least), 64: ("", least_fine)}.get(int(row["n"]), ("", ""))


def table(rows):
    head = ["workload", "triangles", "n", "film", "threads", "isa", "visible ms", "written ms", "Embree ms", "visible", "written",
            "low..high", "aim", "at least", "with build", "whole", "samples per facet", "shared", "layers", "ambiguous", "mismatches", "unexplained"]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for r in rows:
        best, least = aim(r)
        cells = [r["workload"], r["triangles"], r["n"], r["film"], r["threads"], r["isa"],
                 f'{float(r["visible_ms"]):.2f}', f'{float(r["written_ms"]):.2f}', f'{float(r["trace_written_ms"]):.2f}',
                 f'{float(r["ratio_visible"]):.2f}', f'{float(r["ratio_written"]):.2f}',
                 f'{float(r["lowest"]):.2f}..{float(r["highest"]):.2f}', str(best), str(least),
                 f'{float(r["ratio_with_build"]):.2f}',
                 f'{float(r["ratio_whole"]):.2f}', f"{number(r, 'samples'):.0f}", f'{float(r["shared"]):.1%}',
                 f'{float(r["depth_complexity"]):.1f}', f'{float(r["ambiguous"]):.2%}', r["mismatches"], r["unexplained"]]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


AXES = {"triangles": "triangles of the scene", "n": "n: facets along an edge of the sphere's six faces",
        "film": "pixels of the film", "samples": "samples of a facet", "layers": "layers of triangles that a ray meets"}
OTHERS = {"workload": "{}", "triangles": "{} triangles", "n": "n = {}", "film": "{}", "threads": "threads: {}",
          "isa": "{}"}
MOVED_BY = {"samples": "n", "layers": "triangles"}  # what an axis that is measured, not chosen, follows


def number(row, axis):
    if axis == "film":
        width, height = row["film"].split("x")
        return int(width) * int(height)
    if axis == "samples":
        return int(row["pixels"]) / int(row["facets"])
    if axis == "layers":
        return float(row["depth_complexity"])
    return int(row[axis])


COMMON = ("film", "threads", "isa")


def plot(rows, axis, column, file):
    """Of the rows with the film, threads and instruction set that most have (but for the axis) the longest lines, if
    they have three values or more; nothing, and no file, where there is none."""
    chosen = MOVED_BY.get(axis, axis)
    common = {name: collections.Counter(r[name] for r in rows).most_common(1)[0][0] for name in COMMON if name != axis}
    lines = {}
    for r in rows:
        if all(r[name] == value for name, value in common.items()):
            key = ", ".join(text.format(r[name]) for name, text in OTHERS.items()
                            if name != chosen and name not in COMMON)
            lines.setdefault(key, {})[number(r, axis)] = float(r[column])
    most = max((len(points) for points in lines.values()), default=0)
    lines = {key: points for key, points in lines.items() if len(points) == most}
    if most < 3:
        return
    figure, axes = plt.subplots(figsize=(8, 5))
    for key, points in sorted(lines.items()):
        axes.plot(*zip(*sorted(points.items())), marker="o", label=key)
    axes.set_xscale("log")
    axes.set_xlabel(AXES[axis])
    if column in SHARES:
        axes.set_ylabel("share of the samples")
    else:
        axes.axhline(1, color="grey", linewidth=0.8)
        axes.set_yscale("log")
        axes.set_ylabel("Embree's time / projector's time")
    axes.set_title(f"{TITLES[column]}\n" + ", ".join(OTHERS[name].format(common[name]) for name in common))
    axes.legend(fontsize=7)
    axes.grid(True, which="both", alpha=0.3)
    figure.tight_layout()
    figure.savefig(file)
    plt.close(figure)


TITLES = {"ratio_visible": "Triangles seen left in order, t within bounds; rays and samples made beforehand",
          "ratio_written": "Hits written per sample, rays and samples made beforehand", "ratio_whole": "With trees, rays and samples",
          "shared": "Samples in vectors that facets share: rays of their own, not one facet's functions",
          "ambiguous": "Samples that floats left ambiguous, decided exactly"}
SHARES = {"shared", "ambiguous"}


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    rows = []
    for name in sys.argv[1:-1]:
        with open(name, newline="") as file:
            rows += list(csv.DictReader(file))
    if not rows:
        sys.exit("no measurements")
    folder = pathlib.Path(sys.argv[-1])
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "table.md").write_text(table(rows))
    for column in TITLES:
        for axis in AXES:
            plot(rows, axis, column, folder / f"{column.removeprefix('ratio_')}-over-{axis}.svg")


if __name__ == "__main__":
    main()
