"""Regression suites: one seeded fault of each kind is caught and named, and what is written can be read by others."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

import trilens
from conftest import SOURCE

LIMITS = {"rmse": 1e-4, "rgb_flip": 1e-4, "displacement_p99": 0.01, "lost_percent": 0.1,
          "object_mismatch_percent": 0.01}


def write_test(folder, **changes):
    folder.mkdir(parents=True, exist_ok=True)
    test = {"scene": str(SOURCE / "scenes/sphere.json"), "against": "golden", "resolution": 6,
            "set": {"/film/width": 64, "/film/height": 48, "/film/spp": 1}, "max": LIMITS, **changes}
    (folder / "test.json").write_text(json.dumps(test))
    return folder


def only(folder, **options):
    test, = trilens.run_suite(folder, **options).tests
    return test


@pytest.fixture
def ball(tmp_path):
    """A test whose stored image is right."""
    folder = write_test(tmp_path / "ball")
    assert only(folder, update=True).update == "new"
    assert only(folder).state == "passed"
    return folder


def stored(folder):
    return trilens.read_image(folder / "ref/main.exr")


def store(folder, channels, image, size=None):
    trilens.Image.from_arrays(channels, size=size, metadata=image.metadata).save(folder / "ref/main.exr")


def channels_of(image):
    return {name: np.array(image[name]) for name in image}


def shifted(folder):
    image = stored(folder)
    store(folder, {name: np.roll(values, 1, axis=1) for name, values in channels_of(image).items()}, image)


def with_nan(folder):
    image = stored(folder)
    channels = channels_of(image)
    channels["G"][20, 30] = np.nan
    store(folder, channels, image)


def with_a_layer_more(folder):
    image = stored(folder)
    channels = channels_of(image)
    channels.update({"gloss." + name: channels["reflect." + name] for name in "RGB"})
    store(folder, channels, image)


def of_other_size(folder):
    image = stored(folder)
    store(folder, {name: np.ascontiguousarray(values[:40]) for name, values in channels_of(image).items()}, image)


def with_a_wrong_id(folder):
    image = stored(folder)
    channels = channels_of(image)
    seen = channels["reflectID.object"]
    seen[seen == seen[24, 32]] = 1 if seen[24, 32] != 1 else 2
    store(folder, channels, image)


def with_a_facet_turned(folder):
    """The pixels of one facet show what a ball turned by two degrees shows there."""
    image = stored(folder)
    turned = trilens.Renderer(trilens.load_scene(
        SOURCE / "scenes/sphere.json",
        {"/film/width": 64, "/film/height": 48, "/film/spp": 1,
         "/meshes/0/normals": {"type": "sphere", "center": [0.05, 1.0, 0.05]}})).render(resolution=6)
    channels = channels_of(image)
    facet = channels["optic.facet"]
    known, counts = np.unique(facet[facet != trilens.NONE], return_counts=True)
    inside = facet == known[counts.argmax()]
    assert inside.sum() >= 3
    for name in channels:
        if name in turned and not name.startswith("optic."):
            channels[name][inside] = turned[name][inside]
    store(folder, channels, image)


FAULTS = {
    shifted: ["rmse is", "rgb_flip is", "displacement_p99 is"],
    with_nan: ["1 pixels hold NaN in the reference"],
    with_a_layer_more: ["the picture lacks the layer gloss, which the reference has (gloss.R, gloss.G, gloss.B)"],
    of_other_size: ["the size is 64 x 48, and the reference's is 64 x 40"],
    with_a_wrong_id: ["object_mismatch_percent is"],
    with_a_facet_turned: ["lost_percent is", "object_mismatch_percent is"],
}


def without_a_layer(folder):
    image = stored(folder)
    store(folder, {name: values for name, values in channels_of(image).items() if not name.startswith("reflectP")}, image)


def twice_as_deep(folder):
    image = stored(folder)
    channels = channels_of(image)
    seen = channels["Z"] < 1e29
    channels["Z"][seen] *= 2
    store(folder, channels, image)


def with_ids_one_more(folder):
    image = stored(folder)
    channels = channels_of(image)
    for name, values in channels.items():
        if values.dtype == np.uint32:
            values[values != trilens.NONE] += 1
    store(folder, channels, image)


def with_places_moved(folder):
    image = stored(folder)
    channels = channels_of(image)
    channels["reflectP.X"] += 1
    store(folder, channels, image)


def with_a_part_of_the_light_gone(folder):
    image = stored(folder)
    channels = channels_of(image)
    for part in "RGB":
        channels["reflect." + part][:] = 0
    store(folder, channels, image)


UNLIMITED_FAULTS = {
    without_a_layer: ["the reference lacks the layer reflectP"],
    with_a_layer_more: ["the picture lacks the layer gloss"],
    twice_as_deep: ["the layer Z differs at "],
    with_ids_one_more: ["the layer reflectID differs at ", "the layer optic differs at "],
    with_places_moved: ["the layer reflectP differs at "],
    with_a_part_of_the_light_gone: ["the layer reflect differs at "],
}


@pytest.mark.parametrize("fault", UNLIMITED_FAULTS, ids=lambda fault: fault.__name__)
def test_without_limits_every_layer_is_held(tmp_path, fault):
    folder = tmp_path / "ball"
    write_test(folder)
    test = json.loads((folder / "test.json").read_text())
    del test["max"]
    (folder / "test.json").write_text(json.dumps(test))
    assert only(folder, update=True).update == "new"
    assert only(folder).state == "passed"
    fault(folder)
    judged = only(folder)
    assert judged.state == "failed"
    for reason in UNLIMITED_FAULTS[fault]:
        assert any(said.startswith(reason) for said in judged.reasons), judged.reasons


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.__name__)
def test_a_fault_is_caught_and_named_and_update_mends_it(ball, fault):
    fault(ball)
    test = only(ball)
    assert test.state == "failed"
    for reason in FAULTS[fault]:
        assert any(said.startswith(reason) for said in test.reasons), test.reasons
    mended = only(ball, update=True)
    assert mended.state == "passed" and mended.update.startswith("changed: ")
    assert only(ball, update=True).update == "unchanged"


def test_a_slower_order_is_caught(tmp_path):
    """Normals that do not belong to the surface make what a coarse grid shows converge more slowly."""
    limits = {"displacement_order": 1.7, "displacement_p95": 2}
    good = write_test(tmp_path / "good", against="truth", resolution=[4, 8, 16], max=limits)
    assert only(good).metrics["truth"]["displacement_order"] > 1.7
    assert only(good).state == "passed"
    slow = write_test(tmp_path / "slow", against="truth", resolution=[4, 8, 16], max=limits,
                      set={"/film/width": 64, "/film/height": 48,
                           "/meshes/0/normals": {"type": "noise", "seed": 1, "amplitude": 0.1, "scale": 12}})
    test = only(slow)
    assert test.state == "failed"
    assert any("displacement_order is" in reason and "at least 1.7" in reason for reason in test.reasons), test.reasons


def test_a_missing_reference_says_how_to_make_it(tmp_path, command):
    folder = write_test(tmp_path / "a ball")
    test = only(folder)
    assert test.state == "failed"
    reason, = test.reasons
    assert reason.endswith(f"make it with: trilens test '{folder}' --update")
    assert command("test", folder, "--update")[0] == 0
    assert only(folder).state == "passed"


def test_broken_tests_are_errors_of_their_own(ball, command):
    suite = ball.parent
    broken = {"unknown": ('{ "against": "golden", "maks": {} }', "unknown key 'maks' of a test; did you mean 'max'?"),
              "metric": ('{ "against": "truth", "max": { "rsme": 1 } }', "did you mean 'rmse'?"),
              "against": ('{ "against": "gold" }', "is none of \"golden\", \"truth\" and \"facets\", but the string \"gold\""),
              "nothing": ('{ "scene": "scene.json" }', "a test needs 'against'"),
              "empty": ('{ "against": "truth", "max": {} }', "limits nothing"),
              "twice": ('{ "against": "truth", "fail": 1, "fail": 2 }', "stands twice"),
              "half": ('{ "against": "truth", ', "syntax error"),
              "list": ('[]', "expected an object"),
              "order": ('{ "against": "truth", "max": { "displacement_order": 2 } }', "needs several resolutions"),
              "scene": ('{ "against": "truth" }', "scene.json"),
              "engine": (json.dumps({"scene": str(SOURCE / "scenes/flat.json"), "against": "truth", "engine": "exakt"}),
                         "did you mean 'exact'?")}
    for name, (text, _) in broken.items():
        (suite / name).mkdir()
        (suite / name / "test.json").write_text(text)
    code, answer = command("test", suite)
    assert code == 6
    states = {test["name"]: test for test in answer["tests"]}
    assert states["ball"]["state"] == "passed"
    for name, (_, message) in broken.items():
        assert states[name]["state"] == "error"
        assert message in states[name]["reasons"][0], states[name]["reasons"]
    assert len(answer["errors"]) == len(broken)


def test_exit_codes(ball, command, tmp_path):
    assert command("test", ball)[0] == 0
    shifted(ball)
    assert command("test", ball)[0] == 1
    assert command("test", ball, "-k", "no such")[0] == 2
    (tmp_path / "void").mkdir()
    assert command("test", tmp_path / "void")[0] == 3
    assert command("test", ball, "--junit", tmp_path / "none/results.xml")[0] == 4
    elsewhere = write_test(tmp_path / "elsewhere", platforms=["plan9"])
    code, answer = command("test", elsewhere)
    assert code == 77 and answer["tests"][0]["state"] == "skipped"


def test_names_tags_and_patterns(tmp_path):
    for name, tags in (("one/sphere", ["mirror"]), ("one/water", ["glass"]), ("two", [])):
        write_test(tmp_path / name, tags=tags, platforms=["plan9"])

    def names(pattern):
        return [test.name for test in trilens.run_suite(tmp_path, pattern).tests]

    assert names("") == ["one/sphere", "one/water", "two"]
    assert names("mirror") == ["one/sphere"] and names("one/*") == ["one/sphere", "one/water"]
    assert names("t?o") == ["two"] and names("wat") == ["one/water"]
    with pytest.raises(trilens.UsageError):
        names("*r?x")
    assert trilens.list_suite(tmp_path / "one", "glass") == {str(tmp_path / "one/water"): ["glass"]}


def test_any_number_at_a_time_gives_the_same(tmp_path):
    for i in range(5):
        write_test(tmp_path / str(i), against="truth", resolution=2 + 3 * i, max={"displacement_p95": 0.2})
    one, four = (trilens.run_suite(tmp_path, jobs=jobs) for jobs in (1, 4))
    assert [(test.name, test.state, test.reasons, test.metrics) for test in one.tests] == [
        (test.name, test.state, test.reasons, test.metrics) for test in four.tests]
    assert {test.state for test in one.tests} == {"passed", "failed"}


def test_another_programs_image_is_compared_where_it_can_be(ball):
    image = stored(ball)
    trilens.Image.from_arrays({**{name: np.array(image[name]) for name in "RGB"}, "Depth.V": np.array(image["Z"])}).save(
        ball / "ref/other.exr")
    folder = write_test(ball, reference="ref/other.exr", reference_from="elsewhere", max={"rmse": 1e-6})
    test = only(folder, update=True)
    assert test.state == "passed" and test.update == ""
    assert any("Depth" in note for note in test.notes)


def test_junit_is_read_by_other_programs(ball, tmp_path):
    shifted(ball)
    write_test(ball.parent / "away", platforms=["plan9"])
    write_test(ball.parent / "good/deep", against="facets")
    (ball.parent / "broken").mkdir()
    (ball.parent / "broken/test.json").write_text("{ \u0001 <&>")
    trilens.run_suite(ball.parent, junit=tmp_path / "results.xml", html=tmp_path / "page.html", title="a & b")
    suite, = ElementTree.parse(tmp_path / "results.xml").getroot()
    counts = {key: int(suite.get(key)) for key in ("tests", "failures", "errors", "skipped")}
    assert counts == {"tests": 4, "failures": 1, "errors": 1, "skipped": 1} and suite.get("name") == "a & b"
    cases = {case.get("name"): case for case in suite}
    assert "displacement_p99 is" in cases["ball"].find("failure").text
    assert cases["good/deep"].get("classname") == "good" and cases["good/deep"].find("failure") is None
    page = (tmp_path / "page.html").read_text()
    assert page.index("ball: failed") < page.index("broken: error") < page.index("good/deep: passed")
    assert "http" not in page.replace("http://www.w3.org", "")


def test_junit_is_read_by_junitparser(ball, tmp_path):
    junitparser = pytest.importorskip("junitparser")
    shifted(ball)
    trilens.run_suite(ball.parent, junit=tmp_path / "results.xml")
    read = junitparser.JUnitXml.fromfile(str(tmp_path / "results.xml"))
    assert (read.tests, read.failures, read.errors, read.skipped) == (1, 1, 0, 0)


def test_an_interruption_keeps_what_was_finished(tmp_path):
    for i in range(3):
        write_test(tmp_path / str(i), against="facets")
    with pytest.raises(trilens.Interrupted):
        trilens.run_suite(tmp_path, jobs=1, junit=tmp_path / "results.xml", progress=lambda done, job: done < 0.3)
    suite, = ElementTree.parse(tmp_path / "results.xml").getroot()
    assert (int(suite.get("tests")), int(suite.get("skipped"))) == (3, 2)


def test_pytest_runs_them_as_its_own(ball, tmp_path):
    write_test(ball.parent / "off", against="truth", resolution=2, max={"displacement_p95": 0.001}, tags=["coarse"])
    (ball.parent / "own_test.py").write_text(
        "def test_the_ball(render_test):\n    assert render_test('ball').metrics['golden']['rmse'] == 0\n")

    def run(*words):
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
        return subprocess.run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p",
                               "trilens.pytest_plugin", "-o", "python_files=*_test.py", "--rootdir", ball.parent,
                               ball.parent, *words], capture_output=True, text=True, env=environment)

    result = run()
    assert result.returncode == 1 and "2 passed" in result.stdout and "1 failed" in result.stdout, result.stdout
    assert "displacement_p95 is" in result.stdout
    page = re.search(r"pictures: (\S+\.html)", result.stdout)[1]
    assert pathlib.Path(page).read_text(encoding="utf-8").count("<img") >= 2
    assert run("-k", "not coarse").returncode == 0
    shutil.rmtree(ball / "ref")
    assert run("-k", "ball").returncode == 1
    assert run("-k", "ball", "--trilens-update").returncode == 0
