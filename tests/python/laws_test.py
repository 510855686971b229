"""Python and the command are two doors to one library: equal to the last bit."""
import json
import math
import pathlib

import numpy as np
import pytest

import trilens
from conftest import SMALL, SOURCE, size_options

SPHERE, WATER = SOURCE / "scenes/sphere.json", SOURCE / "scenes/water.json"


def number(value):
    """JSON has no inf: the command writes it as text."""
    return float(value) if isinstance(value, str) else value


def silent(message):
    """Warnings are told elsewhere."""


def equal(ours, theirs):
    """A Python value and the command's JSON say the same, to the last bit of every number."""
    if isinstance(theirs, dict):
        return set(ours) == set(theirs) and all(equal(ours[key], theirs[key]) for key in theirs)
    if isinstance(theirs, list):
        return len(ours) == len(theirs) and all(map(equal, ours, theirs))
    if isinstance(ours, float):
        return ours == number(theirs) or (math.isnan(ours) and math.isnan(number(theirs)))
    return ours == theirs


@pytest.mark.parametrize(
    "scene, words, draw",
    [
        (SPHERE, ["render", "-n", 5], lambda renderer: renderer.render(warn=silent)),
        (SPHERE, ["render", "-n", 5, "--crop", "20,10,90,70"], lambda renderer: renderer.render(window=(20, 10, 90, 70))),
        (SPHERE, ["render", "-n", 5, "--aov", "Z,reflect"], lambda renderer: renderer.render(layers=["Z", "reflect"])),
        (
            SPHERE,
            ["render", "-n", 5, "--engine", "classic", "--slices", 3, "--clip", "screen"],
            lambda renderer: renderer.render(engine="classic", curves="slices", pieces=3, clip="screen"),
        ),
        (SPHERE, ["trace", "-n", 5], lambda renderer: renderer.trace()),
        (WATER, ["render", "-n", 5], lambda renderer: renderer.render(warn=silent)),
        (WATER, ["trace", "-n", 5, "--surface", "facets"], lambda renderer: renderer.trace("facets", warn=silent)),
    ],
)
def test_a_picture_is_the_commands_bit_for_bit(command, tmp_path, scene, words, draw):
    code, _ = command(words[0], scene, *words[1:], *size_options(SMALL), "-o", tmp_path / "theirs.exr")
    assert code == 0
    ours = draw(trilens.Renderer(trilens.load_scene(scene, SMALL, 5, warn=silent), warn=silent))
    theirs = trilens.read_image(tmp_path / "theirs.exr")
    assert sorted(ours.names) == sorted(theirs.names)
    assert (ours.size, ours.window, ours.metadata) == (theirs.size, theirs.window, theirs.metadata)
    for name in ours:
        assert ours[name].tobytes() == theirs[name].tobytes(), name
    ours.save(tmp_path / "ours.exr")
    assert (tmp_path / "ours.exr").read_bytes() == (tmp_path / "theirs.exr").read_bytes()


def test_the_commands_warnings_are_ours(command):
    _, answer = command("project", WATER, "--point", "0,0,0", *size_options(SMALL))
    told = []
    scene = trilens.load_scene(WATER, SMALL, warn=told.append)
    trilens.Renderer(scene, warn=told.append)
    assert told == answer["warnings"] and len(told) > 0


@pytest.mark.parametrize("scene, refine, visibility", [(SPHERE, True, True), (SPHERE, False, True), (WATER, True, False)])
def test_projected_points_are_the_commands(command, tmp_path, scene, refine, visibility):
    points = np.random.default_rng(7).uniform([-2.5, -1.1, -2.5], [2.5, 2.5, 3], (60, 3))
    np.savetxt(tmp_path / "points.csv", points, delimiter=",", fmt="%.17g")
    words = ["--refine", "exact" if refine else "none"] + ([] if visibility else ["--no-visibility"])
    _, answer = command("project", scene, "--points", tmp_path / "points.csv", "-n", 6, *size_options(SMALL), *words)
    loaded = trilens.load_scene(scene, SMALL, 6, warn=silent)
    ours = trilens.Renderer(loaded).project(points, refine=refine, visibility=visibility)
    theirs = [(p, image) for p, point in enumerate(answer["points"]) for image in point["images"]]
    assert len(ours) == len(theirs) > 60
    for row, (point, image) in zip(ours, theirs):
        assert row["point"] == point
        for name in ("x", "y", "t", "length", "path", "inside", "visible", "refined"):
            assert equal(row[name].item(), image[name]), name
        if image["optic"] is None:
            assert row["optic"] == row["object"] == trilens.NONE
        else:
            assert loaded.meshes[row["object"]].name == image["optic"]
        assert row["facet"] == (trilens.NONE if image["facet"] is None else image["facet"])


