"""Calls the command: medians of several drawings on one thread, and how far two pictures' masks are apart."""
import json
import os
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
TRILENS = os.environ.get("TRILENS", str(ROOT / "build" / "release" / "trilens"))

# Name: the words that draw a picture so.
METHODS = {
    "ray tracing": ["trace", "--surface", "facets"],
    "exact projection": ["render", "--engine", "exact"],
    "thesis' projection": ["render", "--engine", "classic", "--slices", "1", "--clip", "none"],
    "with scene-space clipping": ["render", "--engine", "classic", "--slices", "1", "--clip", "scene"],
}


def run(words):
    """The command's answer."""
    done = subprocess.run([TRILENS, *map(str, words), "--json", "-q"], capture_output=True, text=True)
    if done.returncode not in (0, 1):
        sys.exit(f"trilens {' '.join(map(str, words))}: exit {done.returncode}\n{done.stderr}")
    return json.loads(done.stdout)


def draw(method, scene, out, *options):
    words = METHODS[method] if isinstance(method, str) else method
    # The thesis draws every facet, also where following its samples would take less time.
    facets = ["--facets", "all"] if words[0] == "render" or "facets" in words else []
    return run([words[0], scene, *words[1:], *facets, *options, "-t", 1, "-o", out])


LONG = 10  # seconds


def timed(method, scene, out, *options, repeats=5):
    """Seconds to prepare and draw: the median of `repeats`, after one that is not counted, and half the range. What
    takes long is drawn once."""
    seconds = []
    for _ in range(repeats + 1):
        answer = draw(method, scene, out, *options)
        seconds.append(answer["prepare_seconds"] + answer["draw_seconds"])
        if seconds[0] > LONG:
            break
    seconds = seconds[1:] or seconds
    return {"seconds": statistics.median(seconds), "spread": (max(seconds) - min(seconds)) / 2,
            "facets": answer["facets"], "triangles": answer["triangles"]}


def packets(scene, *options, repeats=5):
    """Embree's packets and the projector on the same rays in the same run, hits per sample, milliseconds."""
    race = pathlib.Path(TRILENS).parent / "bench" / "bench_race"
    words = [str(word) for word in (race, scene, *options, "--repeat", repeats, "--threads", 1, "--json")]
    answer = json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)
    embree, projector = answer["embree"], answer["projector"]
    return embree["build_ms"] + embree["written_ms"], projector["prepare_ms"] + projector["written_ms"]


def mask_difference(reference, picture):
    """Pixels, with fractions at edges, in which one picture shows a triangle and the other does not."""
    sys.path.insert(0, str(pathlib.Path(TRILENS).parent / "python"))
    import trilens
    return float(abs(trilens.read_image(reference)["A"] - trilens.read_image(picture)["A"]).sum())
