"""Stick and slip between free ends: the solver against finite elements with a convex program."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.finite_elements.rolling import compute_flexibility, solve_rolling
from benchmarks.finite_elements.superpose import PANELS, Resolution
from contactstudy import FiniteLengthSpace, Material, Rolling
from contactstudy.bodies import Counterbody
from contactstudy.contact.rolling import tractions
from contactstudy.contact.solve import solve_contact
from contactstudy.verification.problems import on_cells

LENGTH, COLUMNS, STRIPS, WINDOW, POISSON, FRICTION, LOAD_FRACTION = 8.0, 8, 26, 1.3, 0.3, 0.3, 0.64
LOAD = 0.25 * np.pi * 0.5 * LENGTH  # half-width 1 of a pair with the modulus 1/2


@pytest.mark.slow
def test_rolling_between_free_ends_equals_finite_elements(monkeypatch: pytest.MonkeyPatch) -> None:
    """The ends of a short body cause a transverse traction under longitudinal creepage.

    The slip of both codes is the difference between neighbouring cells, with equal errors of first order.
    """
    mesh = Resolution(order=4, growth=2.0, smallest=0.05, panels=(*PANELS, 200))
    expected = solve_rolling(
        compute_flexibility(LENGTH, COLUMNS, POISSON, mesh), STRIPS, WINDOW, LOAD, FRICTION, LOAD_FRACTION, 2 * STRIPS
    )
    assert expected.change < 1e-3
    monkeypatch.setattr(tractions, "_inside_length", lambda pressure: 0.5 - tractions.EDGE_OFFSET)
    monkeypatch.setattr(tractions, "SLIPPING_OFFSET", 0.5)
    gap = on_cells(lambda x, y: 0.5 * y**2 + 0 * x, (0, LENGTH), (-WINDOW, WINDOW), (COLUMNS, STRIPS))
    body = FiniteLengthSpace(length=LENGTH, material=Material(1 - POISSON**2, POISSON))
    motion = Rolling(force_y=LOAD_FRACTION * FRICTION * LOAD)
    result = solve_contact(body, gap, load=LOAD, friction=FRICTION, counterbody=Counterbody(body), motion=motion)
    # At this creepage a change of 1 % changes the force by 0.75 %.
    assert float(result["longitudinal_creepage"]) == pytest.approx(expected.creepage, rel=1e-3)
    first_half, max_bound = result.isel(x=slice(0, COLUMNS // 2)), FRICTION * float(result["pressure"].max())
    # The reference contains means over columns of one half-width, the package values at their midpoints.
    assert np.abs(first_half["pressure"] - expected.pressure).max() < 1e-2 * float(result["pressure"].max())
    assert np.abs(expected.along_x).max() > 0.1 * max_bound
    for traction, expected_traction in (
        (first_half["traction_x"], expected.along_x),
        (first_half["traction_y"], expected.along_y),
    ):
        # At the border of slip, a cell may stick in one solution and slip in the other.
        assert np.abs(traction - expected_traction).max() < 0.05 * max_bound
        assert np.abs(traction - expected_traction).mean() < 2e-3 * max_bound