def test_whole_paths_and_derivatives_of_points_are_the_commands(command):
    scene = SOURCE / "scenes" / "paths" / "glass-before-mirror.json"
    point = [0.2, 0.6, -1.2]
    _, answer = command("project", scene, "--point", ",".join(map(str, point)), "-n", 6, "--derivatives", *size_options(SMALL))
    loaded = trilens.load_scene(scene, SMALL, 6, warn=silent)
    ours = trilens.Renderer(loaded, warn=silent).project([point], derivatives=True)
    theirs = answer["points"][0]["images"]
    assert len(ours) == len(theirs) > 0
    assert max(row["step_count"] for row in ours) >= 2
    for row, image in zip(ours, theirs):
        assert row["step_count"] == len(image["steps"])
        for i, step in enumerate(row["steps"]):
            if i >= row["step_count"]:
                assert step["optic"] == trilens.NONE and step["event"] == ""
                continue
            assert step["event"] == image["steps"][i]["event"]
        assert row["has_derivative"] == (image.get("derivative") is not None)
        if row["has_derivative"]:
            assert row["derivative"].tolist() == image["derivative"]


def test_facets_on_the_screen_and_folds_are_the_commands(command, tmp_path):
    scene = SOURCE / "scenes" / "saddle.json"
    renderer = trilens.Renderer(trilens.load_scene(scene, SMALL, 8, warn=silent), warn=silent)
    code, _ = command("render", scene, "-n", 8, "--grid", "screen", "--facets", "all", *size_options(SMALL), "-o", tmp_path / "theirs.exr")
    assert code == 0
    ours, theirs = renderer.render(grid="screen", facets="all"), trilens.read_image(tmp_path / "theirs.exr")
    assert all(ours[name].tobytes() == theirs[name].tobytes() for name in theirs)
    assert not np.array_equal(ours["R"], renderer.render(grid="surface", facets="all")["R"])
    code, answer = command("render", scene, "-n", 8, "--folds", *size_options(SMALL), "-o", tmp_path / "theirs.svg")
    lines = renderer.draw_lines(folds=True)
    assert code == 0 and lines.folds == answer["folds"] > 0
    assert lines.svg == (tmp_path / "theirs.svg").read_text() and 'class="fold"' in lines.svg
    assert len(lines.edge_lines) == lines.curves == answer["curves"] > 0
    assert {line["path"] for line in lines.edge_lines} == {"direct", "reflect"}
    for line in lines.edge_lines:
        assert (line["optic"] is None) == (line["path"] == "direct") and line["points"].shape[1:] == (2,) and len(line["points"]) > 1


@pytest.mark.parametrize("options", [{}, {"layer": "reflect"}, {"mask_object": 0, "fail": 0.5, "hardfail": 9.0, "warn": 9.0}])
def test_a_comparison_is_the_commands(command, tmp_path, image, truth, options):
    truth.save(tmp_path / "truth.exr"), image.save(tmp_path / "image.exr")
    words = [word for name, value in options.items() for word in ("--" + name.replace("_", "-"), value)]
    code, answer = command("compare", tmp_path / "truth.exr", tmp_path / "image.exr", "-o", tmp_path / "diff.exr", *words)
    ours = trilens.compare(truth, image, **options)
    assert ours.passed == (code == 0) and ours.verdict == answer["verdict"] and ours.reasons == answer["reasons"]
    theirs = answer["metrics"]["RGB"]
    assert all(equal(value, theirs[name]) for name, value in ours.metrics.to_dict().items())
    assert equal(ours.counts.to_dict(), answer["counts"]) and equal(ours.seen.to_dict(), answer["seen"])
    assert equal(ours.displacement.to_dict(), answer["displacement_px"])
    assert equal(ours.worst.to_dict(), answer["worst"])
    assert set(ours.layers) == set(answer["layers"])
    for name, layer in ours.layers.items():
        assert layer.layer == name and equal(layer.displacement.to_dict(), answer["layers"][name]["displacement_px"])
    difference, expected = ours.difference(), trilens.read_image(tmp_path / "diff.exr")
    assert sorted(difference.names) == sorted(expected.names)
    assert all(difference[name].tobytes() == expected[name].tobytes() for name in difference)


