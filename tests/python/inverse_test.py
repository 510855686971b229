"""Fits and designed mirrors from Python."""
import numpy as np
import pytest

import trilens


@pytest.fixture(scope="module")
def ball():
    return trilens.parse_scene(trilens.scene_examples()["mirror-sphere"], warn=lambda message: None)


@pytest.fixture(scope="module")
def pairs(ball):
    points = np.random.default_rng(1).uniform([-3, -1, 1], [3, 2, 3], (40, 3))
    images = trilens.Renderer(ball).project(points)
    images = images[(images["path"] == "reflect") & images["inside"]]
    return np.stack([images["x"], images["y"]], axis=1), points[images["point"]]


FREE = ["/meshes/ball/primitive/center", "/meshes/ball/primitive/radius"]


def test_a_fit_finds_the_ball(ball, pairs):
    start = ball.with_overrides({"/meshes/ball/primitive/radius": 0.95}, warn=lambda message: None)
    found = trilens.fit(start, *pairs, FREE, warn=lambda message: None)
    assert found.converged and found.rank == 4 and found.rms < 1e-6 < found.rms_start
    assert found.states == ["used"] * len(pairs[0])
    assert found.residuals.shape == (len(pairs[0]), 2)
    true = ball.to_dict()["meshes"]
    radius = next(mesh for mesh in true if mesh["name"] == "ball")["primitive"]["radius"]
    assert found.parameters[3].value == pytest.approx(radius, abs=1e-8)
    assert np.sqrt(np.diag(found.covariance)) == pytest.approx([one.sigma for one in found.parameters])
    again = trilens.fit(found.scene, *pairs, FREE, match="nearest", warn=lambda message: None)
    assert again.rms_start < 1e-6


def test_a_fit_and_a_design_warn_as_all_do(ball, pairs):
    told = []
    far = np.array(pairs[0])
    far[0] += 30
    found = trilens.fit(ball, far, pairs[1], FREE, warn=told.append)
    assert told == found.warnings and any("outliers" in one for one in told)
    with pytest.warns(trilens.TrilensWarning, match="outliers"):
        trilens.fit(ball, far, pairs[1], FREE)
    with pytest.raises(trilens.TrilensWarning):
        trilens.fit(ball, far, pairs[1], FREE)
    with pytest.raises(trilens.UsageError, match="warn"):
        trilens.fit(ball, far, pairs[1], FREE, warn=3)

    told.clear()
    design = trilens.design_mirror(trilens.wish_example(), warn=told.append)
    assert told == design.warnings and any("curl" in one for one in told)
    with pytest.warns(trilens.TrilensWarning, match="curl"):
        trilens.design_mirror(trilens.wish_example())


def test_misuse_of_a_fit_is_named(ball, pairs):
    pixels, points = pairs
    with pytest.raises(trilens.UsageError, match="pixels"):
        trilens.fit(ball, pixels[:, :1], points, FREE)
    with pytest.raises(trilens.UsageError, match="for"):
        trilens.fit(ball, pixels[:3], points, FREE)
    with pytest.raises(trilens.InputError, match="no number"):
        trilens.fit(ball, pixels, points, ["/meshes/ball/name"])
    with pytest.raises(trilens.InputError, match="too few"):
        trilens.fit(ball, pixels[:1], points[:1], FREE)
    with pytest.raises(trilens.ComputationError, match="lost"):
        trilens.fit(ball, np.full_like(pixels, 0.5), points, FREE)
    with pytest.raises(trilens.UsageError, match="match"):
        trilens.fit(ball, pixels, points, FREE, match="best")


def test_a_design_is_nearer_to_its_wish_than_a_sphere(tmp_path):
    wish = trilens.wish_example()
    mirror = trilens.design_mirror(wish, compare_sphere=True, warn=lambda message: None)
    assert mirror.errors["mean"] < 0.5 * mirror.sphere["mean"]
    assert mirror.error_map.shape == (40, 40) and mirror.heights.shape == (12, 12)
    assert mirror.error_map.mean() == pytest.approx(mirror.errors["mean"], rel=0.01)  # at samples; all over
    assert [mesh.name for mesh in mirror.scene.meshes][0] == "mirror"
    mirror.save_stl(tmp_path / "m.stl")
    assert (tmp_path / "m.stl").stat().st_size > 84

    t, s = np.mgrid[0:1:33j, 0:1:65j]
    plane = wish.pop("wish")
    origin, u, v = (np.array(plane[key]) for key in ("origin", "u", "v"))
    wall = origin + s[..., None] * u + t[..., None] * v
    same = trilens.design_mirror(wish, target=wall, warn=lambda message: None)
    assert same.errors["mean"] == pytest.approx(mirror.errors["mean"], rel=1e-5)
    with pytest.raises(trilens.InputError, match="eye"):
        trilens.design_mirror({**wish, "eye": [0, 0, -1]}, target=wall)
    with pytest.raises(trilens.UsageError, match="target"):
        trilens.design_mirror(wish, target=wall[0])


def test_a_designed_lens_is_a_closed_body_and_makes_light_parallel(tmp_path):
    wish = {"version": 1, "eye": [0, 0, 0.5], "lens": {"ior": 1.5, "thickness": 0.08},
            "patch": {"center": [0, 0, 0], "normal": [0, 0, 1], "tangent": [1, 0, 0], "size": [0.2, 0.2],
                      "controls": [20, 20]}}
    lens = trilens.design_mirror(wish, target=np.tile([0.0, 0, -1], (4, 4, 1)), directions=True)
    # Descartes' hyperboloid: (n^2 - 1) z^2 - 2 d (n - 1) z = x^2 + y^2.
    height = (0.25 - np.sqrt(0.0625 + 1.25 * (0.07 ** 2 + 0.05 ** 2))) / 1.25
    assert lens.height(0.07, 0.05) == pytest.approx(height, abs=1e-7)
    assert not lens.scene.warnings
    rays, _ = trilens.Renderer(lens.scene).shoot([[320, 320], [250, 400.0]], path="TT")
    assert rays["direction"][:, 2] == pytest.approx(-1, abs=1e-9)
