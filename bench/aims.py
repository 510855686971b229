#!/usr/bin/python3
"""What pictures cost by projection and by ray tracing: every scene that ships, with few and many samples a pixel.

    python3 bench/aims.py BUILD FOLDER [--size WxH] [--scenes NAME...] [--spp N...] [-n N...] [--repeats N]

BUILD holds `trilens`. One thread, seconds of processor (user and system), the least of REPEATS (1). A row is a scene at
one number of samples a pixel (across) and one n; `render / trace` is aimed at 1.1 at the most for one sample, `trace /
render` at 5 for 8 through glass balls, prisms and lenses, at 15 for mirrors. Shares: of the optics' pixels, drawn
through whole facets, through parts of facets, and traced. Writes FOLDER/aims.md and, where `perf` may record,
FOLDER/aims-profile.md: per cent of the processor's time by what it was for.
"""
import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from frame import GROUPS, markdown

SCENES = pathlib.Path(__file__).resolve().parent.parent / "scenes"
# What glass costs, before the groups of whole commands.
GLASS = [
    ("proof of one history", r"has_one_history|Prover|Beam|PatchTree|hull_of"),
    ("exact surfaces met", r"LimitTracer|BoxTree|embree|Newton|solve_surface|eval_trial|make_ray_frame|on_box|OpenSubdiv"
                           r"|LimitSurface|LimitPatches|nearest_to_origin|predict_second"),
    ("paths followed", r"follow|next_optic|branches|glass_branches|fresnel|refracted|Media|repeat_paths|probe|Probe"),
    ("facets divided and fitted", r"Divider|OpticPaths|fit_|FitSample|predicted|estimated"),
] + GROUPS


def shipped():
    found = [p for p in sorted(SCENES.glob("*.json")) if p.stem != "context"]
    return found + sorted((SCENES / "paths").glob("*.json"))


def run(command):
    """Seconds of processor; what it said as JSON."""
    process = subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    said, errors = process.communicate()
    if process.returncode:
        sys.exit(f"{' '.join(map(str, command))}: exit {process.returncode}\n{errors.decode()}")
    return json.loads(said)


def processor_seconds(command, repeats):
    least, said = float("inf"), {}
    for _ in range(repeats):
        before = os.times()
        said = run(command)
        after = os.times()
        least = min(least, after.children_user + after.children_system - before.children_user - before.children_system)
    return least, said


def commands(trilens, scene, spp, size, out):
    common = [scene, "--size", size, "--spp", spp, "-t", 1, "--json", "-o", out]
    return (lambda n: [trilens, "render", *common, "-n", n]), [trilens, "trace", *common]


def rows_of(trilens, scene, args, out):
    for spp in args.spp:
        render, trace = commands(trilens, scene, spp, args.size, out)
        traced, _ = processor_seconds(trace, args.repeats)
        for n in args.n:
            seconds, said = processor_seconds(render(n), args.repeats)
            shares = said["shares"]
            yield {"scene": scene.stem, "samples": f"{spp} x {spp}", "n": n, "render s": f"{seconds:.2f}",
                   "trace s": f"{traced:.2f}", "render / trace": f"{seconds / traced:.2f}",
                   "trace / render": f"{traced / seconds:.2f}",
                   **{name: f"{100 * shares[name]:.0f} %" for name in ("projected", "divided", "traced")}}


def profile(command, data):
    """Group -> per cent; none where perf may not record."""
    recorded = subprocess.run(["perf", "record", "-q", "-F", "499", "-o", str(data), "--", *map(str, command)],
                              capture_output=True)
    if recorded.returncode:
        return None
    report = subprocess.run(["perf", "report", "-i", str(data), "--sort", "dso,sym", "-t", ";", "--stdio", "-q"],
                            capture_output=True, text=True).stdout
    shares = {name: 0.0 for name, _ in GLASS} | {"everything else": 0.0}
    for line in report.splitlines():
        share, _, symbol = line.partition(";")
        if share.strip().endswith("%"):
            group = next((name for name, pattern in GLASS if re.search(pattern, symbol)), "everything else")
            shares[group] += float(share.strip().rstrip("%"))
    return shares


def profile_rows(trilens, scenes, args, folder):
    columns = {}
    for scene in scenes:
        for spp in (args.spp[0], args.spp[-1]):
            render, _ = commands(trilens, scene, spp, args.size, folder / "o.png")
            shares = profile(render(args.n[0]), folder / "perf.data")
            if shares is None:
                return []
            columns[f"{scene.stem}, {spp} x {spp}"] = shares
    names = [name for name, _ in GLASS] + ["everything else"]
    return [{"picture": column} | {name: f"{shares[name]:.0f}" for name in names} for column, shares in columns.items()]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--scenes", nargs="*")
    parser.add_argument("--spp", nargs="*", type=int, default=[1, 4, 8])
    parser.add_argument("-n", nargs="*", type=int, default=[8, 16])
    parser.add_argument("--repeats", type=int, default=1)
    args = parser.parse_args()
    trilens = args.build.resolve() / "trilens"
    scenes = [s for s in shipped() if not args.scenes or s.stem in args.scenes]
    args.folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as made:
        folder = pathlib.Path(made)
        rows = []
        for scene in scenes:
            for row in rows_of(trilens, scene, args, folder / "o.png"):
                print("  ".join(str(v) for v in row.values()), flush=True)
                rows.append(row)
        (args.folder / "aims.md").write_text(markdown(rows))
        profiles = profile_rows(trilens, scenes, args, folder) if shutil.which("perf") else []
        if profiles:
            (args.folder / "aims-profile.md").write_text(markdown(profiles))
            print(markdown(profiles))
        else:
            print("no profile: perf is missing or may not record")


if __name__ == "__main__":
    main()
