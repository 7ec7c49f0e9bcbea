"""Tension at the trailing edge of a sliding contact: 2 f p0 for a cylinder, mirror symmetry, errors."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    FiniteLengthSpace,
    HalfSpace,
    InvalidInputError,
    Material,
    Roller,
    Rolling,
    choose_grid,
    open_study,
    run_study,
    solve,
)
from contactstudy.analysis import half_width, line_load
from contactstudy.fields.edge_tension import edge_tension
from contactstudy.study.case_setup import build_setup
from tests.small_study import BASE, small_study

# Uncoupled: the traction causes no normal displacement.
INCOMPRESSIBLE = Material(210e9, 0.5)
STEEL = Material(210e9, 0.3)
P0, RADIUS = 1e9, 5e-3


def solve_sliding(material: Material, friction: float) -> xr.Dataset:
    length = 20 * 2 * P0 * RADIUS / material.plane_strain_modulus
    body = FiniteLengthSpace(length=length, material=material)
    case = Case(body=body, roller=Roller(radius=RADIUS, length=length), max_pressure=P0, friction=friction)
    return solve(case, stresses=False)


@pytest.mark.parametrize(("friction", "material"), [(0.05, STEEL), (0.3, INCOMPRESSIBLE)])
def test_edge_tension_of_sliding_cylinder_equals_closed_form(material: Material, friction: float) -> None:
    """Friction adds 2 f p0 of the section to the stress of the normal load."""
    results = [solve_sliding(material, value) for value in (friction, 1e-6)]
    mid_x = 0.5 * float(results[0]["x"][0] + results[0]["x"][-1])
    tension, frictionless_tension = (edge_tension(result, [mid_x]) for result in results)
    section_half_width = float(half_width(results[0])["half_width"].sel(x=mid_x, method="nearest"))
    section_peak_pressure = (
        2 * float(line_load(results[0]).sel(x=mid_x, method="nearest")) / (np.pi * section_half_width)
    )
    friction_tension = float(tension["edge_tension"][0] - frictionless_tension["edge_tension"][0])
    assert friction_tension == pytest.approx(2 * friction * section_peak_pressure, rel=5e-3)
    assert abs(friction_tension - 2 * friction * section_peak_pressure) < float(tension["edge_tension_error"][0])
    assert float(tension["edge_tension_error"][0]) < 0.025 * float(tension["edge_tension"][0])
    assert float(tension["trailing_edge"][0]) == pytest.approx(-section_half_width, rel=1e-2)


def test_edge_tension_of_opposite_sliding_is_mirrored() -> None:
    forward_tension, backward_tension = (edge_tension(solve_sliding(STEEL, friction)) for friction in (0.2, -0.2))
    np.testing.assert_allclose(forward_tension["edge_tension"], backward_tension["edge_tension"], rtol=1e-6)
    np.testing.assert_allclose(forward_tension["trailing_edge"], -backward_tension["trailing_edge"], rtol=1e-6)
    assert forward_tension["edge_tension"].attrs["error_kind"] == "estimated"


def test_contact_without_sliding_has_no_edge_tension() -> None:
    case = Case(body=HalfSpace(material=STEEL), roller=Roller(radius=RADIUS, length=1e-3), max_pressure=P0)
    with pytest.raises(InvalidInputError, match="without friction"):
        edge_tension(solve(case, stresses=False, accuracy=0.1))
    motion = Rolling(longitudinal_creepage=1e-3)
    rolling_case = Case(body=case.body, roller=case.roller, max_pressure=P0, friction=0.3, motion=motion)
    with pytest.raises(InvalidInputError, match="stick and slip"):
        edge_tension(solve(rolling_case, choose_grid(rolling_case, cells_x=3, cells_y=8), stresses=False))


def test_study_contains_largest_tension(tmp_path) -> None:
    base = BASE | {"body": "half-space", "e_over_a": 1.0}
    run_study(small_study(base=base, sweep={"friction": [0.0, 0.1]}, level="summary"), tmp_path, workers=0)
    study_dataset = open_study(tmp_path)
    setup = build_setup(base | {"friction": 0.1})
    tension = edge_tension(solve(setup.case, setup.grid, **setup.options))
    assert np.isnan(study_dataset["peak_edge_tension"].sel(friction=0.0))
    for name, study_name in (("edge_tension", "peak_edge_tension"), ("edge_tension_error", "peak_edge_tension_error")):
        max_tension = tension[name][int(tension["edge_tension"].values.argmax())]
        np.testing.assert_allclose(study_dataset[study_name].sel(friction=0.1), max_tension, rtol=1e-7)
    assert study_dataset["peak_edge_tension"].attrs["units"] == "Pa"
