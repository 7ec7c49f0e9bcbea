"""Case of a result: stored, compared by values, independent of how the load is prescribed."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, FiniteLengthSpace, HalfSpace, InvalidInputError, Material, Roller, profiles, solve
from contactstudy.analysis import solved_case
from contactstudy.analysis.provenance import check_solved_for, with_provenance

STEEL = Material(210e9, 0.3)
CASE = Case(
    body=FiniteLengthSpace(length=0.6e-3, material=STEEL),
    roller=Roller(radius=5e-3, length=0.4e-3, profile=profiles.Lundberg(2e-7)),
    max_pressure=1.5e9,
    friction=0.05,
)


@pytest.fixture
def result() -> xr.Dataset:
    return with_provenance(xr.Dataset(), CASE, {}, {})


@pytest.mark.parametrize(
    "case",
    [
        CASE,
        CASE.body,
        replace(CASE, end_distance=0.1e-3),
        replace(CASE, max_pressure=None, load=CASE.normal_load),
    ],
)
def test_equal_case_is_accepted(result: xr.Dataset, case) -> None:
    check_solved_for(result, case)
    check_solved_for(xr.Dataset(), case)


@pytest.mark.parametrize(
    ("case", "message"),
    [
        (replace(CASE, friction=0.1), r"solved with friction = 0.05.*of the given case, friction = 0.1"),
        (replace(CASE, max_pressure=1.4e9), r"load = 61.2.*load = 53."),
        (replace(CASE, end_distance=0.0), r"end_distance = 0.0001.*end_distance = 0"),
        (replace(CASE, roller=replace(CASE.roller, radius=6e-3)), r"roller.radius = 0.005.*roller.radius = 0.006"),
        (
            replace(CASE, roller=replace(CASE.roller, profile=profiles.Lundberg(3e-7))),
            r"roller.profile = Lundberg\(amplitude=0.2 µm\).*roller.profile = Lundberg\(amplitude=0.3 µm\)",
        ),
        (FiniteLengthSpace(length=0.5e-3, material=STEEL), r"body.length = 0.0006.*of the given body"),
        (HalfSpace(material=STEEL), r"body.kind = FiniteLengthSpace.*body.kind = HalfSpace"),
    ],
)
def test_differing_case_raises(result: xr.Dataset, case, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        check_solved_for(result, case)


def test_comparison_is_limited_to_body_and_roller(result: xr.Dataset) -> None:
    check_solved_for(result, replace(CASE, friction=0.1, max_pressure=1e9), compared_names=("body", "roller"))


def test_case_of_opened_study_raises(study_dataset: xr.Dataset) -> None:
    for dataset in (study_dataset, study_dataset.isel(e_over_a=0, friction=0, body=0)):
        with pytest.raises(InvalidInputError, match=r"load_case\(folder, case_id\)"):
            solved_case(dataset)


@pytest.mark.parametrize("change", [{"max_pressure": None, "approach": 2e-6}, {"load_position": 0.31e-3}])
def test_prescribed_approach_or_position_equals_case_of_its_load(change) -> None:
    case = replace(CASE, body=HalfSpace(material=STEEL), **change)
    result = solve(case, accuracy=0.1, stresses=False)
    motion = {"load_position": None, "tilt": float(result["tilt"])} if "load_position" in change else {}
    load = {"approach": None, "max_pressure": None, "load": float(result["normal_load"])}
    prescribed_case = replace(case, **load, **motion)
    check_solved_for(result, prescribed_case)
    check_solved_for(result, case)
    with pytest.raises(InvalidInputError, match="load = "):
        check_solved_for(result, replace(prescribed_case, load=1.01 * load["load"]))


def test_joined_results_are_compared_by_swept_value(result: xr.Dataset) -> None:
    joined_dataset = xr.concat([result, result], xr.Variable("friction", [0.05, 0.1]))
    selected_dataset = joined_dataset.sel(friction=0.1)
    check_solved_for(selected_dataset, replace(CASE, friction=0.1))
    with pytest.raises(InvalidInputError, match=r"friction = 0.1.*friction = 0.05; .*drop its attribute"):
        check_solved_for(selected_dataset, CASE)


class UserProfile:
    """A user profile whose repr differs in each session."""

    def drop(self, x, length):
        return 1e-6 * np.abs(x) / length


def test_user_profiles_are_compared_by_drop() -> None:
    cases = [replace(CASE, roller=replace(CASE.roller, profile=UserProfile())) for _ in range(2)]
    assert repr(cases[0].roller.profile) != repr(cases[1].roller.profile)
    check_solved_for(with_provenance(xr.Dataset(), cases[0], {}, {}), cases[1])


def test_comparison_ignores_rounding_and_version(result: xr.Dataset) -> None:
    body = FiniteLengthSpace(length=3 * 0.1e-3, material=STEEL)
    case = Case(body=body, roller=Roller(radius=5e-3, length=0.3e-3), max_pressure=1.5e9)
    check_solved_for(with_provenance(xr.Dataset(), case, {}, {}), replace(case, end_distance=0.0))
    inputs = json.loads(result.attrs["contactstudy_inputs"])
    for table in (inputs["case"] | {"something": 1}, [1], {"kind": "Roller"}):
        newer_result = result.assign_attrs(contactstudy_inputs=json.dumps(inputs | {"case": table}))
        check_solved_for(newer_result, replace(CASE, friction=0.2))
