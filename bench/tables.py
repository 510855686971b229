#!/usr/bin/env python3
"""Draws what bench_race measured: python3 bench/tables.py FILE.csv FOLDER

Writes FOLDER/table.md (today beside the aim) and plots of the ratio over triangles, one line per workload, n,
film, threads and instruction set.
"""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# triangles -> (aim at n = 16, at least at n = 16, at least at n = 64), hits left in packet order
AIMS = {12: (6, 3.5, 2), 972: (4, 2.4, 1.4), 10092: (3.5, 2.4, 1.1), 99372: (2.5, 1.8, 1), 1002252: (2, 1.4, 1)}


def aim(row):
    if row["workload"] != "room" or int(row["triangles"]) not in AIMS:
        return "", ""
    best, least, least_fine = AIMS[int(row["triangles"])]
    return {16: (best, least), 64: ("", least_fine)}.get(int(row["n"]), ("", ""))


def table(rows):
    head = ["workload", "triangles", "n", "film", "threads", "isa", "draw ms", "Embree ms", "draw", "low..high",
            "aim", "at least", "written", "with build", "whole", "mismatches", "unexplained"]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for r in rows:
        best, least = aim(r)
        cells = [r["workload"], r["triangles"], r["n"], r["film"], r["threads"], r["isa"],
                 f'{float(r["draw_ms"]):.2f}', f'{float(r["trace_ms"]):.2f}', f'{float(r["ratio_draw"]):.2f}',
                 f'{float(r["lowest"]):.2f}..{float(r["highest"]):.2f}', str(best), str(least),
                 f'{float(r["ratio_written"]):.2f}', f'{float(r["ratio_with_build"]):.2f}',
                 f'{float(r["ratio_whole"]):.2f}', r["mismatches"], r["unexplained"]]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def plot(rows, column, title, file):
    lines = {}
    for r in rows:
        key = f'{r["workload"]}, n = {r["n"]}, {r["film"]}, {r["threads"]} thread, {r["isa"]}'
        lines.setdefault(key, []).append((int(r["triangles"]), float(r[column])))
    figure, axes = plt.subplots(figsize=(8, 5))
    for key, points in sorted(lines.items()):
        axes.plot(*zip(*sorted(points)), marker="o", label=key)
    axes.axhline(1, color="grey", linewidth=0.8)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("triangles of the scene")
    axes.set_ylabel("Embree's time / projector's time")
    axes.set_title(title)
    axes.legend(fontsize=7)
    axes.grid(True, which="both", alpha=0.3)
    figure.tight_layout()
    figure.savefig(file)
    plt.close(figure)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1], newline="") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        sys.exit(f"{sys.argv[1]} holds no measurements")
    folder = pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "table.md").write_text(table(rows))
    plot(rows, "ratio_draw", "Hits left in order, rays and samples made beforehand", folder / "draw.svg")
    plot(rows, "ratio_written", "Hits written per sample", folder / "written.svg")
    plot(rows, "ratio_whole", "With trees, rays and samples", folder / "whole.svg")


if __name__ == "__main__":
    main()
