import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from contactstudy.errors import InvalidInputError
from contactstudy.profiles import Cylinder
from contactstudy.study import parameters
from contactstudy.study.profile_tables import MIN_MAGNITUDE, check_number
from tests.small_study import case_id


@pytest.mark.parametrize("value", [1, 1.0, np.int64(1), np.float32(1), np.float64(1), 1 + 1e-14])
def test_equivalent_parameters_have_same_identity(value):
    assert case_id({"e_over_a": value}) == case_id({"e_over_a": 1})


@given(st.floats(-1e12, 1e12))
def test_identity_rounds_to_twelve_digits(value):
    assume(value == 0 or abs(value) >= MIN_MAGNITUDE)
    assert case_id({"friction": value}) == case_id({"friction": float(f"{value:.12g}")})


def test_different_values_have_different_identity():
    assert case_id({"e_over_a": 1}) != case_id({"e_over_a": 1.000001})


def test_identity_ignores_order_defaults_and_profile_names():
    parameters = {"friction": 0.1, "e_over_a": 1, "profile": {"kind": "cylinder", "fillet_radius": 1e-4}}
    equal_parameters = {
        "coupled": False,
        "body": "finite-length",
        "profile": {"name": "rounded", "fillet_radius": 1e-4, "kind": "cylinder"},
        "e_over_a": 1,
        "friction": 0.1,
    }
    assert case_id(parameters) == case_id(equal_parameters)
    assert case_id(parameters) == case_id(parameters | {"profile": Cylinder(1e-4)})


def test_range_and_list_have_same_identity():
    point_range = {"start": 0, "stop": 1, "count": 3}
    assert case_id({"field_z_over_a": point_range}) == case_id({"field_z_over_a": [0, 0.5, 1]})


def test_new_default_parameter_keeps_identities(monkeypatch):
    stored_identity = "6c02e5292dae80f3"
    assert case_id({"friction": 0.1})[:16] == stored_identity
    new_parameter = parameters.Parameter(
        name="roughness", check=check_number, units="1", meaning="added later", fallback=3.0
    )
    monkeypatch.setitem(parameters.PARAMETERS, "roughness", new_parameter)
    monkeypatch.setitem(parameters.DEFAULTS, "roughness", new_parameter.default)
    assert case_id({"friction": 0.1})[:16] == stored_identity
    assert case_id({"friction": 0.1, "roughness": 3})[:16] == stored_identity
    assert case_id({"friction": 0.1, "roughness": 4})[:16] != stored_identity


def test_identity_never_changes():
    """Results on disk depend on this value; if it must change, SCHEMA must change."""
    assert case_id({"friction": 0.1, "e_over_a": 2})[:16] == "d6d0687246844912"


@pytest.mark.parametrize("value", [float("nan"), float("inf"), "much", True, None.__class__])
def test_non_numeric_values_raise(value):
    with pytest.raises(InvalidInputError, match="friction"):
        case_id({"friction": value})
