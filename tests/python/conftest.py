"""What the tests of the Python module share."""
import json
import os
import pathlib
import subprocess

import pytest

import trilens

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SMALL = {"/film/width": 128, "/film/height": 96, "/film/spp": 1}


@pytest.fixture(scope="session")
def sphere():
    """A mirror sphere in a room of coloured walls, small."""
    return trilens.load_scene(SOURCE / "scenes/sphere.json", SMALL)


@pytest.fixture(scope="session")
def renderer(sphere):
    return trilens.Renderer(sphere)


@pytest.fixture(scope="session")
def image(renderer):
    """For reading only."""
    return renderer.render(resolution=6)


@pytest.fixture(scope="session")
def truth(renderer):
    """For reading only."""
    return renderer.trace()


@pytest.fixture
def command():
    """Runs the command of the same build; returns its exit code and its JSON."""
    program = os.environ.get("TRILENS_COMMAND")
    if not program:
        pytest.skip("TRILENS_COMMAND names no trilens to compare with")

    def run(*words):
        result = subprocess.run([program, *map(str, words), "--json", "-q"], capture_output=True, text=True)
        return result.returncode, json.loads(result.stdout)

    return run


def size_options(overrides):
    return ["--size", f"{overrides['/film/width']}x{overrides['/film/height']}", "--set", f"/film/spp={overrides['/film/spp']}"]


def pytest_unconfigure(config):
    """The last line, as every test program of the project has it."""
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    if not reporter:
        return
    count = {key: len(reporter.stats.get(key, [])) for key in ("passed", "failed", "error", "skipped")}
    print(f"\n{count['passed']} passed, {count['failed'] + count['error']} failed, {count['skipped']} skipped")
