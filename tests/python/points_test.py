"""Point clouds and labels of scenes, from Python and by the command."""
import pathlib
import re

import numpy as np
import pytest

import trilens

SOURCE = pathlib.Path(__file__).resolve().parents[2]
KNOT = SOURCE / "scenes/points/knot.json"
SMALL = {"/film/width": 160, "/film/height": 120, "/film/spp": 1}


@pytest.fixture(scope="module")
def room():
    """The knot's room without its ball of glass, and a few points in the place of the knot."""
    scene = trilens.load_scene(KNOT, SMALL).to_dict()
    scene["meshes"] = [mesh for mesh in scene["meshes"] if mesh["name"] != "drop"]
    scene["materials"] = [material for material in scene["materials"] if material["name"] != "glass"]
    scene["points"] = [{"at": np.array([[1.9, 1.1, 0], [0, 2.4, 1.0]]), "size": 6, "color": [4, 0, 0]}]
    return scene


def test_points_and_labels_are_counted(command):
    scene = trilens.load_scene(KNOT)
    (knot,) = scene.points
    assert (knot.name, knot.points, knot.has_colors) == ("knot", 1200, True)
    assert knot.bounds[1][1] == pytest.approx(1.4, abs=1e-3)
    assert scene.labels == ["post", "start"]
    run, answer = command("scene", "info", KNOT)
    assert answer["points"][0]["points"] == 1200 and answer["labels"] == ["post", "start"]


def test_marks_are_where_project_says(room):
    scene = trilens.parse_scene(room, folder=SOURCE / "scenes/points")
    marked = trilens.Renderer(scene).render()
    plain = trilens.Renderer(trilens.parse_scene({**room, "points": [], "labels": []}, folder=SOURCE / "scenes/points")).render()
    changed = np.abs(marked["R"] - plain["R"]) > 0.2
    statistics = marked.statistics
    assert statistics["marks"] >= 4 and plain.statistics["marks"] == 0
    images = trilens.Renderer(scene).project(room["points"][0]["at"])
    seen = images[images["visible"] & images["inside"]]
    assert len(seen) >= 3
    for x, y in zip(seen["x"], seen["y"]):
        assert changed[int(y), int(x)]
    # Letters, dots and splats, and nothing else.
    assert 60 < changed.sum() < 2500


def test_labels_have_letters(room):
    for text, more in (("i", 12), ("MMMMMM", 120)):
        scene = trilens.parse_scene({**room, "points": [], "labels": [{"text": text, "at": [0, 2.4, 1.0], "dot": 0}]},
                                    folder=SOURCE / "scenes/points")
        red = trilens.Renderer(scene).render()["R"]
        assert ((red > 0.95) & (red < 1.05)).sum() > more / 4


def test_labels_that_give_way_are_counted(room):
    label = {"text": "here", "at": [0, 2.4, 1.0], "minWeight": 0.95}
    crowd = {**room, "points": [], "labels": [label] + 3 * [{**label, "givesWay": True}]}
    with pytest.warns(trilens.TrilensWarning, match="images of labels are left out"):
        statistics = trilens.Renderer(trilens.parse_scene(crowd, folder=SOURCE / "scenes/points")).render().statistics
    free = trilens.Renderer(trilens.parse_scene({**crowd, "labels": 4 * [label]}, folder=SOURCE / "scenes/points"))
    assert free.render().statistics["crowded_marks"] == 0
    assert statistics["crowded_marks"] == 3 * statistics["marks"] > 0


def test_an_svg_has_ellipses_and_texts(room, command, tmp_path):
    scene = tmp_path / "room.json"
    scene.write_text(trilens.parse_scene(room, folder=SOURCE / "scenes/points").to_json())
    for name in ("textures", "points"):
        (tmp_path.parent / name).exists() or (tmp_path.parent / name).symlink_to(SOURCE / "scenes" / name)
    run, answer = command("render", scene, "-o", tmp_path / "room.svg")
    svg = (tmp_path / "room.svg").read_text()
    assert answer["marks"] == len(re.findall(r'data-(?:points|label)="', svg)) > 4
    assert svg.count("<text") == len(re.findall('data-label="', svg)) and ">post</text>" in svg


def test_fonts_that_are_none_are_refused():
    with pytest.raises(trilens.InputError, match="/labels/0/font.*no such font"):
        trilens.load_scene(KNOT, {"/labels/0/font": "nowhere.ttf"})
    with pytest.raises(trilens.InputError, match="nowhere.ply: cannot be opened"):
        trilens.load_scene(KNOT, {"/points/0/file": "nowhere.ply"})
