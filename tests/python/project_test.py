"""Renderer.project beyond single points: words, directions, bounds, warm starts, and derivatives by parameters."""
import copy
import itertools

import numpy as np
import pytest

import trilens
from shoot_test import GLASS

ROOM = {
    "version": 1,
    "film": {"width": 320, "height": 240},
    "cameras": [{"name": "main", "type": "perspective", "yfov": 40,
                 "lookAt": {"eye": [0.3, 0.6, 4.4], "at": [0, 0, 0], "up": [0, 1, 0]}}],
    "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0},
                  {"name": "glass", "transmissionFactor": 1, "ior": 1.5}],
    "meshes": [{"name": "optic", "role": "optic", "material": "chrome", "resolution": 8,
                "primitive": {"type": "sphere", "center": [0.1, 0, -0.1], "radius": 1}}],
    "render": {"maxDepth": 0, "fresnel": True},
}
CUBE = {"points": [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]],
        "faceVertexCounts": [4] * 6,
        "faceVertexIndices": [0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 2, 3, 7, 6, 0, 4, 7, 3, 1, 2, 6, 5],
        "creaseIndices": [4, 5, 6, 7, 4], "creaseLengths": [5], "creaseSharpnesses": [1.5]}
EYE = np.array([0.3, 0.6, 4.4])


def scene_of(change=None, **render):
    scene = copy.deepcopy(ROOM)
    scene["render"].update(render)
    if change:
        change(scene)
    return scene


def renderer_of(scene, overrides=None):
    return trilens.Renderer(trilens.parse_scene(scene, overrides=overrides or {}, warn=lambda message: None))


def cage(scene):
    mesh = scene["meshes"][0]
    del mesh["primitive"]
    mesh.update(copy.deepcopy(CUBE))
    mesh["transform"] = {"translate": [0.1, 0.05, 0], "rotate": [0.1, 0.2, 0.05, 0.97], "scale": [0.9, 0.9, 0.9]}


def glass(scene):
    scene["meshes"][0]["material"] = "glass"


def mirror_and_lens(scene):
    scene["meshes"][0]["primitive"] = {"type": "sphere", "center": [-1, 0, 0], "radius": 0.8}
    scene["meshes"].append({"name": "ball", "role": "optic", "material": "glass", "resolution": 8,
                            "primitive": {"type": "sphere", "center": [1, 0, 0.3], "radius": 0.7}})


def opencv(scene):
    camera = scene["cameras"][0]
    del camera["yfov"]
    camera.update({"type": "opencv", "model": "pinhole", "fx": 330, "fy": 325, "cx": 160, "cy": 120,
                   "distortion": [-0.1, 0.02, 0.001, -0.002]})


def around(count, seed, near=1.6, far=6.0):
    draw = np.random.default_rng(seed)
    way = draw.normal(size=(count, 3))
    return way / np.linalg.norm(way, axis=1)[:, None] * np.exp(draw.uniform(np.log(near), np.log(far), (count, 1)))


def test_words_choose_histories():
    renderer = renderer_of(scene_of(mirror_and_lens, maxDepth=2))
    points = around(16, 1)
    every = renderer.project(points)
    words = {"reflect": "R", "transmit": "T"}
    word_of = lambda image: "".join(words[s] for s in image["steps"]["event"][:image["step_count"]])
    for word in ("R", "TT"):
        asked = renderer.project(points, path=word)
        assert len(asked) and all(word_of(image) == word for image in asked)
        expected = [image for image in every if word_of(image) == word]
        for image in expected:
            assert np.min(np.hypot(asked["x"] - image["x"], asked["y"] - image["y"])) < 1e-6
    deep = renderer.project(points, path="TRT")  # deeper than "TT", as deep as maxDepth
    assert all(word_of(image) == "TRT" for image in deep)


def test_steps_say_where_the_path_meets_the_optics():
    renderer = renderer_of(scene_of(mirror_and_lens, maxDepth=1))
    images = renderer.project(around(8, 2))
    images = images[(images["step_count"] > 0) & images["refined"]]
    assert {1, 2} <= set(images["step_count"])
    rays, events = renderer.shoot(np.stack([images["x"], images["y"]], axis=1)[:, :2], path=None)
    for image in images:
        word = "".join({"reflect": "R", "transmit": "T"}[s] for s in image["steps"]["event"][:image["step_count"]])
        ray, met = renderer.shoot([[image["x"], image["y"]]], path=word)
        if ray["state"][0] == "other path":  # another optic hides it
            continue
        np.testing.assert_allclose(met["point"], image["steps"]["point"][:len(met)], atol=1e-7)
        np.testing.assert_allclose(met["normal"], image["steps"]["normal"][:len(met)], atol=1e-7)


