"""The cameras of scenes: rays and places, as the library has them."""
import json
import pathlib

import numpy as np
import pytest

import trilens

SCENE = pathlib.Path(__file__).resolve().parents[2] / "scenes/cameras.json"


@pytest.fixture(scope="module")
def scene():
    # The lens is given in pixels of the film.
    cameras = trilens.load_scene(SCENE).to_dict()["cameras"]
    index = [camera["name"] for camera in cameras].index("lens")
    pixels = {f"/cameras/{index}/{key}": cameras[index][key] * 96 / 640 for key in ("fx", "fy", "cx", "cy")}
    return trilens.load_scene(SCENE, {"/film/width": 96, "/film/height": 72, "/film/spp": 1, **pixels})


def test_every_camera_shows_points_of_its_rays_where_they_leave(scene):
    places = np.random.default_rng(3).uniform([1, 1], [95, 71], (50, 2))
    for described in scene.cameras:
        camera = trilens.FilmCamera(scene, described.name)
        rays = camera.rays(places)
        has_ray = ~np.isnan(rays["origin"][:, 0])
        assert has_ray.sum() > 20, described.name
        points = (rays["origin"] + 2.5 * rays["direction"])[has_ray]
        images = camera.project(points)
        for i, place in enumerate(places[has_ray]):
            own = images["point"] == i
            off = np.hypot(images["x"][own] - place[0], images["y"][own] - place[1])
            assert off.min() < 1e-4, described.name


def test_types_are_the_scene_files(scene):
    types = [entry.get("type", "perspective") for entry in scene.to_dict()["cameras"]]
    assert [camera.type for camera in scene.cameras] == types
    assert trilens.FilmCamera(scene, "left half").is_linear
    assert not trilens.FilmCamera(scene, "fisheye").is_linear


def test_facets_are_named_after_the_general_linear_cameras(scene, command):
    kinds = {camera.name: trilens.FilmCamera(scene, camera.name).facet_kinds for camera in scene.cameras}
    assert kinds["main"] == {"pinhole": 2} and kinds["oblique"] == {"orthographic": 2}
    assert kinds["strip"] == {"pushbroom": 8192} and kinds["slits"] == {"crossedSlits": 8192}
    assert kinds["panorama"] == {"pinhole": 8064, "none": 128}
    _, answer = command("scene", "info", SCENE)
    assert answer["camera_kinds"][answer["cameras"].index("several")] == kinds["several"]
    pixel = trilens.Renderer(scene).explain(48, 36, camera="strip")
    assert pixel["camera"]["facet_kind"] == "pushbroom"


def test_a_lens_that_folds_the_film_is_refused(scene):
    index = [camera.name for camera in scene.cameras].index("lens")
    broken = scene.with_overrides({f"/cameras/{index}/distortion": [-2, 0, 0, 0]})
    with pytest.raises(trilens.InputError, match=f"/cameras/{index}/distortion: .*not one-to-one"):
        trilens.FilmCamera(broken, "lens")


def test_the_caustic_of_a_ring_is_a_nephroid():
    renderer = trilens.Renderer(trilens.load_scene(SCENE.parent.parent / "tests/laws/cup.json"))
    drawing = renderer.draw_lines(16, "source", folds=True, caustics=True, rays="interpolated")
    (sheet,) = drawing.caustics
    assert (sheet["path"], sheet["optic"], sheet["sheet"], sheet["virtual"]) == ("reflect", 0, 0, False)
    assert sheet["triangles"].max() < len(sheet["points"]) and sheet["segments"].shape == (0, 2)
    assert drawing.obj.count("\nf ") == len(sheet["triangles"])

    def nephroid(places):
        x, z = places[:, 0], places[:, 2]
        return (x**2 + z**2 - 0.25) ** 3 - 27 / 64 * x**2

    assert np.abs(nephroid(sheet["points"])).max() < 2e-3
    curves = [curve for curve in drawing.fold_curves if curve["object"] == 1]
    assert curves and all(len(curve["points"]) == len(curve["places"]) for curve in curves)
    assert max(np.abs(nephroid(curve["places"])).max() for curve in curves) < 2e-3
    assert renderer.draw_lines(2, "source").caustics == [] and renderer.draw_lines(2, "source").obj == ""


