"""Passes over elastic-plastic bodies: shakedown from both sides, finite elements, balance."""

from __future__ import annotations

from dataclasses import replace

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


def test_flow_below_and_above_the_limit(passing, steel_half_space) -> None:
    """With friction the flow of each pass is a part of the flow of the previous one."""
    contact = passing(0.2)
    least = float(fatigue.shakedown(contact, axial=True)["shakedown_stress"].max())
    below, above = (
        residual_stress(contact, steel_half_space, perfectly_plastic(part * least), passes=6) for part in (1.02, 0.97)
    )
    flow = below["plastic_flow"].values
    assert flow[0] > 0
    assert flow[-1] < 0.3 * flow[0]
    assert (np.diff(flow) < 0).all()
    assert below["converged"].all()
    flow = above["plastic_flow"].values
    assert flow.size == 6
    assert flow[5] > 0.9 * flow[4]
    assert flow[5] > 0.2 * flow[0]
    assert above["converged"].all()


@pytest.mark.slow
def test_flow_bounded_by_the_elastic_body(passing, steel_half_space) -> None:
    """Alternating shear of +-0.25 p0 at half the half-width: hardening adds little to what holds the flow."""
    contact = passing()
    least = float(fatigue.shakedown(contact, axial=True)["shakedown_stress"].max())
    flows = [
        residual_stress(
            contact,
            steel_half_space,
            ElasticPlastic(yield_stress=0.98 * ROOT * least, kinematic_hardening=hardening),
            passes=3,
        )["plastic_flow"].values
        for hardening in (0.0, 5.0)
    ]
    assert flows[1] == pytest.approx(flows[0], rel=0.03)
    # Between planes that are held, shear beyond yield would flow there and back, in equivalent plastic strain:
    excess = 0.25 - 0.98 * least
    assert flows[0][-1] < 10 * excess / (1000.0 / 2.6)


@pytest.mark.slow
def test_between_free_ends(passing, steel_between_ends) -> None:
    """Shear decides as in a half-space; below the limit residual stress along x has built up between the ends."""
    contact = passing(0.0, length=8.0)
    least = float(fatigue.shakedown(contact.isel(x=[4]), axial=True)["shakedown_stress"].max())
    alone = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    assert least < 0.9 * alone
    below = residual_stress(contact, steel_between_ends, perfectly_plastic(1.03 * least), passes=8, substeps=1)
    assert float(below["plastic_flow"][-1]) < 5e-3 * float(below["plastic_flow"][0])
    assert below["converged"].all()
    above = ElasticPlastic(yield_stress=0.97 * ROOT * least, kinematic_hardening=5.0)
    flow = residual_stress(contact, steel_between_ends, above, passes=5, substeps=1)["plastic_flow"]
    assert float(flow[4]) == pytest.approx(float(flow[3]), rel=3e-2)
    assert float(flow[4]) > 0.1 * float(flow[0])
    last = below.isel(pass_number=-1)
    assert float(last["sigma_xx"].isel(x=4).min()) < -0.1
    # It has no resultant on a plane, whatever the half-space would say.
    heights = np.gradient(last["z"].values)
    carried = np.abs(last["sigma_xx"].isel(x=4).values) @ heights
    assert abs(last["sigma_xx"].isel(x=4).values @ heights) < 0.5 * carried


def test_middle_of_a_long_contact(passing, steel_half_space) -> None:
    """Columns side by side and their difference to the body's answer come to what one column alone does."""
    line = passing(0.2).isel(z=slice(0, None, 2))
    x = 6.0 * np.arange(-2, 3)
    wide = xr.concat([line.isel(x=0)] * 5, xr.Variable("x", x)).assign_coords(x=x)
    least = float(fatigue.shakedown(line, axial=True)["shakedown_stress"].max())
    alone, middle = (
        residual_stress(contact, steel_half_space, perfectly_plastic(1.03 * least), passes=2).isel(pass_number=-1)
        for contact in (line, wide)
    )
    for name in ("sigma_yy", "sigma_xx", "plastic_strain_yz"):
        size = float(np.abs(alone[name]).max())
        assert size > 0
        assert np.abs(middle[name].sel(x=0) - alone[name].isel(x=0)).max() < 0.08 * size, name


