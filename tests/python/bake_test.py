"""Radiosity from Python, and by the command."""
import pathlib

import numpy as np
import pytest

import trilens

SCENE = pathlib.Path(__file__).resolve().parents[2] / "scenes/radiosity/cornell.json"
SMALL = {"/film/width": 48, "/film/height": 48, "/film/spp": 1}
COARSE = {"patch_size": 0.2, "contrast": 5.0, "hemicube": 32}


def test_baked_light_is_the_files_and_reaches_what_no_lamp_does(tmp_path):
    scene = trilens.load_scene(SCENE, SMALL)
    told = []
    baked, report = trilens.Renderer(scene).bake(file=tmp_path / "baked.json", **COARSE, warn=told.append)
    assert told == report["warnings"] and any("mirrors stop the light" in one for one in told)
    assert trilens.Renderer(trilens.load_scene(tmp_path / "baked.json")).digest() == trilens.Renderer(baked).digest()
    before, after = (trilens.Renderer(one).render() for one in (scene, baked))
    ceiling = (slice(3, 6), slice(8, 40))
    assert before["G"][ceiling].max() < 1e-3 < 0.01 < after["G"][ceiling].min()
    power = report["power"]
    came = np.add(power["emitted"], power["from_lights"])
    assert np.sum([power[key] for key in ("absorbed", "blocked", "escaped", "unshot")], axis=0) == pytest.approx(came)
    rows, unshot = zip(*report["convergence"])
    assert unshot[-1] <= 1e-3 and list(rows) == sorted(rows)
    assert report["mean_difference"] < 0.03 and len(report["warnings"]) >= 2


def test_a_bake_warns_as_all_do():
    renderer = trilens.Renderer(trilens.load_scene(SCENE, SMALL))
    with pytest.warns(trilens.TrilensWarning, match="mirrors stop the light"):
        renderer.bake(**COARSE)


def test_what_cannot_be_baked_is_refused():
    renderer = trilens.Renderer(trilens.load_scene(SCENE, SMALL))
    with pytest.raises(trilens.UsageError, match="did you mean|progressive"):
        renderer.bake(solver="progresive")
    with pytest.raises(trilens.UsageError, match="even"):
        renderer.bake(hemicube=7)
    with pytest.raises(trilens.InputError, match="100 elements are the most"):
        renderer.bake(max_elements=100)
