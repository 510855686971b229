#!/usr/bin/python3
"""Facets chosen for an error against uniform grids of the same error, over scenes at their full films.

    bench/max_error.py [--error 0.5] [--most 64] [--patience 60] [--trilens PROGRAM] FOLDER SCENE.json[@CAMERA] ...

For each scene: `render --max-error`, its displacement against `trace` (99th percentile over all layers' pixels that
could be measured), its facets and the processor's seconds for the whole program on one thread; then the smallest uniform
n up to --most with the same 99th percentile or less, the same corner rays and no error asked for, with its facets and seconds; none beyond
one that took longer than --patience is tried. FOLDER gets max-error.csv and
max-error.md, rewritten after each scene; scenes that are in the CSV already are not done again.
"""
import argparse
import csv
import pathlib
import sys
import tempfile

from timed_command import run

FIELDS = ["scene", "film", "p99", "mean", "max", "pixels", "traced_percent", "predicted", "facets", "seconds", "uniform_n", "uniform_p99",
          "uniform_facets", "uniform_seconds"]


class Study:
    def __init__(self, options, scene, folder):
        self.options, self.folder = options, folder
        self.scene, _, camera = scene.partition("@")
        self.name = pathlib.Path(self.scene).stem + (f"@{camera}" if camera else "")
        self.view = ["--spp", "1", *(["--camera", camera] if camera else [])]
        self.truth = str(folder / "truth.exr")
        run([options.trilens, "trace", self.scene, "-o", self.truth, *self.view])

    def draw(self, *settings):
        image = str(self.folder / "image.exr")
        picture, usage = run([self.options.trilens, "render", self.scene, "-o", image, "-t", "1", *self.view, *settings])
        # Exit 1: the pictures differ, which is what is measured.
        found, _ = run([self.options.trilens, "compare", self.truth, image], allowed=(0, 1))
        return picture, usage.ru_utime + usage.ru_stime, found["displacement_px"]

    def uniform(self, wanted):
        """The smallest n with a 99th percentile of at most `wanted`, by doubling and halving; None beyond --most."""
        known = {}

        def measure(n):
            if n not in known:
                known[n] = self.draw("-n", str(n), "--rays", "fitted", "--max-error", "0")
            return known[n]

        def good(n):
            p99 = measure(n)[2]["p99"]
            return p99 is not None and p99 <= wanted

        high = 1
        while not good(high):
            if high >= self.options.most or known[high][1] > self.options.patience:
                return None
            high = min(2 * high, self.options.most)
        low = high // 2
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (low, middle) if good(middle) else (middle, high)
        return (high, *measure(high))


def row_of(study):
    picture, seconds, found = study.draw("--rays", "fitted", "--max-error", str(study.options.error))
    row = {"scene": study.name, "film": f"{picture['width']} x {picture['height']}", "p99": found["p99"], "mean": found["mean"],
           "max": found["max"], "pixels": found["pixels"], "predicted": picture["predicted_error"], "facets": picture["projected_facets"],
           "traced_percent": 100 * picture["traced_pixels"] / max(picture["optic_pixels"], 1), "seconds": seconds}
    uniform = study.uniform(found["p99"]) if found["p99"] is not None else None
    if uniform:
        n, other, other_seconds, other_found = uniform
        row |= {"uniform_n": n, "uniform_p99": other_found["p99"], "uniform_facets": other["projected_facets"], "uniform_seconds": other_seconds}
    return {key: (f"{value:.4g}" if isinstance(value, float) else value) for key, value in row.items()}


def write(path, text):
    part = path.with_name("." + path.name + ".part")
    part.write_text(text)
    part.replace(path)


def write_tables(folder, rows, options):
    lines = [",".join(FIELDS)] + [",".join(str(row.get(key, "")) for key in FIELDS) for row in rows]
    write(folder / "max-error.csv", "\n".join(lines) + "\n")
    words = [f"`--max-error {options.error:g}`, each scene at its full film, against the smallest uniform grid (n at most {options.most}, and none finer than one that took {options.patience:g} s) with the same 99th percentile "
             "of the displacement. Seconds are the processor's, one thread, the whole program.", "",
             "| scene | film | p99 px | max px | traced % | facets | s | uniform n | p99 px | facets | s |", "|---|---|---|---|---|---|---|---|---|---|---|"]
    for row in rows:
        cells = [row.get(key) for key in ("scene", "film", "p99", "max", "traced_percent", "facets", "seconds", "uniform_n", "uniform_p99", "uniform_facets",
                                          "uniform_seconds")]
        if not row.get("uniform_n"):
            cells[7] = "none"
        words.append("| " + " | ".join("" if cell is None else str(cell) for cell in cells) + " |")
    write(folder / "max-error.md", "\n".join(words) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--error", type=float, default=0.5, help="pixels")
    parser.add_argument("--most", type=int, default=64, help="the finest uniform grid that is tried")
    parser.add_argument("--patience", type=float, default=60, help="seconds of the processor: a uniform grid is not refined beyond one that took longer")
    parser.add_argument("--trilens", default=str(pathlib.Path(__file__).resolve().parent.parent / "build" / "release" / "trilens"))
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("scenes", nargs="+")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    table = options.folder / "max-error.csv"
    rows = list(csv.DictReader(table.open())) if table.exists() else []
    failed = 0
    for scene in options.scenes:
        file, _, camera = scene.partition("@")
        if any(row["scene"] == pathlib.Path(file).stem + (f"@{camera}" if camera else "") for row in rows):
            continue
        print(scene, file=sys.stderr, flush=True)
        with tempfile.TemporaryDirectory() as folder:
            try:
                rows.append(row_of(Study(options, scene, pathlib.Path(folder))))
            except (RuntimeError, KeyError) as error:
                failed += 1
                print(f"  {error}", file=sys.stderr, flush=True)
                continue
        write_tables(options.folder, rows, options)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
