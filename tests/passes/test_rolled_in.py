"""Passes over elastic-plastic bodies: shakedown from both sides, an independent integration, balance."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import xarray as xr

from contactstudy import HalfSpace, InvalidInputError, QuarterSpace, fatigue
from contactstudy.arrays.variables import STRESSES
from contactstudy.passes import ElasticPlastic, residual_stress, rolled_in
from contactstudy.passes.rolled_in import STRAINS

ROOT = np.sqrt(3.0)


def perfectly_plastic(shear_yield_stress: float) -> ElasticPlastic:
    return ElasticPlastic(yield_stress=ROOT * shear_yield_stress)


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_flow_stops_below_the_limit_and_goes_on_above(passing, steel_half_space, friction: float) -> None:
    contact = passing(friction)
    least = float(fatigue.shakedown(contact, axial=True)["shakedown_stress"].max())
    below = rolled_in(contact, steel_half_space, perfectly_plastic(1.02 * least), passes=6)
    assert float(below["plastic_flow"][0]) > 0
    assert float(below["plastic_flow"][-1]) < 1e-3 * float(below["plastic_flow"][0])
    assert below["flow_contained"].all()
    if friction:  # the flow yz goes forward, and nothing holds it
        with pytest.raises(InvalidInputError, match="strains stay below"):
            rolled_in(contact, steel_half_space, perfectly_plastic(0.98 * least), passes=6)
    else:  # it goes to and fro
        above = rolled_in(contact, steel_half_space, perfectly_plastic(0.98 * least), passes=6)
        assert float(above["plastic_flow"][-1]) > 0.5 * float(above["plastic_flow"][0])
        assert not above["flow_contained"].any()


def test_flow_goes_round_above_the_limit_with_hardening(passing, steel_half_space) -> None:
    """Alternating shear of +-0.25 p0 at half the half-width flows to and fro in every pass: plastic shakedown."""
    contact = passing()
    least = float(fatigue.shakedown(contact, axial=True)["shakedown_stress"].max())
    above = ElasticPlastic(yield_stress=0.98 * ROOT * least, kinematic_hardening=5.0)
    flow = rolled_in(contact, steel_half_space, above, passes=5)["plastic_flow"]
    assert flow.sizes["pass_number"] == 5
    assert float(flow[4]) == pytest.approx(float(flow[3]), rel=1e-2)
    assert float(flow[4]) > 0.1 * float(flow[0])


def test_between_free_ends(passing, steel_between_ends) -> None:
    """Shear decides as in a half-space; below the limit residual stress along x has built up between the ends."""
    contact = passing(0.0, length=8.0)
    least = float(fatigue.shakedown(contact.isel(x=[4]), axial=True)["shakedown_stress"].max())
    alone = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    assert least < 0.9 * alone
    below = rolled_in(contact, steel_between_ends, perfectly_plastic(1.03 * least), passes=8)
    assert float(below["plastic_flow"][-1]) < 2e-3 * float(below["plastic_flow"][0])
    assert below["flow_contained"].all()
    above = ElasticPlastic(yield_stress=0.97 * ROOT * least, kinematic_hardening=5.0)
    flow = rolled_in(contact, steel_between_ends, above, passes=4)["plastic_flow"]
    assert float(flow[3]) == pytest.approx(float(flow[2]), rel=3e-2)
    last = below.isel(pass_number=-1)
    assert float(last["sigma_xx"].isel(x=4).min()) < -0.1
    # It has no resultant on a plane, whatever the half-space would say.
    heights = np.gradient(last["z"].values)
    carried = np.abs(last["sigma_xx"].isel(x=4).values) @ heights
    assert abs(last["sigma_xx"].isel(x=4).values @ heights) < 0.5 * carried


def test_what_is_left_keeps_the_passing_contact_from_yielding(passing, steel_between_ends) -> None:
    contact = passing(0.1, length=8.0)
    least = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    plastic = perfectly_plastic(0.97 * least)
    last = rolled_in(contact, steel_between_ends, plastic, passes=10).isel(pass_number=-1)
    total = contact + last[list(STRESSES)].drop_vars("pass_number")
    again = fatigue.shakedown(total)
    assert float(again["first_yield_stress"].max()) < 0.97 * least * (1 + 1e-3)
    assert float(fatigue.shakedown(contact)["first_yield_stress"].max()) > 1.05 * 0.97 * least


def test_residual_stress_is_that_of_the_plastic_strain(passing, steel_between_ends) -> None:
    contact = passing(0.1, length=8.0)
    least = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    last = rolled_in(contact, steel_between_ends, perfectly_plastic(0.97 * least), passes=3).isel(pass_number=-1)
    direct = residual_stress(steel_between_ends, last[list(STRAINS)].drop_vars("pass_number"))
    for name in ("sigma_xx", "sigma_yy"):
        assert np.abs(last[name].values - direct[name].values).max() < 0.1 * np.abs(direct[name].values).max()
    assert np.allclose(last["residual_displacement_z"], direct["residual_displacement_z"], rtol=0.05, atol=1e-6)
    trace = last["plastic_strain_xx"] + last["plastic_strain_yy"] + last["plastic_strain_zz"]
    assert np.abs(trace).max() < 1e-9 * np.abs(last["plastic_strain_yy"]).max()


def integrated(history: np.ndarray, radius: float, hardening: float, passes: int, parts: int) -> np.ndarray:
    """Residual stresses xx and yy of one layer, by the rate equations of Prandtl and Reuss in many small steps."""
    young, nu = 1000.0, 0.3
    modulus = young / (1 - nu**2)
    strain = np.zeros(6)

    def left(plastic: np.ndarray) -> np.ndarray:
        xx, yy = modulus * (plastic[0] + nu * plastic[1]), modulus * (plastic[1] + nu * plastic[0])
        return -np.array([xx, yy, 0, young / (1 + nu) * plastic[3], 0, 0])

    twice = np.array([1, 1, 1, 2, 2, 2.0])
    for _ in range(passes):
        for before, after in pairwise(history):
            for part in range(parts):
                stress = before + (part + 1) / parts * (after - before) + left(strain)
                dev = stress - np.array([1, 1, 1, 0, 0, 0]) * stress[:3].mean() - 2 / 3 * hardening * strain
                size = np.sqrt((twice * dev**2).sum())
                if size > radius:
                    # The stress is brought back along the normal, in a body that answers to its flow by `left`.
                    normal = dev / size
                    answer = -(twice * normal * left(normal)).sum() + 2 / 3 * hardening
                    strain = strain + (size - radius) / answer * normal
    return left(strain)[:2]


@pytest.mark.parametrize(("friction", "part", "hardening"), [(0.0, 0.9, 0.0), (0.0, 0.95, 20.0), (0.2, 0.97, 10.0)])
def test_against_rate_equations(passing, steel_half_space, friction: float, part: float, hardening: float) -> None:
    contact = passing(friction)
    least = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    plastic = ElasticPlastic(yield_stress=ROOT * part * least, kinematic_hardening=hardening)
    found = rolled_in(contact, steel_half_space, plastic, passes=3, substeps=12).isel(pass_number=-1, x=0)
    decisive = int(np.abs(found["sigma_yy"].values).argmax())
    history = np.stack([contact[name].isel(x=0, z=decisive).values[::-1] for name in STRESSES], axis=1)
    history = np.concatenate([history, np.zeros((1, 6))])
    expected = integrated(history, np.sqrt(2) * part * least, hardening, int(found["pass_number"]), 40)
    computed = [float(found[name][decisive]) for name in ("sigma_xx", "sigma_yy")]
    assert np.abs(expected).max() > 0.01
    assert computed == pytest.approx(expected, abs=0.01 * np.abs(expected).max())


def test_isotropic_hardening_shakes_down_at_once(passing, steel_half_space) -> None:
    contact = passing(0.2)
    least = float(fatigue.shakedown(contact, axial=True)["shakedown_stress"].max())
    harder = ElasticPlastic(yield_stress=0.9 * ROOT * least, isotropic_hardening=20.0)
    flow = rolled_in(contact, steel_half_space, harder, passes=8)["plastic_flow"]
    assert float(flow[-1]) < 1e-2 * float(flow[0])


def test_friction_drags_the_top_forwards(passing, steel_half_space) -> None:
    contact = passing(0.2)
    first = float(fatigue.shakedown(contact)["first_yield_stress"].max())
    plastic = ElasticPlastic(yield_stress=0.9 * ROOT * first, kinematic_hardening=20.0)
    found = rolled_in(contact, steel_half_space, plastic, passes=3).isel(pass_number=-1)
    backwards = contact.assign_coords(y=-contact["y"]) * xr.Dataset(
        {name: -1.0 if name in ("tau_xy", "tau_yz") else 1.0 for name in STRESSES}
    )
    other = rolled_in(backwards.sortby("y"), steel_half_space, plastic, passes=3).isel(pass_number=-1)
    assert float(found["residual_displacement_y"][0]) != 0
    # The contact that pushes the other way, seen in a mirror, is passed in the other order: it leaves something else.
    assert not np.allclose(found["plastic_strain_yz"], -other["plastic_strain_yz"], rtol=1e-3, atol=1e-7)


def test_yield_stress_over_depth(passing, steel_half_space) -> None:
    """Only where the material is soft does it flow."""
    contact = passing()
    case = xr.DataArray([1.0, 1.0, 0.4, 0.4], {"z": [0.0, 0.9, 0.95, 2.0]}, "z")
    found = rolled_in(contact, steel_half_space, ElasticPlastic(yield_stress=case), passes=2)
    flowed = found["equivalent_plastic_strain"].isel(pass_number=-1, x=0)
    assert float(flowed.sel(z=slice(0, 0.9)).max()) == 0
    assert float(flowed.sel(z=slice(0.95, None)).max()) > 0


def test_nothing_flows_below_first_yield(passing, steel_half_space) -> None:
    contact = passing()
    first = float(fatigue.shakedown(contact)["first_yield_stress"].max())
    found = rolled_in(contact, steel_half_space, perfectly_plastic(1.001 * first))
    assert found.sizes["pass_number"] == 1
    assert float(abs(found[list(STRESSES)]).to_array().max()) == 0


def test_fatigue_takes_the_residual_stress_in(passing, steel_half_space) -> None:
    """Pressure that stays lowers Findley's normal stress."""
    contact = passing()
    least = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    left = rolled_in(contact, steel_half_space, perfectly_plastic(0.95 * least), passes=3).isel(pass_number=-1)
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
        rolled_in(passing(), **arguments)


def test_positions_have_to_reach_to_the_ends(passing, steel_between_ends) -> None:
    contact = passing(0.0, length=8.0)
    for part in (contact.isel(x=slice(0, 6)), contact.isel(z=slice(4, None)), contact.isel(x=slice(3, None))):
        with pytest.raises(InvalidInputError, match="reach to"):
            rolled_in(part, steel_between_ends, perfectly_plastic(0.2))


@pytest.mark.parametrize("kind", [HalfSpace, QuarterSpace])
def test_bodies_without_a_second_end(passing, steel_between_ends, kind) -> None:
    """Far from where the body ends the residual stress is nearly the same; a free end is free."""
    contact = passing(0.0, length=8.0)
    least = float(fatigue.shakedown(contact)["shakedown_stress"].max())
    plastic = perfectly_plastic(0.95 * least)
    bodies = kind(material=steel_between_ends.material), steel_between_ends
    here, between = (rolled_in(contact, body, plastic, passes=2).isel(pass_number=-1) for body in bodies)
    middle = [one["sigma_yy"].isel(x=4).values for one in (here, between)]
    assert np.abs(np.subtract(*middle)).max() < 0.15 * np.abs(middle[1]).max()
    assert float(np.abs(here["sigma_yy"]).max()) > 0.02
