"""Rays in bulk: what Renderer.shoot says, held against the tracer's layers, against project and against Snell."""
import numpy as np
import pytest

import trilens

GLASS = {
    "version": 1,
    "film": {"width": 64, "height": 48},
    "cameras": [{"name": "main", "type": "perspective", "yfov": 40,
                 "lookAt": {"eye": [0.3, 0.2, 4], "at": [0, 0, 0], "up": [0, 1, 0]}}],
    "background": {"color": [0.2, 0.3, 0.5]},
    "materials": [{"name": "glass", "transmissionFactor": 1, "ior": 1.5}, {"name": "red", "unlit": True}],
    "meshes": [
        {"name": "lens", "role": "optic", "material": "glass",
         "primitive": {"type": "sphere", "center": [0, 0, 0], "radius": 1}},
        {"name": "wall", "role": "object", "material": "red", "points": [[-9, -9, -3], [9, -9, -3], [9, 9, -3], [-9, 9, -3]],
         "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]}],
    "render": {"maxDepth": 8},
}


@pytest.fixture(scope="module")
def glass():
    return trilens.Renderer(trilens.parse_scene(GLASS, warn=lambda message: None))


def centres(width, height, step):
    x, y = np.meshgrid(np.arange(0, width, step) + 0.5, np.arange(0, height, step) + 0.5)
    return np.stack([x.ravel(), y.ravel()], axis=1)


def test_the_ends_are_those_of_the_truth(renderer):
    pixels = centres(128, 96, 5)
    rays, events = renderer.shoot(pixels)
    at = tuple(pixels[:, ::-1].astype(int).T)
    truth = renderer.trace(layers=["reflect", "position", "ray", "optic"])
    on_mirror = truth["optic.object"][at] != trilens.NONE
    assert 0.1 < on_mirror.mean() < 0.9
    assert np.array_equal(rays["event_count"] > 0, on_mirror)
    assert np.array_equal(rays["object"][on_mirror], truth["reflectID.object"][at][on_mirror])
    assert np.array_equal(rays["primitive"][on_mirror], truth["reflectID.primitive"][at][on_mirror])
    for axis, name in enumerate("XYZ"):
        np.testing.assert_allclose(rays["position"][on_mirror, axis], truth["reflectP." + name][at][on_mirror],
                                   atol=2e-5)
        np.testing.assert_allclose(rays["direction"][on_mirror, axis], truth["reflectD." + name][at][on_mirror],
                                   atol=2e-6)
        np.testing.assert_allclose(rays["origin"][on_mirror, axis], truth["reflectO." + name][at][on_mirror],
                                   atol=2e-6)
    direct = ~on_mirror
    np.testing.assert_allclose(rays["position"][direct, 0], truth["directP.X"][at][direct], atol=2e-5)


def test_events_follow_the_laws_of_reflection_and_refraction(glass):
    """No part of the program is asked for the law: angles from the points alone."""
    pixels = np.random.default_rng(3).uniform([15, 10], [50, 40], (300, 2))
    rays, events = glass.shoot(pixels, path="TT")
    through = rays["state"] == "seen"
    assert through.sum() > 100 and set(rays["state"]) <= {"seen", "escapes", "other path"}
    assert np.all(rays["event_count"][through] == 2)
    eye = np.array([0.3, 0.2, 4])
    for ray in rays[through][::7]:
        first, second = events[ray["first_event"]:ray["first_event"] + 2]
        stops = [eye, first["point"], second["point"], ray["position"]]
        ways = [b - a for a, b in zip(stops, stops[1:])]
        ways = [way / np.linalg.norm(way) for way in ways]
        np.testing.assert_allclose(ways[-1], ray["direction"], atol=1e-12)
        for event, (before, after), (n0, n1) in zip((first, second), zip(ways, ways[1:]), ((1, 1.5), (1.5, 1))):
            np.testing.assert_allclose(np.linalg.norm(event["point"]), 1, atol=1e-12)
            np.testing.assert_allclose(event["normal"], event["point"], atol=1e-12)
            np.testing.assert_allclose(np.cross(event["normal"], n0 * before - n1 * after), 0, atol=1e-12)


def test_words_choose_where_light_parts(glass):
    pixels = [[32.5, 24.5]]
    letters = lambda events: "".join({"reflect": "R", "transmit": "T"}[name] for name in events["event"])
    assert letters(glass.shoot(pixels)[1]) == "TT"  # the stronger way
    for word in ("R", "TT", "TRT", "TRRT"):
        rays, events = glass.shoot(pixels, path=word)
        assert letters(events) == word and rays["state"][0] != "other path"
    assert letters(glass.shoot(pixels, path="?R?")[1]) == "TRT"
    for word in ("T", "RT", "TTT"):
        rays, events = glass.shoot(pixels, path=word)
        assert rays["state"][0] == "other path" and len(events) == 0
    weights = [glass.shoot(pixels, path=word)[0]["weight"][0, 0] for word in ("R", "TT", "TRT")]
    assert weights[0] < weights[1] and weights[2] < weights[0]
    with pytest.raises(trilens.UsageError, match="R .reflected"):
        glass.shoot(pixels, path="RX")


def test_rays_of_ones_own_are_those_of_the_camera(glass):
    pixels = centres(64, 48, 7)
    camera = trilens.FilmCamera(glass.scene, "main").rays(pixels)
    seen, events = glass.shoot(pixels)
    own, own_events = glass.shoot(origins=camera["origin"], directions=2 * camera["direction"])
    assert np.array_equal(seen["state"], own["state"])
    np.testing.assert_allclose(seen["direction"], own["direction"], atol=1e-12)
    np.testing.assert_allclose(events["point"], own_events["point"], atol=1e-12)
    inside, _ = glass.shoot(origins=[[0, 0, 0]], directions=[[0, 0, -1], [0.1, 0, -1]])
    np.testing.assert_allclose(inside["t"], np.sqrt([4, 4.04]), atol=1) and inside["event_count"].tolist() == [1, 1]


def test_directions_of_any_length_are_followed(glass):
    origin, direction = [[0.1, 0.2, 4]], np.array([[0.01, -0.02, -1]])
    seen, events = glass.shoot(origins=origin, directions=direction)
    for length in (1e-320, 1e-200, 1e-155, 1e-100, 2.0, 1e100, 1e154, 1e300):
        same, met = glass.shoot(origins=origin, directions=length * direction)
        assert same["state"][0] == seen["state"][0] and len(met) == len(events) > 0
        np.testing.assert_allclose(same["direction"], seen["direction"], atol=1e-2 if length < 1e-300 else 1e-12)


def test_bad_rays_are_refused(glass):
    for arguments in ({}, {"pixels": [[1, 2]], "origins": [[0, 0, 0]], "directions": [[0, 0, 1]]},
                      {"origins": [[0, 0, 0]]}, {"pixels": [[1, 2, 3]]},
                      {"origins": [[0, 0, 0]] * 2, "directions": [[0, 0, 1]] * 3}):
        with pytest.raises(trilens.UsageError):
            glass.shoot(**arguments)
    for arguments in ({"pixels": [[np.nan, 1]]}, {"origins": [[0, 0, 0]], "directions": [[0, 0, 0]]},
                      {"origins": [[0, np.inf, 0]], "directions": [[0, 0, 1]]}):
        with pytest.raises(trilens.InputError):
            glass.shoot(**arguments)


def test_the_same_for_any_number_of_threads(glass):
    pixels = centres(64, 48, 1)
    before = trilens.threads() if hasattr(trilens, "threads") else None
    one = glass.shoot(pixels)
    two = glass.shoot(pixels)
    assert all(a.tobytes() == b.tobytes() for a, b in zip(one, two)) or before is None
