"""The command that makes scenes of STEP files, as a program: answers, exit codes, what its options do."""
import json
import os
import pathlib
import re
import subprocess

import pytest
import trilens

SOURCE = pathlib.Path(__file__).resolve().parents[2]
LENS = SOURCE / "scenes/models/plano-convex.step"


@pytest.fixture
def cad(command):
    if not (pathlib.Path(os.environ["TRILENS_COMMAND"]).parent / "trilens-cad").exists():
        pytest.skip("trilens-cad is not built: no libocct-data-exchange-dev")
    return lambda *words: command("cad", *words)


def test_a_lens_becomes_a_scene_of_glass(cad, tmp_path):
    out = tmp_path / "lens.json"
    code, answer = cad(LENS, "--glass", "*", "--ior", "1.6", "-o", out)
    assert code == 0 and answer["schema"] == "trilens.cad/1" and answer["warnings"] == []
    assert (answer["glass"], answer["mirrors"], answer["objects"], answer["patches"]) == (1, 0, 0, 3)
    assert json.loads(out.read_text())["materials"][0] == {"name": "glass", "transmissionFactor": 1, "ior": 1.6}
    assert trilens.load_scene(out).warnings == []


def test_what_cannot_be_read_or_written_is_an_error_of_its_kind(cad, tmp_path):
    code, answer = cad(tmp_path / "none.step", "-o", tmp_path / "a.json")
    assert code == 3 and "cannot be read" in answer["errors"][0]
    code, answer = cad(LENS, "--mirror", "none", "-o", tmp_path / "a.json")
    assert code == 3 and 'has no body "none"' in answer["errors"][0]
    assert not (tmp_path / "a.json").exists()
    assert cad(LENS, "-o", tmp_path / "no-folder" / "a.json")[0] == 4
    assert cad(LENS, "--ior", "9", "-o", tmp_path / "a.json")[0] == 2


def test_files_that_kill_the_reader_are_input_errors(cad, tmp_path):
    """One coordinate less in every point by turns: some of these OpenCASCADE dies of."""
    text = LENS.read_text()
    points = list(re.finditer(r"CARTESIAN_POINT\('',\(([^,)]*),([^,)]*),[^)]*\)\)", text))
    assert len(points) > 8
    codes = []
    for point in points:
        file = tmp_path / "cut.step"
        file.write_text(f"{text[:point.start()]}CARTESIAN_POINT('',({point[1]},{point[2]})){text[point.end():]}")
        run = subprocess.run([os.environ["TRILENS_COMMAND"], "cad", file, "-q", "-o", tmp_path / "a.json"],
                             capture_output=True, text=True)
        assert run.returncode in (0, 3)
        assert run.returncode == 0 or run.stderr.startswith(f"trilens: error: {file}: ")
        codes.append(run.returncode)
    assert 3 in codes
