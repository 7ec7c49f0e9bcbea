"""Summary, assessment and citations of a result."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, FiniteLengthSpace, HalfSpace, InvalidInputError, Material, Roller, profiles, solve
from contactstudy.analysis import solved_case
from contactstudy.fields.edge_tension import edge_tension
from contactstudy.report import assess, citations, summary
from contactstudy.report.tables import case_table, describe_body, describe_material

STEEL = Material(210e9, 0.3)


@pytest.fixture(scope="module")
def singular_result() -> xr.Dataset:
    body = FiniteLengthSpace(length=0.4e-3, material=STEEL)
    case = Case(body=body, roller=Roller(radius=5e-3, length=0.25e-3), max_pressure=1.5e9)
    return solve(case, x=[0.2e-3], y=[0.0], z=[0.0, 2e-5])


def test_summary_states_error_or_missing_error(case_result: xr.Dataset) -> None:
    for name in ("peak_pressure", "contact_length", "peak_von_mises_z"):
        assert "error not estimated" in summary(case_result)[name].remark, name
        assert summary(case_result)[name].mark == "not estimated", name
    refined_result = case_result.assign(peak_pressure=1.6234e9, peak_pressure_error=0.0121e9)
    row = summary(refined_result)["peak_pressure"]
    assert (row.text, row.remark) == ("1.623 ± 0.012 GPa", "")
    assert summary(refined_result.assign(peak_pressure_error=np.inf))["peak_pressure"].remark.startswith(
        "error not estimated"
    )
    assert (
        summary(refined_result.assign(normal_load=20.0, normal_load_error=0.1))["normal_load"].text == "20.00 ± 0.10 N"
    )
    table = summary(refined_result).to_dataframe()
    assert table.loc["peak_pressure", "error"] == 0.0121e9


def test_summary_contains_reference_depth(singular_result: xr.Dataset) -> None:
    summary_table = summary(singular_result)
    assert (summary_table["reference_depth"].text, summary_table["reference_depth"].remark) == ("0.4 mm", "")
    assert summary(singular_result.assign(reference_depth=np.inf))["reference_depth"].text == "∞"
    case_at_approach = replace(solved_case(singular_result), max_pressure=None, approach=1e-6)
    assert "reference depth of approach and tilt in the body: 0.4 mm" in repr(case_table(case_at_approach))
    assert "reference depth" not in repr(case_table(solved_case(singular_result)))


def test_summary_of_motion_has_errors(case_result: xr.Dataset) -> None:
    work = xr.DataArray(2.5e-3, attrs={"units": "J/m"})
    motion_result = case_result.assign(
        force_y=1.25, force_y_error=0.02, friction_work=work, friction_work_error=2e-5, spin=0.3
    )
    summary_table = summary(motion_result.assign(load_position=1e-3, load_position_error=1e-12))
    assert (summary_table["force_y"].error, summary_table["friction_work"].error) == (0.02, 2e-5)
    assert "±" in summary_table["friction_work"].text
    # These numbers have neither an estimate nor a certificate.
    assert np.isnan(summary_table["spin"].error)
    assert np.isnan(summary_table["load_position"].error)


def test_force_below_rounding_is_zero(case_result: xr.Dataset) -> None:
    arm = float(case_result["hertz_half_width"])
    motion_result = case_result.assign(force_y=2.0, force_x=-5.7e-9, force_x_error=7e-9, moment_z=1e-9 * arm)
    summary_table = summary(motion_result)
    assert (summary_table["force_x"].text, summary_table["moment_z"].text, summary_table["force_y"].text) == (
        "0 N",
        "0 N m",
        "2 N",
    )
    assert summary_table["force_x"].remark == "rounding: below 1e-06 of the largest force"
    assert summary_table["force_x"].mark == "rounding"
    assert list(summary_table.to_dataframe().loc["force_x", ["value", "error"]]) == [-5.7e-9, 7e-9]
    # The text is 0 also for a prescribed force of zero.
    inputs_template = '{"case": {"motion": {"kind": "Rolling", "force_x": %s}}}'
    assert summary(motion_result.assign_attrs(contactstudy_inputs=inputs_template % "0.0"))["force_x"].text == "0 N"
    # Results without rounding: an error below the value or above rounding, a value above rounding, no other force,
    # a prescribed force.
    for exact_result in (
        motion_result.assign(force_x_error=1e-10),
        motion_result.assign(force_x_error=1e-3),
        motion_result.assign(force_x=3e-6, force_x_error=4e-6),
        motion_result.assign(force_y=0.0),
        motion_result.assign_attrs(contactstudy_inputs=inputs_template % "-5.7e-9"),
    ):
        row = summary(exact_result)["force_x"]
        assert "rounding" not in row.remark
        assert not row.text.startswith("0 ")


def test_summary_contains_stick_and_slip(case_result: xr.Dataset) -> None:
    in_contact = (case_result["pressure"] > 0).drop_attrs()
    tractions = {
        "traction_x": 3e7 * in_contact,
        "traction_y": 4e7 * in_contact,
        "slip_x": 0 * in_contact,
        "slip_y": 2e-3 * in_contact,
    }
    rolling_result = case_result.assign(tractions | {"stick": in_contact, "sticking_part": 0.0})
    summary_table = summary(rolling_result)
    assert (summary_table["sticking_part"].text, summary_table["sticking_part"].remark) == ("0", "error not estimated")
    assert summary_table["largest_traction"].text == "50 MPa"
    assert summary_table["largest_slip"].text == "0.002 per distance rolled"
    shift_result = rolling_result.assign(slip_y=(2e-6 * in_contact).assign_attrs(units="m"), shift_y=3e-6)
    assert summary(shift_result)["largest_slip"].text == "2 \N{MICRO SIGN}m"
    assert summary(shift_result)["shift_y"].remark == "error not estimated"
    inputs = {"contactstudy_inputs": '{"case": {"motion": {"kind": "Shift", "y": 3e-6}}}'}
    assert summary(shift_result.assign_attrs(inputs))["shift_y"].remark == ""


def test_summary_of_singular_end_has_law(singular_result: xr.Dataset) -> None:
    summary_table = summary(singular_result)
    for name in ("peak_pressure", "end_pressure_first", "peak_von_mises"):
        assert summary_table[name].text == "∞", name
        assert summary_table[name].remark.startswith("singular")
        assert summary_table[name].mark == "singular"
    assert summary_table["end_intensity_first"].mark == "law"
    assert "GPa mm^0.5" in summary_table["end_intensity_first"].text
    assessment = assess(singular_result)
    assert assessment.overall == "with care"
    assert "intensity replaces the peak" in assessment.verdict


def test_summary_of_corner_has_law(case_result: xr.Dataset) -> None:
    """A study of mixed cases has NaN for the law of an end that is not singular, and for the corner."""
    law = {"corner_x": 5e-3, "corner_slope": 0.02, "corner_intensity": 7.3e8}
    law |= {"corner_distance": 54e-6, "corner_distance_error": 1.3e-6}
    peak = {"peak_pressure": np.inf, "peak_pressure_error": np.inf}
    no_end = {"end_intensity_first": np.nan, "end_exponent_first": np.nan}
    summary_table = summary(case_result.assign(law | peak | no_end))
    assert "end_intensity_first" not in summary_table
    for name in ("peak_pressure", "peak_von_mises"):
        assert summary_table[name].remark == "singular: unbounded towards the corner at x = 5 mm"
    assert {summary_table[name].value for name in law if not name.endswith("_error")} == {5e-3, 0.02, 7.3e8, 54e-6}
    assert summary_table["corner_distance"].text == "54.0 ± 1.3 µm"
    assert summary_table["corner_x"].remark == ""
    sharp_result = case_result.assign(dict.fromkeys(law, np.nan) | peak)
    assert not {"corner_x", "corner_distance"} & set(summary(sharp_result).to_dataframe().index)
    assert summary(sharp_result)["peak_pressure"].remark == "singular: unbounded towards a sharp end"
    assert "sharp end" in assess(sharp_result).verdict


def test_assessment_depends_on_certificate(case_result: xr.Dataset) -> None:
    """Each answer changes with its number."""

    def find_answer(criterion: str, **changes: object) -> str:
        answers = assess(case_result.assign(changes)).criteria
        return next(entry.answer for entry in answers if entry.question.startswith(criterion))

    sound_case = {"peak_pressure": 1e9, "peak_pressure_error": 1e6}
    cases: dict[str, tuple[dict[str, object], dict[str, object]]] = {
        "Did the iteration": ({}, {"converged": False}),
        "Does the pressure": ({}, {"load_error": 1e-2}),
        "Do gap": ({}, {"penetration_error": 0.1}),
        "Are the free ends": ({}, {"end_traction_residual": 0.1}),
        "Are the cells": (sound_case, sound_case | {"peak_pressure_error": 1e9}),
        "Is the largest stress": ({"peak_von_mises_error": 1e7}, {"peak_von_mises_error": np.inf}),
    }
    for criterion, (good_case, bad_case) in cases.items():
        assert find_answer(criterion, **good_case) == "yes", criterion
        assert find_answer(criterion, **bad_case) in ("with care", "no"), criterion
    assert assess(case_result.assign(converged=False)).overall == "no"
    result_without_peak = case_result.drop_vars(
        [name for name in case_result.data_vars if str(name).startswith("peak_von_mises")]
    )
    single_depth_result = result_without_peak.isel(z=[2])
    assert any("one position along z only" in entry.reason for entry in assess(single_depth_result).criteria)
    assert assess(xr.Dataset({"pressure": ("x", [1.0])})).overall != "yes"


def test_unfiltered_measured_profile_needs_care() -> None:
    """The pressure converges on noise as on a crown."""
    x = np.linspace(-0.5e-3, 0.5e-3, 201)
    points = x.tolist(), (0.5 * x**2).tolist()
    for cutoff, overall_assessment in ((None, "with care"), (5e-5, "yes")):
        profile = profiles.Cylinder(fillet_radius=1e-4) + profiles.Measured(*points, cutoff=cutoff)
        roller = Roller(radius=5e-3, length=1e-3, profile=profile)
        result = solve(Case(body=HalfSpace(material=STEEL), roller=roller, load=50.0), stresses=False)
        assessment = assess(result)
        assert assessment.overall == overall_assessment, assessment
        assert any("cut" in entry.reason for entry in assessment.criteria)


def test_stored_result_contains_case(singular_result: xr.Dataset, tmp_path) -> None:
    singular_result.to_netcdf(tmp_path / "case.nc")
    with xr.open_dataset(tmp_path / "case.nc") as stored_result:
        case = solved_case(stored_result)
        assert stored_result.contact.summary()["peak_pressure"].text == "∞"
    assert case.roller == Roller(radius=5e-3, length=0.25e-3)
    assert case.body.material == STEEL
    with pytest.raises(InvalidInputError, match="contactstudy_inputs"):
        solved_case(xr.Dataset())
    with pytest.raises(InvalidInputError, match="JSON"):
        solved_case(xr.Dataset(attrs={"contactstudy_inputs": "[" * 100_000}))


def test_citations_depend_on_inputs_of_result(singular_result: xr.Dataset) -> None:
    cited_subjects = {subject for subject, _ in citations(singular_result).entries}
    assert {"free ends", "contact iteration", "stresses"} <= cited_subjects
    assert "stick and slip" not in cited_subjects
    profile = profiles.Lundberg(2e-7) + profiles.Cylinder(1e-5)
    case = Case(
        body=HalfSpace(material=STEEL), roller=Roller(radius=5e-3, length=0.3e-3, profile=profile), max_pressure=1e9
    )
    cited_subjects = {subject for subject, _ in citations(solve(case, stresses=False)).entries}
    assert "profile Lundberg" in cited_subjects
    assert not {"free ends", "stresses"} & cited_subjects


def test_citations_depend_on_inputs_of_study() -> None:
    base = {"model": "mirror-factor", "profile": {"kind": "measured", "cutoff": 1e-4}}
    study = {"base": base, "sweep": {"body": ["half-space", "quarter-space"]}, "zip": [{"model": ["exact"]}]}
    cited_subjects = {
        subject for subject, _ in citations(xr.Dataset(attrs={"contactstudy_study": json.dumps(study)})).entries
    }
    assert {"free ends", "mirror factor", "profile Measured", "filter of the measured profile"} <= cited_subjects
    half_space_study = {"base": {"body": "half-space"}, "cases": [{"profile": "lundberg"}], "sweep": {}}
    cited_subjects = {
        subject
        for subject, _ in citations(xr.Dataset(attrs={"contactstudy_study": json.dumps(half_space_study)})).entries
    }
    assert "profile Lundberg" in cited_subjects
    assert "free ends" not in cited_subjects
    elastic_study = half_space_study | {"sweep": {"roller_body": ["rigid", "finite-length"]}}
    assert "free ends" in {
        subject for subject, _ in citations(xr.Dataset(attrs={"contactstudy_study": json.dumps(elastic_study)})).entries
    }


def test_assessment_of_failed_case_has_message() -> None:
    failed_case = xr.Dataset({"status": "failed", "message": "WindowError: too wide", "converged": np.nan})
    assessment = assess(failed_case.assign(iterations=np.nan))
    assert assessment.overall == "no"
    assert "the case is failed: WindowError: too wide" in repr(assessment)
    assert len(assessment.criteria) == 1


def test_prescribed_approach_is_exact(case_result: xr.Dataset) -> None:
    assert case_result.contact.summary()["approach"].remark == "error not estimated"
    case = Case(body=HalfSpace(material=STEEL), roller=Roller(radius=5e-3, length=0.3e-3), approach=2e-6)
    assert solve(case, stresses=False, accuracy=0.1).contact.summary()["approach"].remark == ""


def test_summary_contains_edge_tension() -> None:
    roller = Roller(radius=5e-3, length=0.5e-3, profile=profiles.Cylinder(1e-4))
    case = Case(body=HalfSpace(material=STEEL), roller=roller, max_pressure=1e9, friction=0.2)
    result = solve(case, y=[0.0], z=[0.0], accuracy=0.05)
    row = summary(result)["peak_edge_tension"]
    assert row.value == pytest.approx(float(edge_tension(result)["edge_tension"].max()), rel=1e-7)
    assert 0 < row.error < 0.5 * row.value
    assert row.remark.startswith("x = ")
    frictionless = solve(replace(case, friction=0.0), y=[0.0], z=[0.0], accuracy=0.05)
    assert "peak_edge_tension" not in summary(frictionless)


def test_texts_of_intensity_material_and_body_have_units() -> None:
    law = xr.Dataset({"end_intensity_first": 4.5e6, "end_exponent_first": 0.5})
    assert summary(law)["end_intensity_first"].text == "0.1423 GPa mm^0.5"
    assert describe_material(STEEL) == "E = 210 GPa, Poisson's ratio 0.3"
    assert describe_body(FiniteLengthSpace(length=16e-3, material=STEEL)) == "two free ends, 16 mm apart"
