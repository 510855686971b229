"""Spline patches of scenes, from Python."""
import numpy as np
import pytest

import trilens
from conftest import SOURCE

SCENE = SOURCE / "scenes/patches/teapot.json"
SMALL = {"/film/width": 64, "/film/height": 48, "/film/spp": 1}


def test_the_teapot_is_32_patches_that_mirror():
    scene = trilens.load_scene(SCENE, SMALL, resolution=6)
    pot = scene.meshes[0]
    assert (pot.shape, pot.role, pot.faces, pot.resolution) == ("patches", "optic", 32, 6)
    render, trace = (np.stack([image[c] for c in "RGB"], -1) for image in
                     (trilens.Renderer(scene).render(), trilens.Renderer(scene).trace()))
    assert np.median(np.abs(render - trace)) < 0.01


def test_what_is_on_the_ring_of_nurbs_is_on_a_torus():
    scene = trilens.load_scene(SOURCE / "scenes/patches/nurbs.json", SMALL)
    assert [(mesh.shape, mesh.faces) for mesh in scene.meshes[:2]] == [("patches", 392), ("patches", 16)]
    renderer = trilens.Renderer(scene)
    pixels = np.random.default_rng(1).uniform(0, [64, 48], (1500, 2))
    events = renderer.shoot(pixels)[1]
    # The optics are those meshes in their order.
    at = events["point"][events["optic"] == 1] - [2.55, 0.42, 1.7]
    assert len(at) > 30
    away = np.hypot(np.hypot(at[:, 0], at[:, 2]) - 0.95, at[:, 1]) - 0.42
    assert np.abs(away).max() < 1e-6  # the file's points have six digits


def test_knots_that_fall_are_refused_with_their_place():
    with pytest.raises(trilens.InputError, match="/meshes/1/patches/0/knots/1: knots fall at number 5"):
        trilens.load_scene(SOURCE / "scenes/patches/nurbs.json", {"/meshes/1/patches/0/knots/1/4": 0.5})


def test_curves_that_do_not_meet_are_refused_with_their_place():
    line = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]
    with pytest.raises(trilens.InputError, match="/meshes/0/patches/0/curves: the curves' ends do not agree"):
        trilens.load_scene(SCENE, {"/meshes/0/patches/0": {"type": "coons", "curves": [line] * 4}})
