"""The slice model of ISO/TS 16281: equilibrium, limits, comparison with the contact solver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import Case, FiniteLengthSpace, HalfSpace, InvalidInputError, Material, Roller, solve
from contactstudy.arrays.variables import ERROR_KIND, NOT_ESTIMATED
from contactstudy.bearing.laminae import slice_model
from contactstudy.profiles import Cylinder, FullCrown, IsoCylindrical, Lundberg, Tapered

STEEL_ON_STEEL = Material(young=207e9 / 2, poisson=0.3)
"""A body whose contact modulus against a rigid roller equals the modulus of two bodies of steel."""
BODY = HalfSpace(material=STEEL_ON_STEEL)
ROLLER = Roller(radius=5e-3, length=10e-3)
CASE = Case(body=BODY, roller=ROLLER, load=5000.0)


def sum_slice_loads(result) -> float:
    step = float(result["x"][1] - result["x"][0])
    return float(result["load_per_length"].sum()) * step


@given(
    load=st.floats(1.0, 1e5),
    tilt=st.floats(-5e-3, 5e-3),
    slices=st.integers(2, 200),
    profile=st.sampled_from([Cylinder(), Lundberg(1e-6), FullCrown(2.0), IsoCylindrical(10e-3), Tapered(0.05)]),
)
def test_slice_loads_sum_to_load(load: float, tilt: float, slices: int, profile) -> None:
    result = slice_model(Case(body=BODY, roller=replace(ROLLER, profile=profile), load=load), slices=slices, tilt=tilt)
    assert sum_slice_loads(result) == pytest.approx(load, rel=1e-9)
    assert result.sizes == {"x": slices}
    assert float(result["load_per_length"].min()) >= 0


def test_slice_loads_equal_standard_in_millimetres() -> None:
    """The deflection and the drop in the standard apply to two contacts of steel in series."""
    case = replace(CASE, roller=replace(ROLLER, profile=IsoCylindrical(10e-3)))
    result = slice_model(case, slices=40, tilt=1e-4)
    position_mm = 1e3 * (result["x"].values - 5e-3)
    drop_mm = 0.00035 * 10 * np.log(1 / (1 - (2 * position_mm / 10) ** 2))
    # two contacts: twice the approach, and twice the angle between roller and raceway
    deflection_mm = np.maximum(2 * 1e3 * float(result["approach"]) + 2e-4 * position_mm - 2 * drop_mm, 0)
    slice_loads = 35948 * 10 ** (8 / 9) / 40 * deflection_mm ** (10 / 9)
    np.testing.assert_allclose(result["load_per_length"], slice_loads / 0.25e-3, rtol=1e-6)


def test_slices_of_straight_roller_have_hertz_pressure() -> None:
    result = slice_model(CASE)
    np.testing.assert_allclose(result["load_per_length"], 5e5, rtol=1e-12)
    np.testing.assert_allclose(result["pressure"], CASE.hertz_max_pressure, rtol=1e-12)
    np.testing.assert_allclose(result["half_width"], CASE.hertz_half_width, rtol=1e-12)


def test_approach_grows_with_the_power_nine_tenths() -> None:
    approaches = [float(slice_model(replace(CASE, load=load))["approach"]) for load in (100.0, 3200.0)]
    assert approaches[1] / approaches[0] == pytest.approx(32**0.9)


def test_approach_is_independent_of_slices() -> None:
    case = replace(CASE, roller=replace(ROLLER, profile=FullCrown(2.0)))
    coarse_model, fine_model = (slice_model(case, slices=slices, tilt=1e-4) for slices in (60, 600))
    assert float(coarse_model["approach"]) == pytest.approx(float(fine_model["approach"]), rel=1e-4)


@given(st.floats(1e-6, 5e-3))
def test_opposite_tilts_mirror_slice_loads(tilt: float) -> None:
    tilted_model, mirrored_model = slice_model(CASE, tilt=tilt), slice_model(CASE, tilt=-tilt)
    assert (np.diff(tilted_model["load_per_length"]) >= 0).all()
    assert float(tilted_model["load_per_length"][-1]) > 5e5
    np.testing.assert_allclose(
        tilted_model["load_per_length"], mirrored_model["load_per_length"][::-1], rtol=1e-9, atol=1e-6
    )


def test_edge_factor_equals_standard() -> None:
    model_without_riser, model_with_riser = slice_model(CASE, slices=30), slice_model(CASE, slices=30, edge_riser=True)
    factor = model_without_riser["edge_factor"].values
    np.testing.assert_allclose(factor, factor[::-1])
    assert factor[0] == pytest.approx(1 - 0.01 / np.log(1.985 / 2))
    assert factor[0] == pytest.approx(2.328, abs=1e-3)
    assert 1.0 < factor[14] < 1.004
    np.testing.assert_allclose(model_with_riser["pressure"], model_without_riser["pressure"] * np.sqrt(factor))
    np.testing.assert_array_equal(model_with_riser["load_per_length"], model_without_riser["load_per_length"])
    assert slice_model(CASE, slices=31)["edge_factor"][15] == 1.0


def test_errors_of_the_slice_model_are_not_estimated() -> None:
    result = slice_model(CASE, edge_riser=True)
    assert all(array.attrs[ERROR_KIND] == NOT_ESTIMATED for name, array in result.items() if name != "normal_load")


def test_overhanging_roller_has_slices_over_the_body() -> None:
    body = FiniteLengthSpace(length=10e-3, material=STEEL_ON_STEEL)
    result = slice_model(replace(CASE, body=body, end_distance=-2e-3), slices=40)
    assert float(result["x"][0]) == pytest.approx(0.1e-3)
    assert float(result["x"][-1]) == pytest.approx(7.9e-3)


def test_pressure_of_taper_is_larger_at_thin_end() -> None:
    result = slice_model(replace(CASE, roller=replace(ROLLER, profile=Tapered(0.1))))
    assert float(result["pressure"][0]) > 1.1 * float(result["pressure"][-1])


def test_slice_model_of_crowned_roller_approximates_solved_contact(steel_case: Case) -> None:
    """Approach and mid-length pressure are within 8 % of the solved contact; the end pressure is a fifth too low."""
    contact_result, model = solve(steel_case, stresses=False), slice_model(steel_case, slices=40)
    assert float(model["approach"]) == pytest.approx(float(contact_result["approach"]), rel=0.08)
    section_maxima = contact_result["pressure"].max("y")
    assert float(model["pressure"].interp(x=2e-3)) == pytest.approx(float(section_maxima.interp(x=2e-3)), rel=0.05)
    assert float(model["pressure"][0]) < 0.85 * float(section_maxima.interp(x=float(model["x"][0])))


@pytest.fixture(scope="module")
def steel_case() -> Case:
    roller = Roller(radius=5e-3, length=4e-3, profile=FullCrown(5.0))
    return Case(body=HalfSpace(material=Material(210e9, 0.3)), roller=roller, max_pressure=1.5e9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: slice_model("case"), "case = 'case'"),
        (lambda: slice_model(CASE, slices=1), "slices = 1: must be a whole number not below 2"),
        (lambda: slice_model(CASE, slices=30.0), "slices = 30.0"),
        (lambda: slice_model(CASE, tilt=1.0), "tilt = 1.0: must be a small angle.*degrees"),
        (lambda: slice_model(CASE, tilt=np.nan), "tilt = nan"),
        (lambda: slice_model(CASE, edge_riser="yes"), "edge_riser = 'yes'"),
    ],
)
def test_invalid_argument_raises(call, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        call()


def test_default_tilt_is_that_of_the_case() -> None:
    tilted = slice_model(replace(CASE, tilt=1e-3))
    np.testing.assert_array_equal(tilted["pressure"], slice_model(CASE, tilt=1e-3)["pressure"])
    assert tilted.attrs["tilt"] == 1e-3
    assert float(slice_model(replace(CASE, tilt=1e-3), tilt=0.0)["pressure"].std()) < 1.0
    with pytest.raises(InvalidInputError, match="load_position"):
        slice_model(replace(CASE, load_position=4e-3))
