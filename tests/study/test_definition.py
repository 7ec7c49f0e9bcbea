import json
from dataclasses import replace

import numpy as np
import pytest

from contactstudy.errors import InvalidInputError
from contactstudy.study import Study, StudyFileError
from tests.small_study import BASE, case_id, format_toml, small_study


def list_ids(study):
    return [case.id for case in study.plan()]


def test_product_in_stable_order():
    plan = small_study().plan()
    assert plan.cube.dims == ("e_over_a", "friction")
    assert [case.position for case in plan] == [(0, 0), (0, 1), (1, 0), (1, 1)]
    assert plan[1].id == case_id(BASE | {"e_over_a": 0, "friction": 0.1})


def test_toml_equals_python_study(tmp_path):
    study = small_study(sweep={"e_over_a": [0, 1], "profile": ["cylinder"]})
    path = tmp_path / "small.toml"
    path.write_text(
        format_toml(small_study(sweep={"e_over_a": [0, 1]})) + '[[sweep.profile]]\nname = "sharp"\nkind = "cylinder"\n'
    )
    assert list_ids(Study.from_toml(path)) == list_ids(study)


def test_json_round_trip():
    study = small_study(
        zip=[{"max_pressure": [1e9, 2e9], "poisson": [0.2, 0.3]}],
        exclude=[{"profile": "sharp"}, {"friction": 0.1, "e_over_a": [0]}],
        sweep={
            "e_over_a": np.array([0, 1]),
            "profile": [{"kind": "cylinder", "name": "sharp"}, "cylinder"],
            "friction": (0.0, 0.1),
        },
    )
    restored_study = Study.from_mapping(json.loads(study.to_json()))
    assert restored_study.to_json() == study.to_json()
    assert list_ids(restored_study) == list_ids(study)


def test_zip_makes_single_dimension():
    plan = small_study(zip={"max_pressure": [1e9, 2e9], "poisson": [0.3, 0.3]}).plan()
    assert plan.cube.dims == ("e_over_a", "friction", "max_pressure")
    assert plan.cube.labels["poisson"] == ("max_pressure", [0.3, 0.3])


def test_zip_without_distinct_values_is_numbered():
    plan = small_study(sweep={}, zip={"max_pressure": [1e9, 1e9, 2e9], "e_over_a": [0, 1, 1]}).plan()
    assert plan.cube.dims == ("max_pressure_and_e_over_a",)


def test_complete_explicit_cases_form_cube():
    cases = [{"e_over_a": end_distance, "friction": friction} for end_distance in (0, 1) for friction in (0, 0.1)]
    assert list_ids(small_study(sweep={}, cases=cases)) == list_ids(small_study())
    assert small_study(sweep={}, cases=cases).plan().cube.dims == ("e_over_a", "friction")


def test_sparse_explicit_cases_are_listed():
    cases = [
        {
            "e_over_a": case_index,
            "friction": case_index / 10,
            "poisson": case_index / 20,
            "max_pressure": (1 + case_index) * 1e9,
        }
        for case_index in range(5)
    ]
    cube = small_study(sweep={}, cases=cases).plan().cube
    assert cube.dims == ("case",)
    assert cube.labels["poisson"][0] == "case"


def test_explicit_cases_extend_product():
    plan = small_study(cases=[{"e_over_a": 2, "friction": 0}]).plan()
    assert plan.cube.shape == (3, 2)
    assert len(plan) == 5


def test_excluded_combinations():
    plan = small_study(exclude=[{"e_over_a": [1], "friction": 0.1}]).plan()
    assert [case.position for case in plan] == [(0, 0), (0, 1), (1, 0)]


def test_exclusion_by_default_value():
    plan = small_study(
        sweep={"e_over_a": [0, 1]}, exclude=[{"coupled": False, "e_over_a": 1, "body": "finite-length"}]
    ).plan()
    assert len(plan) == 1


def test_impossible_combinations_are_skipped():
    plan = small_study(sweep={"e_over_a": [0, -9]}).plan()
    assert [bool(case.reason) for case in plan] == [False, True]
    assert "body length" in plan.reason(plan.skipped[0])
    assert len(plan.unique) == 1


def test_duplicate_case_is_solved_once():
    plan = small_study(sweep={}, cases=[{"e_over_a": 1}, {"e_over_a": 1.0}]).plan()
    assert (len(plan), len(plan.unique)) == (2, 1)


def test_study_without_sweep_has_single_case():
    plan = small_study(sweep={}, base=BASE | {"e_over_a": 0}).plan()
    assert plan.cube.dims == ("case",)
    assert plan[0].position == (0,)


@pytest.mark.parametrize(
    ("content", "hint"),
    [
        ({"sweep": {"frictoin": [0]}}, "friction"),
        ({"base": {"yuong": 1.0}}, "young"),
        ({"sweep": {"body": ["half-spce"]}}, "half-space"),
        ({"sweep": {"profile": [{"kind": "cylindre"}]}}, "cylinder"),
        ({"sweep": {"profile": [{"kind": "cylinder", "fillet": 1}]}}, "fillet_radius"),
        ({"level": "field"}, "fields"),
        ({"base": {"field_x_over_a": {"start": 0, "stop": 1, "cuont": 3}}}, "count"),
        ({"exclude": [{"e_over_b": 1}]}, "e_over_a"),
    ],
)
def test_unknown_name_error_contains_closest_name(content, hint):
    with pytest.raises(InvalidInputError, match=f"did you mean '{hint}'"):
        small_study(**content)


