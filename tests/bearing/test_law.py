"""The contact law against Hertz' point contact and direct solutions, and its inverse."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, HalfSpace, InvalidInputError, Material, Roller, profiles, solve
from contactstudy.bearing import ContactLaw, contact_law
from contactstudy.bearing.tabulation import ContactSolver

STEEL = Material(210e9, 0.3)
RADIUS = 5e-3


@pytest.fixture(scope="module")
def ball_law() -> ContactLaw:
    """A roller with equal radii of crown and circumference, on a half-space."""
    roller = Roller(radius=RADIUS, length=0.8e-3, profile=profiles.FullCrown(crown_radius=RADIUS))
    case = Case(body=HalfSpace(material=STEEL), roller=roller, load=60.0)
    return contact_law(case, 1e-2 * np.linspace(-1, 1, 5), 1e-6 * np.geomspace(0.5, 4, 5), accuracy=0.1)


@pytest.mark.parametrize("tilt", [0.0, 3e-3, -9e-3])
@pytest.mark.parametrize("approach", [0.7e-6, 3e-6])
def test_law_of_ball_equals_hertz(ball_law: ContactLaw, approach: float, tilt: float) -> None:
    """A tilted ball of radius R touches at R theta; the depth of first touch grows by R theta**2 / 2."""
    depth = approach + 0.5 * RADIUS * tilt**2
    modulus = STEEL.plane_strain_modulus
    load, stiffness = 4 / 3 * modulus * np.sqrt(RADIUS) * depth**1.5, 2 * modulus * np.sqrt(RADIUS * depth)
    motion = ball_law.at(approach, tilt)
    assert float(motion.normal_load) == pytest.approx(load, rel=5e-3)
    assert float(motion.moment) == pytest.approx(load * RADIUS * tilt, rel=5e-3, abs=2e-3 * load * 0.1e-3)
    assert float(motion.normal_stiffness) == pytest.approx(stiffness, rel=0.01)
    assert float(motion.coupling_stiffness) == pytest.approx(
        stiffness * RADIUS * tilt, rel=0.03, abs=0.01 * stiffness * 0.1e-3
    )
    assert float(motion.tilting_stiffness) == pytest.approx(load * RADIUS + stiffness * (RADIUS * tilt) ** 2, rel=0.03)


def test_load_of_ball_grows_with_power_three_halves(ball_law: ContactLaw) -> None:
    loads = ball_law.at([1e-6, 2e-6]).normal_load.values
    assert np.log2(loads[1] / loads[0]) == pytest.approx(1.5, abs=0.01)


@pytest.mark.slow
@pytest.mark.parametrize(("load", "tilt"), [(75.0, 6e-4), (95.0, -1.3e-3), (120.0, 2e-4)])
def test_errors_cover_difference_from_direct_solutions(
    short_case: Case, short_law: ContactLaw, load: float, tilt: float
) -> None:
    direct_result = solve(replace(short_case, load=load, tilt=tilt), stresses=False, accuracy=0.02)
    motion = short_law.at(float(direct_result.approach), tilt)
    moment = load * (float(direct_result.load_position) - 0.25e-3)
    assert abs(float(motion.normal_load) - load) < float(motion.normal_load_error) < 0.02 * load
    assert abs(float(motion.moment) - moment) < float(motion.moment_error) < 0.02 * load * 0.5e-3


def test_stiffness_equals_differences_of_direct_solutions(short_case: Case, short_law: ContactLaw) -> None:
    """The stiffness matrix of direct solutions is symmetric although they contain no energy."""
    solver, delta, theta = ContactSolver(short_case, 0.1, 1e-7), 1.6e-6, 6e-4
    load = float(short_law.at(delta, theta).normal_load)
    step, tilt_step = 0.03 * delta, 6e-5
    upper_loads, lower_loads = (solver.solve_at_approach(delta + sign * step, theta, load) for sign in (1, -1))
    upper_tilt_loads, lower_tilt_loads = (
        solver.solve_at_approach(delta, theta + sign * tilt_step, load) for sign in (1, -1)
    )
    normal_stiffness, load_coupling, _ = (upper_loads - lower_loads) / (2 * step)
    moment_coupling, tilting_stiffness, _ = (upper_tilt_loads - lower_tilt_loads) / (2 * tilt_step)
    assert load_coupling == pytest.approx(moment_coupling, rel=0.03)
    motion = short_law.at(delta, theta)
    assert float(motion.normal_stiffness) == pytest.approx(normal_stiffness, rel=0.02)
    assert float(motion.coupling_stiffness) == pytest.approx(0.5 * (load_coupling + moment_coupling), rel=0.05)
    assert float(motion.tilting_stiffness) == pytest.approx(tilting_stiffness, rel=0.04)


def test_inverse_returns_approach_and_tilt(short_law: ContactLaw) -> None:
    approach, tilt = 1e-6 * np.array([1.1, 2.0, 2.9]), 1e-3 * np.array([-1.4, 0.0, 0.7])
    contact = short_law.at(approach, tilt)
    assert dict(contact.sizes) == {"approach": 3, "tilt": 3}
    motion = short_law.under(contact.normal_load, contact.moment)
    np.testing.assert_allclose(motion["normal_load"], contact["normal_load"], rtol=1e-6)
    np.testing.assert_allclose(motion["normal_stiffness"], contact["normal_stiffness"], rtol=1e-4)
    single_motion = short_law.under(float(contact.normal_load[1, 2]), float(contact.moment[1, 2]))
    assert float(single_motion.approach) == pytest.approx(2.0e-6, rel=1e-5)
    assert float(single_motion.tilt) == pytest.approx(0.7e-3, rel=1e-4)


def test_mirrored_tilts_have_equal_loads(short_law: ContactLaw) -> None:
    tilted_contact, mirrored_contact = short_law.at([1.2e-6, 2.5e-6], 9e-4), short_law.at([1.2e-6, 2.5e-6], -9e-4)
    np.testing.assert_allclose(tilted_contact.normal_load, mirrored_contact.normal_load, rtol=1e-9)
    np.testing.assert_allclose(tilted_contact.moment, -mirrored_contact.moment, rtol=1e-9)


def test_reopened_law_is_identical(short_law: ContactLaw, tmp_path) -> None:
    short_law.table.to_netcdf(tmp_path / "law.nc")
    with xr.open_dataset(tmp_path / "law.nc") as table:
        reopened_law = ContactLaw(table.load())
    assert reopened_law.at(1.7e-6, 3e-4).equals(short_law.at(1.7e-6, 3e-4))
    assert float(table.reference_depth) == np.inf
    assert "reference_depth" in table.approach.attrs["comment"]
    assert repr(reopened_law) == repr(short_law)
    assert "reference depth ∞" in repr(reopened_law)
    assert "mrad" in repr(reopened_law)


def test_variables_of_the_law_have_units(short_law: ContactLaw) -> None:
    for motion in (short_law.table, short_law.at(2e-6, 1e-4), short_law.under(80.0)):
        assert all(variable.attrs["units"] for variable in motion.variables.values())


def test_default_approaches_include_case_load(short_case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    recorded_arguments = {}

    def record_nodes(solver, approaches, tilts):
        recorded_arguments["approaches"] = approaches
        raise InvalidInputError("stop", 0, "here")

    monkeypatch.setattr("contactstudy.bearing.tabulation.solve_nodes", record_nodes)
    with pytest.raises(InvalidInputError, match="stop"):
        contact_law(short_case, np.linspace(-1e-3, 1e-3, 5), accuracy=0.1)
    approach_at_load = float(solve(short_case, stresses=False, accuracy=0.1).approach)
    assert recorded_arguments["approaches"][0] < 0.1 * approach_at_load
    assert approach_at_load < recorded_arguments["approaches"][-1] < 1.6 * approach_at_load
    assert recorded_arguments["approaches"].size == 8


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda law: law.at(0.5e-6), "approach = 5e-07: must be in the table, from 1e-06"),
        (lambda law: law.at(2e-6, 2e-3), r"tilt = 0.002: must be in the table, from -0.0015 to 0.0015 rad"),
        (lambda law: law.at("deep"), "approach = 'deep'"),
        (lambda law: law.under(1e4), "normal_load, moment = .*larger approaches or tilts"),
        (lambda law: law.under(100.0, 0.05), "normal_load, moment = "),
        (lambda law: ContactLaw(law.table.drop_vars("strain_energy")), "strain_energy"),
        (lambda law: ContactLaw(law.table.isel(tilt=slice(3))), "5 or more along tilt"),
    ],
)
def test_values_outside_the_table_are_rejected(short_law: ContactLaw, call, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        call(short_law)


TILTS = [-1e-3, -5e-4, 0.0, 5e-4, 1e-3]


@pytest.mark.parametrize(
    ("changes", "tilts", "approaches", "message"),
    [
        ({"tilt": 1e-3}, TILTS, None, "case.tilt"),
        ({"load_position": 3e-4}, TILTS, None, "case.load_position"),
        ({"friction": 0.1, "coupled": True}, TILTS, None, "case.coupled"),
        ({}, [-1e-3, 0.0, 1e-3], None, "tilts = .*5 or more increasing"),
        ({}, [0.0, -1.0, 2.0, 3.0, 4.0], None, "tilts"),
        ({}, [-2.0, -1.0, 0.0, 1.0, 2.0], None, "small angles"),
        ({}, TILTS, [-1e-6, 1e-6, 2e-6, 3e-6, 4e-6], "approaches"),
    ],
)
def test_invalid_argument_raises(short_case: Case, changes, tilts, approaches, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        contact_law(replace(short_case, **changes), tilts, approaches)


def test_zero_load_is_rejected(ball_law: ContactLaw) -> None:
    with pytest.raises(InvalidInputError, match=r"normal_load = 0.0"):
        ball_law.under(0.0)


def test_labelled_arguments_are_aligned_and_converted(ball_law: ContactLaw) -> None:
    loads = xr.DataArray([0.03, 0.06], {"roller": [1, 2]}, "roller", attrs={"units": "kN"})
    motion = ball_law.under(loads, xr.zeros_like(loads).assign_attrs(units="N m"))
    np.testing.assert_allclose(motion.approach, ball_law.under([30.0, 60.0]).approach)
    roller_tilts = xr.DataArray([1e-4, -1e-4], {"roller": [2, 1]}, "roller")
    np.testing.assert_allclose(
        ball_law.at(xr.DataArray([1e-6, 2e-6], {"roller": [1, 2]}, "roller"), roller_tilts).tilt, roller_tilts[::-1]
    )
    with pytest.raises(InvalidInputError, match=r"roller = \[1, 2\] and \[2, 3\].*same labels along roller"):
        ball_law.under(loads, xr.DataArray([0.0, 0.0], {"roller": [2, 3]}, "roller"))
    with pytest.raises(InvalidInputError, match="as many values along each common dimension"):
        ball_law.under(loads, xr.DataArray([0.0, 0.0, 0.0], dims="roller"))


def test_errors_of_inverse_equal_change_under_load_errors(ball_law: ContactLaw) -> None:
    motion = ball_law.under(60.0, 1e-4)
    load_error, moment_error = float(motion.normal_load_error), float(motion.moment_error)
    perturbed_motions = [
        ball_law.under(60.0 + 1e-3 * load_sign * load_error, 1e-4 + 1e-3 * moment_sign * moment_error)
        for load_sign in (-1, 1)
        for moment_sign in (-1, 1)
    ]
    for name in ("approach", "tilt"):
        max_change = max(abs(float(perturbed_motion[name] - motion[name])) for perturbed_motion in perturbed_motions)
        assert 1e-3 * float(motion[f"{name}_error"]) == pytest.approx(max_change, rel=0.02)
        assert motion[f"{name}_error"].attrs["units"] == ("m" if name == "approach" else "rad")
    assert motion.normal_stiffness.attrs["error_kind"] == "not estimated"
    assert "comment" not in motion.approach_error.attrs
