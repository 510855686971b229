"""Projects curved mirrors and glass, and measures the error against ray-traced truth.

    import trilens
    scene = trilens.load_scene("scene.json", {"/film/width": 320, "/film/height": 240})
    renderer = trilens.Renderer(scene)
    image, truth = renderer.render(resolution=16), renderer.trace()
    print(trilens.compare(truth, image).displacement.mean, "pixels")

Frames are right-handed with y up, lengths are scene units, angles degrees. Pixels count from the film's
top left, x to the right and y down; a pixel's centre is at .5. Ids are indices, NONE where there is none.
"""
from . import _trilens
from ._trilens import *  # noqa: F401,F403

__version__ = _trilens.version()
__all__ = [name for name in dir(_trilens) if not name.startswith("_")]


def _show(self, resolution=16, wipe=1.0, **options):
    """show(self, resolution: int = 16, wipe: float = 1.0, **options) -> object

    In a notebook: this renderer's picture with sliders for the resolution and for a wipe to the truth (trilens.notebook.show)."""
    from .notebook import show
    return show(self, resolution, wipe, **options)


_show.__name__, _show.__qualname__ = "show", "Renderer.show"
Renderer.show = _show  # noqa: F405