def test_residual_stress_prevents_yield(passing, steel_between_ends) -> None:
    contact = passing(0.1, length=8.0)
    least = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    plastic = perfectly_plastic(0.97 * least)
    last = residual_stress(contact, steel_between_ends, plastic, passes=10).isel(pass_number=-1)
    total = contact + last[list(STRESSES)].drop_vars("pass_number")
    again = fatigue.shakedown(total)
    assert float(again["first_yield_stress"].max()) < 0.97 * least * (1 + 1e-3)
    assert float(fatigue.shakedown(contact)["first_yield_stress"].max()) > 1.05 * 0.97 * least


def test_residual_stress_of_the_plastic_strain(passing, steel_between_ends) -> None:
    contact = passing(0.1, length=8.0)
    least = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    last = residual_stress(contact, steel_between_ends, perfectly_plastic(0.97 * least), passes=3).isel(pass_number=-1)
    direct = eigenstrain_stress(steel_between_ends, last[list(STRAINS)].drop_vars("pass_number"))
    for name in ("sigma_xx", "sigma_yy"):
        assert np.abs(last[name].values - direct[name].values).max() < 0.1 * np.abs(direct[name].values).max()
    assert np.allclose(last["residual_displacement_z"], direct["residual_displacement_z"], rtol=0.05, atol=1e-6)
    trace = last["plastic_strain_xx"] + last["plastic_strain_yy"] + last["plastic_strain_zz"]
    assert np.abs(trace).max() < 1e-9 * np.abs(last["plastic_strain_yy"]).max()


def test_isotropic_hardening_shakes_down(passing, steel_half_space) -> None:
    contact = passing(0.2)
    least = float(fatigue.shakedown(contact, axial=True)["shakedown_stress"].max())
    harder = ElasticPlastic(yield_stress=0.9 * ROOT * least, isotropic_hardening=200.0)
    flow = residual_stress(contact, steel_half_space, harder, passes=8)["plastic_flow"]
    assert float(flow[-1]) < 1e-2 * float(flow[0])


def test_friction_drags_the_top_forwards(passing, steel_half_space) -> None:
    contact = passing(0.2)
    first = float(fatigue.shakedown(contact)["first_yield_stress"].max())
    plastic = ElasticPlastic(yield_stress=0.9 * ROOT * first, kinematic_hardening=20.0)
    found = residual_stress(contact, steel_half_space, plastic, passes=3).isel(pass_number=-1)
    backwards = contact.assign_coords(y=-contact["y"]) * xr.Dataset(
        {name: -1.0 if name in ("tau_xy", "tau_yz") else 1.0 for name in STRESSES}
    )
    other = residual_stress(backwards.sortby("y"), steel_half_space, plastic, passes=3).isel(pass_number=-1)
    assert float(found["residual_displacement_y"][0]) != 0
    # The contact that pushes the other way, seen in a mirror, is passed in the other order: it leaves something else.
    assert not np.allclose(found["plastic_strain_yz"], -other["plastic_strain_yz"], rtol=1e-3, atol=1e-7)


def test_yield_stress_over_depth(passing, steel_half_space) -> None:
    """Only where the material is soft does it flow."""
    contact = passing()
    case = xr.DataArray([1.0, 1.0, 0.4, 0.4], {"z": [0.0, 0.9, 0.95, 2.0]}, "z")
    found = residual_stress(contact, steel_half_space, ElasticPlastic(yield_stress=case), passes=2)
    flowed = found["equivalent_plastic_strain"].isel(pass_number=-1, x=0)
    assert float(flowed.sel(z=slice(0, 0.9)).max()) == 0
    assert float(flowed.sel(z=slice(0.95, None)).max()) > 0


