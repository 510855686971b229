"""OpenCV's lens models against OpenCV itself, where its module is installed."""
import json

import numpy as np
import pytest

import trilens

cv2 = pytest.importorskip("cv2", reason="python3-opencv is not installed")

WIDTH, HEIGHT = 320, 240
PINHOLES = {
    "none": [],
    "four": [-0.21, 0.06, 0.001, -0.0015],
    "five": [-0.21, 0.06, 0.001, -0.0015, -0.008],
    "rational": [0.11, -0.05, 0.001, -0.0015, 0.01, 0.08, -0.02, 0.004],
    "prism": [0.11, -0.05, 0.001, -0.0015, 0.01, 0.08, -0.02, 0.004, 0.002, -0.001, 0.0015, 0.001],
    "tilted": [0.11, -0.05, 0.001, -0.0015, 0.01, 0.08, -0.02, 0.004, 0.002, -0.001, 0.0015, 0.001, 0.03, -0.02],
}
FISHEYES = {"none": [], "four": [0.02, -0.006, 0.001, -0.0002]}
FX, FY, CX, CY = 230.0, 224.0, 155.3, 123.1


def camera(model, distortion):
    scene = {
        "version": 1,
        "film": {"width": WIDTH, "height": HEIGHT},
        "cameras": [{"name": "lens", "type": "opencv", "model": model, "fx": FX, "fy": FY, "cx": CX, "cy": CY,
                     "distortion": distortion, "facets": 4,
                     "lookAt": {"eye": [0, 0, 0], "at": [0, 0, -1]}}],
    }
    return trilens.FilmCamera(trilens.parse_scene(json.dumps(scene), warn=lambda message: None))


def matrix():
    # OpenCV counts from the first pixel's centre, the film from its edge.
    return np.array([[FX, 0, CX - 0.5], [0, FY, CY - 0.5], [0, 0, 1]])


def random_points(spread):
    generator = np.random.default_rng(7)
    depth = generator.uniform(0.5, 20, 500)
    across = generator.uniform(-spread, spread, (500, 2))
    return np.column_stack([across * depth[:, None], depth])  # x right, y down, z ahead


def of_world(points):
    return points * [1, -1, -1]


@pytest.mark.parametrize("name", PINHOLES)
def test_pinhole_models(name):
    points = random_points(0.45)
    distortion = np.array(PINHOLES[name]) if PINHOLES[name] else None
    expected = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix(), distortion)[0][:, 0] + 0.5
    found = camera("pinhole", PINHOLES[name]).project(of_world(points))
    assert np.array_equal(found["point"], np.arange(len(points)))
    assert np.abs(np.column_stack([found["x"], found["y"]]) - expected).max() < 1e-7


@pytest.mark.parametrize("name", FISHEYES)
def test_fisheye_model(name):
    points = random_points(2.0)
    distortion = np.array(FISHEYES[name] or [0.0] * 4)
    expected = cv2.fisheye.projectPoints(points[:, None], np.zeros(3), np.zeros(3), matrix(), distortion)[0][:, 0] + 0.5
    found = camera("fisheye", FISHEYES[name]).project(of_world(points))
    assert np.array_equal(found["point"], np.arange(len(points)))
    assert np.abs(np.column_stack([found["x"], found["y"]]) - expected).max() < 1e-7


@pytest.mark.parametrize("name", PINHOLES)
def test_rays_are_undistorted_points(name):
    places = np.random.default_rng(8).uniform([10, 10], [WIDTH - 10, HEIGHT - 10], (200, 2))
    rays = camera("pinhole", PINHOLES[name]).rays(places)
    way = rays["direction"] / -rays["direction"][:, 2:]
    # And back through OpenCV.
    points = of_world(way)
    distortion = np.array(PINHOLES[name]) if PINHOLES[name] else None
    back = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix(), distortion)[0][:, 0] + 0.5
    assert np.abs(back - places).max() < 1e-7
