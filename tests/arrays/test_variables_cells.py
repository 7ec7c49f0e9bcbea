"""Labelled arrays on cells of any width: their edges, and cells that do not tile."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import example, given
from hypothesis import strategies as st

import contactstudy as cs
from contactstudy import Grid, InvalidInputError
from contactstudy.arrays.grid import SPACING_TOLERANCE
from contactstudy.arrays.variables import cell_coordinates, labelled_cells

EDGES = np.array([0.0, 0.1, 0.3, 0.7, 1.1, 1.4, 1.5])
GRID = Grid.from_edges(EDGES, (-1.0, 1.0), 4)


def make_array(**coordinates: object) -> xr.DataArray:
    return xr.DataArray(
        np.arange(24.0).reshape(GRID.shape), coords={"x": GRID.x, "y": GRID.y, **coordinates}, dims=("x", "y")
    )


def test_edges_follow_from_widths() -> None:
    array = make_array(x_width=("x", GRID.widths))
    values, grid = labelled_cells("p", array)
    assert np.allclose(grid.x_edges, EDGES)
    assert np.array_equal(values, array.values)


@pytest.mark.parametrize("extent", [(0.0, np.inf), (0.0, 1.5)])
def test_edges_follow_from_body_extent(extent: tuple[float, float]) -> None:
    _, grid = labelled_cells("p", make_array(), extent=extent)
    assert np.allclose(grid.x_edges, EDGES)


def test_dimension_order_does_not_matter() -> None:
    array = make_array(x_width=("x", GRID.widths))
    values, grid = labelled_cells("p", array.transpose("y", "x"))
    assert grid.shape == GRID.shape
    assert np.array_equal(values, array.values)


def test_uniform_cells_have_no_width_coordinate() -> None:
    uniform_grid = Grid(x_range=(0.0, 1.5), y_range=(-1.0, 1.0), cells_x=6, cells_y=4)
    assert cell_coordinates(uniform_grid) == {}
    array = xr.DataArray(np.ones((6, 4)), coords={"x": uniform_grid.x, "y": uniform_grid.y}, dims=("x", "y"))
    assert labelled_cells("p", array)[1].uniform


@given(ratios=st.lists(st.floats(0.35, 2.9), min_size=2, max_size=20))
@example(ratios=[1.0, 0.99999])
def test_labels_restore_grid(ratios: list[float]) -> None:
    edges = np.append(0.0, np.cumsum(np.cumprod([1.0, *ratios])))
    grid = Grid.from_edges(edges, (-1.0, 1.0), 4)
    dataset = xr.Dataset(
        {"p": (("x", "y"), np.ones(grid.shape))}, coords={"x": grid.x, "y": grid.y, **cell_coordinates(grid)}
    )
    for grid_of_labels in (
        labelled_cells("p", dataset["p"])[1],
        labelled_cells("p", dataset["p"].drop_vars(["x_width", "x_bounds"], errors="ignore"), extent=(0.0, edges[-1]))[
            1
        ],
    ):
        # Without widths, the edges follow from the centres. Nearly uniform cells become uniform.
        tolerance = SPACING_TOLERANCE * grid.widths.max() if grid_of_labels.uniform else 1e-9 * edges[-1]
        assert np.allclose(grid_of_labels.x_edges, edges, atol=tolerance)


def test_selected_cells_keep_widths() -> None:
    array = make_array(x_width=("x", GRID.widths)).isel(x=slice(1, 4))
    assert np.allclose(labelled_cells("p", array)[1].x_edges, EDGES[1:5])


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (make_array(), r"x = .*uniformly spaced.*x_width"),
        (
            make_array(x_width=("x", GRID.widths)).isel(x=[0, 1, 3, 4]),
            r"x_width = 'one cell ends at 0.3 m, the next begins at 0.7 m",
        ),
        (make_array(x_width=("x", 1.2 * GRID.widths)), r"x_width = 'one cell ends at .* the next begins at"),
        (make_array(x_width=("x", GRID.widths)).isel(x=slice(None, None, -1)), r"x"),
        (make_array(x_width=("x", -GRID.widths)), r"x"),
        (make_array(x_width=("x", np.full(6, np.nan))), r"x_width"),
    ],
    ids=["no widths", "a gap", "an overlap", "backwards", "negative", "not finite"],
)
def test_cells_with_gaps_raise(array: xr.DataArray, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        labelled_cells("p", array)


def test_inconsistent_centres_raise() -> None:
    array = xr.DataArray(np.ones((3, 2)), coords={"x": [0.5, 0.6, 2.0], "y": [0.0, 1.0]}, dims=("x", "y"))
    with pytest.raises(InvalidInputError, match=r"a cell centre at 0.6 m.*x_width"):
        labelled_cells("p", array, extent=(0.0, np.inf))


@pytest.mark.parametrize("engine", ["netcdf4", "h5netcdf"])
def test_stored_result_on_graded_cells_has_equal_stresses(tmp_path: Path, engine: str) -> None:
    steel = cs.Material(210e9, 0.3)
    body = cs.FiniteLengthSpace(length=0.6e-3, material=steel)
    roller = cs.Roller(radius=5e-3, length=0.5e-3, profile=cs.profiles.Cylinder(fillet_radius=0.1e-3))
    result = cs.solve(cs.Case(body=body, roller=roller, max_pressure=1.5e9), accuracy=0.05, stresses=False)
    assert {"x_width", "x_bounds"} <= set(result.coords)
    assert np.allclose(result.x_bounds[:, 1] - result.x_bounds[:, 0], result.x_width, rtol=1e-9)
    result.to_netcdf(tmp_path / "result.nc", engine=engine)
    with xr.open_dataset(tmp_path / "result.nc", engine=engine) as stored_result:
        stored_result.load()
    assert np.array_equal(stored_result.x_width, result.x_width)
    stresses = [
        cs.stress_field(body, dataset.pressure, friction=0.1, x=[0.0, 1e-4], y=[0.0], z=[2e-5, 5e-5])
        for dataset in (result, stored_result)
    ]
    for name in stresses[0].data_vars:
        assert np.array_equal(stresses[0][name], stresses[1][name])
