#!/usr/bin/python3
"""Are projected pictures as good as traced ones? Perceived error of both against a truth with many samples a pixel.

    bench/equal_error.py OUT.csv [--size 240x180] [--spp 8] [--truth 16] [--max-error 0.05] [--trilens PROGRAM] SCENE.json ...

The truth is `trace` with --truth x --truth samples a pixel; `render --max-error` and `trace` have --spp x --spp. Of each the mean
FLIP (Andersson et al. 2020), and of `render` the mean signed difference of R, G and B. Aimed at: FLIP of `render` at most 1.1 times
that of `trace`, and 0.001, and a mean difference below 1e-4. Scenes that are in the CSV already are not measured again; lights cast
no caustics, whose truth takes minutes. Exit 1 where a scene misses an aim.
"""
import argparse
import csv
import pathlib
import sys
import tempfile

from timed_command import run, without_caustics

FIELDS = ["scene", "flip_rendered", "flip_traced", "mean_difference", "seconds_rendered", "seconds_traced"]


def row_of(options, scene, folder):
    import trilens
    view = [str(scene), "--size", options.size, "-t", "1", "--aov", "Z", *without_caustics(scene)]
    truth, rendered, traced = (str(folder / name) for name in ("truth.exr", "rendered.exr", "traced.exr"))
    run([options.trilens, "trace", *view, "--spp", str(options.truth), "-o", truth])
    _, of_render = run([options.trilens, "render", *view, "--spp", str(options.spp), "--max-error", str(options.max_error), "-o", rendered])
    _, of_trace = run([options.trilens, "trace", *view, "--spp", str(options.spp), "-o", traced])
    flips = [run([options.trilens, "compare", truth, image], allowed=(0, 1))[0]["metrics"]["RGB"]["flip"] for image in (rendered, traced)]
    image, reference = trilens.read_image(rendered), trilens.read_image(truth)
    difference = sum(float((image[c].astype(float) - reference[c]).mean()) for c in "RGB") / 3
    return [flips[0], flips[1], difference, of_render.ru_utime + of_render.ru_stime, of_trace.ru_utime + of_trace.ru_stime]


def misses(row):
    return float(row["flip_rendered"]) > 1.1 * float(row["flip_traced"]) + 0.001 or abs(float(row["mean_difference"])) >= 1e-4


def main():
    root = pathlib.Path(__file__).resolve().parent.parent
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", default="240x180")
    parser.add_argument("--spp", type=int, default=8)
    parser.add_argument("--truth", type=int, default=16)
    parser.add_argument("--max-error", type=float, default=0.05, help="pixels")
    parser.add_argument("--trilens", default=str(root / "build" / "release" / "trilens"))
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("scenes", nargs="+", type=pathlib.Path)
    options = parser.parse_args()
    sys.path.insert(0, str(pathlib.Path(options.trilens).resolve().parent / "python"))
    rows, failed = list(csv.DictReader(options.out.open())) if options.out.exists() else [], 0
    for scene in options.scenes:
        name = str(scene.resolve().relative_to(root / "scenes") if root / "scenes" in scene.resolve().parents else scene).removesuffix(".json")
        if any(row["scene"] == name for row in rows):
            continue
        print(scene, file=sys.stderr, flush=True)
        with tempfile.TemporaryDirectory() as folder:
            try:
                numbers = row_of(options, scene.resolve(), pathlib.Path(folder))
            except RuntimeError as error:
                failed += 1
                print(f"  {error}", file=sys.stderr, flush=True)
                continue
        rows.append(dict(zip(FIELDS, [name] + [f"{number:.4g}" for number in numbers])))
        part = options.out.with_name("." + options.out.name + ".part")
        with part.open("w", newline="") as out:
            writer = csv.DictWriter(out, FIELDS)
            writer.writeheader()
            writer.writerows(rows)
        part.replace(options.out)
    for row in filter(misses, rows):
        print(f"equal_error: {row['scene']}: FLIP {row['flip_rendered']} rendered, {row['flip_traced']} traced, mean difference {row['mean_difference']}", file=sys.stderr)
    return 1 if failed or any(map(misses, rows)) else 0


if __name__ == "__main__":
    sys.exit(main())
