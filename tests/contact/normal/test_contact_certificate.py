"""The certificate contains each violation of the conditions of contact over its scale."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
import pytest

from contactstudy import Grid, HalfSpace, Material
from contactstudy.cache import ArrayKey
from contactstudy.contact.normal.contact import CONVERGED_TOLERANCES, OPEN_TOLERANCES, Certificate, Shape, certify
from contactstudy.contact.normal.prescribed_loads import PrescribedLoad

TOLERANCE = 1e-6
DISPLACEMENT = 3e-5 * np.array([[1.0, 2.0, 3.0]])  # the variation is 6e-5
VARIATION = 6e-5
PRESSURE = 1e9 * np.array([[0.0, 0.5, 2.0]])
GRID = Grid(x_range=(0.0, 2e-5), y_range=(0.0, 3e-4), cells_x=1, cells_y=3)  # carries 5 N
BODY = HalfSpace(material=Material(210e9, 0.3))


def make_certificate(gap_ratio: list[float], load: float | None = 5.0) -> Certificate:
    """Certificate of a contact with a gap `opening` over the variation of the displacement."""
    gap = VARIATION * np.array([gap_ratio])
    shape = Shape(BODY, GRID, ArrayKey(gap), PrescribedLoad(load))
    return certify(shape, PRESSURE, gap, DISPLACEMENT, TOLERANCE)


def test_exact_contact_has_no_violations() -> None:
    assert list(asdict(make_certificate([0.3, 0.0, 0.0])).values()) == pytest.approx([0.0] * 4, abs=1e-15)
    assert make_certificate([0.3, 0.0, 0.0]).holds(TOLERANCE)
    assert make_certificate([np.inf, 0.0, 0.0]).holds(TOLERANCE)


@pytest.mark.parametrize("gap_ratio", [[0.3, 2e-3, 0.0], [0.3, -2e-3, 0.0], [-2e-3, 0.0, 1e-3]])
def test_gaps_and_overlaps_are_violations(gap_ratio: list[float]) -> None:
    assert make_certificate(gap_ratio).penetration_error == pytest.approx(2e-3)
    assert not make_certificate(gap_ratio).holds(TOLERANCE)


def test_open_pressure_begins_beyond_tolerances() -> None:
    for factor, error in ((0.5, 0.0), (1.5, 0.25)):
        gap_ratio = [0.3, factor * OPEN_TOLERANCES * TOLERANCE, 0.0]
        assert make_certificate(gap_ratio).open_pressure_error == pytest.approx(error)
    assert not make_certificate([0.3, 1.5 * OPEN_TOLERANCES * TOLERANCE, 0.0]).holds(TOLERANCE)


def test_load_error_is_relative_to_load() -> None:
    assert make_certificate([0.3, 0.0, 0.0], load=4.0).load_error == pytest.approx(0.25)
    assert make_certificate([0.3, 0.0, 0.0], load=6.25).load_error == pytest.approx(-0.2)
    assert make_certificate([0.3, 0.0, 0.0], load=None).load_error == 0.0


def test_position_error_is_relative_to_contact_length() -> None:
    """Two columns of different widths carry half of the load each; the error does not depend on their position."""
    for position in (0.0, 5.0):
        grid = Grid.between(position + np.array([0.0, 1.0, 2.0, 3.0, 5.0, 6.0]), (0.0, 1.0), 2)
        pressure = np.zeros(grid.shape)
        pressure[1], pressure[3] = 2.0, 1.0  # half of the load on each; centres 1.5 and 4, widths 1 and 2
        shape = Shape(BODY, grid, ArrayKey(pressure), PrescribedLoad(1.0))
        for load_position in (2.0, 3.5):
            prescribed = PrescribedLoad(1.0, position + load_position)
            computed = certify(shape._replace(prescribed=prescribed), pressure, 0 * pressure, pressure, TOLERANCE)
            assert computed.load_position_error == pytest.approx(abs(2.75 - load_position) / 4.0)
    assert certify(shape, pressure, 0 * pressure, pressure, TOLERANCE).load_position_error == 0.0


@pytest.mark.parametrize("name", ["load_error", "penetration_error", "open_pressure_error", "load_position_error"])
@pytest.mark.parametrize("sign", [1, -1])
def test_certificate_fails_beyond_bound(name: str, sign: int) -> None:
    exact_values = asdict(make_certificate([0.3, 0.0, 0.0]))
    bound = CONVERGED_TOLERANCES * TOLERANCE
    assert Certificate(**(exact_values | {name: 0.9 * sign * bound})).holds(TOLERANCE)
    assert not Certificate(**(exact_values | {name: 1.1 * sign * bound})).holds(TOLERANCE)
