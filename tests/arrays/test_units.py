"""Units on labelled input are converted or refused, never ignored."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

from contactstudy import HalfSpace, InvalidInputError, solve_contact, stress_field, surface_displacement
from contactstudy.arrays.units import in_si

OnCells = Callable[..., xr.DataArray]


def test_a_gap_in_millimetres_on_cells_in_micrometres(on_cells: OnCells, half_space: HalfSpace) -> None:
    gap = on_cells(lambda x, y: 0.5 * (x**2 + y**2), (-1.5, 1.5), (-1.5, 1.5), (24, 24))
    scaled = (1e3 * gap).assign_attrs(units="mm").assign_coords(x=1e6 * gap.x, y=1e6 * gap.y)
    for axis in ("x", "y"):
        scaled[axis].attrs["units"] = "um"
    expected, found = (solve_contact(half_space, each, load=4 / 3) for each in (gap, scaled))
    np.testing.assert_allclose(found["pressure"], expected["pressure"], rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(found["x"], expected["x"], rtol=1e-12)


def test_a_pressure_in_gigapascals(on_cells: OnCells, half_space: HalfSpace) -> None:
    pressure = on_cells(lambda x, y: 1.0 + 0 * x + 0 * y, (-1.0, 1.0), (-1.0, 1.0), (8, 8))
    scaled = (1e-9 * pressure).assign_attrs(units="GPa")
    sunk = [surface_displacement(half_space, each) for each in (scaled, pressure)]
    np.testing.assert_allclose(*sunk, rtol=1e-12)
    stresses = [stress_field(half_space, each, z=[0.5]).sigma_zz for each in (scaled, pressure)]
    np.testing.assert_allclose(*stresses, rtol=1e-12)


@pytest.mark.parametrize("unit", ["inch", "Pa", "", 7])
def test_other_units_are_refused(unit: object) -> None:
    with pytest.raises(InvalidInputError, match=r"gap.attrs\['units'\]"):
        in_si("gap", xr.DataArray([1.0], attrs={"units": unit}), "m")


@pytest.mark.parametrize("values", [np.ones((4, 4)) * 1j, np.zeros((4, 4), "datetime64[ns]"), np.full((4, 4), "a")])
def test_only_real_numbers_are_taken(values: np.ndarray, half_space: HalfSpace) -> None:
    cells = np.arange(4.0)
    array = xr.DataArray(values, coords={"x": cells, "y": cells}, dims=("x", "y"))
    with pytest.raises(InvalidInputError, match=r"pressure.dtype = .* real numbers"):
        surface_displacement(half_space, array)
    complex_cells = xr.DataArray(np.ones((4, 4)), coords={"x": cells * 1j, "y": cells}, dims=("x", "y"))
    with pytest.raises(InvalidInputError, match=r"x = .* numbers"):
        surface_displacement(half_space, complex_cells)
