"""Contacts on given graded cells: against uniform cells, and invalid cells."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import FiniteLengthSpace, Grid, HalfSpace, InvalidInputError, solve, solve_contact
from tests.contact.refinement.rollers import (
    CASES,
    HALF_SPACE,
    HALF_WIDTH,
    RADIUS,
    SHORT,
    SHORT_ELASTIC,
    make_finite_body,
)


@pytest.mark.parametrize("body", [HALF_SPACE, make_finite_body(SHORT)], ids=["half", "finite"])
def test_graded_cells_match_uniform_cells(body: HalfSpace | FiniteLengthSpace) -> None:
    """`solve_contact` on graded cells has the exact load and the pressure of uniform cells."""
    has_free_ends = isinstance(body, FiniteLengthSpace)
    kept_edges = np.concatenate([np.arange(16), np.arange(16, 48, 2), np.arange(48, 65)])
    uniform_grid = Grid(x_range=(0.0, SHORT), y_range=(-2 * HALF_WIDTH, 2 * HALF_WIDTH), cells_x=64, cells_y=32)
    graded_grid = Grid.from_edges(uniform_grid.x_edges[kept_edges], uniform_grid.y_range, 32)
    contacts = []
    for grid in (graded_grid, uniform_grid):
        is_inside = (
            (grid.x > 0) & (grid.x < SHORT)
            if has_free_ends
            else (grid.x > 0.5 * HALF_WIDTH) & (grid.x < SHORT - 0.5 * HALF_WIDTH)
        )
        heights = np.where(is_inside[:, None], grid.y**2 / (2 * RADIUS), np.inf)
        gap = xr.DataArray(heights, coords={"x": grid.x, "y": grid.y, "x_width": ("x", grid.widths)}, dims=("x", "y"))
        contacts.append(solve_contact(body, gap, load=CASES["flush"].normal_load))
    graded_contact, uniform_contact = contacts
    assert bool(graded_contact.converged)
    mid_pressures = [float(contact.pressure.sel(x=SHORT / 2, method="nearest").max()) for contact in contacts]
    assert mid_pressures[0] == pytest.approx(mid_pressures[1], rel=5e-3)
    assert float(graded_contact.approach) == pytest.approx(float(uniform_contact.approach), rel=5e-3)
    total_load = float((graded_contact.pressure * graded_grid.widths[:, None]).sum()) * graded_grid.dy
    assert total_load == pytest.approx(CASES["flush"].normal_load, rel=1e-9)
    repeated_contact = solve_contact(
        body, make_initial_gap(graded_contact, graded_grid), approach=float(graded_contact.approach)
    )
    assert float(repeated_contact["normal_load"]) == pytest.approx(CASES["flush"].normal_load, rel=1e-3)


def make_initial_gap(contact: xr.Dataset, grid: Grid) -> xr.DataArray:
    """Initial gap of a contact, from the cells with a finite gap."""
    heights = np.where(np.isfinite(contact.gap.values), grid.y**2 / (2 * RADIUS), np.inf)
    return contact.gap.copy(data=heights)


def test_steep_cell_growth_raises_error_with_position() -> None:
    widths = np.array([1.0, 1.0, 5.0, 5.0, 5.0, 1.5, 1.5])
    x = np.cumsum(widths) - 0.5 * widths
    y = np.linspace(-1.5, 1.5, 17)
    heights = np.broadcast_to(0.5 * y**2, (7, 17))
    gap = xr.DataArray(heights, coords={"x": x, "y": y, "x_width": ("x", widths)}, dims=("x", "y"))
    with pytest.raises(InvalidInputError, match="cells of 1 and 5 m next to x = 2 m"):
        solve_contact(HALF_SPACE, gap, load=1.0)


def test_cells_missing_roller_end_raise_error() -> None:
    case = CASES["elastic inside"]
    edges = SHORT_ELASTIC * np.array([0.0, 0.1, 0.3, 0.6, 0.8, 1.0])
    with pytest.raises(InvalidInputError, match=r"without a border at x = "):
        solve(case, Grid.from_edges(edges, (-4 * HALF_WIDTH, 4 * HALF_WIDTH), 16), stresses=False)