def test_completeness_does_not_depend_on_the_grid():
    renderer = renderer_of(scene_of(maxDepth=8))
    points = around(40, 5)
    answers = [renderer.project(points, resolution=n) for n in (4, 8, 16)]
    assert all(answer["complete"].all() for answer in answers)
    for answer in answers[1:]:
        np.testing.assert_allclose(answer["x"], answers[0]["x"], atol=1e-9)


@pytest.mark.parametrize("change", [None, cage, opencv])
def test_directions_are_points_without_end(change):
    renderer = renderer_of(scene_of(change))
    directions = around(12, 7)
    images = renderer.project(directions=directions, derivatives=True)
    assert np.isinf(images["t"]).all() and len(images) > 8
    for image in images[images["path"] == "reflect"]:
        ray, _ = renderer.shoot([[image["x"], image["y"]]])
        unit = directions[image["point"]] / np.linalg.norm(directions[image["point"]])
        if image["inside"] and ray["event_count"][0] == 1:
            np.testing.assert_allclose(ray["direction"][0], unit, atol=1e-9)
    far = renderer.project(1e11 * directions)
    for image in far[far["refined"] & far["inside"]]:
        same = images[images["point"] == image["point"]]
        assert np.min(np.hypot(same["x"] - image["x"], same["y"] - image["y"])) < 1e-6
    with pytest.raises(trilens.InputError, match="farther"):
        renderer.project([[1e31, 0, 0]])
    with pytest.raises(trilens.InputError, match="no direction"):
        renderer.project(directions=[[0, 0, 0]])


def test_bounds_of_images_and_weight():
    renderer = renderer_of(scene_of(mirror_and_lens, maxDepth=3))
    points = around(3, 11)
    every = renderer.project(points)
    few = renderer.project(points, max_images=2)
    with pytest.raises(trilens.UsageError, match="max_images is 0 or more, not -1"):
        renderer.project(points, max_images=-1)
    assert np.bincount(few["point"]).max() == 2 and not few["complete"].any()
    for p in range(len(points)):
        strongest = np.sort(every["weight"][every["point"] == p].sum(axis=1))[-2:]
        np.testing.assert_allclose(np.sort(few["weight"][few["point"] == p].sum(axis=1)), strongest, rtol=1e-12)
    strong = renderer.project(points, min_weight=0.5)
    assert len(strong) == (every["weight"].max(axis=1) >= 0.5).sum()
    for least in (float("nan"), -1.0):
        with pytest.raises(trilens.UsageError, match="at least 0"):
            renderer.project(points, min_weight=least)
    with pytest.raises(trilens.InputError, match="/film/width: is no number of a camera"):
        renderer.project(points, derivatives=["/film/width"])


