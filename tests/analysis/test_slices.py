"""Slices: loads, pressures, stresses and errors."""

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
    analysis,
    profiles,
    solve,
)
from contactstudy.analysis.slices import Columns, border_load_errors, maximum_between, power_means
from contactstudy.arrays.variables import ERROR_KIND, ESTIMATED, NOT_ESTIMATED
from contactstudy.study import Study, open_study, run_study
from tests.split_columns import split_columns


@pytest.mark.parametrize("count", [1, 5, 16])
def test_load_of_slices(strip_result, count: int) -> None:
    result = strip_result()
    table = analysis.slices(result, count)
    assert float(table["normal_load"].sum()) == pytest.approx(float(analysis.contact_results(result)["resultant"]))
    assert table["normal_load"].values == pytest.approx(float(table["normal_load"].mean()))
    assert float(table["width"].sum()) == pytest.approx(4.0)
    assert float(table["position"].mean()) == pytest.approx(3.0)


def test_columns_of_the_line_contact(strip_result) -> None:
    table = analysis.slices(strip_result(), 4).to_dataframe()
    assert table.index.tolist() == [1, 2, 3, 4]
    assert table["axial_pressure"].to_numpy() == pytest.approx(1, abs=1e-3)
    assert table["half_width"].to_numpy() == pytest.approx(1, abs=1e-9)
    assert table["peak_von_mises"].to_numpy() == pytest.approx(0.5575, abs=1e-3)
    assert table["peak_orthogonal_shear_amplitude_z"].to_numpy() == pytest.approx(0.5, abs=0.03)


def test_slices_without_stress_points(strip_result) -> None:
    table = analysis.slices(strip_result().isel(x_field=[0]), 4)
    assert table["peak_von_mises"].isnull().values.tolist() == [False, True, True, True]


def test_surfaces_only(opened: xr.Dataset) -> None:
    one = opened.sel(e_over_a=1, friction=0.1, body="finite-length")
    surface = one.drop_vars([name for name in one.data_vars if "z_over_a" in one[name].dims])
    table = analysis.slices(surface, 5)
    assert "peak_von_mises" not in table
    assert float(table["normal_load"].sum()) == pytest.approx(float(analysis.contact_results(one)["resultant"]))


def test_real_contact_is_symmetric(solved: xr.Dataset) -> None:
    table = analysis.slices(solved, 6)
    for name in ("normal_load", "axial_pressure", "half_width"):
        assert np.allclose(table[name], table[name][::-1], rtol=1e-5)


def test_bad_input(strip_result, opened: xr.Dataset) -> None:
    with pytest.raises(InvalidInputError, match="number of cells, 16"):
        analysis.slices(strip_result(), 17)
    with pytest.raises(InvalidInputError, match="count"):
        analysis.slices(strip_result(), 0)
    with pytest.raises(InvalidInputError, match="single case"):
        analysis.slices(opened)


def test_slices_keep_order_at_single_depth(solved: xr.Dataset) -> None:
    there = analysis.slices(solved, 4)
    turned = analysis.slices(solved.isel(x=slice(None, None, -1)), 4)
    assert turned["normal_load"].values == pytest.approx(there["normal_load"].values)
    assert "peak_maximum_shear" not in analysis.slices(solved.isel(z=1), 4)


STEEL = Material(210e9, 0.3)
DESIGN = profiles.Lundberg.for_pressure(1.5e9, radius=5e-3, modulus=STEEL.plane_strain_modulus)


def pressed(profile: profiles.Profile, length: float, body: float | None, **given: float) -> Case:
    """A roller of 5 mm radius on a body of a length, or on a half-space."""
    on = HalfSpace(material=STEEL) if body is None else FiniteLengthSpace(length=body, material=STEEL)
    return Case(body=on, roller=Roller(radius=5e-3, length=length, profile=profile), max_pressure=1.5e9, **given)


KINDS = {
    "crowned": pressed(profiles.FullCrown(crown_radius=0.06), 1.6e-3, 2e-3),
    "crowned, tilted": pressed(profiles.FullCrown(crown_radius=0.1), 1e-3, 1.4e-3, tilt=1e-3),
    "straight, flush with free ends": pressed(profiles.Cylinder(), 1e-3, 1e-3),
    "straight, flush and tilted": pressed(profiles.Cylinder(), 1e-3, 1e-3, tilt=1e-3),
    "logarithmic, on a half-space": pressed(DESIGN, 1e-3, None),
    "logarithmic, lifted at one end by its tilt": pressed(DESIGN, 1e-3, 1.2e-3, tilt=6e-3),
    "rounded edges": pressed(profiles.Cylinder(fillet_radius=0.05e-3), 1.2e-3, 1.6e-3),
    "sharp end inside the face": pressed(profiles.Cylinder(), 1e-3, 1.2e-3, end_distance=0.0),
}


