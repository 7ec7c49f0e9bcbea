"""Where a result comes from: the case that was solved, with what settings, by what, when, and in which time.

Both stand in attributes of the Dataset as JSON, so that they are in every file that it is written to.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from operator import attrgetter
from typing import Any

import numpy as np
import xarray as xr

from contactstudy.arrays.required import require
from contactstudy.bodies.models import Body
from contactstudy.case.case import Case
from contactstudy.case.stored import case_from, case_table, table_of
from contactstudy.errors import InvalidInputError
from contactstudy.versions import versions

INPUTS_ATTRIBUTE, RUN_ATTRIBUTE = "contactstudy_inputs", "contactstudy_run"
STUDY_ATTRIBUTE = "contactstudy_study"
"""What was solved; and by what, when and how long. The files of a study have the second one, too."""

SAME, NOTHING = 1e-6, 1e-15
"""Part, and size in SI, by which two numbers may differ and be the same: a load that was found carries its tolerance.
Accuracy."""

FOLLOWING = ("approach", "load_position", "load", "tilt")
"""Values of a case of which some follow from the others and the solution."""

WHOLE = ("roller.profile", "friction", "motion")
"""Parts that a message names as a whole."""

MOST_SHOWN = 3
"""Values that a message names."""


def with_provenance(
    result: xr.Dataset, case: Case, settings: Mapping[str, Any], stages: Mapping[str, float]
) -> xr.Dataset:
    """Return a result with what was solved, and how.

    Parameters
    ----------
    result : Dataset
        What `solve` returns.
    case : Case
        What it solved.
    settings : mapping
        Arguments beside the case, as plain values.
    stages : mapping
        Seconds of each stage.
    """
    now = datetime.now(UTC).isoformat(timespec="seconds")
    rounded = {name: round(seconds, 4) for name, seconds in stages.items()}
    inputs = {"case": case_table(case), "settings": dict(settings)}
    run = {**versions(), "time": now, "seconds": round(sum(stages.values()), 4), "stages": rounded}
    return result.assign_attrs({INPUTS_ATTRIBUTE: json.dumps(inputs), RUN_ATTRIBUTE: json.dumps(run)})


def attribute(dataset: xr.Dataset, name: str) -> dict[str, Any]:
    """Table in an attribute of a Dataset; empty if there is none.

    Examples
    --------
    >>> attribute(xr.Dataset(attrs={"contactstudy_run": '{"seconds": 1.0}'}), "contactstudy_run")
    {'seconds': 1.0}
    """
    try:
        found = json.loads(dataset.attrs.get(name, "{}"))
    except (TypeError, ValueError):
        raise InvalidInputError(f"attribute {name}", str(dataset.attrs[name])[:60], "JSON, as it was written") from None
    return found if isinstance(found, dict) else {}


def solved_case(dataset: xr.Dataset) -> Case:
    """Case that a result was solved for, from the result alone.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`, or its file reopened with xarray.

    Returns
    -------
    Case
        Equal to the one that was solved. A profile that is not of this package is the one at some points, with lines
        between.

    Raises
    ------
    InvalidInputError
        If the Dataset does not say it: one that was computed from a result, or solved before results said it, or a
        case selected from an opened study. For the latter the message names the file that says it.

    Examples
    --------
    >>> from contactstudy import Case, HalfSpace, Material, Roller, solve
    >>> body = HalfSpace(material=Material(210e9, 0.3))
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.2e-3), max_pressure=1.5e9)
    >>> solved_case(solve(case, stresses=False)) == case
    True
    """
    require(dataset)
    inputs = attribute(dataset, INPUTS_ATTRIBUTE)
    if "case" not in inputs:
        wanted = f"a result of solve, with the attribute {INPUTS_ATTRIBUTE}"
        raise InvalidInputError("dataset", sorted(map(str, dataset.attrs)), wanted, _where_else(dataset))
    return case_from(inputs["case"])


def _where_else(dataset: xr.Dataset) -> str:
    """Return the advice where the case stands that a part of an opened study was solved for."""
    if "case_id" not in dataset:
        return ""
    named = f", {dataset['case_id'].item()[:8]}..." if dataset["case_id"].ndim == 0 else ""
    return f"each case's own file in the study's folder, under cases, says it: its name begins as case_id does{named}"


def check_solved_for(
    result: xr.Dataset, given: Case | Body, argument: str = "result", *, only: tuple[str, ...] = ()
) -> None:
    """Raise if a result says that it was solved for another case, or in another body, than the one given.

    Parameters
    ----------
    result : Dataset
        One that says nothing of its case, or says it in the words of another version, is taken as it is.
    given : Case or Body
        What was given beside it.
    argument : str
        Name of the result among the arguments, for the message.
    only : tuple of str
        Parts of the case that have to agree, such as "roller". Default: all.

    Raises
    ------
    InvalidInputError
        With what differs.
    """
    try:
        solved = case_from(attribute(result, INPUTS_ATTRIBUTE)["case"])
    except (InvalidInputError, KeyError, TypeError):
        return
    if isinstance(given, Case):
        known, wanted = _compared(solved) | _found(result), _compared(given)
    else:
        known, wanted = (dict(_leaves({"body": table_of(each)})) for each in (solved.body, given))
    names = [
        name
        for name in {**known, **wanted}
        if (not only or any(name.startswith(part) for part in only))
        and not _same(known.get(name), wanted.get(name))
        # What the other one does not prescribe follows from the solution.
        and not (name in FOLLOWING and None in (known.get(name), wanted.get(name)))
    ]
    if names:
        what = "case" if isinstance(given, Case) else "body"
        shown = (", ".join(_in_words(*each, names)) for each in ((known, solved), (wanted, given)))
        raise InvalidInputError(
            argument,
            f"solved with {next(shown)}",
            f"a result of the {what} that is given, {next(shown)}",
            f"if the Dataset was joined or changed, drop its attribute {INPUTS_ATTRIBUTE}",
        )


def _compared(case: Case) -> dict[str, Any]:
    """Values of a case by name, the same for the same contact however it was prescribed."""
    values = dict(_leaves(case_table(case))) | {"end_distance": case.roller_start}
    for name in ("load", "max_pressure"):
        values.pop(name, None)
    if case.approach is None:
        values |= {"load": case.normal_load}
    if case.load_position is not None:
        values.pop("tilt")
    return values


def _found(result: xr.Dataset) -> dict[str, float]:
    """Values that a result has as numbers, which follow a selection from joined results: attributes do not."""
    named = {"load": "normal_load", "tilt": "tilt", "friction": "friction"}
    return {
        name: float(result[variable])
        for name, variable in named.items()
        if variable in result and result[variable].ndim == 0 and np.isfinite(result[variable])
    }


def _leaves(entry: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Yield what a table holds, with dotted names; not how a profile calls itself."""
    if isinstance(entry, Mapping):
        for key, value in entry.items():
            if (entry.get("kind"), key) != ("Sampled", "says"):
                yield from _leaves(value, f"{name}.{key}" if name else str(key))
    elif isinstance(entry, (list, tuple)):
        for number, value in enumerate(entry):
            yield from _leaves(value, f"{name}.{number}")
    else:
        yield name, entry


def _in_words(values: Mapping[str, Any], part: Case | Body, names: list[str]) -> list[str]:
    """Say the values of these names, whole parts of a case as they call themselves."""
    said: dict[str, str] = {}
    for name in names:
        whole = next((each for each in WHOLE if name.startswith(each)), name)
        value = values.get(name) if name == whole else attrgetter(whole)(part)
        said[whole] = f"{whole} = {value:.6g}" if isinstance(value, float) else f"{whole} = {value}"
    return list(said.values())[:MOST_SHOWN]


def _same(one: Any, other: Any) -> bool:
    """Whether two values are the same but for rounding."""
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=SAME, abs_tol=NOTHING)
    return bool(one == other)
