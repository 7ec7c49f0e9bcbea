"""Stiffness of one contact between free ends and by formulas for bearings: the table of the page on contact laws."""

from __future__ import annotations

import pytest

from benchmarks.stiffness import compute_iso_stiffness, compute_palmgren_stiffness, solve_stiffness


@pytest.mark.slow
def test_stiffness_depends_on_reference_depth() -> None:
    shallow_stiffness, deep_stiffness = solve_stiffness((18e-3, 6e-3)), solve_stiffness((18e-3, 12e-3))
    assert shallow_stiffness == pytest.approx(536, abs=1)
    assert deep_stiffness == pytest.approx(490, abs=1)


def test_stiffness_of_bearing_formulas_equals_stated_values() -> None:
    assert compute_palmgren_stiffness() == pytest.approx(491, abs=1)
    assert compute_iso_stiffness() == pytest.approx(475, abs=1)
