"""The race against Embree from Python: the same rays on both sides, every number there."""
import math

import pytest

import trilens
from conftest import SOURCE


@pytest.fixture(scope="module")
def scene():
    return trilens.load_scene(SOURCE / "scenes/sphere.json", {"/film/width": 160, "/film/height": 120})


def test_both_sides_draw_the_rays_of_the_optic(scene):
    race = trilens.bench(scene, resolution=8, repeat=1)
    image = trilens.Renderer(scene).render(resolution=8)
    assert race.pixels == int((image["optic.object"] != trilens.NONE).sum())
    assert 0 < race.facets <= 6 * 2 * 8 * 8
    assert race.triangles == 30
    assert race.mismatches.unexplained == 0
    assert race.mismatches.pixels == race.mismatches.edge + race.mismatches.depth
    for name, value in race.to_dict().items():
        if name.endswith("_ms"):
            assert math.isfinite(value) and value >= 0, name
    assert race.visible_ms > 0 and race.ratio.visible > 0
    for share in (race.shared, race.doubtful, race.unbounded):
        assert 0 <= share < 1
    assert race.depth_complexity > 0.5
    assert race.draw_ms > 0 and race.trace_ms > 0
    assert race.surface_ms > 0 and race.corner_rays_ms > 0 and race.shade_ms > 0 and not race.direct
    assert set(race.to_dict()) == {name for name in vars(trilens.Race) if isinstance(vars(trilens.Race)[name], property)}
    assert race.draw_low <= race.ratio.draw <= race.draw_high


def test_an_unknown_instruction_set_is_said(scene):
    with pytest.raises(trilens.UsageError, match="mmx"):
        trilens.bench(scene, repeat=1, isa="mmx")
