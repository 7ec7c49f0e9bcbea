import numpy as np
import pytest

from contactstudy.bodies.material import Material
from contactstudy.bodies.models import HalfSpace
from contactstudy.case.motion import Shift
from contactstudy.errors import InvalidInputError
from contactstudy.study.case_setup import build_motion, build_setup
from contactstudy.study.parameters import add_default_accuracy, identity_value
from tests.small_study import BASE


def test_roller_length_determines_roller():
    case = build_setup(BASE | {"e_over_a": 2}).case
    assert case.roller.length == pytest.approx(0.5e-3)
    assert case.body.length == pytest.approx(0.5e-3 + 4 * case.hertz_half_width)
    assert case.roller_start == pytest.approx(2 * case.hertz_half_width)


def test_gamma_determines_body_length():
    values = {key: value for key, value in BASE.items() if key != "roller_length"}
    case = build_setup(values | {"gamma": 0.2, "e_over_a": 2}).case
    assert case.body.length == pytest.approx(1e-3)
    assert case.roller.length == pytest.approx(1e-3 - 4 * case.hertz_half_width)


def test_half_space_keeps_roller_and_coordinates():
    finite_case = build_setup(BASE | {"e_over_a": 2})
    half_space_case = build_setup(BASE | {"e_over_a": 2, "body": "half-space"})
    assert isinstance(half_space_case.case.body, HalfSpace)
    assert half_space_case.case.contact_range == finite_case.case.contact_range
    assert half_space_case.case.roller == finite_case.case.roller


@pytest.mark.parametrize("e_over_a", [-1.0, 0.0, 3.0])
@pytest.mark.parametrize("parameters", [{"gamma": 0.5}, {"roller_length": 2e-3}])
def test_end_distance_follows_from_load_and_e_over_a(parameters, e_over_a):
    values = {key: BASE[key] for key in ("young", "poisson", "radius")} | parameters
    case = build_setup(values | {"load": 300.0, "e_over_a": e_over_a}).case
    assert case.roller_start == pytest.approx(e_over_a * case.hertz_half_width, rel=1e-9, abs=1e-15)


def test_load_without_positive_roller_length_raises():
    values = {key: BASE[key] for key in ("young", "poisson", "radius")}
    with pytest.raises(InvalidInputError, match="load"):
        build_setup(values | {"gamma": 0.1, "load": 1e5, "e_over_a": 5})


BASE_AT_APPROACH = {key: BASE[key] for key in ("young", "poisson", "radius", "roller_length")} | {
    "approach": 1e-6,
    "accuracy": 0.01,
}


def test_approach_leaves_half_width_undefined():
    setup = build_setup(BASE_AT_APPROACH | {"end_distance": 1e-4})
    assert setup.case.approach == 1e-6
    assert np.isnan(setup.e_over_a)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"e_over_a": 1}, "e_over_a = 1.0: must be left out where the approach is prescribed; give end_distance"),
        ({"end_distance": 0, "cells_x": 4}, "cells_x = 4.0.*leave it out: columns are refined"),
        ({"end_distance": 0, "field_z_over_a": [0.0]}, "field_z_over_a = .*the solver chooses"),
        ({"end_distance": 0, "load_offset": 1e-5}, "load_offset = 1e-05.*prescribe the load instead"),
        ({"end_distance": 0, "load": 3.0}, "load, approach = .*one of the three, max_pressure, load or approach"),
    ],
)
def test_approach_refuses_parameters_over_half_width(changes, message):
    with pytest.raises(InvalidInputError, match=message):
        build_setup(BASE_AT_APPROACH | changes)


def test_stress_points_are_over_a():
    setup = build_setup(BASE | {"e_over_a": 0})
    np.testing.assert_allclose(setup.options["x"] / setup.case.hertz_half_width, [0, 1, 2])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"e_over_a": None}, "e_over_a, end_distance"),
        ({"e_over_a": 1, "end_distance": 0.0}, "e_over_a, end_distance"),
        ({"e_over_a": 1, "gamma": 2}, "gamma, roller_length"),
        ({"e_over_a": 1, "load": 2}, "max_pressure, load"),
        ({"e_over_a": 1, "young": None}, "young"),
        ({"e_over_a": 1, "radius": -1}, "radius"),
        ({"e_over_a": 1, "poisson": 0.7}, "poisson"),
        ({"e_over_a": -9}, "body length"),
        ({"e_over_a": 1, "body": "half-space", "model": "mirror"}, "no free end"),
        ({"e_over_a": 1, "field_x_over_a": [500]}, "field_x_over_a"),
        ({"e_over_a": 1, "field_z_over_a": [-1]}, "field_z_over_a"),
        ({"e_over_a": 1, "profile": {"kind": "cylinder", "fillet_radius": -1}}, "fillet_radius"),
        ({"e_over_a": 1, "profile": {"kind": "lundberg"}}, "profile"),
    ],
)
def test_impossible_parameters_raise(changes, message):
    with pytest.raises(InvalidInputError, match=message):
        build_setup(BASE | changes)


def test_amplitude_of_lundberg_profile_follows_from_design_pressure():
    table = {"kind": "lundberg", "design_pressure": 1.5e9}
    case = build_setup(BASE | {"e_over_a": 1, "profile": table}).case
    assert case.roller.profile.amplitude == pytest.approx(5e-3 * (1.5e9 / case.modulus) ** 2)


def test_case_contains_elastic_roller_tilt_and_offset():
    parameters = {**BASE, "e_over_a": 1.0, "roller_body": "finite-length", "roller_poisson": 0.25, "load_offset": 1e-5}
    case = build_setup(parameters).case
    assert case.roller.body is not None
    assert case.roller.material == Material(BASE["young"], 0.25)
    assert case.load_position == pytest.approx(case.roller_start + 0.5 * case.roller.length + 1e-5)
    assert build_setup({**BASE, "e_over_a": 1.0, "tilt": 1e-4}).case.tilt == 1e-4
    assert case.hertz_half_width > build_setup({**BASE, "e_over_a": 1.0}).case.hertz_half_width


def test_elastic_roller_defaults_to_body_material():
    case = build_setup({**BASE, "e_over_a": 1.0, "roller_body": "half-space"}).case
    assert case.roller.material == case.body.material
    assert isinstance(case.roller.body, HalfSpace)


@pytest.mark.parametrize(
    ("contradiction", "parameter"),
    [({"roller_young": 70e9}, "roller_young"), ({"roller_body": "rubber"}, "roller_body"), ({"tilt": 1.0}, "tilt")],
)
def test_contradictory_roller_parameters_raise(contradiction, parameter):
    with pytest.raises(InvalidInputError, match=parameter):
        build_setup({**BASE, "e_over_a": 1.0, **contradiction})


def test_identity_contains_default_accuracy():
    assert add_default_accuracy({"friction": 0.1}) == {"friction": 0.1, "accuracy": 0.01}
    assert add_default_accuracy({"cells_x": 4.0}) == {"cells_x": 4.0}
    assert identity_value("friction", 0.0) is None
    profile_table = {"kind": "tapered", "half_angle": 0.1}
    assert identity_value("profile", profile_table | {"name": "ours"}) == profile_table


def test_motion_parameters_make_shift():
    values = {"motion": "shift", "shift_y": 1e-6, "rolling_model": "exact"}
    assert build_motion(values) == Shift(y=1e-6)