def test_a_cameras_own_facets_are_an_axis_of_sweeps(tmp_path):
    summary = trilens.sweep(SCENE, tmp_path, "camera-facets=8..32:x2", camera="cylinder",
                            overrides={"/film/width": 96, "/film/height": 72, "/film/spp": 1})
    fit = next(fit for fit in summary.fits if (fit.layer, fit.metric) == ("direct", "disp_mean_px"))
    assert fit.axis == "camera-facets" and fit.order > 1.9


def test_a_cube_map_cross_is_six_faces_every_id_the_same():
    file, side = SCENE.parent / "cameras/cross.json", 80
    ids = ["directID.object", "directID.primitive", "optic.object", "optic.facet"]

    def drawn(width, height):
        film = {"/film/width": width, "/film/height": height, "/film/spp": 1}
        return trilens.Renderer(trilens.load_scene(file, film, warn=lambda text: None))

    cross, face = drawn(4 * side, 3 * side), drawn(side, side)
    layers = ["Z", "optic", "direct", "position"]
    whole = cross.render(camera="cross", layers=layers, warn=lambda text: None)
    described = {camera["name"]: camera for camera in cross.scene.to_dict()["cameras"]}
    compared, objects = 0, set()
    for name, camera in described.items():
        if name == "cross":
            continue
        (view,) = [one for one in described["cross"]["views"] if one["lookAt"]["at"] == camera["lookAt"]["at"]]
        x, y = round(view["window"][0] * 4 * side), round(view["window"][1] * 3 * side)
        one = face.render(camera=name, layers=layers, warn=lambda text: None)
        part = {channel: np.asarray(whole[channel])[y : y + side, x : x + side] for channel in [*ids, "Z"]}
        for channel in ids:
            assert part[channel].tobytes() == np.ascontiguousarray(one[channel]).tobytes(), (name, channel)
        # The cross interpolates its rays between corners: the last bit of a depth may be another.
        assert np.allclose(part["Z"], one["Z"], rtol=3e-7)
        objects |= set(np.unique(part["directID.object"]))
        compared += 1
    assert compared == 6 and len(objects) > 3


def test_a_lens_of_14_coefficients_and_a_tilted_sensor_is_opencv_s_formula():
    d = [0.11, -0.05, 0.001, -0.0015, 0.01, 0.08, -0.02, 0.004, 0.002, -0.001, 0.0015, 0.001, 0.13, -0.22]
    lens = {"name": "lens", "type": "opencv", "model": "pinhole", "fx": 230, "fy": 224, "cx": 155.3, "cy": 123.1,
            "distortion": d, "facets": 4, "lookAt": {"eye": [0, 0, 0], "at": [0, 0, -1]}}
    film = {"version": 1, "film": {"width": 320, "height": 240}, "cameras": [lens]}
    camera = trilens.FilmCamera(trilens.parse_scene(film, warn=lambda text: None))
    generator = np.random.default_rng(3)
    x, y = generator.uniform(-0.35, 0.35, (2, 400))
    depth = generator.uniform(0.5, 20, 400)
    k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, about_x, about_y = d
    r2 = x * x + y * y
    radial = (1 + k1 * r2 + k2 * r2**2 + k3 * r2**3) / (1 + k4 * r2 + k5 * r2**2 + k6 * r2**3)
    across = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x) + s1 * r2 + s2 * r2**2
    down = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y + s3 * r2 + s4 * r2**2
    # The documented matrices of OpenCV's tilted sensor.
    (cx, sx), (cy, sy) = [(np.cos(angle), np.sin(angle)) for angle in (about_x, about_y)]
    turn = np.array([[cy, 0, -sy], [0, 1, 0], [sy, 0, cy]]) @ np.array([[1, 0, 0], [0, cx, sx], [0, -sx, cx]])
    onto = np.array([[turn[2, 2], 0, -turn[0, 2]], [0, turn[2, 2], -turn[1, 2]], [0, 0, 1]])
    u, v, w = onto @ turn @ np.stack([across, down, np.ones(400)])
    found = camera.project(np.column_stack([x * depth, -y * depth, -depth]))
    assert np.array_equal(found["point"], np.arange(400))
    assert np.abs(found["x"] - (230 * u / w + 155.3)).max() < 1e-10
    assert np.abs(found["y"] - (224 * v / w + 123.1)).max() < 1e-10
