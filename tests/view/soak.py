#!/usr/bin/python3
"""Random input to the viewer, for as long as one likes: no crash, no hang, no memory that grows.

    python3 soak.py BUILD FOLDER [--seconds 30] [--window] [--seed 1] [SCENE...]

One process for each scene, in turns, all of them at least once, each with a script of random moves, drags, clicks, settings, numbers of the scene (also such
that are no scene), undo, reload. Ends with 1 and names the script where a viewer ends badly, does not answer for ten minutes, or
holds at its end over a quarter and 64 MiB more than in the middle. --window: in OpenGL on an Xvfb (77 where that is missing).
"""
import argparse
import contextlib
import itertools
import json
import pathlib
import random
import shutil
import subprocess
import sys
import time

from xvfb import NO_DISPLAY, display

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCENES = ("sphere", "animation", "cameras", "saddle", "torus", "engine", "hero", "water", "context", "paths/crystal-ball",
          "paths/prism", "paths/wine-glass", "caustics/crystal-ball", "gallery/glass", "gltf/room", "volumes/benzene")
SIZE = 800, 500


def shown(draw):
    """One setting at random."""
    return draw.choice([
        {"n": draw.choice([1, 2, 3, 8, 16])}, {"rays": draw.choice(["fitted", "interpolated", None])},
        {"engine": draw.choice(["exact", "classic", "facets", "limit", "envmap", "planar"])}, {"maxError": draw.choice([None, 0.1, 1])}, {"facets": draw.random() < 0.5},
        {"edges": draw.random() < 0.5}, {"folds": draw.random() < 0.5}, {"method": draw.random() < 0.5},
        {"caustics": draw.random() < 0.3}, {"birdsEye": draw.random() < 0.5}, {"wipe": draw.random()},
        {"exposure": draw.uniform(-3, 3)}, {"layer": draw.choice(["", "direct", "reflect", "refract"])},
        {"left": draw.choice(["projected", "truth", "difference", "displacement", "flip"])},
        {"right": draw.choice(["projected", "truth", "difference", "displacement", "flip"])}])


def step(draw, i):
    at = lambda: [draw.uniform(0, SIZE[0]), draw.uniform(0, SIZE[1])]
    kind = draw.randrange(12)
    if kind < 4:
        return {"random": draw.randrange(1 << 30), "frames": 12}
    if kind == 4:
        return {"drag": [at(), at()], "button": draw.choice(["left", "middle", "right"]), "frames": 6}
    if kind == 5:
        return {"click": at(), "keys": draw.choice(["ctrl", "alt", "shift", ""])}
    if kind == 6:
        return {"wheel": [*at(), draw.uniform(-2, 2)]}
    if kind < 10:
        return {"show": shown(draw)}
    return draw.choice([{"wait": 0.3}, {"undo": draw.randrange(1, 20)}, {"redo": 3}, {"reload": True}, {"orbit": [30, 5], "frames": 6},
                        {"save": "saved.json"}, {"screenshot": "shot.png"}])


def resident(process):
    """MiB that the viewer, which the command becomes, holds."""
    try:
        lines = pathlib.Path(f"/proc/{process.pid}/status").read_text().splitlines()
        return next(int(line.split()[1]) / 1024 for line in lines if line.startswith("VmRSS"))
    except (OSError, StopIteration):
        return None


def soak(words, scene, environment, until):
    """Scripts of one process until the time is over; what it held, and how many pictures it showed, or an error."""
    folder, draw = words.folder, random.Random(f"{words.seed} {scene}")
    steps = [{"show": {"n": 4}}] + [step(draw, i) for i in range(words.steps)]
    name = folder / (scene.replace("/", "-") + ".steps.json")
    name.write_text(json.dumps({"steps": steps}))
    command = [words.build / "trilens", "view", SOURCE / "scenes" / f"{scene}.json", "--script", name, "--window-size", "x".join(map(str, SIZE)),
               "--json"] + (["--window"] if words.window else [])
    log = folder / "last.txt"
    with open(log, "w") as out:
        process = subprocess.Popen(command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT)
    begun, held = time.monotonic(), []
    while process.poll() is None:
        time.sleep(0.5)
        held.append(resident(process) or (held[-1] if held else 0))
        if time.monotonic() > until + 600:
            process.kill()
            return f"no end in {time.monotonic() - begun:.0f} s"
    text = log.read_text()
    if process.returncode:
        return f"ends with {process.returncode}: {text[-3000:]}"
    answer = json.loads(text[text.index("{"):])
    pictures = sum(one["frames"] for one in answer["steps"])
    middle = max(held[len(held) // 3:len(held) // 2 + 1], default=0)
    last = max(held[-len(held) // 4:], default=0)
    print(f"{scene}: {time.monotonic() - begun:.0f} s, {len(steps)} steps, {pictures} frames, {middle:.0f} MiB in the middle, {last:.0f} at the end",
          flush=True)
    return f"grows from {middle:.0f} to {last:.0f} MiB" if last > 1.25 * middle + 64 else None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("folder", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--seconds", type=float, default=30)
    parser.add_argument("--steps", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--window", action="store_true")
    words = parser.parse_args()
    words.folder.mkdir(parents=True, exist_ok=True)
    if words.window and not shutil.which("Xvfb"):
        print("skipped: Xvfb is missing")
        return 77
    until, first = time.monotonic() + words.seconds, words.seed
    with display() if words.window else contextlib.nullcontext(NO_DISPLAY) as environment:
        for words.seed in itertools.count(words.seed):
            for scene in words.scenes:
                failed = soak(words, scene, environment, until)
                if failed:
                    print(f"{scene}, seed {words.seed} ({words.folder}): {failed}")
                    return 1
                if time.monotonic() > until and words.seed > first:
                    return 0
            if time.monotonic() > until:
                return 0


if __name__ == "__main__":
    sys.exit(main())