@pytest.mark.parametrize("change", [None, cage, mirror_and_lens])
def test_warm_starts_follow_the_images(change):
    depth = 1 if change is mirror_and_lens else 0
    scene = scene_of(change, maxDepth=depth)
    points = around(30, 13)
    renderer = renderer_of(scene)
    start = renderer.project(points)
    moved = points + 1e-3 * around(30, 14)
    warm = renderer.project(moved, start=start, visibility=False)
    assert len(warm) == len(start)
    cold = renderer.project(moved)
    found = warm[warm["refined"]]
    assert len(found) > 0.95 * len(start)
    for image in found:
        same = cold[cold["point"] == image["point"]]
        near = np.argmin(np.hypot(same["x"] - image["x"], same["y"] - image["y"]))
        assert np.hypot(same["x"][near] - image["x"], same["y"][near] - image["y"]) < 1e-8
        np.testing.assert_allclose(same["weight"][near], image["weight"], rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(same["length"][near], image["length"], rtol=1e-9)


def test_warm_starts_go_on_over_edges_of_faces():
    """Points move by a third of the cage's size: images leave their faces, and are those that a search finds there."""
    scene = scene_of(cage)
    points = around(400, 23)
    renderer = renderer_of(scene)
    start = renderer.project(points, path="R", visibility=False)
    moved = points + 0.3 * around(400, 24)
    warm = renderer.project(moved, start=start, path="R", visibility=False)
    cold = renderer.project(moved, path="R", visibility=False)
    crossed = 0
    for before, image in zip(start, warm):
        if not image["refined"] or image["steps"]["face"][0] == before["steps"]["face"][0]:
            continue
        same = cold[cold["point"] == image["point"]]
        off = np.hypot(same["x"] - image["x"], same["y"] - image["y"])
        assert off.min() < 1e-8
        crossed += 1
    assert crossed > 30


def numbers_of(value):
    return [(i,) for i in range(len(value))] if isinstance(value, list) else [()]


def value_at(scene, pointer):
    at = scene
    for key in pointer.split("/")[1:]:
        at = at[int(key)] if isinstance(at, list) else at[key]
    return at


KINDS = {
    "ball": (None, 0, None, ["/meshes/0/primitive/center", "/meshes/0/primitive/radius", "/cameras/0/yfov",
                             "/cameras/0/lookAt/eye", "/cameras/0/lookAt/at"]),
    "cage": (cage, 0, None, ["/meshes/0/transform/translate", "/meshes/0/transform/rotate",
                             "/meshes/0/transform/scale", "/meshes/0/points/6", "/cameras/0/yfov"]),
    "glass": (glass, 1, "TT", ["/meshes/0/primitive/center", "/meshes/0/primitive/radius", "/materials/1/ior",
                               "/cameras/0/yfov", "/cameras/0/lookAt/eye"]),
    "lens of OpenCV": (opencv, 0, None, ["/cameras/0/fx", "/cameras/0/cy", "/cameras/0/distortion",
                                         "/cameras/0/lookAt/eye", "/meshes/0/primitive/radius"]),
    "mirror and ball": (mirror_and_lens, 2, "R?", ["/meshes/0/primitive/center", "/meshes/1/primitive/center",
                                                   "/meshes/1/primitive/radius"]),
}


@pytest.mark.parametrize("kind", KINDS)
def test_derivatives_are_those_of_differences(kind):
    """Against central differences of whole projections, warm-started so that each follows its image."""
    change, depth, path, pointers = KINDS[kind]
    scene = scene_of(change, maxDepth=depth)
    points = around(30, 17)
    renderer = renderer_of(scene)
    images = renderer.project(points, path=path, derivatives=pointers)
    columns = [(pointer, at) for pointer in pointers for at in numbers_of(value_at(scene, pointer))]
    assert images["by_parameter"].shape[1:] == (2, len(columns))
    kept = images["refined"] & images["inside"] & np.isfinite(images["by_parameter"]).all(axis=(1, 2))
    if path is None:
        assert (images["path"] == "direct").any()
    assert kept.sum() >= 8
    step, worst = 1e-5, []
    for column, (pointer, at) in enumerate(columns):
        places = []
        for sign in (1, -1):
            value = copy.deepcopy(value_at(scene, pointer))
            if at:
                value[at[0]] += sign * step
            else:
                value += sign * step
            other = renderer_of(scene, {pointer: value}).project(points, start=images, visibility=False)
            places.append(np.stack([other["x"], other["y"]], axis=1))
        difference = (places[0] - places[1]) / (2 * step)
        good = kept & np.isfinite(difference).all(axis=1)
        assert good.sum() >= 0.9 * kept.sum()
        scale = np.maximum(np.linalg.norm(difference[good], axis=1), 1)
        error = np.linalg.norm(images["by_parameter"][good][:, :, column] - difference[good], axis=1) / scale
        worst.append(error.max())
        assert np.median(error) < 1e-6, (pointer, at)
    assert max(worst) < 1e-5, list(zip(columns, worst))


def test_warm_starts_have_the_derivatives_of_searches():
    renderer = renderer_of(trilens.scene_examples()["mirror-sphere"])
    points = np.random.default_rng(3).uniform([-3, -1, 1], [3, 2, 3], (30, 3))
    pointers = ["/meshes/ball/primitive/center", "/meshes/ball/primitive/radius", "/cameras/0/yfov"]
    cold = renderer.project(points, path="R", derivatives=pointers)
    warm = renderer.project(points, start=cold, derivatives=pointers)
    assert len(warm) > 10 and warm["refined"].all()
    np.testing.assert_allclose(warm["by_parameter"], cold["by_parameter"], rtol=1e-6, atol=1e-5)


def test_pointers_without_numbers_are_refused():
    renderer = renderer_of(scene_of())
    for pointer in ("/meshes/0/primitive/nothing", "/meshes/0/name", "meshes", "/cameras"):
        with pytest.raises(trilens.InputError):
            renderer.project([[1, 2, 3]], derivatives=[pointer])


@pytest.mark.parametrize("start", [5, "ball", [1, 2], np.zeros(3), np.zeros((2, 2)), {"point": 1},
                                   np.zeros(2, [("point", "i8"), ("step_count", "i8"), ("steps", "f8")])])
def test_a_start_that_no_projection_returned_is_refused_in_words(start):
    renderer = trilens.Renderer(trilens.parse_scene(trilens.scene_examples()["mirror-sphere"]))
    with pytest.raises(trilens.UsageError, match="start is an array of images that project has returned"):
        renderer.project([[1, 2, 3]], start=start)