def test_flow_without_convergence(passing, steel_half_space, monkeypatch) -> None:
    monkeypatch.setattr(passes, "MOST_REPETITIONS", 2)
    with pytest.warns(ConvergenceWarning, match="did not reach tolerance"):
        found = residual_stress(passing(), steel_half_space, perfectly_plastic(0.27), passes=1)
    assert not found["converged"].all()


def test_no_plastic_flow_below_yield(passing, steel_half_space) -> None:
    contact = passing()
    first = float(fatigue.shakedown(contact)["first_yield_stress"].max())
    found = residual_stress(contact, steel_half_space, perfectly_plastic(1.001 * first))
    assert found.sizes["pass_number"] == 1
    assert float(abs(found[list(STRESSES)]).to_array().max()) == 0


def test_fatigue_takes_the_residual_stress_in(passing, steel_half_space) -> None:
    """Pressure that stays lowers Findley's normal stress."""
    contact = passing()
    least = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    left = residual_stress(contact, steel_half_space, perfectly_plastic(0.95 * least), passes=3).isel(pass_number=-1)
    total = contact + left[list(STRESSES)].drop_vars("pass_number")
    limits = fatigue.FatigueLimits(bending=1.0, torsion=0.65)
    before, after = (fatigue.dang_van(one, limits)["dang_van_hydrostatic"] for one in (contact, total))
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
def test_bad_input(passing, steel_half_space, change, message) -> None:
    arguments = {"body": steel_half_space, "material": perfectly_plastic(1.0)} | change
    with pytest.raises(InvalidInputError, match=message):
        residual_stress(passing(), **arguments)


def test_positions_short_of_the_ends(passing, steel_between_ends) -> None:
    contact = passing(0.0, length=8.0)
    for part in (contact.isel(x=slice(0, 6)), contact.isel(z=slice(4, None)), contact.isel(x=slice(3, None))):
        with pytest.raises(InvalidInputError, match="reach to"):
            residual_stress(part, steel_between_ends, perfectly_plastic(0.2))


def test_bodies_without_a_second_end(passing, steel_between_ends) -> None:
    """Far from where the body ends the residual stress is nearly the same; a free end is free."""
    contact = passing(0.0, length=8.0, positions=5)
    least = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    plastic = perfectly_plastic(0.95 * least)
    endless = (kind(material=steel_between_ends.material) for kind in (HalfSpace, QuarterSpace))
    between, *others = (
        residual_stress(contact, body, plastic, passes=2).isel(pass_number=-1)["sigma_yy"]
        for body in (steel_between_ends, *endless)
    )
    middle = between.isel(x=2).values
    for other in others:
        assert np.abs(other.isel(x=2).values - middle).max() < 0.15 * np.abs(middle).max()
        assert float(np.abs(other).max()) > 0.02


def test_stresses_of_another_body(passing, steel_between_ends) -> None:
    contact = passing(0.0, length=8.0)
    shorter = replace(steel_between_ends, length=6.0)
    with pytest.raises(InvalidInputError, match=r"x = '.* m': must be positions in the body, from 0 to 6 m"):
        residual_stress(contact, shorter, perfectly_plastic(0.2))


def test_positions_within_rounding_of_the_end(passing, steel_between_ends) -> None:
    contact = passing(0.0, length=8.0)
    metric = contact.assign_coords(x=(1e3 * contact["x"]).assign_attrs(units="mm"))
    moved = contact.assign_coords(x=contact["x"] * (1 + 1e-15))
    least = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    material = ElasticPlastic(yield_stress=0.98 * ROOT * least, kinematic_hardening=20.0)
    plain = residual_stress(contact, steel_between_ends, material, passes=1)
    assert float(plain["plastic_flow"][0]) > 0
    for each in (metric, moved):
        found = residual_stress(each, steel_between_ends, material, passes=1)
        np.testing.assert_allclose(found["plastic_flow"], plain["plastic_flow"], rtol=1e-6)
