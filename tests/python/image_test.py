"""Images: arrays that look into the image, and its files."""
import copy
import gc
import pickle
import weakref

import numpy as np
import pytest

import trilens


def address(array):
    return array.__array_interface__["data"][0]


def same_bits(a, b):
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


def random_image(seed):
    rng = np.random.default_rng(seed)
    height, width = rng.integers(1, 40, 2)
    x0, y0, right, below = rng.integers(0, 9, 4)
    magnitude = 10 ** rng.uniform(-30, 30, (height, width))
    odd = np.resize(np.array([0, -0.0, np.nan, np.inf, -np.inf, 1e-45], np.float32), (height, width))
    channels = {
        "R": rng.normal(size=(height, width)) * magnitude,
        "G": odd,
        "B": rng.normal(size=(height, width)).astype(np.float16),
        "seen.id": rng.integers(0, 2**32, (height, width), dtype=np.uint32),
    }
    size = (int(x0 + width + right), int(y0 + height + below))
    window = (int(x0), int(y0), int(x0 + width), int(y0 + height))
    return channels, trilens.Image.from_arrays(channels, size, window, {"trilens:note": f"seed {seed}"})


def test_channels_are_views_of_the_images_own_memory(renderer):
    image = renderer.render(resolution=2)
    for name in image:
        first, second = image[name], image[name]
        assert np.shares_memory(first, second)
        assert address(first) == address(second)
        assert first.base is image
    red = image["R"]
    red[3, 5] = 42
    assert image["R"][3, 5] == 42
    assert image.rgb()[3, 5, 0] == 42


def test_channels_do_not_share_memory_with_each_other_or_with_other_images(renderer):
    first, second = renderer.render(resolution=2), renderer.render(resolution=2)
    assert not np.shares_memory(first["R"], first["G"])
    assert not np.shares_memory(first["R"], second["R"])
    assert not np.shares_memory(first.rgb(), first["R"])


def test_a_view_keeps_the_image_alive_and_nothing_else_does(renderer):
    image = renderer.render(resolution=2)
    red, expected, alive = image["R"], image["R"].copy(), weakref.ref(image)
    corner = red[:2, :2]
    del image, red
    gc.collect()
    filler = [np.random.default_rng(k).normal(size=expected.shape) for k in range(32)]
    assert alive() is not None
    assert np.array_equal(corner, expected[:2, :2])
    del corner, filler
    gc.collect()
    assert alive() is None


def test_an_image_from_a_call_without_a_name_lives_as_long_as_its_channel(renderer):
    depth = renderer.render(resolution=2, layers=["Z"])["Z"]
    gc.collect()
    assert np.array_equal(depth, renderer.render(resolution=2)["Z"])


def test_ids_are_uint32_and_colours_float32(image, sphere):
    assert image["optic.object"].dtype == np.uint32
    assert image["R"].dtype == np.float32
    assert set(np.unique(image["optic.object"])) == {0, trilens.NONE}
    width, height = image.size
    assert image["R"].shape == (height, width) == (sphere.film.height, sphere.film.width)


def test_an_image_is_a_mapping(image):
    assert list(image) == image.names == image.keys()
    assert len(image) == len(image.names) and "R" in image and "Q" not in image
    assert set(dict(image)) == set(image.names)
    with pytest.raises(KeyError):
        image["Q"]


@pytest.mark.parametrize("seed", range(12))
def test_arrays_survive_an_exr_to_the_last_bit(seed, tmp_path):
    channels, image = random_image(seed)
    image.save(tmp_path / "image.exr")
    again = trilens.read_image(tmp_path / "image.exr")
    assert (again.size, again.window) == (image.size, image.window)
    assert again.metadata["trilens:note"] == f"seed {seed}"
    for name, array in channels.items():
        expected = array if array.dtype == np.uint32 else array.astype(np.float32)
        assert same_bits(image[name], expected)
        if name == "G":  # a NaN may come back as another NaN
            assert np.array_equal(again[name], expected, equal_nan=True)
        else:
            assert same_bits(again[name], expected)


