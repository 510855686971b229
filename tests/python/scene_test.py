"""Scenes: what is in them, and how they change."""
import copy
import json
import pickle
import warnings

import numpy as np
import pytest

import trilens
from conftest import SMALL, SOURCE


def test_a_scene_tells_what_it_holds(sphere):
    assert (sphere.film.width, sphere.film.height, sphere.film.spp) == (128, 96, 1)
    assert [camera.name for camera in sphere.cameras] == ["main"] and sphere.camera == "main"
    camera = sphere.cameras[0]
    assert camera.type == "perspective" and camera.yfov == 40 and camera.eye == (0.3, 0.6, 4.4)
    names = {mesh.name: mesh.role for mesh in sphere.meshes}
    assert names["ball"] == "optic" and names["floor"] == "object" and len(names) == 9
    assert sphere.meshes[0].shape == "sphere" and sphere.meshes[0].bounds == ((-1, -1, -1), (1, 1, 1))
    assert sphere.warnings == [] and sphere.file.endswith("sphere.json")


def test_json_and_dict_make_the_same_scene_again(sphere, image):
    assert json.loads(sphere.to_json()) == sphere.to_dict() == json.loads(sphere.resolved)
    for source in (sphere.to_dict(), sphere.to_json(), sphere.resolved):
        again = trilens.parse_scene(source, sphere.folder)
        drawn = trilens.Renderer(again).render(resolution=6)
        assert all(drawn[name].tobytes() == image[name].tobytes() for name in image)
    assert sphere.to_json(indent=None).count("\n") == 0


def test_json_names_files_from_where_it_will_lie(tmp_path):
    (tmp_path / "given").mkdir()
    (tmp_path / "wall.obj").write_text("v -3 0 -4\nv 3 0 -4\nv 3 3 -4\nf 1 2 3\n")
    scene = trilens.parse_scene({"version": 1, "film": {"width": 4, "height": 4},
                                 "cameras": [{"name": "main", "lookAt": {"eye": [0, 1, 4], "at": [0, 1, 0]}}],
                                 "lights": [{"type": "ambient"}],
                                 "meshes": [{"name": "wall", "role": "object", "file": "../wall.obj"}]},
                                tmp_path / "given")
    assert "../wall.obj" in scene.to_json()
    (tmp_path / "out.json").write_text(scene.to_json(folder=tmp_path))
    moved = trilens.load_scene(tmp_path / "out.json")
    assert moved.to_dict()["meshes"][0]["file"] == "wall.obj"


def test_overrides_and_resolution_stand_in_the_resolved_scene(sphere):
    changed = trilens.load_scene(
        SOURCE / "scenes/sphere.json", {"/film/width": 64, "/meshes/1/name": "7", "/background/color": [0, 0.5, 1]}, resolution=3
    )
    resolved = changed.to_dict()
    assert resolved["film"]["width"] == changed.film.width == 64
    assert resolved["meshes"][1]["name"] == changed.meshes[1].name == "7"
    assert resolved["background"]["color"] == [0, 0.5, 1]
    assert changed.meshes[0].resolution == resolved["meshes"][0]["resolution"] == 3
    again = sphere.with_overrides({"/film/spp": 2}, resolution=5)
    assert (again.film.spp, again.film.width, again.meshes[0].resolution) == (2, 128, 5)
    assert (sphere.film.spp, sphere.meshes[0].resolution) == (1, 16) and again.file == sphere.file


def test_a_scene_is_copied_and_pickled(sphere):
    assert copy.copy(sphere) is sphere and copy.deepcopy({"scene": sphere})["scene"] is sphere
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        twin = pickle.loads(pickle.dumps(sphere))
    assert twin.resolved == sphere.resolved
    assert (twin.file, twin.label, twin.folder) == (sphere.file, sphere.label, sphere.folder)
    assert trilens.Renderer(twin).digest() == trilens.Renderer(sphere).digest()


def test_an_image_carries_its_scene(image, sphere, tmp_path):
    image.save(tmp_path / "image.exr")
    scene = trilens.load_scene(tmp_path / "image.exr")
    assert scene.to_dict() == sphere.to_dict()


def test_the_examples_are_scenes_that_fit_the_schema():
    examples = trilens.scene_examples()
    assert "mirror-sphere" in examples
    properties = trilens.scene_schema()["properties"]
    for text in examples.values():
        scene = trilens.parse_scene(text, overrides=SMALL, warn=lambda message: None)
        assert set(scene.to_dict()) <= set(properties)
        assert any(mesh.role == "optic" for mesh in scene.meshes)


