"""Animations, turntables, tone curves and filters from Python."""
import math
import struct
import zlib

import numpy as np
import pytest
import trilens

SCENE = {
    "version": 1,
    "film": {"width": 40, "height": 30},
    "cameras": [{"name": "main", "yfov": 40, "lookAt": {"eye": [0, 0.5, 5], "at": [0, 0, 0]}}],
    "background": {"color": [0.3, 1.5, 6.0]},
    "materials": [{"name": "m", "metallicFactor": 1}, {"name": "a", "baseColorFactor": [0.8, 0.2, 0.1], "unlit": True}],
    "meshes": [
        {"name": "ball", "role": "optic", "material": "m", "resolution": 3, "primitive": {"type": "sphere", "radius": 0.8}},
        {"name": "card", "role": "object", "material": "a", "points": [[-1, -1, 2], [0, -1, 2], [0, 1, 2], [-1, 1, 2]],
         "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]},
    ],
    "animation": {"fps": 10, "tracks": [{"target": "/cameras/0/yfov", "keys": [{"frame": 0, "value": 40}, {"frame": 10, "value": 60}]}]},
}


def png_pixels(file):
    """8-bit RGB rows of a PNG, by its own specification."""
    data = file.read_bytes()
    at, packed, header = 8, b"", None
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", data[at + 8:at + 8 + size])
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += 12 + size
    width, height, depth, colour = header[:4]
    assert (depth, colour) == (8, 2)
    raw, stride, before, rows = zlib.decompress(packed), 3 * width, bytearray(3 * width), []
    for y in range(height):
        how, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left, up, corner = line[i - 3] if i >= 3 else 0, before[i], before[i - 3] if i >= 3 else 0
            guess = left + up - corner
            paeth = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
            line[i] = (line[i] + (0, left, up, (left + up) // 2, paeth)[how]) % 256
        rows.append(bytes(line))
        before = line
    return np.frombuffer(b"".join(rows), np.uint8).reshape(height, width, 3)


def srgb(v):
    v = np.clip(v, 0, 1)
    return np.rint(255 * np.where(v <= 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055))


def test_frames_are_the_scene_with_their_values():
    scene = trilens.parse_scene(SCENE)
    assert scene.animation == {"first": 0, "last": 10, "fps": 10, "tracks": 1}
    renderer = trilens.Renderer(scene.at_frame(0))
    renderer.render()
    for frame in (3, 10, 25):
        at = scene.at_frame(frame)
        assert at.animation is None
        assert at.cameras[0].yfov == pytest.approx(40 + 2 * min(frame, 10))
        assert renderer.change(at) == {"objects": True, "optics": 1}
        still = {k: v for k, v in SCENE.items() if k != "animation"}
        still["cameras"] = [dict(SCENE["cameras"][0], yfov=at.cameras[0].yfov)]
        expected = trilens.Renderer(trilens.parse_scene(still)).render()
        drawn = renderer.render()
        assert all(np.array_equal(drawn[name], expected[name]) for name in expected)


def test_a_turntable_turns_the_eye():
    scene = trilens.parse_scene(SCENE)
    quarter = scene.at_frame(2, turntable=8)
    assert np.allclose(quarter.cameras[0].eye, (5, 0.5, 0), atol=1e-14)
    assert math.isclose(quarter.cameras[0].yfov, 44)


@pytest.mark.parametrize("tone", ["none", "reinhard", "aces", "neutral"])
def test_tone_curves_are_what_numpy_says(tone, tmp_path):
    image = trilens.Renderer(trilens.parse_scene(SCENE)).render()
    file = tmp_path / "out.png"
    image.save(file, exposure=0.5, tone=tone, white=5)
    light = np.maximum(image.rgb().astype(np.float64), 0) * 2 ** 0.5
    if tone == "reinhard":
        luminance = light @ np.array([0.2126, 0.7152, 0.0722])
        light = light * ((1 + luminance / 25) / (1 + luminance))[..., None]
    if tone == "aces":
        light = light * (2.51 * light + 0.03) / (light * (2.43 * light + 0.59) + 0.14)
    if tone == "neutral":
        least = light.min(axis=2)
        light = light - np.where(least < 0.08, least - 6.25 * least ** 2, 0.04)[..., None]
        peak = light.max(axis=2)
        d = 1 - 0.76
        shown = np.where(peak < 0.76, peak, 1 - d * d / (peak + d - 0.76))
        grey = np.where(peak < 0.76, 0, 1 - 1 / (0.15 * (peak - shown) + 1))
        scaled = light * np.where(peak > 0, shown / np.maximum(peak, 1e-30), 1)[..., None]
        light = scaled * (1 - grey)[..., None] + (shown * grey)[..., None]
    assert np.abs(png_pixels(file).astype(int) - srgb(light)).max() <= 1  # floats are rounded to 32 bits on the way


def test_tone_curves_that_are_none_are_refused(tmp_path):
    image = trilens.Renderer(trilens.parse_scene(SCENE)).render()
    with pytest.raises(trilens.UsageError, match="no tone curve"):
        image.save(tmp_path / "out.png", tone="filmic")
    with pytest.raises(trilens.UsageError, match="exposure"):
        image.save(tmp_path / "out.png", exposure=1000)
    assert not (tmp_path / "out.png").exists()


def test_filters_are_named():
    scene = trilens.parse_scene(SCENE)
    assert scene.film.filter == "box"
    assert scene.with_overrides({"/film/filter": "mitchell"}).film.filter == "mitchell"
    with pytest.raises(trilens.InputError, match="/film/filter"):
        scene.with_overrides({"/film/filter": "sinc"})
