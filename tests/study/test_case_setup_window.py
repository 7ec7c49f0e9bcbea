"""For a wide contact, a study widens the window as `solve` does."""

import numpy as np
import pytest

from contactstudy import solve
from contactstudy.case.gridding import create_widening_grids, solve_in_first_window
from contactstudy.study import load_case, run_study
from contactstudy.study.case_setup import build_setup
from tests.small_study import small_study

WIDE_CONTACT = {
    "young": 210e9,
    "poisson": 0.3,
    "radius": 5e-3,
    "roller_length": 0.5e-3,
    "e_over_a": 0.0,
    "body": "half-space",
    "max_pressure": 1.0e9,
    "profile": {"kind": "full-crown", "crown_radius": 3e-4},
    "stresses": False,
    "cells_x": 8.0,
    "cells_y": 16.0,
}


RIDGE = {"roller_length": 5.5e-3, "max_pressure": 1e8, "cells_x": 0.5, "cells_y": 1.0}
RIDGE |= {"profile": {"kind": "full-crown", "crown_radius": 5e-3}}  # wider than eight Hertz half-widths


@pytest.mark.parametrize("changes", [{}, RIDGE])
def test_default_window_is_widened(tmp_path, changes):
    base = WIDE_CONTACT | changes
    study = small_study(base=base, sweep={})
    report = run_study(study, tmp_path, workers=0, progress=False)
    assert report.counts == {"ok": 1}
    setup = build_setup(base)
    first_grid = setup.grid
    separate_result = solve_in_first_window(
        create_widening_grids(setup.case, **setup.cells), lambda grid: solve(setup.case, grid, stresses=False)
    )
    stored_case = load_case(tmp_path, study.plan()[0].id)
    assert separate_result.sizes["y"] > first_grid.cells_y
    np.testing.assert_array_equal(stored_case["pressure"], separate_result["pressure"])
    assert stored_case.sizes["y"] == separate_result.sizes["y"]


def test_narrow_explicit_window_raises(tmp_path):
    report = run_study(small_study(base=WIDE_CONTACT | {"window": 1.9}, sweep={}), tmp_path, workers=0, progress=False)
    (failure,) = report.failures
    assert failure[1].startswith("WindowError")


def test_coordinates_have_no_fill_value(case_result, tmp_path):
    import netCDF4

    case_result.to_netcdf(tmp_path / "a.nc")
    with netCDF4.Dataset(tmp_path / "a.nc") as file:
        assert not [name for name in ("x", "y", "z") if "_FillValue" in file[name].ncattrs()]
