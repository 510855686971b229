"""Rows of bench/inverse.py beside other programs' own code, where Debian's packages are installed: pfstools (unwrapping a
mirror ball) and python3-opencv (a fisheye's projection, and the central model of its module omnidir for a mirror ball)."""
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np

import trilens
from timed_command import best_of

CHROME = {"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0}
BALL = {"name": "ball", "role": "optic", "material": "chrome",
        "primitive": {"type": "sphere", "center": [0, 0, 0], "radius": 1}}


def scene_of(camera, film, meshes):
    return trilens.Renderer(trilens.parse_scene(
        {"version": 1, "film": dict(zip(("width", "height"), film)), "cameras": [camera], "materials": [CHROME],
         "meshes": meshes, "render": {"maxDepth": 0}}, warn=lambda message: None))


def skipped(what, package):
    return {"what": what, "note": f"skipped: apt install {package}"}


# pfspanoramic: a mirror ball's photograph unwrapped.

PANORAMA = (720, 360)


def write_pfm(file, values):
    with open(file, "wb") as out:
        out.write(b"PF\n%d %d\n-1.0\n" % (values.shape[1], values.shape[0]))
        out.write(values[::-1].astype("<f4").tobytes())


def read_pfm(file):
    with open(file, "rb") as data:
        data.readline()
        width, height = map(int, data.readline().split())
        order = "<f4" if float(data.readline()) < 0 else ">f4"
        return np.frombuffer(data.read(), order).reshape(height, width, 3)[::-1].astype(float)


def pfspanoramic_places(size=2048):
    """Where pfspanoramic looks on a mirror ball's picture for each pixel of a panorama: (height, width, 2), -1..1 over the
    picture, y upward. Asked of the program itself, by unwrapping a picture of its own coordinates."""
    y, x = np.mgrid[0:size, 0:size] + 0.5
    with tempfile.TemporaryDirectory() as folder:
        ball, panorama = (pathlib.Path(folder) / name for name in ("ball.pfm", "panorama.pfm"))
        write_pfm(ball, np.stack([2 * x / size + 1, 3 - 2 * y / size, np.ones_like(x)], axis=2))
        subprocess.run(f"pfsinpfm {ball} | pfspanoramic mirrorball+polar -i -w {PANORAMA[0]} | pfsoutpfm {panorama}",
                       shell=True, check=True)
        seen = read_pfm(panorama)
    return seen[..., :2] / seen[..., 2:] - 2


def panorama_directions():
    """Of a panorama whose middle looks from the ball to the camera, as pfspanoramic's does."""
    y, x = np.mgrid[0:PANORAMA[1], 0:PANORAMA[0]] + 0.5
    longitude, latitude = (x / PANORAMA[0] - 0.5) * 2 * np.pi, (0.5 - y / PANORAMA[1]) * np.pi
    return np.stack([np.cos(latitude) * np.sin(longitude), np.sin(latitude), np.cos(latitude) * np.cos(longitude)], axis=2)


def degrees_between(a, b):
    return np.degrees(2 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=-1) / 2, 0, 1)))


