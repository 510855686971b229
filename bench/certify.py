#!/usr/bin/python3
"""What --certify proves of scenes, how tight it is and what it costs.

    bench/certify.py [--error 0.5] [--size 320x240] [--most 2000] [--trilens PROGRAM] FOLDER SCENE.json ...

For each scene: `render --max-error E --certify --facets all` at one sample a pixel, and the same without --certify. FOLDER gets
certify.csv and certify.md, rewritten after each scene: the share of the optics' pixels whose displacement is proven to be at most
E, and the largest bound. Two answers are held against the bounds: for --most proven pixels, evenly chosen, the distance to where
`project` finds the nearest image of the place that the pixel shows (how many lie beyond their bound; the bound over that distance,
median and worst, where it is over 0.01 pixels), over mirrors alone; and for all that it can measure, `compare` with `trace` (checked,
beyond), reflected and through glass. None may lie beyond: exit 1. Last, the processor's seconds with the proof and without. Scenes without optics have no row; those that are in
the CSV already are not done again.
"""
import argparse
import csv
import math
import pathlib
import statistics
import sys
import tempfile

from timed_command import run, without_caustics

FIELDS = ["scene", "optic_pixels", "certified_percent", "traced_percent", "largest_bound", "projected", "beyond", "tightness_p50",
          "tightness_max", "compared", "beyond_compared", "seconds", "seconds_uncertified"]
NONE = 4294967295  # of ids: the environment
LEAST = 0.01  # pixels, of which a ratio says something
ROUNDING = 1e-3  # pixels: of places in floats


