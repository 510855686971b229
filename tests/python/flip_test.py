"""FLIP a second time, as the paper writes it: whole two-dimensional filters, in numpy, nothing separated."""
import numpy as np
import pytest

import trilens

PER_DEGREE = 0.7 * (3840 / 0.7) * np.pi / 180
XYZ = np.array([[10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
                [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
                [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382]])
WHITE = XYZ @ np.ones(3)


def window(radius):
    offsets = np.arange(-radius, radius + 1)
    return np.meshgrid(offsets, offsets)


def correlate(plane, kernel):
    radius = kernel.shape[0] // 2
    padded = np.pad(plane, radius, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, kernel.shape)
    return np.einsum("yxij,ij->yx", windows, kernel)


def sensitivity(*gaussians):
    radius = int(np.ceil(3 * np.sqrt(0.04 / (2 * np.pi**2)) * PER_DEGREE))
    x, y = window(radius)
    squared = (x**2 + y**2) / PER_DEGREE**2
    kernel = sum(a * np.sqrt(np.pi / b) * np.exp(-np.pi**2 * squared / b) for a, b in gaussians)
    return kernel / kernel.sum()


def lab(rgb):
    ratio = rgb @ XYZ.T / WHITE
    root = np.where(ratio > (6 / 29)**3, np.cbrt(ratio), ratio / (3 * (6 / 29)**2) + 4 / 29)
    lightness = 116 * root[..., 1] - 16
    a, b = 500 * (root[..., 0] - root[..., 1]), 200 * (root[..., 1] - root[..., 2])
    return np.stack([lightness, 0.01 * lightness * a, 0.01 * lightness * b], axis=-1)


def filtered(rgb):
    x, y, z = np.moveaxis(rgb @ XYZ.T / WHITE, -1, 0)
    bright = correlate(116 * y - 16, sensitivity((1, 0.0047)))
    red = correlate(500 * (x - y), sensitivity((1, 0.0053)))
    blue = correlate(200 * (y - z), sensitivity((34.1, 0.04), (13.5, 0.025)))
    y = (bright + 16) / 116
    xyz = np.stack([y + red / 500, y, y - blue / 200], axis=-1) * WHITE
    return np.clip(xyz @ np.linalg.inv(XYZ).T, 0, 1)


def hyab(one, other):
    apart = one - other
    return abs(apart[..., 0]) + np.hypot(apart[..., 1], apart[..., 2])


def features(rgb, kind):
    sigma = 0.5 * 0.082 * PER_DEGREE
    x, y = window(int(np.ceil(3 * sigma)))
    kernel = (-x if kind == "edge" else x**2 / sigma**2 - 1) * np.exp(-(x**2 + y**2) / (2 * sigma**2))
    kernel = np.where(kernel < 0, kernel / -kernel[kernel < 0].sum(), kernel / kernel[kernel > 0].sum())
    bright = (rgb @ XYZ.T)[..., 1]
    return np.hypot(correlate(bright, kernel), correlate(bright, kernel.T))


def flip(reference, test):
    reference, test = (np.clip(np.asarray(one, dtype=float), 0, 1) for one in (reference, test))
    largest = hyab(lab(np.array([0.0, 1, 0])), lab(np.array([0.0, 0, 1])))**0.7
    distance = hyab(lab(filtered(reference)), lab(filtered(test)))**0.7
    knee = 0.4 * largest
    colour = np.where(distance < knee, 0.95 * distance / knee, 0.95 + 0.05 * (distance - knee) / (largest - knee))
    feature = np.max([abs(features(reference, kind) - features(test, kind)) for kind in ("edge", "point")], axis=0)
    return colour**(1 - np.sqrt(feature / np.sqrt(2)))


def picture(rgb):
    rgb = np.asarray(rgb, dtype=np.float32)
    return trilens.Image.from_arrays({name: np.ascontiguousarray(rgb[..., c]) for c, name in enumerate("RGB")})


def random_pair(seed, height=40, width=52):
    numbers = np.random.default_rng(seed)
    smooth = numbers.random((height // 4, width // 4, 3)).repeat(4, 0).repeat(4, 1)
    return smooth, smooth + numbers.normal(0, 0.1, smooth.shape) * (numbers.random(smooth.shape[:2]) < 0.2)[..., None]


def test_maps_are_the_second_implementations():
    x, y = np.meshgrid(np.arange(52), np.arange(40))
    disk = (((x - 24)**2 + (y - 20)**2 < 120)[..., None] * np.array([0.9, 0.4, 0.1])) + 0.05
    pairs = [random_pair(seed) for seed in range(3)]
    pairs += [(disk, np.roll(disk, 1, axis=1)), (disk, disk * 3), (np.zeros_like(disk), np.ones_like(disk)),
              (disk * [0, 1, 0], disk * [0, 0, 1])]
    for reference, test in pairs:
        reference, test = np.float32(reference), np.float32(test)
        result = trilens.compare(picture(reference), picture(test))
        expected = flip(reference, test)
        np.testing.assert_allclose(result.difference()["flip.Y"], expected, atol=2e-6)
        assert result.metrics.flip == pytest.approx(expected.mean(), abs=1e-6)


def test_a_scene(image, truth):
    rgb = [np.stack([one[name] for name in "RGB"], axis=-1) for one in (truth, image)]
    expected = flip(*rgb)
    assert expected.mean() > 1e-4
    assert trilens.compare(truth, image).metrics.flip == pytest.approx(expected.mean(), abs=1e-6)


def test_command_says_the_same(command, tmp_path, image, truth):
    image.save(tmp_path / "image.exr")
    truth.save(tmp_path / "truth.exr")
    value = trilens.compare(truth, image).metrics.flip
    for limit, code in ((value * 1.01, 0), (value * 0.99, 1)):
        status, answer = command("compare", tmp_path / "truth.exr", tmp_path / "image.exr", "--fail", "9", "--hardfail",
                                 "99", "--max", f"rgb_flip={limit}")
        assert status == code
        assert answer["metrics"]["RGB"]["flip"] == pytest.approx(value, abs=1e-12)
