"""Chapter 8's measurements: a little of all of them, as the script makes them."""
import csv
import os
import pathlib
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def rows_of(folder, name):
    with (folder / f"{name}.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_all_of_chapter_8_can_be_measured(tmp_path):
    pytest.importorskip("matplotlib")
    environment = dict(os.environ, TRILENS=os.environ["TRILENS_COMMAND"])
    done = subprocess.run([sys.executable, ROOT / "scripts" / "thesis-evaluation", "--quick", tmp_path], env=environment,
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr

    for study in ("configurations", "complexity", "subdivision", "projections", "examples", "error_against_time"):
        assert rows_of(tmp_path, study), study
    for row in rows_of(tmp_path, "complexity"):
        assert all(float(row[name]) > 0 for name in ("ray tracing", "exact projection", "thesis' projection", "packets", "projector alone"))

    # A triangle whose edges are cut finer comes nearer to the ray-traced one.
    for way in ("slices", "tessellate"):
        differences = [float(row["difference"]) for row in rows_of(tmp_path, "subdivision") if row["way"] == way]
        assert differences[0] > differences[-1] > 0

    # So does a mirror of more facets; the rivals hardly.
    engines = {}
    for row in rows_of(tmp_path, "error_against_time"):
        engines.setdefault(row["engine"], []).append(row["mean px"])
    assert float(engines["exact projection"][0]) > 2 * float(engines["exact projection"][-1])

    page = (tmp_path / "README.md").read_text()
    for number in [f"8_{figure}" for figure in range(1, 17)] + ["error"]:
        assert f"fig_{number}.svg" in page and (tmp_path / f"fig_{number}.svg").stat().st_size > 1000
    assert "{" not in page and "TODO" not in page