def proven_pixels(image, most):
    """Some of the pixels with a bound that show one place, over mirrors: (x, y) of their centres, the place, the bound."""
    bound, objects = image["bound"], image["reflectID.object"]
    places = [image[f"reflectP.{axis}"] for axis in "XYZ"]
    rows, columns = ((bound > 0) & (objects != NONE) & (image["path.count"] == 1)).nonzero()
    for i in range(0, len(rows), max(1, -(-len(rows) // most))):
        at = rows[i], columns[i]
        yield (at[1] + 0.5, at[0] + 0.5), [float(one[at]) for one in places], float(bound[at])


def nearest_images(renderer, asked, word, search):
    """For each pixel how far from it `project` finds the nearest image of its place over that word of events (infinity: none), and
    whether the list of images is said to be complete."""
    nearest, complete = [math.inf] * len(asked), [False] * len(asked)
    for image in renderer.project([place for _, place, _ in asked], path=word, search=search, visibility=False):
        i = int(image["point"])
        nearest[i] = min(nearest[i], math.dist(asked[i][0], (float(image["x"]), float(image["y"]))))
        complete[i] = bool(image["complete"])
    return nearest, complete


def held_by_project(options, scene, image):
    """Bounds against the nearest image that `project` finds: pixels asked, beyond, ratios."""
    import trilens
    asked = list(proven_pixels(trilens.read_image(image), options.most))
    if not asked:
        return 0, 0, []
    width, height = map(int, options.size.split("x"))
    film = {"/film/width": width, "/film/height": height}
    renderer = trilens.Renderer(trilens.load_scene(scene, film, warn=lambda _: None))
    distances, complete = [math.inf] * len(asked), [False] * len(asked)
    # Images that the mirror itself hides are listed by the search near facets alone.
    for word, search in ("R", "complete"), ("R", "facets"), ("RR", "complete"), ("RRR", "complete"), ("RRRR", "complete"):
        others = [i for i, (_, _, bound) in enumerate(asked) if distances[i] > bound + ROUNDING]
        if others:
            for i, distance, whole in zip(others, *nearest_images(renderer, [asked[i] for i in others], word, search), strict=True):
                distances[i] = min(distances[i], distance)
                complete[i] = complete[i] or whole
    # No answer is what may be missing from a list.
    known = [i for i, (_, _, bound) in enumerate(asked) if complete[i] or distances[i] <= bound + ROUNDING]
    ratios = [asked[i][2] / distances[i] for i in known if LEAST < distances[i] < math.inf]
    return len(known), sum(distances[i] > asked[i][2] + ROUNDING for i in known), ratios


def name_of(options, scene):
    return str(scene.relative_to(options.scenes_folder)).removesuffix(".json")


def row_of(options, scene, folder):
    truth, image = str(folder / "truth.exr"), str(folder / "image.exr")
    view = [str(scene), "--size", options.size, "-t", "1", *without_caustics(scene)]
    draw = [options.trilens, "render", *view, "--spp", "1", "-o", image, "--max-error", str(options.error), "--facets", "all", "--aov", "all"]
    _, plain = run(draw)
    picture, proven = run([*draw, "--certify"])
    if picture["optic_pixels"] == 0:
        return None
    asked, beyond, ratios = held_by_project(options, scene, image)
    bounds = []
    if picture["certified_pixels"] > 0:
        run([options.trilens, "trace", *view, "--spp", "1", "-o", truth, "--aov", "all"])
        # Exit 1: the pictures differ, which is what is measured.
        found, _ = run([options.trilens, "compare", truth, image], allowed=(0, 1))
        bounds = [found["layers"].get(layer, {}).get("bounds_px") or {} for layer in ("reflect", "refract")]
    pixels = picture["optic_pixels"]
    return {"scene": name_of(options, scene), "optic_pixels": pixels,
            "certified_percent": 100 * picture["certified_pixels"] / pixels, "traced_percent": 100 * picture["traced_pixels"] / pixels,
            "largest_bound": picture["certified_error"], "projected": asked, "beyond": beyond,
            "tightness_p50": statistics.median(ratios) if ratios else None, "tightness_max": max(ratios, default=None),
            "compared": sum(one.get("pixels", 0) for one in bounds), "beyond_compared": sum(one.get("beyond", 0) for one in bounds),
            "seconds": proven.ru_utime + proven.ru_stime, "seconds_uncertified": plain.ru_utime + plain.ru_stime}


def write_tables(options, rows):
    def cell(value):
        return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
    def put(name, lines):
        part = options.folder / ("." + name + ".part")
        part.write_text("\n".join(lines) + "\n")
        part.replace(options.folder / name)
    put("certify.csv", [",".join(FIELDS)] + [",".join(cell(row[key]) for key in FIELDS) for row in rows])
    put("certify.md", [f"`--max-error {options.error:g} --certify --facets all`, {options.size}, one sample a pixel. Asked: by `project`; compared: with `trace`. Seconds are the processor's, one thread, the whole program, with the proof and without.", "",
                       "| scene | pixels of optics | proven % | traced % | largest bound px | asked | beyond | bound over displacement: median | worst | compared | beyond | s | s without |",
                       "|" + "---|" * len(FIELDS)] + ["| " + " | ".join(cell(row[key]) for key in FIELDS) + " |" for row in rows])


def main():
    root = pathlib.Path(__file__).resolve().parent.parent
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--error", type=float, default=0.5, help="pixels")
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--most", type=int, default=2000, help="pixels of each scene that project is asked of")
    parser.add_argument("--trilens", default=str(root / "build" / "release" / "trilens"))
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("scenes", nargs="+", type=pathlib.Path)
    options = parser.parse_args()
    sys.path.insert(0, str(pathlib.Path(options.trilens).resolve().parent / "python"))
    options.folder.mkdir(parents=True, exist_ok=True)
    options.scenes_folder = root / "scenes" if all(root / "scenes" in one.resolve().parents for one in options.scenes) else pathlib.Path("/")
    table = options.folder / "certify.csv"
    rows, failed = list(csv.DictReader(table.open())) if table.exists() else [], 0
    for scene in options.scenes:
        if any(row["scene"] == name_of(options, scene.resolve()) for row in rows):
            continue
        print(scene, file=sys.stderr, flush=True)
        with tempfile.TemporaryDirectory() as folder:
            try:
                row = row_of(options, scene.resolve(), pathlib.Path(folder))
            except (RuntimeError, KeyError) as error:
                failed += 1
                print(f"  {error}", file=sys.stderr, flush=True)
                continue
        if row:
            rows.append(row)
            write_tables(options, rows)
    beyond = sum(int(row["beyond"]) + int(row["beyond_compared"]) for row in rows)
    if beyond:
        print(f"certify: {beyond} pixels lie beyond what is proven of them", file=sys.stderr)
    return 1 if failed or beyond else 0


if __name__ == "__main__":
    sys.exit(main())
