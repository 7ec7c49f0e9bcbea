"""Passes over elastic-plastic bodies: flow below and above the shakedown limit, residual stress, free ends."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
import xarray as xr

from contactstudy import ConvergenceWarning, HalfSpace, InvalidInputError, QuarterSpace, fatigue
from contactstudy.arrays.variables import STRESSES
from contactstudy.plasticity import ElasticPlastic, eigenstrain_stress, passes, residual_stress
from contactstudy.plasticity.passes import STRAINS

ROOT_3 = np.sqrt(3.0)


def make_perfectly_plastic(shear_yield_stress: float) -> ElasticPlastic:
    return ElasticPlastic(yield_stress=ROOT_3 * shear_yield_stress)


def test_flow_decays_below_shakedown_limit_only(line_contact, steel_half_space) -> None:
    """Below the limit the flow of each pass is a fraction of the flow of the previous pass."""
    contact = line_contact(0.2).isel(z=slice(0, None, 2))
    shakedown_stress = float(fatigue.shakedown(contact, axial=True)["shakedown_stress"].max())
    below_limit, above_limit = (
        residual_stress(contact, steel_half_space, make_perfectly_plastic(factor * shakedown_stress), passes=6)
        for factor in (1.02, 0.97)
    )
    flow = below_limit["plastic_flow"].values
    assert flow[0] > 0
    assert flow[-1] < 0.3 * flow[0]
    assert (np.diff(flow) < 0).all()
    assert below_limit["converged"].all()
    flow = above_limit["plastic_flow"].values
    assert flow.size == 6
    assert flow[5] > 0.9 * flow[4]
    assert flow[5] > 0.2 * flow[0]
    assert above_limit["converged"].all()


@pytest.mark.slow
def test_flow_above_limit_is_bounded_by_elastic_strain(line_contact, steel_half_space) -> None:
    """Under alternating shear of +-0.25 p0 at a depth of a/2, hardening changes the flow by less than 3 percent."""
    contact = line_contact()
    shakedown_stress = float(fatigue.shakedown(contact, axial=True)["shakedown_stress"].max())
    flows = [
        residual_stress(
            contact,
            steel_half_space,
            ElasticPlastic(yield_stress=0.98 * ROOT_3 * shakedown_stress, kinematic_hardening=hardening),
            passes=3,
        )["plastic_flow"].values
        for hardening in (0.0, 5.0)
    ]
    assert flows[1] == pytest.approx(flows[0], rel=0.03)
    # Elastic shear strain beyond yield
    excess = 0.25 - 0.98 * shakedown_stress
    assert flows[0][-1] < 10 * excess / (1000.0 / 2.6)


@pytest.mark.slow
def test_flow_between_free_ends_decays_below_limit_only(line_contact, steel_between_ends) -> None:
    """The shear determines the limit as in a half-space; below it a residual stress along x exists between the ends."""
    contact = line_contact(0.0, length=8.0)
    shakedown_stress = float(fatigue.shakedown(contact.isel(x=[4]), axial=True)["shakedown_stress"].max())
    rolling_limit = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    assert shakedown_stress < 0.9 * rolling_limit
    result_below_limit = residual_stress(
        contact, steel_between_ends, make_perfectly_plastic(1.03 * shakedown_stress), passes=8, substeps=1
    )
    assert float(result_below_limit["plastic_flow"][-1]) < 5e-3 * float(result_below_limit["plastic_flow"][0])
    assert result_below_limit["converged"].all()
    material_above_limit = ElasticPlastic(yield_stress=0.97 * ROOT_3 * shakedown_stress, kinematic_hardening=5.0)
    flow = residual_stress(contact, steel_between_ends, material_above_limit, passes=5, substeps=1)["plastic_flow"]
    assert float(flow[4]) == pytest.approx(float(flow[3]), rel=3e-2)
    assert float(flow[4]) > 0.1 * float(flow[0])
    last_pass = result_below_limit.isel(pass_number=-1)
    assert float(last_pass["sigma_xx"].isel(x=4).min()) < -0.1
    # The residual stress has no resultant on a plane.
    depth_steps = np.gradient(last_pass["z"].values)
    magnitude = np.abs(last_pass["sigma_xx"].isel(x=4).values) @ depth_steps
    assert abs(last_pass["sigma_xx"].isel(x=4).values @ depth_steps) < 0.5 * magnitude


def test_stress_at_mid_length_of_long_contact_equals_line_contact(line_contact, steel_half_space) -> None:
    """Several columns along x agree with a single column."""
    line_stress = line_contact(0.2).isel(z=slice(0, None, 2))
    x = 6.0 * np.arange(-2, 3)
    wide_stress = xr.concat([line_stress.isel(x=0)] * 5, xr.Variable("x", x)).assign_coords(x=x)
    shakedown_stress = float(fatigue.shakedown(line_stress, axial=True)["shakedown_stress"].max())
    line_result, wide_result = (
        residual_stress(contact, steel_half_space, make_perfectly_plastic(1.03 * shakedown_stress), passes=2).isel(
            pass_number=-1
        )
        for contact in (line_stress, wide_stress)
    )
    for name in ("sigma_yy", "sigma_xx", "plastic_strain_yz"):
        max_value = float(np.abs(line_result[name]).max())
        assert max_value > 0
        assert np.abs(wide_result[name].sel(x=0) - line_result[name].isel(x=0)).max() < 0.08 * max_value, name


class ShakedownState(NamedTuple):
    """A contact between free ends, its shakedown stress, and the last of ten passes at a yield stress 3 % below it."""

    contact: xr.Dataset
    shakedown_stress: float
    last_pass: xr.Dataset


@pytest.fixture(scope="module")
def shakedown_state(line_contact, steel_between_ends) -> ShakedownState:
    contact = line_contact(0.1, length=8.0)
    shakedown_stress = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    perfect_material = make_perfectly_plastic(0.97 * shakedown_stress)
    last_pass = residual_stress(contact, steel_between_ends, perfect_material, passes=10).isel(pass_number=-1)
    return ShakedownState(contact, shakedown_stress, last_pass)


def test_residual_stress_prevents_yield(shakedown_state) -> None:
    contact, shakedown_stress, last_pass = shakedown_state
    total_stress = contact + last_pass[list(STRESSES)].drop_vars("pass_number")
    limits_with_residual = fatigue.shakedown(total_stress)
    assert float(limits_with_residual["first_yield_stress"].max()) < 0.97 * shakedown_stress * (1 + 1e-3)
    assert float(fatigue.shakedown(contact)["first_yield_stress"].max()) > 1.05 * 0.97 * shakedown_stress


def test_residual_stress_equals_stress_of_plastic_strain(shakedown_state, steel_between_ends) -> None:
    last_pass = shakedown_state.last_pass
    eigenstrain_result = eigenstrain_stress(steel_between_ends, last_pass[list(STRAINS)].drop_vars("pass_number"))
    for name in ("sigma_xx", "sigma_yy"):
        assert (
            np.abs(last_pass[name].values - eigenstrain_result[name].values).max()
            < 0.1 * np.abs(eigenstrain_result[name].values).max()
        )
    assert np.allclose(
        last_pass["residual_displacement_z"], eigenstrain_result["residual_displacement_z"], rtol=0.05, atol=1e-6
    )
    trace = last_pass["plastic_strain_xx"] + last_pass["plastic_strain_yy"] + last_pass["plastic_strain_zz"]
    assert np.abs(trace).max() < 1e-9 * np.abs(last_pass["plastic_strain_yy"]).max()


def test_isotropic_hardening_shakes_down(line_contact, steel_half_space) -> None:
    contact = line_contact(0.2)
    shakedown_stress = float(fatigue.shakedown(contact, axial=True)["shakedown_stress"].max())
    hardening_material = ElasticPlastic(yield_stress=0.9 * ROOT_3 * shakedown_stress, isotropic_hardening=200.0)
    flow = residual_stress(contact, steel_half_space, hardening_material, passes=8)["plastic_flow"]
    assert float(flow[-1]) < 1e-2 * float(flow[0])


def test_friction_causes_residual_displacement_along_y(line_contact, steel_half_space) -> None:
    contact = line_contact(0.2)
    first_yield = float(fatigue.shakedown(contact)["first_yield_stress"].max())
    plastic = ElasticPlastic(yield_stress=0.9 * ROOT_3 * first_yield, kinematic_hardening=20.0)
    result = residual_stress(contact, steel_half_space, plastic, passes=3).isel(pass_number=-1)
    mirrored_contact = contact.assign_coords(y=-contact["y"]) * xr.Dataset(
        {name: -1.0 if name in ("tau_xy", "tau_yz") else 1.0 for name in STRESSES}
    )
    reversed_result = residual_stress(mirrored_contact.sortby("y"), steel_half_space, plastic, passes=3).isel(
        pass_number=-1
    )
    assert float(result["residual_displacement_y"][0]) != 0
    # The mirrored contact passes in reversed order, with another residual state.
    assert not np.allclose(result["plastic_strain_yz"], -reversed_result["plastic_strain_yz"], rtol=1e-3, atol=1e-7)


def test_plastic_strain_is_limited_to_soft_depths(line_contact, steel_half_space) -> None:
    contact = line_contact()
    yield_stress = xr.DataArray([1.0, 1.0, 0.4, 0.4], {"z": [0.0, 0.9, 0.95, 2.0]}, "z")
    result = residual_stress(contact, steel_half_space, ElasticPlastic(yield_stress=yield_stress), passes=2)
    strain = result["equivalent_plastic_strain"].isel(pass_number=-1, x=0)
    assert float(strain.sel(z=slice(0, 0.9)).max()) == 0
    assert float(strain.sel(z=slice(0.95, None)).max()) > 0


def test_flow_without_convergence_warns(line_contact, steel_half_space, monkeypatch) -> None:
    monkeypatch.setattr(passes, "MAX_REPETITIONS", 2)
    with pytest.warns(ConvergenceWarning, match="did not reach tolerance"):
        result = residual_stress(line_contact(), steel_half_space, make_perfectly_plastic(0.27), passes=1)
    assert not result["converged"].all()


def test_no_plastic_flow_below_yield(line_contact, steel_half_space) -> None:
    contact = line_contact()
    first_yield = float(fatigue.shakedown(contact)["first_yield_stress"].max())
    result = residual_stress(contact, steel_half_space, make_perfectly_plastic(1.001 * first_yield))
    assert result.sizes["pass_number"] == 1
    assert float(abs(result[list(STRESSES)]).to_array().max()) == 0


def test_residual_stress_lowers_hydrostatic_stress(line_contact, steel_half_space) -> None:
    contact = line_contact()
    shakedown_stress = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    residual = residual_stress(
        contact, steel_half_space, make_perfectly_plastic(0.95 * shakedown_stress), passes=3
    ).isel(pass_number=-1)
    total_stress = contact + residual[list(STRESSES)].drop_vars("pass_number")
    limits = fatigue.FatigueLimits(bending=1.0, torsion=0.65)
    hydrostatic_stress, hydrostatic_stress_with_residual = (
        fatigue.dang_van(history, limits)["dang_van_hydrostatic"] for history in (contact, total_stress)
    )
    assert float(hydrostatic_stress_with_residual.min()) < float(hydrostatic_stress.min())
    assert set(total_stress.dims) == set(contact.dims)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"passes": 0}, "passes"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"substeps": 1.5}, "substeps"),
        ({"material": 3.0}, "ElasticPlastic"),
        ({"body": None}, "body"),
    ],
)
def test_invalid_argument_raises(line_contact, steel_half_space, change, message) -> None:
    arguments = {"body": steel_half_space, "material": make_perfectly_plastic(1.0)} | change
    with pytest.raises(InvalidInputError, match=message):
        residual_stress(line_contact(), **arguments)


def test_positions_that_miss_an_end_raise(line_contact, steel_between_ends) -> None:
    contact = line_contact(0.0, length=8.0)
    for short_contact in (contact.isel(x=slice(0, 6)), contact.isel(z=slice(4, None)), contact.isel(x=slice(3, None))):
        with pytest.raises(InvalidInputError, match="reach to"):
            residual_stress(short_contact, steel_between_ends, make_perfectly_plastic(0.2))


def test_residual_stress_at_mid_length_depends_little_on_ends(line_contact, steel_between_ends) -> None:
    """The bodies have two ends, one end and no end."""
    contact = line_contact(0.0, length=8.0, positions=5).isel(z=slice(0, None, 2))
    shakedown_stress = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    plastic = make_perfectly_plastic(0.95 * shakedown_stress)
    bodies_without_end = (kind(material=steel_between_ends.material) for kind in (HalfSpace, QuarterSpace))
    reference_stress, *other_stresses = (
        residual_stress(contact, body, plastic, passes=2).isel(pass_number=-1)["sigma_yy"]
        for body in (steel_between_ends, *bodies_without_end)
    )
    middle_stress = reference_stress.isel(x=2).values
    for body_stress in other_stresses:
        assert np.abs(body_stress.isel(x=2).values - middle_stress).max() < 0.15 * np.abs(middle_stress).max()
        assert float(np.abs(body_stress).max()) > 0.02


def test_stresses_outside_the_body_raise(line_contact, steel_between_ends) -> None:
    contact = line_contact(0.0, length=8.0)
    shorter_body = replace(steel_between_ends, length=6.0)
    with pytest.raises(InvalidInputError, match=r"x = '.* m': must be positions in the body, from 0 to 6 m"):
        residual_stress(contact, shorter_body, make_perfectly_plastic(0.2))


def test_flow_ignores_rounding_and_unit_of_positions(line_contact, steel_between_ends) -> None:
    contact = line_contact(0.0, length=8.0, positions=5).isel(z=slice(0, None, 2))
    contact_in_mm = contact.assign_coords(x=(1e3 * contact["x"]).assign_attrs(units="mm"))
    rounded_contact = contact.assign_coords(x=contact["x"] * (1 + 1e-15))
    shakedown_stress = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    material = ElasticPlastic(yield_stress=0.98 * ROOT_3 * shakedown_stress, kinematic_hardening=20.0)
    expected_residual = residual_stress(contact, steel_between_ends, material, passes=1)
    assert float(expected_residual["plastic_flow"][0]) > 0
    for equivalent_contact in (contact_in_mm, rounded_contact):
        result = residual_stress(equivalent_contact, steel_between_ends, material, passes=1)
        np.testing.assert_allclose(result["plastic_flow"], expected_residual["plastic_flow"], rtol=1e-6)
