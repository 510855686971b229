"""Photographs unwrapped, maps as other programs apply them, and anamorphoses, from Python."""
import pathlib
import shutil
import subprocess

import numpy as np
import pytest

import trilens

SCENES = pathlib.Path(__file__).resolve().parents[2] / "scenes"


@pytest.fixture(scope="module")
def room():
    scene = trilens.load_scene(str(SCENES / "sphere.json"), {"/film/width": 160, "/film/height": 120, "/render/maxDepth": 0})
    return trilens.Renderer(scene)


@pytest.fixture(scope="module")
def photo(room):
    return room.trace()


def test_an_object_unwraps_to_what_it_looks_like(room, photo):
    """The floor out of the ball's picture against the floor seen by a camera above it."""
    made = room.unwrap(photo, "floor:80x107", min_resolution=4)
    assert made.size == (80, 107)
    seen = made["A"] > 0
    assert 0.02 < made.statistics["coverage"] < 1 and seen.any()
    assert (made["res.max"] >= made["res.min"]).all() and (made["res.min"][seen] >= 4).all()
    # The same pixels are asked for one by one: exact places.
    y, x = np.argwhere(seen)[:: max(1, seen.sum() // 40)].T
    points = np.stack([-3 + 6 * (x + 0.5) / 80, np.full(len(x), -1.2), -3 + 8 * (y + 0.5) / 107], axis=1)
    images = room.project(points)
    for i in range(len(x)):
        own = images[(images["point"] == i) & (images["path"] == "reflect")]
        off = np.hypot(own["x"] - made["src.X"][y[i], x[i]], own["y"] - made["src.Y"][y[i], x[i]])
        assert off.min() < 0.011


def test_several_photographs_and_choices(room, photo):
    blend = room.unwrap([photo], "equirect:64x32", cameras=["main"], images="blend", exposures=[2.0])
    best = room.unwrap(photo, "equirect:64x32", images=1)
    both = (blend["A"] > 0) & (best["A"] > 0)
    assert np.allclose(blend["G"][both] * 2, best["G"][both], rtol=1e-3, atol=1e-4)
    dark = trilens.Image.from_arrays({c: np.zeros((120, 160), np.float32) for c in "RGB"})
    with pytest.raises(trilens.InputError, match="shows nothing"):
        room.unwrap(photo, "equirect:64x32", masks=[dark])


def test_maps_are_read_by_others(room, photo, tmp_path):
    arrays = room.map("equirect:128x64", file=tmp_path / "map.exr")
    room.map("equirect:128x64", file=tmp_path / "map.npz")
    read = np.load(tmp_path / "map.npz")
    assert np.array_equal(read["valid"].astype(bool), arrays["valid"])
    assert np.allclose(read["map_x"][arrays["valid"]], arrays["x"][arrays["valid"]] - 0.5)
    stmap = trilens.read_image(tmp_path / "map.exr")
    assert np.allclose(stmap["R"][arrays["valid"]] * 160, arrays["x"][arrays["valid"]], atol=1e-4)
    assert arrays["jacobian"].shape == (64, 128, 2, 2)
    unwrapped = room.unwrap(photo, "equirect:128x64")
    assert np.allclose(unwrapped["src.X"][arrays["valid"]], arrays["x"][arrays["valid"]], atol=0.02)
    room.map("equirect:128x64", file=tmp_path / "map.pgm")
    words = np.frombuffer((tmp_path / "map_y.pgm").read_bytes()[-2 * 128 * 64:], ">u2").reshape(64, 128)
    assert (words[~arrays["valid"]] == 65535).all()
    assert (words[arrays["valid"]] == np.floor(arrays["y"][arrays["valid"]])).all()


@pytest.mark.skipif(not shutil.which("oiiotool"), reason="needs oiiotool")
def test_oiiotool_warps_by_the_map(room, photo, tmp_path):
    photo.save(tmp_path / "photo.exr")
    room.map("equirect:128x64", file=tmp_path / "map.exr")
    subprocess.run(["oiiotool", tmp_path / "photo.exr", "--ch", "R,G,B", tmp_path / "map.exr", "--ch", "R,G", "--st_warp",
                    "-o", tmp_path / "out.exr"], check=True)
    warped = trilens.read_image(tmp_path / "out.exr")["G"][:64, :128]  # it keeps the photograph's size
    own = room.unwrap(photo, "equirect:128x64", divide_weight=False)
    smooth = (own["A"] > 0) & (own["res.min"] * 360 / 128 > 0.8)  # where a pixel covers about one of the photograph
    assert smooth.sum() > 500
    assert np.median(np.abs(warped - own["G"])[smooth]) < 0.03


def test_a_view_is_the_inverse_of_an_unwrap(room):
    views, unwraps = room.map("equirect:512x256", way="view", proxy="infinity"), room.map("equirect:512x256", proxy="infinity")
    y, x = np.nonzero(views["valid"])
    u, v = views["x"][y, x], views["y"][y, x]
    inner = (u > 1) & (u < 511) & (v > 1) & (v < 255)
    at = (np.floor(v[inner]).astype(int), np.floor(u[inner]).astype(int))
    whole = unwraps["valid"][at]
    step = np.stack([u[inner] - at[1] - 0.5, v[inner] - at[0] - 0.5], axis=1)
    back_x = unwraps["x"][at] + (unwraps["jacobian"][at][:, 0] * step).sum(axis=1)
    assert np.median(np.abs(back_x - (x[inner] + 0.5))[whole]) < 0.02


def test_a_warp_mesh_and_an_anamorphosis(tmp_path):
    dome = trilens.Renderer(trilens.load_scene(str(SCENES / "inverse/dome.json")))
    mesh = dome.warp_mesh("fisheye:512", 33, 19, proxy="sphere:3", center=(0, 0, 0), file=tmp_path / "warp.data")
    assert mesh["nodes"].shape == (19, 33, 5) and mesh["error_mean"] > 0
    lines = (tmp_path / "warp.data").read_text().split("\n")
    assert lines[:2] == ["2", "33 19"] and len(lines) == 2 + 33 * 19 + 1
    rings = dome.warp_mesh("fisheye:512", 65, 17, proxy="sphere:3", center=(0, 0, 0), grid="target")
    assert np.array_equal(rings["nodes"][:, 0, [0, 1, 4]], rings["nodes"][:, -1, [0, 1, 4]])
    for grid, way in (("film", {"path": "reflect"}), ("target", {"word": "R"})):
        with pytest.raises(trilens.UsageError, match="regular on"):
            dome.warp_mesh("fisheye:512", 33, 19, proxy="sphere:3", center=(0, 0, 0), grid=grid, **way)
    assert dome.warp_mesh("fisheye:512", 2, 2, proxy="sphere:3", center=(0, 0, 0), grid="target")["error_max"] is None
    for way, other in (("view", {"path": "reflect"}), ("unwrap", {"word": "R"})):
        with pytest.raises(trilens.UsageError, match="goes with the way"):
            dome.map("fisheye:64", way, proxy="sphere:3", center=(0, 0, 0), **other)
    radius = np.hypot(*(rings["nodes"][..., 2:4] - 256).transpose(2, 0, 1))
    assert np.allclose(radius, 256 * np.linspace(0, 1, 17)[:, None]) and rings["error_p99"] < 20

    scene = trilens.load_scene(str(SCENES / "inverse/anamorph-ball.json"), {"/film/width": 256, "/film/height": 192})
    ramp = np.linspace(0.2, 0.8, 64, dtype=np.float32)
    picture = trilens.Image.from_arrays({"R": np.tile(ramp, (64, 1)), "G": np.tile(ramp[:, None], (1, 64)),
                                         "B": np.full((64, 64), 0.5, np.float32)})
    made = trilens.anamorph(trilens.Renderer(scene), picture, "page", paper="A4", dpi=60, verify=True,
                            file=tmp_path / "page.pdf")
    assert made["paper"] == (297, 210) and made["page"].shape == (496, 702, 3)
    assert made["coverage"] > 0.99 and made["psnr_db"] > 30
    assert (tmp_path / "page.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize("call, error", [
    (lambda r, p: r.unwrap(p, "equirect:0x5"), trilens.UsageError),
    (lambda r, p: r.unwrap(p, "nobody"), trilens.UsageError),
    (lambda r, p: r.unwrap(p, "equirect:64x32", images="all"), trilens.UsageError),
    (lambda r, p: r.unwrap(p, "equirect:64x32", optic="floor"), trilens.UsageError),
    (lambda r, p: r.unwrap([p, p], "equirect:64x32", cameras=["main"]), trilens.UsageError),
    (lambda r, p: r.unwrap("nowhere.exr", "equirect:64x32"), trilens.InputError),
    (lambda r, p: r.map("equirect:64x32", way="sideways"), trilens.UsageError),
    (lambda r, p: r.map("equirect:64x32", file="map.jpg"), trilens.UsageError),
    (lambda r, p: trilens.anamorph(r, p, "floor", unit="furlong"), trilens.UsageError),
    (lambda r, p: trilens.anamorph(r, p, "floor", paper="A99"), trilens.UsageError),
    (lambda r, p: trilens.anamorph(r, p, "pyramid", dpi=10), trilens.Error)])
def test_misuse_is_told(room, photo, call, error):
    with pytest.raises(error):
        call(room, photo)
