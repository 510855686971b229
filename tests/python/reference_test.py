"""The kept convergence tables: what is worse is refused, and what is better and not written down too."""
import importlib.machinery
import importlib.util

import pytest

from conftest import SOURCE

loader = importlib.machinery.SourceFileLoader("reference_results", str(SOURCE / "scripts/reference-results"))
reference = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
loader.exec_module(reference)


@pytest.mark.parametrize("metric, kept, now, word", [
    ("mean_px", "0.1", 0.1004, None), ("mean_px", "0.1", 0.11, "worse"), ("mean_px", "0.1", 0.09, "better"),
    ("order", "2", 1.9, "worse"), ("order", "2", 2.1, "better"), ("order", "2", 2.01, None),
    ("order", "", None, None), ("order", "2", None, "not measured"), ("mean_px", "", 1.0, "not measured")])
def test_the_ratchet_turns_neither_way_by_itself(metric, kept, now, word):
    said = reference.judge("here", metric, kept, now)
    assert said is None if word is None else word in said


def test_rows_that_appear_or_vanish_are_named():
    row = {"scene": "a", "rays": "fitted", "layer": "reflect", "n": 1, **{metric: 1.0 for metric in reference.TOLERANCES}}
    kept = {("a", "fitted", "reflect", "1"): {metric: "1" for metric in reference.TOLERANCES}}
    assert reference.complaints([row], kept) == []
    assert "not written down" in reference.complaints([row], {})[0]
    assert "was not measured" in reference.complaints([], kept)[0]


def test_the_kept_tables_hold():
    """Measured anew from every scene."""
    import trilens
    if not reference.TABLE.exists():
        pytest.skip("no table is kept yet: scripts/reference-results --update makes it")
    rows = [row for file in reference.scenes() for row in reference.rows_of(trilens, file)]
    assert len(rows) >= 5 * len(reference.RESOLUTIONS) * len(reference.RAYS)
    assert reference.complaints(rows, reference.read_table()) == []
