"""Runs work for a benchmark, the command or a function: its answer, and what the processor spent on it."""
import json
import os
import subprocess
import tempfile
import time


def run(words, allowed=(0,)):
    """The answer of `words` --json, and its resource usage (ru_utime, ru_stime: seconds of the processor).

    Raises RuntimeError for an exit code that is not in `allowed`.
    """
    with tempfile.TemporaryFile("w+") as out:
        child = subprocess.Popen([*words, "--json", "-q"], stdout=out)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode not in allowed:
            raise RuntimeError(f"{' '.join(words)}: exit {child.returncode}")
        out.seek(0)
        return json.load(out), usage


def best_of(work, times=3):
    """The least seconds of the processor, all threads together, of so many calls, and the last answer."""
    least, answer = float("inf"), None
    for _ in range(times):
        start = time.process_time()
        answer = work()
        least = min(least, time.process_time() - start)
    return least, answer


def without_caustics(scene):
    """Words that turn off what lights cast over optics in a scene: it shines on what is seen, and takes minutes to trace."""
    import trilens
    lights = trilens.load_scene(scene, warn=lambda _: None).to_dict().get("lights", [])
    return [word for i, light in enumerate(lights) if light.get("caustics") for word in ("--set", f"/lights/{i}/caustics=false")]