def test_from_arrays_copies_and_takes_any_layout():
    source = np.arange(48, dtype=np.float64).reshape(6, 8)
    image = trilens.Image.from_arrays({"a": source.T, "b": source[::-1, ::-1].T, "c": np.asfortranarray(source.T)})
    assert np.array_equal(image["a"], source.T) and np.array_equal(image["b"], source[::-1, ::-1].T)
    assert np.array_equal(image["c"], source.T)
    source[:] = -1
    assert image["a"].min() == 0


@pytest.mark.parametrize(
    "channels, error",
    [
        ({"a": np.zeros((2, 3)), "b": np.zeros((3, 2))}, trilens.UsageError),
        ({"a": np.zeros(4)}, trilens.UsageError),
        ({"a": np.zeros((2, 2), np.int64)}, trilens.UsageError),
        ({"a": np.zeros((2, 2), complex)}, trilens.UsageError),
        ({"a": np.zeros((0, 2))}, trilens.InputError),
        ({"": np.zeros((2, 2))}, trilens.InputError),
        ({}, trilens.InputError),
    ],
)
def test_arrays_that_make_no_image_are_refused(channels, error):
    with pytest.raises(error):
        trilens.Image.from_arrays(channels)


def test_windows_and_metadata_are_checked():
    array = {"a": np.zeros((2, 3))}
    with pytest.raises(trilens.UsageError):
        trilens.Image.from_arrays(array, window=(0, 0, 2, 3))
    with pytest.raises(trilens.InputError):
        trilens.Image.from_arrays(array, size=(3, 1))
    with pytest.raises(trilens.InputError):
        trilens.Image.from_arrays(array, metadata={"other:note": "x"})


def test_an_image_is_a_mapping(image):
    assert [name for name, _ in image.items()] == image.keys() == list(image)
    assert all(np.shares_memory(array, image[name]) for name, array in image.items())
    assert all(np.shares_memory(array, image[name]) for name, array in zip(image, image.values()))
    assert np.shares_memory(image.get("R"), image["R"])
    assert image.get("no such") is None and image.get("no such", 3) == 3


def test_copies_and_pickles_are_images_of_their_own(image):
    for twin in (copy.copy(image), copy.deepcopy(image), pickle.loads(pickle.dumps(image))):
        assert twin.names == image.names and twin.window == image.window and twin.metadata == image.metadata
        assert twin.statistics == image.statistics
        assert all(same_bits(twin[name], image[name]) for name in image)
        assert not np.shares_memory(twin["R"], image["R"])


@pytest.mark.parametrize("job", ["render", "trace"])
def test_a_picture_that_is_drawn_into_a_file_has_the_bytes_of_one_that_is_saved(renderer, job, tmp_path):
    held, drawn = tmp_path / "held.exr", tmp_path / "drawn.exr"
    draw = getattr(renderer, job)
    image = draw(resolution=2, layers=["Z", "optic"])
    image.save(held)
    rest = draw(resolution=2, layers=["Z", "optic"], file=drawn)
    assert drawn.read_bytes() == held.read_bytes()
    assert list(rest) == [] and rest.statistics["optic_pixels"] == image.statistics["optic_pixels"]
    with pytest.raises(trilens.OutputError):
        draw(resolution=2, file=tmp_path / "nowhere" / "a.exr")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["drawn.exr", "held.exr"]


def test_a_png_holds_the_beauty(image, tmp_path):
    image.save(tmp_path / "image.png")
    assert (tmp_path / "image.png").read_bytes()[:4] == b"\x89PNG"
    with pytest.raises(trilens.UsageError):
        image.save(tmp_path / "image.jpeg")


def test_regions_are_the_shapes_before_the_environment():
    alpha = np.zeros((20, 30), np.float32)
    alpha[2:6, 2:6] = 1
    alpha[6:10, 6:10] = 0.25     # touches by a corner
    alpha[15:18, 20:28] = 1
    alpha[0, 29] = 1             # a speck
    image = trilens.Image.from_arrays({"A": alpha})
    assert (trilens.count_regions(image), trilens.count_regions(image, 1), trilens.count_regions(image, least=25)) == (2, 3, 1)
    with pytest.raises(trilens.InputError):
        trilens.count_regions(trilens.Image.from_arrays({"R": alpha}))
    with pytest.raises(trilens.UsageError, match="least is 0 or more pixels, not -1"):
        trilens.count_regions(image, -1)
