"""How far a mirror's picture is from the truth, over the resolution of its grid.

Projects a scene at several resolutions, traces it once, measures how many pixels what the mirror shows lies from
where the truth shows it, and plots that error with its fitted order.

    python3 error_against_resolution.py [SCENE.json] [--size 320x240] [-o error_against_resolution.png]

Without a scene it is scenes/sphere.json of the source tree, or where that is not, the module's example of a mirror sphere.
"""
import argparse
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import trilens

SPHERE = pathlib.Path(__file__).resolve().parent / "../../scenes/sphere.json"
RESOLUTIONS = [1, 2, 4, 8, 16]
SHOWN = 4  # the resolution whose pictures are shown


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene", nargs="?", default=SPHERE if SPHERE.exists() else None)
    parser.add_argument("--size", default="320x240", help="film size in pixels, WxH")
    parser.add_argument("-o", "--output", default="error_against_resolution.png")
    return parser.parse_args()


def load_scene(file, size):
    width, height = map(int, size.split("x"))
    film = {"/film/width": width, "/film/height": height}
    if file is None:
        return trilens.parse_scene(trilens.scene_examples()["mirror-sphere"], overrides=film)
    return trilens.load_scene(file, film)


def measure(renderer, truth):
    """Comparisons with the truth by resolution."""
    found = {}
    for n in RESOLUTIONS:
        found[n] = trilens.compare(truth, renderer.render(n))
        shift = found[n].displacement
        print(f"n = {n:3d}   mean {shift.mean:.4f} px   p95 {shift.p95:.4f} px   {shift.lost} lost")
    return found


def srgb(linear):
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def show_picture(axes, title, picture, **options):
    axes.set_title(title)
    axes.set_axis_off()
    return axes.imshow(picture, **options)


def show_shift(axes, comparison, layer):
    shift = comparison.displacement_arrays(layer)
    pixels = np.where(shift["state"] == 1, np.hypot(shift["shift_x"], shift["shift_y"]), np.nan)
    picture = show_picture(axes, f"displacement, n = {SHOWN}", pixels, cmap="viridis", vmin=0,
                           vmax=comparison.displacement.p99)
    axes.figure.colorbar(picture, ax=axes, label="pixels", fraction=0.036)


def show_errors(axes, found):
    n = np.array(RESOLUTIONS, float)
    for name, label in {"mean": "mean", "p50": "median", "p95": "95 %"}.items():
        errors = [getattr(found[k].displacement, name) for k in RESOLUTIONS]
        fit = trilens.fit_power_law(n, errors)
        print(f"{label:7s} order {fit.order:.2f}, r2 {fit.r2:.4f}")
        (line,) = axes.loglog(n, fit.constant * n**-fit.order, "--", linewidth=1)
        axes.loglog(n, errors, "o", color=line.get_color(), label=f"{label}: order {fit.order:.2f}")
    axes.set_xticks(n, [str(k) for k in RESOLUTIONS])
    axes.minorticks_off()
    axes.set_xlabel("resolution n (n x n squares per face)")
    axes.set_ylabel("displacement, pixels")
    axes.grid(True, alpha=0.3)
    axes.legend()


def main():
    arguments = parse_arguments()
    renderer = trilens.Renderer(load_scene(arguments.scene, arguments.size))
    truth = renderer.trace()
    found = measure(renderer, truth)

    figure, axes = plt.subplots(2, 2, figsize=(10, 7.5), layout="constrained")
    show_picture(axes[0, 0], f"projected, n = {SHOWN}", srgb(renderer.render(SHOWN).rgb()))
    show_picture(axes[0, 1], "ray traced", srgb(truth.rgb()))
    layer = next(name for name, one in found[SHOWN].layers.items() if one.displacement and one.displacement.pixels)
    show_shift(axes[1, 0], found[SHOWN], layer)
    show_errors(axes[1, 1], found)
    figure.savefig(arguments.output, dpi=100)
    print(arguments.output)


if __name__ == "__main__":
    main()
