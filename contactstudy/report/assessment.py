"""Assessment of a result: convergence, balance, free ends, cells and errors, with a verdict."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from contactstudy.analysis import single_case
from contactstudy.analysis.axes import axis_dimensions
from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, RUN_ATTRIBUTE, attribute
from contactstudy.arrays.engineering import format_quantity
from contactstudy.arrays.variables import UNKNOWN_ERROR
from contactstudy.case.serialization import tables_within
from contactstudy.report.tables import Quantity, Summary, summary

YES, CAUTION, NO, UNKNOWN = "yes", "with care", "no", "not known"  # Answers; "not known" if a number is missing
LOAD_TOLERANCE, RESIDUAL_TOLERANCE, VIOLATION_TOLERANCE = 1e-6, 1e-3, 1e-4
"""Largest relative error of the load, residual of free ends and of Coulomb's law, and violation of the contact
conditions: each is below the digits that a summary prints."""

PEAK_TOLERANCE = 0.02  # Largest relative error of the peak pressure: twice the default accuracy

Answer = tuple[str, str]  # The answer, and the reason


class Criterion(NamedTuple):
    """A question, its answer, and the reason."""

    question: str
    answer: str
    reason: str


@dataclass(frozen=True)
class Assessment:
    """Criteria that a trustworthy result meets; prints as text."""

    criteria: tuple[Criterion, ...]

    @property
    def overall(self) -> str:
        """Worst answer of all criteria, apart from "not known"."""
        answers = {criterion.answer for criterion in self.criteria}
        return next((answer for answer in (NO, CAUTION, YES) if answer in answers), UNKNOWN)

    @property
    def verdict(self) -> str:
        """The overall answer in one sentence."""
        reason = next((criterion.reason for criterion in self.criteria if criterion.answer == self.overall), "")
        return {
            YES: "all criteria hold",
            CAUTION: reason,
            NO: f"do not rely on it; {reason}",
            UNKNOWN: "the result contains no criterion",
        }[self.overall]

    def __repr__(self) -> str:
        lines = [f"  {criterion.question} {criterion.answer}: {criterion.reason}" for criterion in self.criteria]
        return "\n".join([f"{self.overall}: {self.verdict}", *lines])


def assess(dataset: xr.Dataset) -> Assessment:
    """Assess the numbers of a result: convergence, balance, contact conditions, free ends, cells, errors.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`, its file, or one case selected from a study.

    Returns
    -------
    Assessment
        Prints as text. The limits of the model are not assessed.

    Raises
    ------
    InvalidInputError
        If the Dataset contains more than one case.

    Examples
    --------
    >>> assess(xr.Dataset({"converged": True, "iterations": 7})).overall
    'yes'
    """
    case = single_case(dataset)
    return assess_case(case, summary(case))


def assess_case(case: xr.Dataset, table: Summary) -> Assessment:
    """Return the assessment of a case, given the case's summary; for a case without a result, only the reason."""
    if "status" in case and (status := str(case["status"].item())) != "ok":
        message = str(case["message"].item()) if "message" in case else ""
        reason = f"the case is {status}" + (f": {message}" if message else "")
        return Assessment((Criterion("Is there a result?", NO, reason),))
    answers = {
        "Did the iteration converge?": _assess_convergence(case),
        "Does the pressure carry the load?": _assess_load(case),
        "Do gap and pressure exclude each other?": _assess_contact(case),
        "Do stick and slip follow Coulomb's law?": _assess_friction(case),
        "Are the free ends free?": _assess_free_ends(case),
        "Are the cells fine enough?": _assess_cells(case),
    }
    criteria = [Criterion(question, *answer) for question, answer in answers.items() if answer is not None]
    profile = attribute(case, INPUTS_ATTRIBUTE).get("case", {}).get("roller", {}).get("profile", {})
    for profile_table in tables_within(profile):
        if profile_table["kind"] == "Measured":
            criteria.append(Criterion("Is the measured profile filtered?", *_assess_profile(profile_table)))
    if "peak_von_mises" in table:
        criteria.append(Criterion("Is the largest stress known?", *_assess_peak_stress(case, table["peak_von_mises"])))
    warnings = attribute(case, RUN_ATTRIBUTE).get("warnings", [])
    criteria += [Criterion("Was there a warning?", CAUTION, str(text)) for text in warnings]
    return Assessment(tuple(criteria))


def _assess_convergence(case: xr.Dataset) -> Answer:
    """Whether the iteration met its tolerance."""
    if "converged" not in case:
        return _answer_unknown("converged")
    steps = _magnitude(case, "iterations")
    step_text = f" in {steps:.0f} applications of the operator" if np.isfinite(steps) else ""
    if bool(case["converged"]):
        return YES, f"the iteration reached its tolerance{step_text}"
    return NO, f"the iteration stopped before its tolerance{step_text}"


def _assess_load(case: xr.Dataset) -> Answer:
    """Whether the pressure is in equilibrium with the load."""
    error, position_error = _magnitude(case, "load_error"), _magnitude(case, "load_position_error")
    if np.isnan(error):
        return _answer_unknown("load_error")
    position = f", its position to {_format_digit(position_error)} of the length" if position_error > 0 else ""
    is_balanced = error <= LOAD_TOLERANCE and not position_error > VIOLATION_TOLERANCE
    return YES if is_balanced else NO, f"the resultant equals the load to {_format_digit(error)} of the load{position}"


def _assess_contact(case: xr.Dataset) -> Answer:
    """Whether gap and pressure are complementary."""
    penetration, open_pressure = _magnitude(case, "penetration_error"), _magnitude(case, "open_pressure_error")
    if np.isnan(penetration):
        return _answer_unknown("penetration_error")
    is_fulfilled = max(penetration, np.nan_to_num(open_pressure)) <= VIOLATION_TOLERANCE
    reason = (
        f"gap or overlap under pressure is {_format_digit(penetration)} of the displacement, pressure over a gap "
        f"{_format_digit(open_pressure)} of the peak"
    )
    return YES if is_fulfilled else CAUTION, reason


def _assess_friction(case: xr.Dataset) -> Answer | None:
    """Whether stick and slip obey Coulomb's law; None without their errors."""
    if "bound_error" not in case:
        return None
    errors = {name: _magnitude(case, name) for name in ("bound_error", "slip_error", "force_error") if name in case}
    reason = ", ".join(f"{name.replace('_', ' ')} {_format_digit(value)}" for name, value in errors.items())
    return CAUTION if any(value > RESIDUAL_TOLERANCE for value in errors.values()) else YES, reason


def _assess_free_ends(case: xr.Dataset) -> Answer:
    """Whether the traction on the free ends vanishes."""
    residual = _magnitude(case, "end_traction_residual")
    body = attribute(case, INPUTS_ATTRIBUTE).get("case", {}).get("body", {})
    if body.get("kind") == "HalfSpace" or (residual == 0 and not body):
        return YES, "the body has no free end, or the traction on the free end is zero"
    if np.isnan(residual):
        return _answer_unknown("end_traction_residual")
    reason = f"the traction on the free end is {_format_digit(residual)} of the peak pressure"
    if body.get("model", "exact") != "exact":
        return CAUTION, f"{reason}: the model {body['model']!r} serves comparisons only"
    return YES if residual <= RESIDUAL_TOLERANCE else CAUTION, reason


def _assess_cells(case: xr.Dataset) -> Answer:
    """Whether the cells resolve the peak pressure."""
    peak, error = (float(case.get(name, np.nan)) for name in ("peak_pressure", "peak_pressure_error"))
    if np.isinf(peak):
        return CAUTION, f"the pressure is singular at {_singular_edge(case)}: its intensity replaces the peak"
    if np.isnan(error):
        reason = "the error on the given cells was not estimated; numbers at the ends may depend on the cells"
        return CAUTION if "pressure" in case else UNKNOWN, reason
    if np.isinf(error):
        return CAUTION, case["peak_pressure_error"].attrs.get("comment", "two grids show no limit: take finer cells")
    relative_error = error / peak if peak else 0.0
    if relative_error > PEAK_TOLERANCE:
        return CAUTION, f"the error of the peak pressure is {relative_error:.1%}"
    return YES, f"the peak pressure has converged to {relative_error:.1%}"


def _singular_edge(case: xr.Dataset) -> str:
    """Name of the edge with a singular pressure, and the argument for its radius."""
    if np.isfinite(_magnitude(case, "corner_x")):
        return f"the corner x = {format_quantity(float(case['corner_x']), 'm')}; a Chamfer may have a blend_radius"
    inputs = attribute(case, INPUTS_ATTRIBUTE).get("case", {})
    start, length = inputs.get("end_distance"), inputs.get("body", {}).get("length", np.inf)
    overhangs = start is not None and (
        ("end_intensity_first" in case and start < 0)
        or ("end_intensity_last" in case and start + inputs["roller"]["length"] > length)
    )
    if overhangs:
        return "the body's sharp edge, under the roller; Case(body_edge=...) takes a radius or a chamfer"
    return "the roller's sharp end inside the face; Roller(profile=...) takes a radius or a chamfer"


def _assess_profile(profile: Mapping[str, Any]) -> Answer:
    """Whether a measured profile is filtered: the cells would resolve its noise like a shape."""
    cutoff = profile.get("cutoff")
    if cutoff is None:
        return CAUTION, (
            "its points are unfiltered, and the pressure contains their noise, even of a tenth of a micrometre: choose "
            "a cutoff such that the peak hardly depends on it"
        )
    return YES, f"the cut-off is {format_quantity(cutoff, 'm')}; a second cut-off shows its influence on the peak"


def _assess_peak_stress(case: xr.Dataset, row: Quantity) -> Answer:
    """Whether the largest von Mises stress has an error."""
    if "peak_von_mises_error" not in case and "von_mises" in case:
        single_axes = [axis for axis, dim in axis_dimensions(case["von_mises"]).items() if case.sizes[dim] == 1]
        if single_axes:
            return CAUTION, f"the stresses have one position along {' and '.join(single_axes)} only"
    if not np.isfinite(row.error) or np.isinf(row.value):
        return CAUTION, row.remark or UNKNOWN_ERROR
    return YES, row.text


def _answer_unknown(name: str) -> Answer:
    """Answer to a question on a number that the result lacks."""
    return UNKNOWN, f"the result has no {name}"


def _magnitude(case: xr.Dataset, name: str) -> float:
    """Absolute value of a scalar; NaN if the scalar is missing."""
    return abs(float(case.get(name, np.nan)))


def _format_digit(value: float) -> str:
    """Text of a number with one digit, such as '2e-07'."""
    return f"{value:.0e}" if value else "0"
