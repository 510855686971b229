"""The scripts: what proves something can fail, packages are asked for by purpose, and help is only said."""
import os
import re
import subprocess
import zlib

import pytest

from conftest import SOURCE

SCRIPTS = sorted(file for file in (SOURCE / "scripts").iterdir() if file.is_file() and file.read_bytes().startswith(b"#!"))
SHELL = [file for file in [*SCRIPTS, SOURCE / ".ci/run"] if file.read_bytes().startswith(b"#!/usr/bin/env bash")]


@pytest.mark.parametrize("file", SHELL, ids=lambda file: file.name)
def test_no_command_that_must_fail_is_passed_over(file):
    """errexit ignores a pipeline with "!" before it: only as a condition does it stop anything."""
    bare = [line for line in file.read_text().splitlines() if re.match(r"(.*[;&|{(])?\s*!\s", line) and
            not re.search(r"\b(if|elif|while|until)\s+!\s", line)]
    assert bare == []
    assert "set -euo pipefail" in file.read_text()


@pytest.mark.parametrize("file", SCRIPTS, ids=lambda file: file.name)
def test_a_script_that_is_asked_for_help_only_says_what_it_does(file):
    run = subprocess.run([file, "--help"], capture_output=True, text=True, timeout=20, env={**os.environ, "PATH": "/usr/bin:/bin"})
    assert (run.returncode, run.stderr) == (0, "")
    head = file.read_text().splitlines()[1].strip('"# ')
    assert head in run.stdout if "argparse" not in file.read_text() else run.stdout.startswith("usage: ")


def test_each_package_is_named_once_for_a_purpose():
    purpose, packages = None, {}
    for line in (SOURCE / "scripts/packages.txt").read_text().splitlines():
        line = line.split("#")[0].strip()
        if line.startswith("["):
            purpose = line[1:-1]
            assert purpose not in packages
            packages[purpose] = set()
        elif line:
            assert purpose and line not in packages[purpose]
            packages[purpose].add(line)
    assert set(packages) == {"program", "viewer", "cad", "package", "tests", "docs", "checks", "browser", "wheel", "arm"}
    assert {"slurm-wlm", "catch2"} <= packages["tests"] and "doxygen" in packages["checks"]
    assert "lintian" in packages["package"]


def test_a_purpose_that_there_is_not_is_refused():
    run = subprocess.run([SOURCE / "scripts/install-deps", "nothing"], capture_output=True, text=True)
    assert run.returncode == 2 and "nothing" in run.stderr


@pytest.mark.parametrize("script, folder", [("make-path-scenes", "paths"), ("make-camera-scenes", "cameras")])
def test_scenes_that_a_script_makes_are_as_it_makes_them(script, folder, tmp_path):
    """A change by hand would be lost when the script runs again."""
    subprocess.run([SOURCE / "scripts" / script, tmp_path], check=True, capture_output=True)
    made = sorted((tmp_path / folder).iterdir())
    assert len(made) > 4
    for file in made:
        assert file.read_text() == (SOURCE / "scenes" / folder / file.name).read_text(), file.name


def test_volumes_that_a_script_makes_are_as_it_makes_them(tmp_path):
    subprocess.run([SOURCE / "scripts/make-volume-scenes", tmp_path], check=True, capture_output=True)
    made = sorted((tmp_path / "volumes").iterdir())
    assert [file.name for file in made] == ["benzene.json", "benzene.nrrd", "jet.json", "jet.vtk"]
    for file in made:
        assert file.read_bytes() == (SOURCE / "scenes/volumes" / file.name).read_bytes(), file.name


def test_the_terrain_that_a_script_makes_is_as_it_makes_it(tmp_path):
    subprocess.run([SOURCE / "scripts/make-terrain-scene", tmp_path], check=True, capture_output=True)
    assert (tmp_path / "terrain/mountains.json").read_text() == (SOURCE / "scenes/terrain/mountains.json").read_text()
    for name in ("heights.png", "colours.png"):  # what zlib makes of them may differ
        made, kept = ((folder / "terrain" / name).read_bytes() for folder in (tmp_path, SOURCE / "scenes"))
        assert zlib.decompress(png_data(made)) == zlib.decompress(png_data(kept))


def png_data(png):
    at, data = 8, b""
    while at < len(png):
        length = int.from_bytes(png[at:at + 4], "big")
        if png[at + 4:at + 8] == b"IDAT":
            data += png[at + 8:at + 8 + length]
        at += 12 + length
    return data


@pytest.mark.parametrize("name", ["teapot", "nurbs"])
def test_scenes_of_patches_that_scripts_make_are_as_they_make_them(name, tmp_path):
    subprocess.run([SOURCE / f"scripts/make-{name}-scene", tmp_path], check=True, capture_output=True)
    assert (tmp_path / f"patches/{name}.json").read_text() == (SOURCE / f"scenes/patches/{name}.json").read_text()
