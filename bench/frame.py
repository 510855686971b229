#!/usr/bin/python3
"""Times whole commands as a user waits for them, and says where a picture's time goes.

    python3 bench/frame.py BUILD FOLDER [small]

BUILD holds `trilens` and `bench/bench_stages`. The commands take turns, five rounds, with one thread and with two; a row has the median,
lowest and highest seconds of wall, the median processor seconds and the peak memory. small: one round, of films and
numbers so small that the seconds say nothing.
Writes FOLDER/table.md and, where `perf` may record, FOLDER/profile.md: per cent of the processor's time by what it
was for.
"""
import dataclasses
import json
import math
import os
import pathlib
import random
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

THREADS = (1, 2)


@dataclasses.dataclass
class Size:
    """How much the commands are given to do."""
    repeats: int = 5
    film: tuple = (1920, 1080)
    points: int = 100_000  # of `project`
    side: int = 708        # of the field: its triangles are twice the square
    runs: int = 16         # of the sweep
    prepared: int = 1_002_252  # triangles of the trees, a size of bench_stages

    def film_text(self, times=1):
        return f"{times * self.film[0]}x{times * self.film[1]}"


WHOLE, SMALL = Size(), Size(1, (320, 180), 2000, 40, 2, 972)


# what a profile counts together: name, symbols or libraries
GROUPS = [
    ("kernel: drawing through facets", r"trilens::N_AVX|trilens::N_SSE|draw_batch|Bvh|BlockDrawer|place_exactly"),
    ("samples: facets' samples into vectors", r"plan_tiles|TileMaker|rasterize|group_by_facet|make_sample_tiles"),
    ("shadow rays", r"casts_shadow|segment|unhindered|BoxTree|Tracer|ShearedRay|embree|PrimitiveSurface|Sphere::|on_box"
                    r"|::solve|__fma"),
    ("shading", r"shade_|Shaded|Contributions|sample_colour|lookup_|optic_weights|fresnel|light_of_view"),
    ("compression and packing", r"isal|deflate|zip_block|pack_|OpenEXR|libdeflate|libz|png|ExrStrips"),
    ("textures", r"::lookup|look_up|texels_at|lattice_over|Texture|FacetMap|RayDifferentials|texture_"),
    ("coverage: squares of rays", r"Square|CoverageBounder|MetTriangles|see_first|collect_triangles|are_paired"),
    ("rays and views of samples", r"for_each_camera_ray|SampleViews|FacetViewer|collect_ends|NodeDrawer|ShownDrawer|OpticPaths"
                                  r"|draw_optic_paths|sample_ray|follow|surroundings|HistoryDrawer|facet_map|facet_weights"
                                  r"|trace_samples|shade_rays|FacetRays|set_means"),
    ("pixels of the layers", r"Canvas|BandSource|put_band|mean_colour|draw_layers|::add\b"),
    ("operating system: pages, files", r"\[k\]|kernel|mem(set|cpy|move)"),
]


def field_of_triangles(file, side):
    """A bumpy floor."""
    with open(file, "w") as out:
        for j in range(side + 1):
            for i in range(side + 1):
                x, z = 6 * i / side - 3, 8 * j / side - 3
                out.write(f"v {x:.6f} {-1.2 + 0.05 * math.sin(9 * x) * math.cos(11 * z):.6f} {z:.6f}\n")
        for j in range(side):
            for i in range(side):
                a = j * (side + 1) + i + 1
                b, c, d = a + 1, a + side + 1, a + side + 2
                out.write(f"f {a} {c} {b}\nf {b} {c} {d}\n")


def write_million(folder, sphere, side):
    """The scene of the sphere with that floor in place of its room."""
    scene = json.loads(re.sub(r"^\s*//.*$", "", sphere.read_text(), flags=re.M))
    field_of_triangles(folder / "field.obj", side)
    scene["meshes"] = [m for m in scene["meshes"] if m["role"] == "optic"]
    scene["meshes"].append({"name": "field", "role": "object", "material": "white", "file": "field.obj"})
    used = {m["material"] for m in scene["meshes"]}
    scene["materials"] = [m for m in scene["materials"] if m["name"] in used]
    (folder / "million.json").write_text(json.dumps(scene))
    return folder / "million.json"


def write_points(file, count):
    numbers = random.Random(1)
    rows = ["x,y,z"] + [f"{numbers.uniform(-3, 3)},{numbers.uniform(0, 3)},{numbers.uniform(-3, 3)}" for _ in range(count)]
    file.write_text("\n".join(rows) + "\n")
    return file


def jobs(folder, sphere, size):
    """One sample a pixel. name, aim in seconds, aim in MB, arguments, whether threads matter; `{}` is the number of threads."""
    hd, uhd = ["--size", size.film_text(), "--spp", "1"], ["--size", size.film_text(2), "--spp", "1"]
    picture = ["render", str(sphere), "-n", "16", "-q", "-t", "{}"]
    exr = ["-o", str(folder / "o.exr")]
    million = ["render", str(write_million(folder, sphere, size.side)), "-n", "16", "-q", "-t", "{}"]
    points = write_points(folder / "points.csv", size.points)
    sweep = ["sweep", "run", str(sphere), "--size", "640x480", "--spp", "1", "--over", f"resolution=1..{size.runs}:+1", "-q", "-t", "{}"]
    return [
        ("render, beauty to EXR, 1080p", 0.25, None, picture + hd + ["--aov", "Z"] + exr, True),
        ("render, beauty to PNG, 1080p", None, None, picture + hd + ["-o", str(folder / "o.png")], True),
        ("render, default layers to EXR, 1080p", None, None, picture + hd + exr, True),
        ("render, all layers to EXR, 1080p", 1.0, None, picture + hd + ["--aov", "all"] + exr, True),
        ("render, all layers to EXR, 4K", 4, 600, picture + uhd + ["--aov", "all"] + exr, True),
        ("render, a million triangles, default layers, 1080p", None, 350, million + hd + exr, True),
        ("project, 100,000 points", 0.3, None,
         ["project", str(sphere), "-n", "16", "--points", str(points), "-q", "-t", "{}"], True),
        ("sweep run, n = 1 to 16, 640x480", 3, None, sweep + ["-o", str(folder / "sweep")], True),
        ("--version", 0.03, None, ["--version"], False),
        ("scene validate", 0.03, None, ["scene", "validate", str(sphere)], False),
    ]


