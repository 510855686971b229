"""The figures: one plot per figure of chapter 8, from the rows that the studies made."""
import statistics

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)

from measure import METHODS

plt.rcParams.update({"svg.hashsalt": "trilens", "svg.fonttype": "none", "font.size": 9, "axes.grid": True, "grid.alpha": 0.3})


def lines(file, curves, title, x, y, log="xy", upright=None):
    """Writes a plot of `curves`: name -> [(x, y)...] in their order; `upright`: (x, name) of a vertical line."""
    figure, plot = plt.subplots(figsize=(5.2, 3.6))
    for name, points in curves.items():
        dashes = "--" if name in ("packets", "projector alone") else "-"
        plot.plot([p[0] for p in points], [p[1] for p in points], dashes, marker="o", markersize=3, label=name)
    if upright:
        plot.axvline(upright[0], color="black", linestyle=":", label=upright[1])
    plot.set(title=title, xlabel=x, ylabel=y)
    if "x" in log:
        plot.set_xscale("log", base=2)
        ticks = sorted({p[0] for points in curves.values() for p in points})
        plot.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        plot.minorticks_off()
    if "y" in log:
        plot.set_yscale("log")
    plot.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)


def by(rows, group, x, y):
    """name of the group -> [(x, y)...]."""
    curves = {}
    for row in rows:
        curves.setdefault(f"{row[group]:,}" if isinstance(row[group], int) else row[group], []).append((row[x], row[y]))
    return curves


def methods_over(rows, x, names):
    return {name: [(row[x], row[name]) for row in rows] for name in names if name in rows[0]}


def speedups(rows, group, x):
    return by([row | {"speed-up": row["ray tracing"] / row["exact projection"]} for row in rows], group, x, "speed-up")


def draw_all(folder, data):
    """Writes every plot and returns [(figure, file, caption)...]."""
    made = []

    def plot(number, caption, curves, x, y, log="xy", upright=None):
        file = folder / f"fig_{number.replace('.', '_')}.svg"
        lines(file, curves, caption, x, y, log, upright)
        made.append((number, file.name, caption))

    seconds = "seconds"
    pixels, triangles, facets = "pixels across", "scene triangles", "facets projected"
    one, many, cut, meshes = data["configurations"], data["complexity"], data["subdivision"], data["projections"]
    largest = max(row["size"] for row in many)
    at_largest = [row for row in many if row["size"] == largest]
    beside = [*METHODS, "packets", "projector alone"]

    plot("8.1", "Ray tracing one triangle through one facet", by(one, "configuration", "size", "ray tracing"), pixels, seconds)
    plot("8.2", "Ray tracing scenes of 1 to 10,000 triangles", by(many, "triangles", "size", "ray tracing"), pixels, seconds)
    plot("8.3", "Ray tracing: films of several sizes", by(many, "size", "triangles", "ray tracing"), triangles, seconds)
    plot("8.4", "Projecting one triangle through one facet", by(one, "configuration", "size", "exact projection"), pixels, seconds)
    plot("8.5", "Projecting scenes of 1 to 10,000 triangles", by(many, "triangles", "size", "exact projection"), pixels, seconds)
    plot("8.6", f"All methods at {largest} x {largest} pixels", methods_over(at_largest, "triangles", beside), triangles, seconds)
    plot("8.7", "Speed-up by projection, one triangle", speedups(one, "configuration", "size"), pixels, "time traced / projected", "x")
    plot("8.8", "Speed-up by projection, many triangles", speedups(many, "triangles", "size"), pixels, "time traced / projected", "x")
    for number, way, caption in (("8.9", "slices", "Mask difference, curved edges in K slices"),
                                 ("8.10", "tessellate", "Mask difference, K x K smaller triangles")):
        plot(number, caption, relative_differences([row for row in cut if row["way"] == way]), "K", "share of that at K = 1")
    plot("8.11", "Mask difference, mean over configurations", {way: mean_over(cut, way, "relative") for way in ("slices", "tessellate")},
         "K", "share of that at K = 1")
    plot("8.12", "Time, mean over configurations", {way: mean_over(cut, way, "seconds") for way in ("slices", "tessellate")}, "K", seconds)
    plot("8.13", "Ray tracing through many facets", by(meshes, "size", "projections", "ray tracing"), facets, seconds)
    plot("8.14", "Projecting through many facets", by(meshes, "size", "projections", "exact projection"), facets, seconds)
    plot("8.15", f"All methods at {largest} x {largest} pixels", methods_over([row for row in meshes if row["size"] == largest], "projections", beside),
         facets, seconds)
    clipped = [row | {"cost": row["with scene-space clipping"] / row["thesis' projection"]} for row in many]
    plot("8.16", "What clipping to the facet costs", by(clipped, "size", "triangles", "cost"), triangles, "time clipped / not", "x")

    engines = [row for row in data["error_against_time"] if row["n"]]
    plot("error", "Mirror ball, each line from n = 1 to 32",
         {name: [(row["seconds"], row["mean px"]) for row in engines if row["engine"] == name] for name in {row["engine"]: 0 for row in engines}},
         seconds, "mean displacement [pixels]", "y",
         next((row["seconds"], row["engine"]) for row in data["error_against_time"] if not row["n"]))
    return made


def relative(rows):
    """Each row with its difference as a share of the one at the smallest K of its configuration and way."""
    first = {}
    for row in sorted(rows, key=lambda row: row["K"]):
        first.setdefault((row["configuration"], row["way"]), row["difference"])
    return [row | {"relative": row["difference"] / first[row["configuration"], row["way"]]} for row in rows]


def relative_differences(rows):
    return by(relative(rows), "configuration", "K", "relative")


def mean_over(rows, way, column):
    """[(K, mean over the configurations)...]."""
    rows = [row for row in relative(rows) if row["way"] == way]
    return [(k, statistics.mean(row[column] for row in rows if row["K"] == k)) for k in sorted({row["K"] for row in rows})]