@pytest.mark.parametrize("engine, words", [("exact", ["render"]), ("limit", ["trace"]), ("facets", ["trace", "--surface", "facets"])])
def test_an_explained_pixel_is_the_commands(command, renderer, engine, words):
    for x, y in [(64, 48), (3, 90), (50, 40)]:
        _, answer = command(words[0], SPHERE, *words[1:], *size_options(SMALL), "--pixel", f"{x},{y}")
        for common in ("schema", "status", "exit_code", "warnings", "errors"):
            answer.pop(common)
        assert equal(renderer.explain(x, y, engine=engine), answer)


def test_a_line_drawing_is_the_commands(command, tmp_path):
    _, answer = command("render", SPHERE, "-n", 2, *size_options(SMALL), "-o", tmp_path / "theirs.svg")
    drawing = trilens.Renderer(trilens.load_scene(SPHERE, SMALL, 2)).draw_lines()
    assert drawing.svg == (tmp_path / "theirs.svg").read_text() == drawing._repr_svg_()
    assert (drawing.curves, drawing.arcs) == (answer["curves"], answer["arcs"])
    drawing.save(tmp_path / "ours.svg")
    assert (tmp_path / "ours.svg").read_text() == drawing.svg


def test_a_sweep_is_the_commands_and_its_fit_is_least_squares(command, tmp_path):
    told = []
    summary = trilens.sweep(SPHERE, tmp_path / "ours", [1, 2, 4, 8], overrides=SMALL,
                            progress=lambda done, job: told.append(job))
    code, answer = command("sweep", "run", SPHERE, "--over", "resolution=1,2,4,8", *size_options(SMALL), "-o", tmp_path / "theirs")
    assert code == 0 and [run.n for run in summary.runs] == [1, 2, 4, 8]
    assert {run.state for run in summary.runs} == {"done"}
    assert {"render", "trace", "sweep of sphere"} == set(told)
    theirs = answer["fits"]
    assert len(summary.fits) == len(theirs) > 0
    for ours, fit in zip(summary.fits, theirs):
        # A group is a text there and a dict here; both are empty where one axis is swept.
        assert not ours.group and not fit["group"]
        assert all(equal(getattr(ours, name), value) for name, value in fit.items() if name != "group")

    fit = summary.fit("disp_mean_px")
    used = [(point.n, point.value) for point in fit.points if point.used]
    slope, intercept = np.polyfit(*np.log(used).T, 1)
    assert fit.order == pytest.approx(-slope, rel=1e-9) and fit.constant == pytest.approx(np.exp(intercept), rel=1e-9)
    assert 1.5 < fit.order < 2.5
    assert summary.fit("no_such_metric") is None
    law = trilens.fit_power_law(*np.array(used).T)
    assert law.order == pytest.approx(fit.order, rel=1e-12)

    # What is done is not done again, and the folder tells the same later.
    told.clear()
    again = trilens.sweep(SPHERE, tmp_path / "ours", "resolution=1..8:x2", overrides=SMALL,
                          progress=lambda done, job: told.append(job))
    assert set(told) == {"sweep of sphere"}
    for other in (again, trilens.load_sweep(tmp_path / "ours"), trilens.report_sweep(tmp_path / "ours")):
        assert [one.to_dict()["order"] for one in other.fits] == [one.order for one in summary.fits]
    assert (tmp_path / "ours/report.html").exists()
    assert json.loads((tmp_path / "ours/summary.json").read_text())["counts"]["done"] == 4


def test_a_sweep_can_be_interrupted_and_goes_on(tmp_path):
    with pytest.raises(trilens.Interrupted):
        trilens.sweep(SPHERE, tmp_path, [1, 2], overrides=SMALL,
                      progress=lambda done, job: not (job.startswith("sweep") and done >= 0.5))
    states = [run.state for run in trilens.load_sweep(tmp_path).runs]
    assert states == ["done", "missing"]
    assert {run.state for run in trilens.sweep(SPHERE, tmp_path, [1, 2], overrides=SMALL).runs} == {"done"}