def run(trilens, arguments, threads, folder):
    """Seconds of wall and processor, MB at the peak."""
    shutil.rmtree(folder / "sweep", ignore_errors=True)
    command = [str(trilens)] + [a.replace("{}", str(threads)) for a in arguments]
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    errors = process.stderr.read()
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        sys.exit(f"{' '.join(command)}: exit {process.returncode}\n{errors.decode()}")
    return time.perf_counter() - start, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def prepared_rows(build, size):
    """The trees over a million triangles on one processor, without a command around them."""
    one = {min(os.sched_getaffinity(0))}
    out = subprocess.run([str(build / "bench" / "bench_stages"), f"--benchmark_filter=prepare.*/{size.prepared}",
                          "--benchmark_repetitions=5", "--benchmark_format=json"],
                         check=True, capture_output=True, text=True,
                         preexec_fn=lambda: os.sched_setaffinity(0, one)).stdout
    found = {}
    for entry in json.loads(out)["benchmarks"]:
        if entry["run_type"] == "iteration":
            found.setdefault(entry["name"].split("/")[0], []).append(entry["real_time"] / 1000)
    names = {"prepare_scene": ("the projector's tree, a million triangles", 0.3),
             "prepare_rays": ("the rays' tree, a million triangles", None)}
    return [row(names[name][0], 1, times, "", "", names[name][1], None) for name, times in found.items()]


def row(name, threads, walls, processor, memory, aim, aim_memory):
    return {"what": name, "threads": threads, "seconds": f"{statistics.median(walls):.2f}",
            "lowest..highest": f"{min(walls):.2f}..{max(walls):.2f}", "processor": processor, "peak MB": memory,
            "aim": " ".join([f"{aim} s"] * (aim is not None) + [f"{aim_memory} MB"] * (aim_memory is not None))}


def timed_rows(trilens, folder, sphere, size):
    cells = [(job, t) for job in jobs(folder, sphere, size) for t in (THREADS if job[4] else THREADS[:1])]
    results = [[] for _ in cells]
    for _ in range(size.repeats):
        for (job, threads), result in zip(cells, results):
            result.append(run(trilens, job[3], threads, folder))
    return [row(job[0], threads if job[4] else "", [r[0] for r in result],
                f"{statistics.median(r[1] for r in result):.2f}", f"{max(r[2] for r in result):.0f}", job[1], job[2])
            for (job, threads), result in zip(cells, results)]


def markdown(rows):
    head = list(rows[0])
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(str(r[h]) for h in head) + " |" for r in rows]
    return "\n".join(lines) + "\n"


def profile(trilens, folder, arguments, threads):
    """Group -> per cent of all samples; none where perf may not record."""
    data = folder / "perf.data"
    command = [str(trilens)] + [a.replace("{}", str(threads)) for a in arguments]
    recorded = subprocess.run(["perf", "record", "-q", "-F", "1999", "-o", str(data), "--"] + command,
                              capture_output=True)
    if recorded.returncode:
        return None
    report = subprocess.run(["perf", "report", "-i", str(data), "--sort", "dso,sym", "-t", ";", "--stdio", "-q"],
                            capture_output=True, text=True).stdout
    shares = {name: 0.0 for name, _ in GROUPS} | {"everything else": 0.0}
    for line in report.splitlines():
        parts = line.split(";", 1)
        if len(parts) < 2 or not parts[0].strip().endswith("%"):
            continue
        group = next((name for name, pattern in GROUPS if re.search(pattern, parts[1])), "everything else")
        shares[group] += float(parts[0].strip().rstrip("%"))
    return shares


def profile_rows(trilens, folder, sphere, size):
    wanted = [job for job in jobs(folder, sphere, size) if job[0] in ("render, beauty to EXR, 1080p",
                                                                 "render, all layers to EXR, 1080p")]
    columns = {}
    for job in wanted:
        for threads in THREADS:
            shares = profile(trilens, folder, job[3], threads)
            if shares is None:
                return []
            columns[f"{job[0].split(',')[1].strip()}, {threads} thread{'s' * (threads > 1)}"] = shares
    names = [name for name, _ in GROUPS] + ["everything else"]
    return [{"per cent of the processor's time": name} | {c: f"{s[name]:.0f}" for c, s in columns.items()}
            for name in names]


def main():
    build, out = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    size = SMALL if sys.argv[3:] == ["small"] else WHOLE
    sphere = pathlib.Path(__file__).resolve().parent.parent / "scenes" / "sphere.json"
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as made:
        folder = pathlib.Path(made)
        shutil.copytree(sphere.parent / "textures", folder / "textures")
        rows = timed_rows(build / "trilens", folder, sphere, size) + prepared_rows(build, size)
        (out / "table.md").write_text(markdown(rows))
        print(markdown(rows))
        profiles = profile_rows(build / "trilens", folder, sphere, size) if shutil.which("perf") else []
        if profiles:
            (out / "profile.md").write_text(markdown(profiles))
            print(markdown(profiles))
        else:
            print("no profile: perf is missing or may not record")


if __name__ == "__main__":
    main()
