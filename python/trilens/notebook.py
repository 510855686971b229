"""A picture in a notebook, with sliders: how many facets, and a wipe to the truth.

    from trilens.notebook import show
    show(trilens.Renderer(scene))
"""
import numpy as np

from . import Image


def wiped(left, right, share):
    """The image `left` in the first `share` (0..1) of the width, `right` in the rest; of one size."""
    if left.size != right.size:
        raise ValueError(f"a wipe needs two pictures of one size, not {left.size} and {right.size}")
    pixels = left.rgb().copy()
    column = int(round(min(max(share, 0.0), 1.0) * pixels.shape[1]))
    pixels[:, column:] = right.rgb()[:, column:]
    return Image.from_arrays({name: np.ascontiguousarray(pixels[..., i]) for i, name in enumerate("RGB")})


def show(renderer, resolution=16, wipe=1.0, **options):
    """Shows what a Renderer draws. Where ipywidgets is installed, with a slider for the resolution (1..128 facets a side) and one
    for the wipe, which shows the truth on its right; else the still picture of both, an Image, which notebooks show.

    `options` go to Renderer.render. The truth is drawn once, when the wipe first needs it. Returns the widget, or the Image."""
    truth = []

    def picture(n, share):
        drawn = renderer.render(n, **options)
        if share >= 1:
            return drawn
        if not truth:
            truth.append(renderer.trace())
        return wiped(drawn, truth[0], share)

    try:
        import ipywidgets
    except ImportError:
        return picture(resolution, wipe)
    shown = ipywidgets.Image(format="png", value=picture(resolution, wipe)._repr_png_())
    n = ipywidgets.IntSlider(value=resolution, min=1, max=128, description="n")
    share = ipywidgets.FloatSlider(value=wipe, min=0, max=1, step=0.01, description="wipe")

    def redraw(_):
        shown.value = picture(n.value, share.value)._repr_png_()

    n.observe(redraw, names="value")
    share.observe(redraw, names="value")
    return ipywidgets.VBox([n, share, shown])