def test_a_scene_in_memory_is_swept_as_its_file_is(tmp_path):
    scene, told = trilens.load_scene(SPHERE, SMALL), []
    ours = trilens.sweep(scene, tmp_path / "ours", [2, 4, 8])
    theirs = trilens.sweep(SPHERE, tmp_path / "theirs", [2, 4, 8], overrides=SMALL)
    assert [fit.order for fit in ours.fits] == [fit.order for fit in theirs.fits] and len(ours.fits) > 0
    assert ours.title == "sphere"
    trilens.sweep(scene, tmp_path / "theirs", [2, 4, 8], progress=lambda done, job: told.append(job))
    assert set(told) == {"sweep of sphere"}

    # One without a label is another's as soon as it changes; a label makes it one that is edited.
    text = scene.with_overrides({"/film/width": 64}).to_json()
    moved = trilens.parse_scene(text, scene.folder)
    assert moved.label == "" and "'scene'" in repr(moved)
    with pytest.raises(trilens.UsageError, match="scene"):
        trilens.sweep(moved, tmp_path / "ours", [2, 4])
    with pytest.raises(trilens.UsageError, match="with_overrides"):
        trilens.sweep(moved, tmp_path / "ours", [2, 4], overrides=SMALL)
    with pytest.raises(TypeError):
        trilens.sweep(None, tmp_path / "ours", [2, 4])
    assert trilens.sweep(moved, tmp_path / "ours", [2, 4], replace=True).title == "scene"
    for width in (64, 80):
        edited = trilens.parse_scene(text, scene.folder, {"/film/width": width}, label="my ball")
        assert edited.label == "my ball"
        summary = trilens.sweep(edited, tmp_path / "edited", [2, 4])
        assert summary.title == "my ball"
        assert {run.metrics["width"] for run in summary.runs} == {width}


def test_a_plan_runs_nothing(tmp_path):
    file = trilens.plan_sweep(SPHERE, tmp_path, [1, 2], overrides=SMALL)
    assert len(pathlib.Path(file).read_text().splitlines()) == 2
    assert {run.state for run in trilens.load_sweep(tmp_path).runs} == {"missing"}
    with pytest.raises(trilens.UsageError):
        trilens.plan_sweep(SPHERE, tmp_path, "resolution=4..1:x2")
    with pytest.raises(trilens.InputError):
        trilens.load_sweep(tmp_path / "no")


BALLS = SOURCE / "scenes/paths/mirror-balls.json"


def balls():
    return trilens.Renderer(trilens.load_scene(BALLS, SMALL, 8, warn=silent), warn=silent)


def test_optics_in_mirrors_are_layers_or_divided_as_asked():
    told = []
    renderer = balls()
    layers = renderer.render(layers=["stat"], seen_optics="layers", facets="all", warn=told.append)
    divided = renderer.render(layers=["stat"], seen_optics="divided", facets="all", warn=told.append)
    assert not any("no layers" in message for message in told)
    traced = [np.count_nonzero(image["stat.method"] == 2) for image in (layers, divided)]
    assert traced[0] < traced[1]
    assert np.array_equal(renderer.render(layers=["stat"], facets="all")["stat.method"], layers["stat.method"])
    with pytest.raises(trilens.UsageError):
        renderer.render(seen_optics="both")
    with pytest.raises(trilens.UsageError):
        renderer.trace(seen_optics="layers")


def test_layers_that_cannot_be_are_told():
    told = []
    renderer = balls()
    renderer.render(seen_optics="layers", max_error=0.5, warn=told.append)
    assert len([message for message in told if "are no layers: an error is asked for" in message]) == 2
    told.clear()
    renderer.render(max_error=0.5, warn=told.append)  # nobody asked
    assert not any("no layers" in message for message in told)


def test_a_comparison_checks_proven_bounds_as_the_command_does(command, tmp_path, renderer, truth):
    image = renderer.render(resolution=4, max_error=0.5, certify=True, facets="all",
                            layers=["Z", "direct", "reflect", "refract", "optic", "bound"])
    truth.save(tmp_path / "truth.exr"), image.save(tmp_path / "image.exr")
    code, answer = command("compare", tmp_path / "truth.exr", tmp_path / "image.exr", "--max", "beyond_bound=0")
    bounds = trilens.compare(truth, image).layers["reflect"].bounds
    assert bounds.pixels > 50 and bounds.beyond == 0 and code == 0
    assert equal(bounds.to_dict(), answer["layers"]["reflect"]["bounds_px"])
    assert trilens.compare(truth, renderer.render(resolution=4)).layers["reflect"].bounds is None
