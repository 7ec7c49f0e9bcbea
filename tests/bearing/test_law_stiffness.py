"""Stiffness of one contact beside half-spaces and the formulas of bearings: the table of the page on contact laws."""

from __future__ import annotations

import pytest

from benchmarks.stiffness import iso_stiffness, palmgren_stiffness, solved_stiffness


@pytest.mark.slow
def test_stiffness_depends_on_reference_depth() -> None:
    shallow, deep = solved_stiffness((18e-3, 6e-3)), solved_stiffness((18e-3, 12e-3))
    assert shallow == pytest.approx(536, abs=1)
    assert deep == pytest.approx(490, abs=1)


def test_formulas_of_bearings_have_similar_stiffness() -> None:
    assert palmgren_stiffness() == pytest.approx(491, abs=1)
    assert iso_stiffness() == pytest.approx(475, abs=1)