def test_values_that_json_cannot_say_are_refused(sphere):
    with pytest.raises(trilens.InputError, match="^/film/width: is nan"):
        sphere.with_overrides({"/film/width": float("nan")})
    with pytest.raises(TypeError):
        sphere.with_overrides({"/film/width": object()})
    with pytest.raises(trilens.InputError):
        sphere.with_overrides({"/film/widht": 3})


def test_a_renderer_tells_what_it_draws(renderer, sphere):
    (optic,) = renderer.optics
    assert optic.to_dict() == {"object": 0, "name": "ball", "mirror": True, "resolution": 16, "faces": 6}
    assert renderer.facet_count(3) == 6 * 2 * 9 and renderer.facet_count() == 6 * 2 * 256
    assert renderer.triangle_count == sum(mesh.triangles for mesh in sphere.meshes)
    assert renderer.scene.to_dict() == sphere.to_dict()
    assert renderer.digest() == trilens.Renderer(sphere).digest() and len(renderer.digest()) == 16


def test_parts_outlive_their_owners():
    film = trilens.Renderer(trilens.load_scene(SOURCE / "scenes/sphere.json", SMALL)).scene.film
    assert (film.width, film.height) == (128, 96)


def test_points_in_bulk_are_points_one_by_one(renderer):
    points = np.random.default_rng(3).uniform(-1.1, 2, (40, 3))
    bulk = renderer.project(points, resolution=4)
    for p, point in enumerate(points):
        one = renderer.project([point], resolution=4)
        mine = bulk[bulk["point"] == p]
        assert len(one) == len(mine)
        for name in one.dtype.names:
            assert name == "point" or np.array_equal(one[name], mine[name])
    same = renderer.project(np.asfortranarray(points), resolution=4)
    assert np.array_equal(same, bulk)
    assert len(renderer.project(np.zeros((0, 3)))) == 0


def test_a_direct_image_is_where_the_camera_projects_the_point(renderer, sphere):
    points = np.random.default_rng(4).uniform(-1.1, 2, (40, 3))
    images = renderer.project(points)
    direct = images[images["path"] == "direct"]
    camera = sphere.cameras[0]
    pinhole = trilens.make_perspective(camera.eye, camera.at, camera.up, camera.yfov, sphere.film.width, sphere.film.height)
    x, y, w = pinhole.project(points[direct["point"]]).T
    assert len(direct) == 40
    assert np.allclose(direct["x"], x / w, atol=1e-9) and np.allclose(direct["y"], y / w, atol=1e-9)
    assert np.allclose(direct["t"], w, atol=1e-12)


def test_a_gltf_is_a_scene_whose_optics_are_chosen_by_name():
    file = SOURCE / "scenes/gltf/room.gltf"
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        scene = trilens.load_scene(file, {"/film/width": 64}, optics=["Right"], time=1.0)
    assert any("drawn as a perfect mirror" in str(one.message) for one in told)
    roles = {mesh["name"]: mesh["role"] for mesh in scene.to_dict()["meshes"]}
    assert roles["Right"] == roles["Mirror ball"] == roles["Glass lens"] == "optic"
    assert roles["Floor"] == "object"
    with pytest.raises(trilens.UsageError, match="no mesh"):
        trilens.load_scene(file, optics=["Wrong"])
    with pytest.raises(trilens.UsageError, match="there is no animation"):
        trilens.load_scene(file, animation="Hope")


def test_a_number_that_is_not_finite_is_refused_with_its_place(sphere):
    scene = sphere.to_dict()
    scene["meshes"][1]["points"] = np.array([[0, 0, 0], [1, np.inf, 0], [1, 1, 0]])
    with pytest.raises(trilens.InputError, match="^scene: /meshes/1/points/1/1: is inf"):
        trilens.parse_scene(scene, sphere.folder)
    with pytest.raises(trilens.InputError, match="^mine: /extras/a~1b/0: is nan"):
        trilens.parse_scene({"version": 1, "extras": {"a/b": (float("nan"),)}}, label="mine")
    with pytest.raises(trilens.InputError, match="^/lights/0/position/1: is -inf"):
        trilens.load_scene(SOURCE / "scenes/sphere.json", {"/lights/0/position": [0, -np.inf, 0]})
    scene = {"version": 1}
    scene["extras"] = scene
    with pytest.raises(ValueError, match="Circular"):
        trilens.parse_scene(scene, sphere.folder)
