"""The notebook of examples/ as a reader runs it: every cell by nbconvert, its picture and numbers there."""
import json
import os
import shutil
import subprocess
import sys

import pytest

import trilens
from conftest import SOURCE

NOTEBOOK = SOURCE / "examples/notebook/mirror_ball.ipynb"


def test_the_notebook_runs_and_shows_what_it_says(tmp_path):
    if subprocess.run([sys.executable, "-c", "import nbconvert, ipykernel"], capture_output=True).returncode:
        pytest.skip("nbconvert or ipykernel is missing (python3-nbconvert, python3-ipykernel)")
    folder = os.path.dirname(os.path.dirname(trilens.__file__))
    kernel = tmp_path / "jupyter/kernels/python3"
    kernel.mkdir(parents=True)
    # This interpreter, which has the module under test.
    (kernel / "kernel.json").write_text(json.dumps(
        {"argv": [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"], "display_name": "Python 3",
         "language": "python"}))
    # The still picture: Debian 12's nbconvert knows no widgets of Debian 12's ipywidgets (its messages have no state).
    (tmp_path / "still/ipywidgets").mkdir(parents=True)
    (tmp_path / "still/ipywidgets/__init__.py").write_text("raise ImportError('none here')")
    environment = {**os.environ, "PYTHONPATH": f"{tmp_path / 'still'}:{folder}", "JUPYTER_PATH": str(tmp_path / "jupyter"), "HOME": str(tmp_path),
                   "PYTHONDONTWRITEBYTECODE": "1"}
    shutil.copy(NOTEBOOK, tmp_path / "ball.ipynb")
    run = subprocess.run([sys.executable, "-m", "nbconvert", "--to", "notebook", "--execute", "--output", "run.ipynb",
                          "ball.ipynb"], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stderr[-2000:]
    cells = [cell for cell in json.loads((tmp_path / "run.ipynb").read_text())["cells"] if cell["cell_type"] == "code"]
    outputs = [output for cell in cells for output in cell["outputs"]]
    kinds = {kind for output in outputs for kind in output.get("data", {})}
    assert "image/png" in kinds, kinds
    text = "".join("".join(output.get("text", "")) for output in outputs if output["output_type"] == "stream")
    assert text.count("pixels") == 4 and "n = 16" in text, text
    assert not NOTEBOOK.read_text().count('"output_type"'), "the notebook in the tree has no outputs"
