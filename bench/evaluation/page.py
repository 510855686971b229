"""The page that shows the measurements of chapter 8 and says what they say."""
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


def growth(rows, x, y):
    """The exponent between the smallest and the largest x, of the median y there."""
    import math
    least, most = min(row[x] for row in rows), max(row[x] for row in rows)
    at = {value: statistics.median(row[y] for row in rows if row[x] == value) for value in (least, most)}
    return math.log(at[most] / at[least]) / math.log(most / least) if most > least else float("nan")


def median_ratio(rows, numerator, denominator):
    return statistics.median(row[numerator] / row[denominator] for row in rows)


def write(file, data, figures):
    one, many, cut, meshes = data["configurations"], data["complexity"], data["subdivision"], data["projections"]
    size = max(row["size"] for row in many)
    large = [row for row in many if row["size"] == size]
    last = max(row["K"] for row in cut)
    left = {way: [row for row in cut if row["way"] == way and row["K"] in (1, last)] for way in ("slices", "tessellate")}

    def remains(way):
        ends = {k: sum(row["difference"] for row in left[way] if row["K"] == k) for k in (1, last)}
        return 100 * ends[last] / ends[1]

    text = TEXT.format(
        machine=machine(), size=size, last=last,
        trace_pixels=growth(one, "size", "ray tracing"), project_pixels=growth(one, "size", "exact projection"),
        trace_triangles=growth(large, "triangles", "ray tracing"), project_triangles=growth(large, "triangles", "exact projection"),
        thesis_triangles=growth(large, "triangles", "thesis' projection"), packets_triangles=growth(large, "triangles", "packets"),
        most=max(row["triangles"] for row in many),
        speedup_one=median_ratio(one, "ray tracing", "exact projection"),
        speedup_few=median_ratio([row for row in large if row["triangles"] == min(r["triangles"] for r in large)], "ray tracing", "exact projection"),
        speedup_most=median_ratio([row for row in large if row["triangles"] == max(r["triangles"] for r in large)], "ray tracing", "exact projection"),
        packets_few=median_ratio([row for row in large if row["triangles"] == min(r["triangles"] for r in large)], "packets", "projector alone"),
        packets_most=median_ratio([row for row in large if row["triangles"] == max(r["triangles"] for r in large)], "packets", "projector alone"),
        slices_left=remains("slices"), tessellate_left=remains("tessellate"),
        clip=median_ratio(many, "with scene-space clipping", "thesis' projection"),
        trace_facets=growth([row for row in meshes if row["size"] == size], "projections", "ray tracing"),
        project_facets=growth([row for row in meshes if row["size"] == size], "projections", "exact projection"),
        thesis_facets=growth([row for row in meshes if row["size"] == size], "projections", "thesis' projection"))
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

Made by `scripts/thesis-evaluation`. {machine}. Times are medians of whole pictures without encoding, so only their ratios
and slopes say something about another machine. The thesis' own tables are not public as text: its scenes are built anew
(random triangles, and a triangle and a facet searched for each configuration of shapes), and what is compared is how each
curve should run by what each method does.

TODO
"""
