"""Volumes of scenes, from Python and by the command."""
import pathlib

import numpy as np
import pytest

import trilens

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SMALL = {"/film/width": 64, "/film/height": 48, "/film/spp": 1}


def colours(image):
    return np.stack([image[channel] for channel in "RGB"], axis=-1)


def test_volumes_are_counted(command):
    scene = trilens.load_scene(SOURCE / "scenes/volumes/jet.json", SMALL)
    (jet,) = scene.volumes
    assert (jet.name, jet.field, jet.cells) == ("jet", "heat", 16 * 6 * 20)
    assert jet.tetrahedra == 20 * 16 * (3 + 5 * 6) and jet.least == 0 and jet.most == 1
    assert jet.bounds[1][1] == pytest.approx(3)
    run, answer = command("scene", "info", SOURCE / "scenes/volumes/jet.json")
    assert answer["volumes"][0]["tetrahedra"] == jet.tetrahedra and answer["volumes"][0]["range"] == [0, 1]


def test_a_volume_is_seen_and_its_transfer_function_changes_it():
    scene = trilens.load_scene(SOURCE / "scenes/volumes/jet.json", SMALL)
    clear = scene.with_overrides({"/volumes/0/transferFunction/extinction": 0})
    seen, without = (colours(trilens.Renderer(one).render()) for one in (scene, clear))
    changed = np.abs(seen - without).max(axis=-1) > 0.05
    assert 60 < changed.sum() < 600
    truth = colours(trilens.Renderer(scene).trace())
    assert np.abs(seen - truth).mean() < 0.01


def test_cells_that_are_none_are_refused_with_their_place():
    with pytest.raises(trilens.InputError, match="/volumes/0/transferFunction/map"):
        trilens.load_scene(SOURCE / "scenes/volumes/jet.json", {"/volumes/0/transferFunction/map": "jet"})
    with pytest.raises(trilens.InputError, match="it has 'heat'"):
        trilens.load_scene(SOURCE / "scenes/volumes/jet.json", {"/volumes/0/field": "cold"})
