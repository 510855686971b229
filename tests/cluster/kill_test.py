#!/usr/bin/python3
"""A sweep over optics x n x engine x spp, killed at random moments and resumed, against an unbroken one; and
three shards in folders of their own, merged.

usage: kill_test.py TRILENS SCRATCH_FOLDER [KILLS]
"""
import os
import random
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from slurm_test import comparable, done_runs  # noqa: E402

SCENE = """{"version": 1, "film": {"width": 64, "height": 48},
 "cameras": [{"name": "main", "type": "perspective", "yfov": 45, "lookAt": {"eye": [0, 0, 5], "at": [0, 0, 0], "up": [0, 1, 0]}}],
 "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0}, {"name": "red", "baseColorFactor": [0.8, 0.2, 0.1]},
               {"name": "blue", "baseColorFactor": [0.1, 0.2, 0.8]}],
 "meshes": [
  {"name": "left", "role": "optic", "material": "chrome", "primitive": {"type": "sphere", "center": [-1.1, 0, 0], "radius": 1}},
  {"name": "right", "role": "optic", "material": "chrome", "primitive": {"type": "sphere", "center": [1.1, 0, 0], "radius": 0.9}},
  {"name": "wall", "role": "object", "material": "red", "points": [[-9, -9, 7], [9, -9, 7], [9, 9, 7], [-9, 9, 7]], "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]},
  {"name": "floor", "role": "object", "material": "blue", "points": [[-9, -2, -9], [9, -2, -9], [9, -2, 9], [-9, -2, 9]], "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]}],
 "lights": [{"type": "ambient", "color": [1, 1, 1]}]}
"""
AXES = ["--over", "optic=left,right", "--over", "resolution=1,2,3,4,6,8,12,16", "--over", "engine=exact,classic", "--over", "spp=1,2"]


def main(trilens, scratch, kills):
    shutil.rmtree(scratch, ignore_errors=True)
    os.makedirs(scratch)
    scene = scratch + "/scene.json"
    with open(scene, "w") as file:
        file.write(SCENE)

    def words(folder, *more):
        return [trilens, "sweep", "run", scene, *AXES, "-o", scratch + "/" + folder, "-q", *more]

    started = time.monotonic()
    subprocess.run(words("whole"), check=True)
    seconds = time.monotonic() - started
    chance = random.Random(os.environ.get("TRILENS_TEST_SEED", "sweep"))
    told = []
    for kill in range(kills):
        how = [signal.SIGKILL, signal.SIGTERM, signal.SIGINT][kill % 3]
        before = done_runs(scratch + "/killed")
        process = subprocess.Popen(words("killed", "-j", str(1 + kill % 2)))
        # A few runs further on than the last time, and then at any moment.
        target, latest = before + chance.randrange(0, 7), time.monotonic() + 120
        while process.poll() is None and time.monotonic() < latest and done_runs(scratch + "/killed") < target:
            time.sleep(0.005)
        time.sleep(chance.uniform(0, seconds / 32))
        process.send_signal(how)
        code = process.wait()
        done = done_runs(scratch + "/killed")
        told.append(f"{how.name} at {done}" + ("" if code else " (had ended)"))
    subprocess.run(words("killed"), check=True)
    assert comparable(scratch + "/killed") == comparable(scratch + "/whole"), "another summary after kills"
    for part in range(3):
        subprocess.run(words(f"part{part}", "--shard", f"{part}/3"), check=True)
    subprocess.run([trilens, "sweep", "merge", *(f"{scratch}/part{part}" for part in range(3)), "-o", scratch + "/merged", "-q"], check=True)
    assert comparable(scratch + "/merged") == comparable(scratch + "/whole"), "another summary after a merge"
    print(f"{done_runs(scratch + '/whole')} runs in {seconds:.1f} s unbroken; killed {', '.join(told)} runs; three shards merged: the same summary")


if __name__ == "__main__":
    main(os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 9)
