"""Terrains of scenes, from Python and by the command."""
import json

import numpy as np
import pytest

import trilens
from conftest import SOURCE

SCENE = SOURCE / "scenes/terrain/mountains.json"
SMALL = {"/film/width": 64, "/film/height": 48, "/film/spp": 1}


def test_a_terrain_tells_how_it_was_thinned(command):
    ball, mountains, *_ = trilens.load_scene(SCENE, SMALL).meshes
    assert ball.terrain is None and mountains.shape == "terrain" and mountains.role == "object"
    terrain = mountains.terrain
    assert (terrain.columns, terrain.rows, terrain.missing_heights) == (241, 181, 0)
    assert mountains.triangles < terrain.whole_triangles == 2 * 240 * 180
    bound = json.loads(SCENE.read_text())["meshes"][1]["heightError"]
    assert 0 < terrain.rms_error < terrain.greatest_error <= bound
    run, answer = command("scene", "info", SCENE)
    assert answer["meshes"][1]["terrain"]["greatest_error"] == pytest.approx(terrain.greatest_error)
    assert answer["meshes"][1]["triangles"] == mountains.triangles


def test_fewer_triangles_show_the_same_mountains():
    scene = trilens.load_scene(SCENE, {**SMALL, "/meshes/1/heightError": 0.1})
    finer = scene.with_overrides({"/meshes/1/heightError": 0.002})
    assert scene.meshes[1].triangles < finer.meshes[1].triangles / 3
    coarse, fine = (np.stack([trilens.Renderer(one).render()[c] for c in "RGB"], -1) for one in (scene, finer))
    assert np.abs(coarse - fine).mean() < 0.05


def test_heights_that_are_none_are_refused_with_their_place():
    with pytest.raises(trilens.InputError, match="/meshes/1/heights"):
        trilens.load_scene(SCENE, {"/meshes/1/heights": "mountains.json"})
    with pytest.raises(trilens.InputError, match="/meshes/1/heightError"):
        trilens.load_scene(SCENE, {"/meshes/1/heightError": -1})
