"""Is this number real? What a result says about itself, in words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from contactstudy.analysis.axes import axis_dimensions, single_case
from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, RUN_ATTRIBUTE, attribute
from contactstudy.analysis.short import MainNumber, ShortView, short
from contactstudy.arrays.engineering import quantity
from contactstudy.arrays.required import require

YES, CARE, NO, UNKNOWN = "yes", "with care", "no", "not known"
"""Answers, best first but for the last, which says that the result does not tell."""

LARGEST_LOAD_ERROR, LARGEST_RESIDUAL, LARGEST_VIOLATION = 1e-6, 1e-3, 1e-4
"""Relative errors of load, of free ends and of the contact's conditions that hide in no number that is given."""

SETTLED = 0.02
"""Error over the peak up to which cells count as settled: twice the default accuracy."""


class Answer(NamedTuple):
    """One question, its answer in a word, and the reason."""

    question: str
    answer: str
    reason: str


@dataclass(frozen=True)
class Certainty:
    """Answers to what makes a number trustworthy; shows itself as text.

    Examples
    --------
    >>> Certainty((Answer("Did it converge?", "yes", "in 7 steps"),))
    yes: everything that was checked holds
      Did it converge? yes: in 7 steps
    """

    answers: tuple[Answer, ...]

    @property
    def overall(self) -> str:
        """The worst of the answers that are known."""
        given = {answer.answer for answer in self.answers}
        return next((answer for answer in (NO, CARE, YES) if answer in given), UNKNOWN)

    @property
    def summary(self) -> str:
        """One sentence."""
        reason = next((each.reason for each in self.answers if each.answer == self.overall), "")
        return {
            YES: "everything that was checked holds",
            CARE: reason,
            NO: f"do not rely on it; {reason}",
            UNKNOWN: "the result does not tell",
        }[self.overall]

    def __repr__(self) -> str:
        lines = [f"  {each.question} {each.answer}: {each.reason}" for each in self.answers]
        return "\n".join([f"{self.overall}: {self.summary}", *lines])


def certainty(dataset: xr.Dataset) -> Certainty:
    """Say in words whether the numbers of a result are real: converged, in balance, ends free, cells settled.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`, a file of it, or one case selected from a study.

    Returns
    -------
    Certainty
        Prints as text. What the result does not tell is "not known". The limits of the model are not its subject.

    Raises
    ------
    InvalidInputError
        If there is more than one case.

    Examples
    --------
    >>> certainty(xr.Dataset({"converged": True, "iterations": 7})).overall
    'yes'
    """
    require(dataset)
    one = single_case(dataset).assign_attrs(dataset.attrs)
    return certainty_of(one, short(one))


def certainty_of(one: xr.Dataset, view: ShortView) -> Certainty:
    """Return what :func:`certainty` does, for one case whose main numbers are known already."""
    return Certainty(tuple(_answers(one, view)))


def _answers(one: xr.Dataset, view: ShortView) -> Iterator[Answer]:
    """Every answer; of a case of a study without a result, why there is none."""
    if "status" in one and (status := str(one["status"].item())) != "ok":
        message = str(one["message"].item()) if "message" in one else ""
        yield Answer("Is there a result?", NO, f"the case is {status}" + (f": {message}" if message else ""))
        return
    yield _converged(one)
    yield _load(one)
    yield _conditions(one)
    if "bound_error" in one:
        yield _friction(one)
    yield _ends(one)
    yield _cells(one)
    profile = attribute(one, INPUTS_ATTRIBUTE).get("case", {}).get("roller", {}).get("profile", {})
    yield from map(_measured, _of_kind(profile, "Measured"))
    if "peak_von_mises" in view:
        yield _largest_stress(one, view["peak_von_mises"])
    for text in attribute(one, RUN_ATTRIBUTE).get("warnings", []):
        yield Answer("Was there a warning?", CARE, str(text))


def _largest_stress(one: xr.Dataset, row: MainNumber) -> Answer:
    """Whether the largest stress is known: of results that state none, between the points."""
    question = "Is the largest stress known?"
    single = [] if "peak_von_mises_error" in one else _single_positions(one)
    if single:
        return Answer(question, CARE, f"stresses are known at one position along {' and '.join(single)} only")
    if np.isinf(row.error) or np.isinf(row.value) or np.isnan(row.error):
        return Answer(question, CARE, row.remark or "no error is known")
    return Answer(question, YES, row.text)


def _single_positions(one: xr.Dataset) -> list[str]:
    """Axes along which the stresses have one position, and so no largest value."""
    if "von_mises" not in one:
        return []
    return [axis for axis, dim in axis_dimensions(one["von_mises"]).items() if one.sizes[dim] == 1]


def _converged(one: xr.Dataset) -> Answer:
    """Whether the iteration met its tolerance."""
    question = "Did the iteration converge?"
    if "converged" not in one:
        return Answer(question, UNKNOWN, "the result does not say")
    steps = f" in {int(one['iterations'])} applications of the operator" if "iterations" in one else ""
    if bool(one["converged"]):
        return Answer(question, YES, f"it reached its tolerance{steps}")
    return Answer(question, NO, f"it stopped before its tolerance{steps}")


