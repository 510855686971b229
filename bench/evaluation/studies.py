"""The measurements of chapter 8, one function per group of figures; each returns rows for a table."""
import pathlib
import statistics

from measure import METHODS, draw, mask_difference, packets, run, timed
from scenes import CONFIGURATIONS, ROOT, configuration_file, random_scene


class Plan:
    """How much is measured."""

    def __init__(self, quick, folder):
        self.folder = pathlib.Path(folder)
        self.out = self.folder / "picture.exr"
        self.repeats = 1 if quick else 5
        self.sizes = [40, 80] if quick else [100, 200, 400, 800]
        self.triangles = [1, 8] if quick else [1, 10, 100, 1000, 10000]
        self.factors = [1, 2] if quick else [1, 2, 3, 4, 5, 6, 8, 10, 12, 16]
        self.facets_across = [1, 2] if quick else [1, 2, 4, 8, 16, 32]
        self.resolutions = [1, 2] if quick else [1, 2, 4, 8, 16, 32]
        self.scene_size = 60 if quick else 400
        self.configurations = list(CONFIGURATIONS)[:1] if quick else list(CONFIGURATIONS)

    def timed(self, method, scene, size, *options):
        return timed(method, scene, self.out, "--size", f"{size}x{size}", "--spp", 1, *options, repeats=self.repeats)

    def all_methods(self, scene, size):
        """Seconds of every method."""
        return {method: self.timed(method, scene, size)["seconds"] for method in METHODS}

    def race(self, scene, size):
        """Seconds of Embree's packets and of the projector on the same rays, without what makes a picture of hits."""
        embree, projector = packets(scene, "--size", f"{size}x{size}", "--spp", 1, repeats=self.repeats)
        return {"packets": embree / 1e3, "projector alone": projector / 1e3}


def configurations(plan):
    """Time against resolution, one facet and one triangle (fig 8.1, 8.4; tables D.4 to D.17)."""
    for name in plan.configurations:
        for size in plan.sizes:
            yield {"configuration": name, "size": size} | plan.all_methods(configuration_file(name), size)


def complexity(plan):
    """Time against resolution and scene triangles, two facets (fig 8.2, 8.3, 8.5 to 8.8, 8.16; tables D.1 to D.3)."""
    for triangles in plan.triangles:
        scene = random_scene(plan.folder, triangles)
        for size in plan.sizes:
            yield {"triangles": triangles, "size": size} | plan.all_methods(scene, size) | plan.race(scene, size)


def subdivision(plan):
    """Mask difference and time against the tessellation factor K (fig 8.9 to 8.12; tables D.18 to D.31)."""
    for name in plan.configurations:
        scene = configuration_file(name)
        size = ["--size", f"{plan.scene_size}x{plan.scene_size}"]
        truth = plan.folder / "truth.exr"
        draw("ray tracing", scene, truth, *size)
        for way in ("slices", "tessellate"):
            for factor in plan.factors:
                method = ["render", "--engine", "classic", f"--{way}", factor]
                draw(method, scene, plan.out, *size)
                difference = mask_difference(str(truth), str(plan.out))
                seconds = plan.timed(method, scene, plan.scene_size)["seconds"]
                yield {"configuration": name, "way": way, "K": factor, "difference": difference, "seconds": seconds}


def projections(plan):
    """Time against the number of facets, a hundred triangles (fig 8.13 to 8.15)."""
    for across in plan.facets_across:
        scene = random_scene(plan.folder, 100, across)
        for size in plan.sizes:
            yield {"projections": 2 * across * across, "size": size} | plan.all_methods(scene, size) | plan.race(scene, size)


def examples(plan):
    """Time of example pictures (table 8.1): the figures' scenes and those of scenes/."""
    files = sorted((ROOT / "scenes/thesis").glob("*.json")) + sorted((ROOT / "scenes").glob("*.json"))
    across = plan.scene_size * 4 // 5
    for file in files[:2] if plan.repeats == 1 else files:
        row = {"scene": str(file.relative_to(ROOT / "scenes"))}
        for method in METHODS:
            measured = timed(method, file, plan.out, "--size", f"{across}x{across * 3 // 4}", "--spp", 1, repeats=min(3, plan.repeats))
            row |= {method: measured["seconds"], "facets": measured["facets"], "triangles": measured["triangles"]}
        yield row


# Engines that show a mirror ball otherwise, with the words that ask for them.
RIVALS = {
    "exact projection": ["render", "--engine", "exact", "--rays", "interpolated"],
    "exact projection, fitted rays": ["render", "--engine", "exact", "--rays", "fitted"],
    "thesis' projection": ["render", "--engine", "classic", "--rays", "interpolated"],
    "ray tracing of the facets": ["trace", "--surface", "facets", "--rays", "interpolated"],
    "environment map": ["render", "--engine", "envmap"],
    "flat facets": ["render", "--engine", "planar"],
}


def error_against_time(plan):
    """What a smaller error costs, and what the exact surface's ray tracing costs beside it."""
    scene = ROOT / "scenes" / "sphere.json"
    film = ["--size", f"{plan.scene_size * 4 // 3}x{plan.scene_size}", "--spp", 1]
    truth = plan.folder / "truth.exr"
    exact = timed(["trace", "--surface", "limit"], scene, truth, *film, repeats=plan.repeats)
    yield {"engine": "ray tracing of the exact surface", "n": None, "seconds": exact["seconds"], "mean px": 0.0, "unmeasured": 0.0}
    for engine, words in RIVALS.items():
        for n in plan.resolutions:
            seconds = timed(words, scene, plan.out, *film, "-n", n, repeats=plan.repeats)["seconds"]
            moved = run(["compare", truth, plan.out])["displacement_px"]
            yield {"engine": engine, "n": n, "seconds": seconds, "mean px": moved["mean"], "unmeasured": 1 - (moved["coverage"] or 0)}


def ratio(rows, numerator, denominator):
    """The median of one method's time over another's."""
    return statistics.median(row[numerator] / row[denominator] for row in rows)
