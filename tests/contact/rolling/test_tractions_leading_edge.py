"""Cells in steady rolling: offset of the leading edge, dependent cells, and the derivative along y."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.rolling_force import compute_middle_force
from contactstudy import Rolling
from contactstudy.contact.rolling import tractions
from contactstudy.contact.rolling.surfaces import LeadingEdges
from contactstudy.contact.rolling.tractions import (
    DEPENDENT_OFFSET,
    EDGE_OFFSET,
    SLIPPING_OFFSET,
    RollingCells,
    averaging_weights,
    find_slipping_edges,
)
from contactstudy.verification.tribology import material, rolling_ellipse


def make_row_pressure(leading_length: float, cells: int = 20) -> np.ndarray:
    """Pressure of one row: its square is a parabola that ends `leading_length` cells beyond the fifth cell from the
    end."""
    position = np.arange(cells) + 0.5
    edge = cells - 5 + leading_length
    pressure = np.sqrt(np.maximum((edge - position) * (position + 2), 0.0))
    pressure[cells - 5] = max(pressure[cells - 5], 0.1)
    pressure[cells - 4] = 0.0
    pressure[:4] = 0.0
    return pressure[None, :]


def find_dependent_cells(cells: RollingCells) -> list[list[int]]:
    """Row and column of the cells whose tractions depend on the cells behind them."""
    return np.argwhere((cells.ratio > 0) & ~cells.is_unknown).tolist()


@pytest.mark.parametrize("leading_length", [0.75, 0.9, 1.3])
def test_leading_cell_inside_contact_is_unknown(leading_length: float) -> None:
    pressure = 3 * make_row_pressure(leading_length)
    cells = RollingCells.of(pressure, pressure)
    assert not find_dependent_cells(cells)
    assert cells.unknown.shape[1] == (pressure > 0).sum()
    assert cells.offset == pytest.approx(EDGE_OFFSET + leading_length)


@pytest.mark.parametrize("leading_length", [0.3, 0.5])
def test_narrow_leading_cell_is_dependent(leading_length: float) -> None:
    pressure = make_row_pressure(leading_length)
    cells = RollingCells.of(pressure, 0.3 * pressure)
    last_column = int(np.flatnonzero(pressure[0])[-1])
    assert find_dependent_cells(cells) == [[0, last_column]]
    assert cells.unknown[1, cells.source[0, last_column]] == last_column - 1
    assert cells.offset == pytest.approx(DEPENDENT_OFFSET)
    unit_traction = np.ones((2, cells.unknown.shape[1]))
    grid_traction = cells.ratio * cells.on_grid(unit_traction)
    assert grid_traction[0, 0, last_column] == pytest.approx(pressure[0, last_column] / pressure[0, last_column - 1])
    assert (cells.on_grid(cells.unknown[1])[0, 4 : last_column + 1] == [*range(4, last_column), last_column - 1]).all()
    weights = np.random.default_rng(0).random((3, *pressure.shape))
    expected = (weights * grid_traction[0]).sum(axis=(1, 2))
    assert cells.gather(weights).sum(axis=1) == pytest.approx(expected)


@pytest.mark.parametrize("empty_cells", [0, 2])
@pytest.mark.parametrize(("count", "offset"), [(5, EDGE_OFFSET + 1), (6, EDGE_OFFSET + 0.9)])
def test_few_cells_leave_the_offset_constant(empty_cells: int, count: int, offset: float) -> None:
    pressure = make_row_pressure(0.9)
    cells = np.zeros((1, empty_cells + count + 2))
    last_column = int(np.flatnonzero(pressure[0])[-1]) + 1
    cells[0, empty_cells : empty_cells + count] = pressure[0, last_column - count : last_column]
    assert RollingCells.of(cells, cells).offset == pytest.approx(offset)


def test_rising_pressure_leaves_the_offset_constant() -> None:
    for pressure in (np.ones((1, 8)), np.array([[1.0, 1.0, 1.0, 2.0, 2.5, 3.1, 1.0, 0.0]])):
        assert RollingCells.of(pressure, pressure).offset == pytest.approx(EDGE_OFFSET + 1)


def test_two_contacts_in_row_have_two_edges() -> None:
    strip_pressure = make_row_pressure(0.3)
    pressure = np.hstack([strip_pressure, strip_pressure])
    assert len(find_dependent_cells(RollingCells.of(pressure, pressure))) == 2


def test_cells_without_friction_have_no_traction() -> None:
    pressure = make_row_pressure(0.9)
    assert RollingCells.of(pressure, 0 * pressure).unknown.size == 0


def test_derivative_is_exact_for_parabolas() -> None:
    pressure, dy = make_row_pressure(0.9), 0.25
    cells = RollingCells.of(pressure, pressure)
    y = dy * np.arange(pressure.shape[1])
    displacement = (2 + 3 * y - 0.7 * y**2)[None, :]
    slip_positions = y[cells.unknown[1]] + cells.offset * dy
    assert cells.derivative(displacement, dy) == pytest.approx(3 - 1.4 * slip_positions)


def test_half_cell_offset_matches_published_creepage(monkeypatch: pytest.MonkeyPatch) -> None:
    """Force, moment and stick cells equal those of the program CONTACT on the same 1276 cells, with plain differences.

    The spin of CONTACT acts a third of a cell further ahead, which equals a lateral creepage. One such shift matches
    all three numbers; both methods converge to 0.625 of the force of full sliding (docs/explanation/rolling.md).
    """
    between_neighbours = 0.5 - EDGE_OFFSET
    monkeypatch.setattr(tractions, "_inside_length", lambda pressure: between_neighbours)
    monkeypatch.setattr(tractions, "SLIPPING_OFFSET", 0.5)
    load, friction, spin, spin_offset = 82e3, 0.3, -0.625, 0.334 * 0.4e-3
    motion = Rolling(lateral_creepage=-6.25e-4 + spin * spin_offset, spin=spin)
    computed = rolling_ellipse(4e-3, 8e-3, load, material(82e9, 0.28), friction, motion, (42, 46))
    assert int((computed["pressure"] > 0).sum()) == 1276
    assert float(computed["force_x"]) / (friction * load) == pytest.approx(0.6074, abs=2e-4)
    assert float(computed["moment_z"]) == pytest.approx(-48.21, abs=0.02)
    assert int(computed["stick"].sum()) == pytest.approx(356, abs=2)


def test_close_columns_share_slip_offset() -> None:
    """Two columns are far narrower than the length of the cells; the width of the third equals this length."""
    pressure = np.vstack([make_row_pressure(leading_length) for leading_length in (0.75, 1.3, 0.9)])
    x, widths, dy = np.array([0.0, 0.02, 2.0]), np.array([0.01, 0.03, 1.0]), 1.0
    weights = averaging_weights(x, widths, dy)
    assert weights is not None
    cells = RollingCells.of(pressure, pressure, weights)
    first_offset, second_offset, third_offset = (cells.offset[cells.unknown[0] == row][0] for row in range(3))
    assert abs(first_offset - second_offset) < 0.01  # their separate offsets differ by 0.55
    assert first_offset == pytest.approx(EDGE_OFFSET + (0.01 * 0.75 + 0.98 * 0.03 * 1.3) / (0.01 + 0.98 * 0.03))
    assert third_offset == pytest.approx(EDGE_OFFSET + 0.9)
    assert averaging_weights(np.arange(4.0), np.ones(4), 0.5) is None


def test_single_cell_ahead_is_separate_contact() -> None:
    pressure = make_row_pressure(0.9)
    last_column = int(np.flatnonzero(pressure[0])[-1])
    separate_pressure = pressure.copy()
    separate_pressure[0, last_column + 2] = 0.1
    computed = RollingCells.of(separate_pressure, separate_pressure)
    assert not find_dependent_cells(computed)
    assert computed.offset[:-1] == pytest.approx(EDGE_OFFSET + 0.9)
    assert computed.offset[-1] == pytest.approx(EDGE_OFFSET + 1.0)


def test_slipping_edges_have_one_position_of_slip() -> None:
    pressure = np.vstack([make_row_pressure(0.9), make_row_pressure(0.3), make_row_pressure(0.9)])
    computed = RollingCells.of(pressure, pressure, None, LeadingEdges(np.array([True, True, False]), pressure))
    assert not find_dependent_cells(computed)
    assert (computed.offset[computed.unknown[0] < 2] == SLIPPING_OFFSET).all()
    assert computed.offset[computed.unknown[0] == 2] == pytest.approx(EDGE_OFFSET + 0.9)


def test_displacement_is_constant_beyond_last_cell() -> None:
    pressure = np.ones((1, 6))
    displacement = np.random.default_rng(0).standard_normal((1, 6))
    computed = RollingCells.of(pressure, pressure)
    extended_displacement = np.pad(displacement, ((0, 0), (0, 2)), mode="edge")
    assert computed.derivative(displacement, 0.5) == pytest.approx(computed.derivative(extended_displacement, 0.5))


def test_leading_cell_of_each_column_slips_or_sticks() -> None:
    is_loaded = np.ones((4, 5), dtype=bool)
    is_loaded[:, -1] = False
    sticks = np.zeros((4, 5), dtype=bool)
    sticks[0, :4] = True
    sticks[1, :3] = True
    sticks[2, 1] = True
    assert find_slipping_edges(sticks, is_loaded).tolist() == [False, True, True, True]


@pytest.mark.parametrize("creepage", [0.4, 0.7])
def test_force_of_unlike_bodies_depends_little_on_position_of_cells(creepage: float) -> None:
    """At the leading edge of a rigid roller the pressure itself makes the surfaces slip."""
    forces = [compute_middle_force(creepage, 32, position) for position in (-0.5, -0.25, 0.0, 0.25)]
    assert np.ptp(forces) < 0.012
    assert np.mean(forces) == pytest.approx(compute_middle_force(creepage, 128, 0.0), abs=0.008)
