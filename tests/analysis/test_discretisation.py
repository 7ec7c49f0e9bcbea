import re

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    FiniteLengthSpace,
    Grid,
    InvalidInputError,
    Material,
    Roller,
    choose_grid,
    profiles,
    solve,
)
from contactstudy.analysis.discretisation import discretisation_error

STEEL = Material(210e9, 0.3)
HALF_WIDTH = 65e-6
BODY = FiniteLengthSpace(length=8 * HALF_WIDTH, material=STEEL)
PRESSURE = 1.5e9
LUNDBERG = profiles.Lundberg.for_pressure(PRESSURE, radius=5e-3, modulus=STEEL.plane_strain_modulus)


def solve_with_errors(case: Case, grid: Grid) -> xr.Dataset:
    """Contact on a grid, with the errors from the contact on the coarser grid."""
    fine_result, coarse_result = (solve(case, cells, stresses=False) for cells in (grid, grid.coarsened()))
    return fine_result.assign(discretisation_error(fine_result, coarse_result).data_vars)


def make_case(length: float, profile: profiles.Profile) -> Case:
    return Case(body=BODY, roller=Roller(radius=5e-3, length=length, profile=profile), max_pressure=PRESSURE)


def solve_on_cells(case: Case, cells: int):
    window = 2 * case.hertz_half_width
    return solve(
        case, Grid(x_range=(0.0, BODY.length), y_range=(-window, window), cells_x=cells, cells_y=cells), stresses=False
    )


@pytest.mark.parametrize(
    "case",
    [make_case(8 * HALF_WIDTH, profiles.Cylinder()), make_case(7 * HALF_WIDTH, LUNDBERG)],
    ids=["flush cylinder", "Lundberg"],
)
def test_error_estimates_bound_fine_grid_difference(case):
    coarse_result, fine_result, reference_result = (solve_on_cells(case, cells) for cells in (32, 64, 192))
    estimate, reference = (
        discretisation_error(fine_result, coarse_result),
        discretisation_error(reference_result, fine_result),
    )
    for name in ("peak_pressure", "end_pressure_first", "end_pressure_last", "half_width_middle"):
        difference = abs(float(estimate[name]) - float(reference[name]))
        assert difference <= float(estimate[f"{name}_error"]), name
        assert float(estimate[f"{name}_error"]) <= 0.08 * max(float(reference[name]), 1.0)


def test_end_pressures_of_symmetric_contact_are_equal():
    case = make_case(8 * HALF_WIDTH, profiles.Cylinder())
    result = discretisation_error(solve_on_cells(case, 32), solve_on_cells(case, 16))
    assert float(result.end_pressure_first) == pytest.approx(float(result.end_pressure_last), rel=1e-6)


def test_sharp_end_has_infinite_error_with_comment():
    case = make_case(5 * HALF_WIDTH, profiles.Cylinder())
    result = discretisation_error(solve_on_cells(case, 64), solve_on_cells(case, 32))
    for name in ("peak_pressure_error", "end_pressure_first_error", "end_pressure_last_error"):
        assert np.isinf(float(result[name]))
        assert "ends sharply" in result[name].attrs["comment"]
        assert "leave the grid out" in result[name].attrs["comment"]
    assert np.isfinite(float(result.half_width_middle_error))


def test_end_pressure_of_contact_inside_profile_is_zero():
    case = make_case(7 * HALF_WIDTH, LUNDBERG)
    result = discretisation_error(solve_on_cells(case, 64), solve_on_cells(case, 32))
    assert float(result.end_pressure_first) == float(result.end_pressure_first_error) == 0.0


def test_contact_on_equal_grid_raises():
    contact = solve_on_cells(make_case(8 * HALF_WIDTH, profiles.Cylinder()), 16)
    with pytest.raises(InvalidInputError, match="coarse"):
        discretisation_error(contact, contact)


@pytest.mark.parametrize(("pressure", "cells"), [(1e9, 2), (0.8e9, 6)])
def test_peak_error_with_loaded_sharp_end_is_infinite(pressure, cells):
    """The largest cell pressure lies in the middle on coarse cells, although the peak at the end is higher."""
    body = FiniteLengthSpace(length=0.8e-3, material=STEEL)
    roller = Roller(radius=5e-3, length=0.5e-3, profile=profiles.FullCrown(0.1))
    case = Case(body=body, roller=roller, max_pressure=pressure)
    result = solve_with_errors(case, choose_grid(case, cells_x=cells))
    assert 0 < float(result.end_pressure_first) < float(result.peak_pressure)
    assert np.isinf(float(result.peak_pressure_error))
    assert "ends sharply" in result.peak_pressure_error.attrs["comment"]


SMALL_RADIUS_PROFILES = [
    profiles.PartialCrown(straight_length=0.4e-3, crown_radius=0.05e-3),
    profiles.PartialCrown(straight_length=0.4e-3, crown_radius=0.2e-3),
    profiles.Cylinder(fillet_radius=0.05e-3),
    profiles.Cylinder(fillet_radius=0.2e-3),
]
"""Edges of a roller of 0.5 mm that need more than 16 cells per half-width."""


