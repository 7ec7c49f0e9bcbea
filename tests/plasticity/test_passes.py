"""Passes over elastic-plastic bodies: shakedown from both sides, finite elements, balance."""

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

ROOT = np.sqrt(3.0)


def perfectly_plastic(shear_yield_stress: float) -> ElasticPlastic:
    return ElasticPlastic(yield_stress=ROOT * shear_yield_stress)


def test_flow_below_and_above_the_limit(line_contact, steel_half_space) -> None:
    """With friction the flow of each pass is a fraction of the flow of the previous pass."""
    contact = line_contact(0.2).isel(z=slice(0, None, 2))
    limit = float(fatigue.shakedown(contact, axial=True)["shakedown_stress"].max())
    below_limit, above_limit = (
        residual_stress(contact, steel_half_space, perfectly_plastic(factor * limit), passes=6)
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
def test_elastic_body_bounds_the_flow(line_contact, steel_half_space) -> None:
    """Under alternating shear of +-0.25 p0 at a depth of a/2 hardening contributes little to the bound of the flow."""
    contact = line_contact()
    limit = float(fatigue.shakedown(contact, axial=True)["shakedown_stress"].max())
    flows = [
        residual_stress(
            contact,
            steel_half_space,
            ElasticPlastic(yield_stress=0.98 * ROOT * limit, kinematic_hardening=hardening),
            passes=3,
        )["plastic_flow"].values
        for hardening in (0.0, 5.0)
    ]
    assert flows[1] == pytest.approx(flows[0], rel=0.03)
    # Between fixed planes, shear beyond yield would flow forth and back by this equivalent plastic strain:
    excess = 0.25 - 0.98 * limit
    assert flows[0][-1] < 10 * excess / (1000.0 / 2.6)


@pytest.mark.slow
def test_shakedown_between_free_ends(line_contact, steel_between_ends) -> None:
    """The shear determines the limit as in a half-space; below it a residual stress along x exists between the ends."""
    contact = line_contact(0.0, length=8.0)
    limit = float(fatigue.shakedown(contact.isel(x=[4]), axial=True)["shakedown_stress"].max())
    line_result = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    assert limit < 0.9 * line_result
    below = residual_stress(contact, steel_between_ends, perfectly_plastic(1.03 * limit), passes=8, substeps=1)
    assert float(below["plastic_flow"][-1]) < 5e-3 * float(below["plastic_flow"][0])
    assert below["converged"].all()
    above = ElasticPlastic(yield_stress=0.97 * ROOT * limit, kinematic_hardening=5.0)
    flow = residual_stress(contact, steel_between_ends, above, passes=5, substeps=1)["plastic_flow"]
    assert float(flow[4]) == pytest.approx(float(flow[3]), rel=3e-2)
    assert float(flow[4]) > 0.1 * float(flow[0])
    last = below.isel(pass_number=-1)
    assert float(last["sigma_xx"].isel(x=4).min()) < -0.1
    # The residual stress has no resultant on a plane.
    heights = np.gradient(last["z"].values)
    magnitude = np.abs(last["sigma_xx"].isel(x=4).values) @ heights
    assert abs(last["sigma_xx"].isel(x=4).values @ heights) < 0.5 * magnitude


def test_mid_length_of_a_long_contact(line_contact, steel_half_space) -> None:
    """Several columns with the body's correction agree with one column alone."""
    line = line_contact(0.2).isel(z=slice(0, None, 2))
    x = 6.0 * np.arange(-2, 3)
    wide = xr.concat([line.isel(x=0)] * 5, xr.Variable("x", x)).assign_coords(x=x)
    limit = float(fatigue.shakedown(line, axial=True)["shakedown_stress"].max())
    line_result, middle = (
        residual_stress(contact, steel_half_space, perfectly_plastic(1.03 * limit), passes=2).isel(pass_number=-1)
        for contact in (line, wide)
    )
    for name in ("sigma_yy", "sigma_xx", "plastic_strain_yz"):
        size = float(np.abs(line_result[name]).max())
        assert size > 0
        assert np.abs(middle[name].sel(x=0) - line_result[name].isel(x=0)).max() < 0.08 * size, name


class ShakenDown(NamedTuple):
    """A contact between free ends, its shakedown stress, and the state after ten passes 3 % above that limit."""

    contact: xr.Dataset
    limit: float
    last: xr.Dataset


@pytest.fixture(scope="module")
def shaken_down(line_contact, steel_between_ends) -> ShakenDown:
    contact = line_contact(0.1, length=8.0)
    limit = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    plastic = perfectly_plastic(0.97 * limit)
    last = residual_stress(contact, steel_between_ends, plastic, passes=10).isel(pass_number=-1)
    return ShakenDown(contact, limit, last)


def test_residual_stress_prevents_yield(shaken_down) -> None:
    contact, limit, last = shaken_down
    total = contact + last[list(STRESSES)].drop_vars("pass_number")
    limits_with_residual = fatigue.shakedown(total)
    assert float(limits_with_residual["first_yield_stress"].max()) < 0.97 * limit * (1 + 1e-3)
    assert float(fatigue.shakedown(contact)["first_yield_stress"].max()) > 1.05 * 0.97 * limit


def test_residual_stress_of_the_plastic_strain(shaken_down, steel_between_ends) -> None:
    last = shaken_down.last
    direct = eigenstrain_stress(steel_between_ends, last[list(STRAINS)].drop_vars("pass_number"))
    for name in ("sigma_xx", "sigma_yy"):
        assert np.abs(last[name].values - direct[name].values).max() < 0.1 * np.abs(direct[name].values).max()
    assert np.allclose(last["residual_displacement_z"], direct["residual_displacement_z"], rtol=0.05, atol=1e-6)
    trace = last["plastic_strain_xx"] + last["plastic_strain_yy"] + last["plastic_strain_zz"]
    assert np.abs(trace).max() < 1e-9 * np.abs(last["plastic_strain_yy"]).max()


def test_isotropic_hardening_shakes_down(line_contact, steel_half_space) -> None:
    contact = line_contact(0.2)
    limit = float(fatigue.shakedown(contact, axial=True)["shakedown_stress"].max())
    hardening_material = ElasticPlastic(yield_stress=0.9 * ROOT * limit, isotropic_hardening=200.0)
    flow = residual_stress(contact, steel_half_space, hardening_material, passes=8)["plastic_flow"]
    assert float(flow[-1]) < 1e-2 * float(flow[0])


def test_friction_displaces_the_surface_forwards(line_contact, steel_half_space) -> None:
    contact = line_contact(0.2)
    first = float(fatigue.shakedown(contact)["first_yield_stress"].max())
    plastic = ElasticPlastic(yield_stress=0.9 * ROOT * first, kinematic_hardening=20.0)
    result = residual_stress(contact, steel_half_space, plastic, passes=3).isel(pass_number=-1)
    backwards = contact.assign_coords(y=-contact["y"]) * xr.Dataset(
        {name: -1.0 if name in ("tau_xy", "tau_yz") else 1.0 for name in STRESSES}
    )
    reversed_result = residual_stress(backwards.sortby("y"), steel_half_space, plastic, passes=3).isel(pass_number=-1)
    assert float(result["residual_displacement_y"][0]) != 0
    # The mirrored contact passes in reversed order, with another residual state.
    assert not np.allclose(result["plastic_strain_yz"], -reversed_result["plastic_strain_yz"], rtol=1e-3, atol=1e-7)


def test_yield_stress_over_depth(line_contact, steel_half_space) -> None:
    """The flow is limited to the soft depths."""
    contact = line_contact()
    yield_stress = xr.DataArray([1.0, 1.0, 0.4, 0.4], {"z": [0.0, 0.9, 0.95, 2.0]}, "z")
    result = residual_stress(contact, steel_half_space, ElasticPlastic(yield_stress=yield_stress), passes=2)
    strain = result["equivalent_plastic_strain"].isel(pass_number=-1, x=0)
    assert float(strain.sel(z=slice(0, 0.9)).max()) == 0
    assert float(strain.sel(z=slice(0.95, None)).max()) > 0


def test_flow_without_convergence(line_contact, steel_half_space, monkeypatch) -> None:
    monkeypatch.setattr(passes, "MAX_REPETITIONS", 2)
    with pytest.warns(ConvergenceWarning, match="did not reach tolerance"):
        result = residual_stress(line_contact(), steel_half_space, perfectly_plastic(0.27), passes=1)
    assert not result["converged"].all()


def test_no_plastic_flow_below_yield(line_contact, steel_half_space) -> None:
    contact = line_contact()
    first = float(fatigue.shakedown(contact)["first_yield_stress"].max())
    result = residual_stress(contact, steel_half_space, perfectly_plastic(1.001 * first))
    assert result.sizes["pass_number"] == 1
    assert float(abs(result[list(STRESSES)]).to_array().max()) == 0


def test_residual_stress_lowers_findleys_normal_stress(line_contact, steel_half_space) -> None:
    """Residual pressure lowers Findley's normal stress."""
    contact = line_contact()
    limit = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    residual = residual_stress(contact, steel_half_space, perfectly_plastic(0.95 * limit), passes=3).isel(
        pass_number=-1
    )
    total = contact + residual[list(STRESSES)].drop_vars("pass_number")
    limits = fatigue.FatigueLimits(bending=1.0, torsion=0.65)
    before, after = (fatigue.dang_van(history, limits)["dang_van_hydrostatic"] for history in (contact, total))
    assert float(after.min()) < float(before.min())
    assert set(total.dims) == set(contact.dims)


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
def test_bad_input_is_rejected(line_contact, steel_half_space, change, message) -> None:
    arguments = {"body": steel_half_space, "material": perfectly_plastic(1.0)} | change
    with pytest.raises(InvalidInputError, match=message):
        residual_stress(line_contact(), **arguments)


def test_positions_short_of_the_ends_are_rejected(line_contact, steel_between_ends) -> None:
    contact = line_contact(0.0, length=8.0)
    for short_contact in (contact.isel(x=slice(0, 6)), contact.isel(z=slice(4, None)), contact.isel(x=slice(3, None))):
        with pytest.raises(InvalidInputError, match="reach to"):
            residual_stress(short_contact, steel_between_ends, perfectly_plastic(0.2))


def test_residual_stress_far_from_the_ends(line_contact, steel_between_ends) -> None:
    """Far from the ends of the body the residual stress is nearly unchanged; a free end is free."""
    contact = line_contact(0.0, length=8.0, positions=5).isel(z=slice(0, None, 2))
    limit = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    plastic = perfectly_plastic(0.95 * limit)
    bodies_without_end = (kind(material=steel_between_ends.material) for kind in (HalfSpace, QuarterSpace))
    reference_stress, *other_bodies = (
        residual_stress(contact, body, plastic, passes=2).isel(pass_number=-1)["sigma_yy"]
        for body in (steel_between_ends, *bodies_without_end)
    )
    middle = reference_stress.isel(x=2).values
    for body_stress in other_bodies:
        assert np.abs(body_stress.isel(x=2).values - middle).max() < 0.15 * np.abs(middle).max()
        assert float(np.abs(body_stress).max()) > 0.02


def test_stresses_of_another_body_are_rejected(line_contact, steel_between_ends) -> None:
    contact = line_contact(0.0, length=8.0)
    shorter = replace(steel_between_ends, length=6.0)
    with pytest.raises(InvalidInputError, match=r"x = '.* m': must be positions in the body, from 0 to 6 m"):
        residual_stress(contact, shorter, perfectly_plastic(0.2))


def test_positions_within_rounding_of_the_end(line_contact, steel_between_ends) -> None:
    contact = line_contact(0.0, length=8.0, positions=5).isel(z=slice(0, None, 2))
    in_millimetres = contact.assign_coords(x=(1e3 * contact["x"]).assign_attrs(units="mm"))
    rounded = contact.assign_coords(x=contact["x"] * (1 + 1e-15))
    limit = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    material = ElasticPlastic(yield_stress=0.98 * ROOT * limit, kinematic_hardening=20.0)
    reference = residual_stress(contact, steel_between_ends, material, passes=1)
    assert float(reference["plastic_flow"][0]) > 0
    for equivalent_contact in (in_millimetres, rounded):
        result = residual_stress(equivalent_contact, steel_between_ends, material, passes=1)
        np.testing.assert_allclose(result["plastic_flow"], reference["plastic_flow"], rtol=1e-6)