def test_missing_file_appears_once_in_message(tmp_path):
    with pytest.raises(StudyFileError) as error:
        Study.from_toml(tmp_path / "nowhere.toml")
    assert str(error.value).count("nowhere.toml") == 1


def test_unknown_file_key_raises(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text("[bsae]\nyoung = 1.0\n")
    with pytest.raises(InvalidInputError, match="did you mean 'base'"):
        Study.from_toml(path)


@pytest.mark.parametrize(
    "content",
    [
        {"sweep": {"friction": 0.1}},
        {"sweep": {"friction": []}},
        {"sweep": {"friction": [0.1, 0.1]}},
        {"sweep": {"friction": ["a"]}},
        {"sweep": [1]},
        {"zip": {"friction": [0.1], "e_over_a": [1, 2]}},
        {"zip": {"e_over_a": [1, 2]}},
        {"cases": [3]},
        {"exclude": [{}]},
        {"name": "../elsewhere"},
        {"base": {"coupled": 1}},
    ],
)
def test_invalid_content_raises(content):
    with pytest.raises(InvalidInputError):
        small_study(**({"name": "small"} | content))


@pytest.mark.parametrize("text", ["a = ", "\x00"])
def test_invalid_toml_raises(tmp_path, text):
    path = tmp_path / "s.toml"
    path.write_text(text)
    with pytest.raises(StudyFileError, match=r"s\.toml"):
        Study.from_toml(path)
    with pytest.raises(StudyFileError, match="no_such"):
        Study.from_toml(tmp_path / "no_such.toml")


def test_evenly_spaced_numbers_are_swept():
    sweep = {"e_over_a": [0.0], "friction": {"start": 0.0, "stop": 0.1, "count": 3}}
    study = small_study(sweep=sweep)
    assert study.sweep["friction"] == [0.0, 0.05, 0.1]
    with pytest.raises(InvalidInputError, match="or for numbers a table with start, stop and count"):
        small_study(sweep={"friction": {"start": 0.0}})
    with pytest.raises(InvalidInputError, match=r"sweep.friction.count = 100000000"):
        small_study(sweep={"friction": {"start": 0.0, "stop": 0.1, "count": 100_000_000}})


def test_exclusion_without_effect_is_reported():
    plan = small_study(exclude=[{"e_over_a": [1, 7], "friction": 0.1}]).plan()
    assert plan.unknown == ("exclude.e_over_a = 7.0: no case has this value, so it excludes nothing",)
    assert not small_study(exclude=[{"e_over_a": [1], "friction": 0.1}]).plan().unknown


def test_default_uniform_cells_contradict_accuracy():
    plan = small_study(base={**small_study().base, "cells_x": 8, "accuracy": 0.02}).plan()
    assert all("must be given as one of the two, accuracy or uniform cells" in case.reason for case in plan)


def test_exclusion_keeps_remaining_cases():
    sweep, cases = {"friction": [0.0, 0.1]}, [{"cells_x": 12}]
    full_study = small_study(sweep=sweep, cases=cases, base={**small_study().base, "e_over_a": 0.0, "cells_x": None})
    reduced_study = replace(full_study, exclude=[{"friction": 0.1, "cells_x": 12}])
    remaining_cases = {case.id: case.parameters for case in reduced_study.plan()}
    assert remaining_cases.items() <= {case.id: case.parameters for case in full_study.plan()}.items()
    assert reduced_study.plan()[0].parameters == full_study.plan()[0].parameters


@pytest.mark.parametrize(
    ("missing", "message"),
    [
        ("young", "such that cases have young; give it in base, sweep, zip or cases"),
        ("poisson", "have poisson;"),
        ("radius", "have radius;"),
        ("roller_length", "have one of gamma, roller_length;"),
        ("max_pressure", "have one of max_pressure, load, approach;"),
    ],
)
def test_study_without_required_parameter_raises(missing, message):
    base = {name: value for name, value in small_study().base.items() if name != missing}
    with pytest.raises(InvalidInputError, match=message):
        small_study(base=base)
    value = small_study().base[missing]
    other_sweep = {"e_over_a": [0.0, 1.0]}
    for arguments in (
        {"sweep": other_sweep | {missing: [value]}},
        {"sweep": other_sweep, "zip": {missing: [value]}},
        {"sweep": other_sweep, "cases": [{missing: value}]},
    ):
        assert small_study(base=base, **arguments).size
    assert len(small_study(base=base, sweep={}, cases=[{missing: value, "e_over_a": 0.0}]).plan().unique) == 1


def test_message_lists_all_missing_parameters():
    with pytest.raises(InvalidInputError, match=r"young; poisson; radius; .*one of e_over_a, end_distance; one of max"):
        Study(name="nothing")