def _said(value: float) -> str:
    """Small number with one digit.

    Examples
    --------
    >>> _said(0.0), _said(2.34e-7)
    ('0', '2e-07')
    """
    return f"{value:.0e}" if value else "0"


def _number(one: xr.Dataset, name: str) -> float:
    """Size of a scalar; NaN if it is not there."""
    return abs(float(one[name])) if name in one else np.nan


def _load(one: xr.Dataset) -> Answer:
    """Whether the pressure carries the load, where it acts."""
    question, error = "Does the pressure carry the load?", _number(one, "load_error")
    if np.isnan(error):
        return Answer(question, UNKNOWN, "the result does not say")
    place = _number(one, "load_position_error")
    where = f", and acts where it should to {_said(place)} of the length" if place > 0 else ""
    good = error <= LARGEST_LOAD_ERROR and not place > LARGEST_VIOLATION
    return Answer(question, YES if good else NO, f"its resultant is the load to {_said(error)} of it{where}")


def _conditions(one: xr.Dataset) -> Answer:
    """Whether gap and pressure exclude each other."""
    question = "Do gap and pressure exclude each other?"
    overlap, opened = _number(one, "penetration_error"), _number(one, "open_pressure_error")
    if np.isnan(overlap):
        return Answer(question, UNKNOWN, "the result does not say")
    good = max(overlap, np.nan_to_num(opened)) <= LARGEST_VIOLATION
    reason = (
        f"gap or overlap under pressure is {_said(overlap)} of the displacement, pressure over a gap {_said(opened)}"
    )
    return Answer(question, YES if good else CARE, f"{reason} of the peak")


def _friction(one: xr.Dataset) -> Answer:
    """Whether stick and slip are what Coulomb's law says."""
    errors = {name: _number(one, name) for name in ("bound_error", "slip_error", "force_error") if name in one}
    said = ", ".join(f"{name.replace('_', ' ')} {_said(value)}" for name, value in errors.items())
    good = all(not value > LARGEST_RESIDUAL for value in errors.values())
    return Answer("Do stick and slip follow Coulomb's law?", YES if good else CARE, said)


def _ends(one: xr.Dataset) -> Answer:
    """Whether the free ends are free."""
    question, left = "Are the free ends free?", _number(one, "end_traction_residual")
    body = attribute(one, INPUTS_ATTRIBUTE).get("case", {}).get("body", {})
    if body.get("kind") == "HalfSpace" or (left == 0 and not body):
        return Answer(question, YES, "the body has no free end, or nothing is left on it")
    if np.isnan(left):
        return Answer(question, UNKNOWN, "the result does not say")
    if body.get("model", "exact") != "exact":
        model = body["model"]
        return Answer(
            question, CARE, f"{_said(left)} of the peak pressure is left: the model {model!r} is one for comparison"
        )
    good = left <= LARGEST_RESIDUAL
    return Answer(question, YES if good else CARE, f"{_said(left)} of the peak pressure is left on them as traction")


def _cells(one: xr.Dataset) -> Answer:
    """Whether the cells are fine enough."""
    question = "Are the cells fine enough?"
    peak, error = (float(one[name]) if name in one else np.nan for name in ("peak_pressure", "peak_pressure_error"))
    if np.isinf(peak):
        return Answer(
            question,
            CARE,
            "the pressure is singular at a sharp end inside the face: no cells give a peak, its intensity is the "
            "result; a real corner has a radius, give it to the profile",
        )
    if np.isnan(error):
        reason = "the cells were given and no error was asked for: numbers at the ends may hang on the cells"
        return Answer(question, CARE if "pressure" in one else UNKNOWN, reason)
    if np.isinf(error):
        reason = one["peak_pressure_error"].attrs.get("comment", "two grids show no limit: take finer cells")
        return Answer(question, CARE, str(reason))
    part = error / peak if peak else 0.0
    if part > SETTLED:
        return Answer(question, CARE, f"the peak is known only to {part:.1%}")
    return Answer(question, YES, f"the peak is settled to {part:.1%}")


def _of_kind(table: Any, kind: str) -> Iterator[dict[str, Any]]:
    """Yield every part of a stored profile that is of a kind."""
    if isinstance(table, dict):
        if table.get("kind") == kind:
            yield table
        table = list(table.values())
    if isinstance(table, list):
        for entry in table:
            yield from _of_kind(entry, kind)


def _measured(profile: dict[str, Any]) -> Answer:
    """Whether a measured profile is without noise, which is pressed like a shape: no cells tell it apart."""
    question, cutoff = "Is the measured profile filtered?", profile.get("cutoff")
    if cutoff is None:
        return Answer(
            question,
            CARE,
            "its points are taken as they are, so noise of a tenth of a micrometre is pressed too: give it a cutoff, "
            "and see that the peak does not hang on it",
        )
    said = f"with a cut-off of {quantity(cutoff, 'm')}; another one tells whether the peak hangs on it"
    return Answer(question, YES, said)
