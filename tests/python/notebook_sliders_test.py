"""Pictures in notebooks with sliders: ipywidgets' where it is installed, else a still picture."""
import sys

import numpy as np
import pytest

import trilens
from trilens.notebook import wiped


def test_a_wipe_has_the_picture_on_its_left_and_the_truth_on_its_right(renderer):
    image, truth = renderer.render(2), renderer.trace()
    width = image.size[0]
    both = wiped(image, truth, 0.5)
    half = round(0.5 * width)
    assert np.array_equal(both.rgb()[:, :half], image.rgb()[:, :half])
    assert np.array_equal(both.rgb()[:, half:], truth.rgb()[:, half:])
    assert np.array_equal(wiped(image, truth, 2).rgb(), image.rgb())
    with pytest.raises(ValueError):
        wiped(image, renderer.render(2, window=(0, 0, 4, 4)), 0.5)


def test_without_widgets_a_still_picture_is_shown(renderer, monkeypatch):
    monkeypatch.setitem(sys.modules, "ipywidgets", None)
    shown = renderer.show(2)
    assert isinstance(shown, trilens.Image)
    assert np.array_equal(shown.rgb(), renderer.render(2).rgb())


def test_sliders_draw_again(renderer):
    pytest.importorskip("ipywidgets")
    box = renderer.show(2)
    n, wipe, shown = box.children
    assert shown.value == renderer.render(2)._repr_png_()
    n.value = 4
    assert shown.value == renderer.render(4)._repr_png_()
    wipe.value = 0.0
    assert shown.value == wiped(renderer.render(4), renderer.trace(), 0)._repr_png_()