@pytest.mark.parametrize("profile", SMALL_RADIUS_PROFILES, ids=repr)
@pytest.mark.parametrize("length", [0.5e-3, 0.8e-3], ids=["flush", "inside"])
@pytest.mark.parametrize("cells", [2, 4, 8])
def test_coarse_cells_at_small_radius_have_infinite_error(profile, length, cells):
    body = FiniteLengthSpace(length=length, material=STEEL)
    case = Case(body=body, roller=Roller(radius=5e-3, length=0.5e-3, profile=profile), max_pressure=1e9)
    grid = choose_grid(case, cells_x=cells, cells_y=8, window=3)
    result = solve_with_errors(case, grid)
    assert np.isinf(float(result.peak_pressure_error))
    comment = result.peak_pressure_error.attrs["comment"]
    assert comment.startswith(f"the cells are too coarse for the shape's turn on {grid.shape[0]} x {grid.shape[1]}")
    assert np.isfinite(float(result.half_width_middle_error))


@pytest.mark.parametrize(
    "profile",
    [profiles.FullCrown(0.005), profiles.FullCrown(0.1), profiles.PartialCrown(0.25e-3, 5e-3), profiles.Cylinder()],
    ids=repr,
)
@pytest.mark.parametrize("cells", [2, 8])
def test_errors_cover_refined_column_values(profile, cells):
    body = FiniteLengthSpace(length=0.5e-3, material=STEEL)
    case = Case(body=body, roller=Roller(radius=5e-3, length=0.5e-3, profile=profile), max_pressure=1e9)
    result = solve_with_errors(case, choose_grid(case, cells_x=cells))
    refined_result = solve(case, stresses=False)
    assert float(result.peak_pressure_error) < 0.06 * float(result.peak_pressure)
    for name in ("peak_pressure", "end_pressure_first", "end_pressure_last"):
        tolerance = float(result[f"{name}_error"]) + float(refined_result[f"{name}_error"])
        assert abs(float(result[name]) - float(refined_result[name])) <= tolerance, name


@pytest.mark.parametrize("case", [make_case(5 * HALF_WIDTH, profiles.Cylinder()), make_case(8 * HALF_WIDTH, LUNDBERG)])
def test_end_pressures_are_at_most_peak_pressure(case):
    result = discretisation_error(solve_on_cells(case, 64), solve_on_cells(case, 32))
    ends = [float(result[f"end_pressure_{end}"]) for end in ("first", "last")]
    assert float(result.peak_pressure) >= max(ends)


@pytest.mark.parametrize("poisson", [-0.5, -0.2])
def test_peak_of_auxetic_body_lies_at_free_end(poisson):
    """An auxetic material is stiffer at its free end: the pressure rises towards the end."""
    body = FiniteLengthSpace(length=8 * HALF_WIDTH, material=Material(210e9, poisson))
    case = Case(body=body, roller=Roller(radius=5e-3, length=8 * HALF_WIDTH), max_pressure=PRESSURE)
    coarse_result, fine_result, reference_result = (solve_on_cells(case, cells) for cells in (24, 48, 96))
    estimate, reference = (
        discretisation_error(fine_result, coarse_result),
        discretisation_error(reference_result, fine_result),
    )
    for result in (estimate, reference):
        assert float(result.peak_pressure) == float(max(result.end_pressure_first, result.end_pressure_last))
    difference = abs(float(estimate.peak_pressure) - float(reference.peak_pressure))
    assert difference <= float(estimate.peak_pressure_error) <= 0.12 * float(reference.peak_pressure)


def test_comment_contains_sufficient_cell_counts():
    case = make_case(8 * HALF_WIDTH, profiles.Cylinder(fillet_radius=0.05e-3))
    grid = choose_grid(case, cells_x=4, cells_y=8)
    result = solve_with_errors(case, grid)
    comment = result.peak_pressure_error.attrs["comment"]
    assert np.isinf(float(result.peak_pressure_error))
    assert f"turn on {grid.shape[0]} x {grid.shape[1]} cells: leave the grid out" in comment
    cell_counts = re.search(r"choose_grid\(case, cells_x=([\d.]+), cells_y=([\d.]+)\)", comment)
    finer_grid = choose_grid(case, cells_x=float(cell_counts[1]), cells_y=float(cell_counts[2]))
    assert finer_grid.shape[0] >= 4 * grid.shape[0]
    assert finer_grid.shape[1] == pytest.approx(2 * grid.shape[1], rel=0.1)
    results_without_half_width = [
        dataset.drop_vars("hertz_half_width") for dataset in (solve_on_cells(case, 32), solve_on_cells(case, 16))
    ]
    assert re.search(
        r"or take [\d.]+ times as many", discretisation_error(*results_without_half_width).peak_pressure_error.comment
    )


@pytest.mark.parametrize("width_ratio", [1.5, 1.0005])
def test_comment_on_graded_columns_contains_no_grid(width_ratio):
    """The centres of columns of two alternating widths have equal distances; the widths may differ by nanometres."""
    case = make_case(8 * HALF_WIDTH, profiles.Cylinder(fillet_radius=0.05e-3))
    edges = np.cumsum([0.0, *np.tile([1.0, width_ratio], 16)])
    window = 2 * case.hertz_half_width
    grid = Grid.from_edges(edges * (BODY.length / edges[-1]), (-window, window), 32)
    comment = solve_with_errors(case, grid).peak_pressure_error.attrs["comment"]
    assert "times as many" in comment
    assert "choose_grid" not in comment