def row_unwrap_beside_pfspanoramic(count):
    """What the panoramas' pixels show of a ball whose picture is taken from ten radii: by exact rays."""
    what = "unwrap of a ball at 10 radii"
    if not shutil.which("pfspanoramic"):
        return skipped(what, "pfstools")
    side, distance = 1024, 10.0
    camera = {"name": "main", "type": "perspective", "yfov": 2 * np.degrees(np.arcsin(1 / distance)),
              "lookAt": {"eye": [0, 0, distance], "at": [0, 0, 0]}}
    renderer = scene_of(camera, (side, side), [BALL])
    wanted = panorama_directions()
    # Beside the ball's rim, whose pixels are interpolated with what is not the ball.
    places = pfspanoramic_places()
    inside = np.hypot(places[..., 0], places[..., 1]) < 0.99

    def off(pixels, of):
        rays, _ = renderer.shoot(pixels[of])
        return degrees_between(rays["direction"], wanted[of])[rays["event_count"] == 1]

    theirs = off(np.stack([(places[..., 0] + 1) / 2 * side, (1 - places[..., 1]) / 2 * side], axis=2), inside)
    # The panorama's middle is -Z in trilens, and its right half +X: seen from the other side.
    seconds, own = best_of(lambda: renderer.map(f"equirect:{PANORAMA[0]}x{PANORAMA[1]}", proxy="infinity"), 1)
    turn = np.roll(np.arange(PANORAMA[0])[::-1], PANORAMA[0] // 2)
    pixels = np.stack([own["x"], own["y"]], axis=2)[:, turn]
    ours = off(pixels, own["valid"][:, turn])
    return {"what": what, "us": 1e6 * seconds / own["valid"].sum(), "error": float(np.quantile(ours, 0.99)),
            "unit": "degrees, p99",
            "note": f"pfspanoramic {np.mean(theirs):.2g} in the mean, {np.quantile(theirs, 0.99):.2g} p99 (pfstools' own program)"}


# OpenCV: a fisheye's projection, and a central camera in place of a mirror ball.

def row_fisheye_beside_opencv(count):
    what = "projection, OpenCV fisheye lens, no optic"
    try:
        import cv2
    except ImportError:
        return skipped(what, "python3-opencv")
    matrix = np.array([[300.0, 0, 512], [0, 305.0, 384], [0, 0, 1]])
    distortion = np.array([0.05, -0.01, 0.004, -0.0007])
    camera = {"name": "main", "type": "opencv", "model": "fisheye", "fx": 300, "fy": 305, "cx": 512, "cy": 384,
              "distortion": distortion.tolist(), "lookAt": {"eye": [0, 0, 0], "at": [0, 0, 1], "up": [0, -1, 0]}}
    renderer = scene_of(camera, (1024, 768), [])
    draw = np.random.default_rng(5)
    angle, around = draw.uniform(0.05, 1.1, count), draw.uniform(0, 2 * np.pi, count)
    points = draw.uniform(1, 5, (count, 1)) * np.stack(
        [np.sin(angle) * np.cos(around), np.sin(angle) * np.sin(around), np.cos(angle)], axis=1)
    seconds, images = best_of(lambda: renderer.project(points, visibility=False))
    theirs, seen = best_of(lambda: cv2.fisheye.projectPoints(
        points[:, None], np.zeros(3), np.zeros(3), matrix, distortion)[0][:, 0])
    images = images[images["path"] == "direct"]
    error = np.abs(np.stack([images["x"], images["y"]], axis=1) - seen[images["point"]]).max()
    return {"what": what, "us": 1e6 * seconds / count, "error": float(error), "unit": "px from cv2.fisheye",
            "note": f"{len(images)} images; cv2.fisheye.projectPoints {1e6 * theirs / count:.2f} us"}


def row_ball_beside_omnidir(count):
    """Pairs of a mirror ball with points two to six radii away: what the best central model leaves of them."""
    what = "a ball's pairs, points 2 to 6 radii away"
    try:
        import cv2
        from scipy.optimize import least_squares
        project_omni = cv2.omnidir.projectPoints
    except (ImportError, AttributeError):
        return skipped(what, "python3-opencv python3-scipy")
    camera = {"name": "main", "type": "perspective", "yfov": 30, "lookAt": {"eye": [0, 0, 4.5], "at": [0, 0, 0]}}
    renderer = scene_of(camera, (1024, 768), [BALL])
    draw = np.random.default_rng(6)
    way = draw.normal(size=(400, 3)) + [0, 0, 1.5]
    points = way / np.linalg.norm(way, axis=1)[:, None] * draw.uniform(2, 6, (400, 1))
    images = renderer.project(points, path="R")
    images = images[images["inside"]]
    pixels, points = np.stack([images["x"], images["y"]], axis=1), points[images["point"]]

    def residual(numbers):
        focal, centre, xi, lens, turn, move = np.split(numbers, [2, 4, 5, 9, 12])
        matrix = np.array([[focal[0], 0, centre[0]], [0, focal[1], centre[1]], [0, 0, 1]])
        return (project_omni(points[:, None], turn, move, matrix, float(xi[0]), lens)[0][:, 0] - pixels).ravel()

    # The ball looks towards the camera, and mirrors: from several starts, the best.
    found = [least_squares(residual, [400 * (1 + xi), -400 * (1 + xi), 512, 384, xi] + [0] * 10,
                           x_scale=[100, 100, 10, 10, 1] + [0.1] * 10, max_nfev=400) for xi in (0.5, 1, 2)]
    central = min(np.sqrt(2 * np.mean(one.fun ** 2)) for one in found)
    free = ["/meshes/0/primitive/center", "/meshes/0/primitive/radius"]
    scene = renderer.scene.with_overrides({"/meshes/0/primitive/radius": 0.95})
    seconds, fit = best_of(lambda: trilens.fit(scene, pixels, points, free))
    return {"what": what, "us": 1e6 * seconds, "error": fit.rms, "unit": "px rms left by fit",
            "note": f"{len(points)} pairs; cv2.omnidir's model, 15 numbers free: {central:.2g} px rms"}