QUICK = ("crowned", "sharp end inside the face")
"""Kinds of the default tier."""


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=() if kind in QUICK else pytest.mark.slow) for kind in KINDS]
)
def test_errors_against_finer_columns(kind: str) -> None:
    coarse = solve(KINDS[kind], stresses=False, accuracy=0.01)
    fine = solve(KINDS[kind], split_columns(coarse, 4), stresses=False)
    for count in (3, 12, 30):
        table, finer = analysis.slices(coarse, count), analysis.slices(fine, count)
        for name in ("axial_pressure", "normal_load"):
            limited = np.isfinite(finer[name])
            missed = abs(table[name] - finer[name]).where(limited, 0.0)
            assert (missed <= table[f"{name}_error"]).all(), (count, name)
            typical = float((table[f"{name}_error"] / finer[name].where(limited).max()).where(limited).median())
            assert typical < 0.1, (count, name)


def test_mirrored_slices() -> None:
    """A border between an unloaded slice and the contact leaves the same open on both sides."""
    result = solve(pressed(profiles.FullCrown(crown_radius=0.1), 1e-3, 1.4e-3), stresses=False, accuracy=0.03)
    table = analysis.slices(result, 25)
    for name in ("axial_pressure", "axial_pressure_error", "normal_load", "normal_load_error"):
        values = table[name].values
        assert values == pytest.approx(values[::-1], rel=1e-6, abs=1e-9 * values.max())
    pressures, errors = maximum_between(
        Columns(
            np.stack([np.arange(6.0), np.arange(6.0) + 1], axis=-1), np.arange(6) + 0.5, np.array([0, 0, 0, 5, 5, 5])
        ),
        np.array([0.0, 2.7, 6.0]),
    )
    assert pressures[0] == pytest.approx(np.sqrt(0.2 * 25))
    assert errors[0] == 5.0


def test_narrow_columns_and_singular_ends() -> None:
    rounded = solve(KINDS["rounded edges"], stresses=False, accuracy=0.03)
    largest = analysis.slices(rounded, 10)["axial_pressure"]
    for side, part in (("first", 0), ("last", -1)):
        peak, error = (float(rounded[f"peak_pressure_{side}{kind}"]) for kind in ("", "_error"))
        assert float(largest[part]) == pytest.approx(peak, abs=error)
    sharp = analysis.slices(solve(KINDS["sharp end inside the face"], stresses=False, accuracy=0.1), 10)
    for name in ("axial_pressure", "axial_pressure_error"):
        assert np.isinf(sharp[name]).values.tolist() == [False] * 9 + [True]
    assert np.isfinite(sharp["normal_load_error"]).all()


def test_errors_of_a_case_of_a_study(tmp_path) -> None:
    base = {"young": 210e9, "poisson": 0.3, "radius": 5e-3, "roller_length": 0.5e-3, "e_over_a": 1.0, "stresses": False}
    base["accuracy"] = 0.05
    edge = {"name": "rounded", "kind": "cylinder", "fillet_radius": 0.05e-3}
    study = Study(name="small", base=base | {"profile": edge}, sweep={"max_pressure": [1.2e9, 1.5e9]})
    run_study(study, tmp_path, workers=0, progress=False)
    own, shared = (open_study(tmp_path, cells=cells).sel(max_pressure=1.5e9) for cells in ("original", "common"))
    table = analysis.slices(own, 6)
    assert float(table["axial_pressure"][0]) == pytest.approx(
        float(own["peak_pressure_first"]), abs=float(own["peak_pressure_first_error"])
    )
    assert np.isfinite(table["axial_pressure_error"]).all()
    assert np.isnan(analysis.slices(shared, 6)["axial_pressure_error"]).all()


def test_error_kinds(solved: xr.Dataset) -> None:
    settled = solve(KINDS["straight, flush with free ends"], stresses=False, accuracy=0.05)
    parts = {"given cells": solved, "cut": settled.sel(x=slice(0.5e-3, None)), "half": settled.sel(y=slice(0, None))}
    for what, result in parts.items():
        table = analysis.slices(result, 4)
        for name in ("axial_pressure", "normal_load"):
            assert np.isnan(table[f"{name}_error"]).all(), what
            assert table[name].attrs[ERROR_KIND] == NOT_ESTIMATED, what
            assert table[f"{name}_error"].attrs[ERROR_KIND] == NOT_ESTIMATED, what
    for name, array in analysis.slices(solved, 4).data_vars.items():
        if name not in ("position", "width"):
            assert array.attrs[ERROR_KIND] == NOT_ESTIMATED, name
    whole = analysis.slices(settled, 4)
    assert all(whole[name].attrs[ERROR_KIND] == ESTIMATED for name in ("axial_pressure", "normal_load"))


def test_values_of_parts_between_borders() -> None:
    edges, borders = np.array([[0.0, 1], [1, 2], [2, 3], [3, 4]]), np.array([0.0, 2.0, 4.0])
    pressure = Columns(edges, edges.mean(axis=1), np.array([1.0, 1, 2, 2]))
    largest, error = maximum_between(pressure, borders)
    np.testing.assert_allclose((largest, error), ([np.sqrt(2.5), 2.0], [0.5, 0.5]))
    np.testing.assert_allclose(border_load_errors(pressure, borders), [0.25, 0.25])
    means = power_means(Columns(edges, edges.mean(axis=1), np.array([1.0, 1, 1, 3])), borders, 1.0)
    np.testing.assert_allclose(means, ([1.0, 2.125], [0.0, 0.625]), atol=1e-12)
