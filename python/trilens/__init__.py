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
