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


def test_curves_that_do_not_meet_are_refused_with_their_place():
    line = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]
    with pytest.raises(trilens.InputError, match="/meshes/0/patches/0/curves: the curves' ends do not agree"):
        trilens.load_scene(SCENE, {"/meshes/0/patches/0": {"type": "coons", "curves": [line] * 4}})
