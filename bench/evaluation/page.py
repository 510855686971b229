"""The page that shows the measurements of chapter 8 and says what they say."""
import math
import os
import platform
import statistics
import subprocess

from measure import TRILENS


def machine():
    """The processor and the program, in words."""
    model = platform.machine()
    try:
        with open("/proc/cpuinfo") as file:
            model = next((line.split(":", 1)[1].strip() for line in file if line.startswith("model name")), model)
    except OSError:
        pass
    version = subprocess.run([TRILENS, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    return f"{version}; {model}, one of {os.cpu_count()} threads used"


def table(rows, columns):
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    for row in rows:
        cells = []
        for name in columns:
            value = row.get(name)
            cells.append("" if value is None else f"{value:.3g}" if isinstance(value, float) else f"{value:,}" if isinstance(value, int) else str(value))
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def ends(rows, x, y):
    """The smallest and the largest x, each with the median of y there."""
    return [(value, statistics.median(row[y] for row in rows if row[x] == value))
            for value in (min(row[x] for row in rows), max(row[x] for row in rows))]


def times(rows, x, y):
    """How many times as large y is at the largest x as at the smallest."""
    (_, first), (_, last) = ends(rows, x, y)
    return last / first


def growth(rows, x, y):
    """The power of x with which y grows between the two."""
    (least, first), (most, last) = ends(rows, x, y)
    return math.log(last / first) / math.log(most / least)


def median_ratio(rows, numerator, denominator):
    return statistics.median(row[numerator] / row[denominator] for row in rows)


def error_words(rows):
    """What the finest facets of each engine say beside the exact surface."""
    exact = next(row["seconds"] for row in rows if not row["n"])
    finest = {row["engine"]: row for row in rows if row["n"]}  # the last of each
    ours, fitted = finest["exact projection"], finest["exact projection, fitted rays"]
    return {"error_n": ours["n"], "error_px": ours["mean px"], "error_time": ours["seconds"] / exact, "fitted_px": fitted["mean px"],
            "fitted_time": fitted["seconds"] / exact, "envmap_px": finest["environment map"]["mean px"], "planar_px": finest["flat facets"]["mean px"]}


def write(file, data, figures):
    one, many, cut, meshes = data["configurations"], data["complexity"], data["subdivision"], data["projections"]
    size = max(row["size"] for row in many)
    large = [row for row in many if row["size"] == size]
    last = max(row["K"] for row in cut)
    left = {way: [row for row in cut if row["way"] == way and row["K"] in (1, last)] for way in ("slices", "tessellate")}

    def remains(way):
        ends = {k: sum(row["difference"] for row in left[way] if row["K"] == k) for k in (1, last)}
        return 100 * ends[last] / ends[1]

    few = [row for row in large if row["triangles"] == min(r["triangles"] for r in large)]
    most = [row for row in large if row["triangles"] == max(r["triangles"] for r in large)]
    text = TEXT.format(
        machine=machine(), size=size, least_size=min(row["size"] for row in one), last=last, most=most[0]["triangles"],
        trace_pixels=growth(one, "size", "ray tracing"), project_pixels=growth(one, "size", "exact projection"),
        trace_times=times(large, "triangles", "ray tracing"), project_times=times(large, "triangles", "exact projection"),
        thesis_times=times(large, "triangles", "thesis' projection"),
        packets_times=times(large, "triangles", "packets"), alone_times=times(large, "triangles", "projector alone"),
        speedup_one=median_ratio(one, "ray tracing", "exact projection"),
        speedup_most=median_ratio(most, "ray tracing", "exact projection"),
        packets_few=median_ratio(few, "packets", "projector alone"), packets_most=median_ratio(most, "packets", "projector alone"),
        slices_left=remains("slices"), tessellate_left=remains("tessellate"), clip=median_ratio(many, "with scene-space clipping", "thesis' projection"),
        **error_words(data["error_against_time"]),
        clip_facets=median_ratio([row for row in meshes if row["size"] == size and row["projections"] == max(r["projections"] for r in meshes)],
                                 "with scene-space clipping", "thesis' projection"),
        most_facets=max(row["projections"] for row in meshes),
        **{f"{word}_facets": times([row for row in meshes if row["size"] == size], "projections", method)
           for word, method in (("trace", "ray tracing"), ("project", "exact projection"), ("thesis", "thesis' projection"))})
    plots = "\n".join(f"![Figure {number}: {caption}]({name})" for number, name, caption in figures)
    methods = ["ray tracing", "exact projection", "thesis' projection", "with scene-space clipping"]
    tables = "\n\n".join((
        "## Table 8.1: example pictures, seconds\n\n" + table(data["examples"], ["scene", "facets", "triangles", *methods]),
        f"## Random triangles, seconds (as tables D.1 to D.3)\n\n" + table(many, ["triangles", "size", *methods, "packets", "projector alone"]),
        "## Configurations, seconds (as tables D.4 to D.17)\n\n" + table(one, ["configuration", "size", *methods]),
        "## Curved edges in pieces (as tables D.18 to D.31)\n\n" + table(cut, ["configuration", "way", "K", "difference", "seconds"]),
        "## Facets, seconds\n\n" + table(meshes, ["projections", "size", *methods, "packets", "projector alone"]),
        "## Error against time, a mirror ball\n\n" + table(data["error_against_time"], ["engine", "n", "seconds", "mean px", "unmeasured"])))
    beside = file.with_suffix(".md.part")
    beside.write_text(f"{text}\n{plots}\n\n{tables}\n")
    beside.replace(file)


TEXT = """# Performance, as chapter 8 of the thesis measures it

Made by `scripts/thesis-evaluation`. {machine}. Times are medians of whole pictures with all their layers, not encoded; only
ratios and slopes say something about another machine. The thesis' own tables are not public as text: its scenes are built
anew (random triangles, and a triangle and a facet searched for each configuration of shapes), so no number here can be held
against one of the thesis. What is compared is how each curve runs, by what each method has to do.

*Ray tracing* is Embree with one ray at a time through the same facets, solved again in double. *Exact projection* is the
default engine; the *thesis' projection* draws outlines with straight edges, without and with scene-space clipping. *Packets*
and *projector alone* are Embree's coherent packets and the projector on the same rays, without what makes a picture of hits.

## What the curves say

**Film** (8.1, 8.2, 8.4, 8.5). From {least_size} to {size} pixels across, the time of one triangle through one facet grows as
the {trace_pixels:.2f}th power of the width when it is traced and as the {project_pixels:.2f}th when it is projected. Both
visit each sample that the facet covers, which would be a power of 2.

**Triangles** (8.3, 8.6). From 1 to {most:,} triangles at {size} pixels across, tracing takes {trace_times:.1f} times as long,
exact projection {project_times:.1f} times, the thesis' projection {thesis_times:.1f} times, packets alone {packets_times:.0f}
times and the projector alone {alone_times:.0f} times. A method that tests each triangle for each sample would take {most:,} times as
long; these all ask a tree. The layers of a picture, which cost the same for any number of triangles, flatten the first three
curves.

**Speed-up** (8.7, 8.8). Over ray tracing one ray at a time, exact projection is {speedup_one:.2f} times as fast for one
triangle, {speedup_most:.2f} times for {most:,}, since most of the time of either is the picture, not the rays. Without the
picture, against Embree's packets and at {size} pixels across, both with their trees, the projector is {packets_few:.2f} times
as fast for one triangle and {packets_most:.2f} times for {most:,}.

**Curved edges in pieces** (8.9 to 8.12). At K = {last} the difference masks have {slices_left:.1f} % of their pixels at K = 1
where edges are cut into slices, and {tessellate_left:.1f} % where the triangle is cut into K x K. Both fall towards zero, as
straight pieces of a curve do; slices cost K pieces an edge, tessellation K x K triangles, which its time shows.

**Facets** (8.13 to 8.15). From 2 to {most_facets:,} facets at {size} pixels across, tracing takes {trace_facets:.2f} times as
long, exact projection {project_facets:.2f} times and the thesis' projection without clipping {thesis_facets:.2f} times: each
facet of the latter draws every triangle that it may show, however few samples it has.

**Clipping** (8.16). Through 2 facets scene-space clipping takes {clip:.2f} times as long as none, in the median; through
{most_facets:,} facets at {size} pixels across {clip_facets:.2f} times, since what is clipped to its facet need not be drawn
elsewhere.

**Error against time** (last figure). A mirror ball through {error_n} x {error_n} facets per face shows things {error_px:.3f} pixels
from their place in the mean, in {error_time:.2f} times the time that ray tracing the exact surface takes; with fitted corner
rays {fitted_px:.3f} pixels in {fitted_time:.2f} times. An environment map stays at {envmap_px:.0f} pixels for any n, flat facets
at {planar_px:.1f}. Finer facets cost next to nothing at this film, so they are what to choose.
"""
