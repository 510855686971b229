"""Regression tests of rendered images under pytest: every folder with a test.json is a test.

In a project's conftest.py, or on the command line with -p:

    pytest_plugins = ["trilens.pytest_plugin"]

`pytest -k glass` chooses by name and tag; `pytest --trilens-update` makes the stored images again. In a test of one's
own the fixture `render_test` runs the test of a folder and fails with its reasons:

    def test_the_ball(render_test):
        assert render_test("renders/ball").metrics["golden"]["displacement_p95"] < 1

A failure ends with the name of an HTML page that shows picture, reference and difference; pages lie in pytest's cache.
"""
import pathlib
import tempfile

import pytest

import trilens


class RenderTestFailure(Exception):
    """A tolerance was exceeded, or the test could not be run: one reason per line."""


def _page(folder, config):
    """Where the page of a folder's test is written: in pytest's cache, or where there is none in a new folder."""
    cache = getattr(config, "cache", None)
    pages = pathlib.Path(cache.mkdir("trilens") if cache else tempfile.mkdtemp(prefix="trilens-"))
    return pages / ("_".join(pathlib.Path(folder).resolve().parts[1:]) + ".html")


def _run(folder, config):
    page = _page(folder, config)
    test, = trilens.run_suite([folder], update=config.getoption("--trilens-update"), html=page).tests
    if test.state in ("failed", "error"):
        raise RenderTestFailure("\n".join([*test.reasons, f"pictures: {page}"]))
    page.unlink(missing_ok=True)
    if test.state == "skipped":
        pytest.skip("; ".join(test.reasons))
    return test


class RenderTestFile(pytest.File):
    def collect(self):
        item = RenderTestItem.from_parent(self, name=self.path.parent.name)
        for folder, tags in trilens.list_suite(self.path.parent).items():
            if pathlib.Path(folder) == self.path.parent:
                item.extra_keyword_matches.update(tags)
        yield item


class RenderTestItem(pytest.Item):
    def runtest(self):
        _run_alone(self.path.parent, self.config)

    def repr_failure(self, excinfo, style=None):
        if isinstance(excinfo.value, RenderTestFailure):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self):
        return self.path, None, f"render test {self.path.parent.name}"


def _run_alone(folder, config):
    """The test of exactly this folder, not those below it."""
    names = [pathlib.Path(one) for one in trilens.list_suite(folder)]
    if names != [pathlib.Path(folder)]:
        raise RenderTestFailure(f"{folder} holds other tests below it; give each a folder of its own")
    return _run(folder, config)


def pytest_addoption(parser):
    parser.getgroup("trilens").addoption("--trilens-update", action="store_true",
                                         help="make the stored images of render tests again, where they repeat")


def pytest_collect_file(file_path, parent):
    if file_path.name == "test.json":
        return RenderTestFile.from_parent(parent, path=file_path)
    return None


@pytest.fixture
def render_test(request):
    """Runs the test of a folder (relative to the calling file's); fails with its reasons, returns its SuiteTest."""
    here = request.path.parent
    return lambda folder: _run_alone(here / folder, request.config)
