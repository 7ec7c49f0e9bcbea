"""Where a result comes from: the case that was solved, with what settings, by what, when, and in which time.

Both stand in attributes of the Dataset as JSON, so that they are in every file that it is written to.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from typing import Any

import xarray as xr

from contactstudy.arrays.required import require
from contactstudy.bodies.models import Body
from contactstudy.case.case import Case
from contactstudy.case.stored import case_from, case_table, table_of
from contactstudy.errors import InvalidInputError
from contactstudy.versions import versions

INPUTS_ATTRIBUTE, RUN_ATTRIBUTE = "contactstudy_inputs", "contactstudy_run"
"""What was solved; and by what, when and how long. The files of a study have the second one, too."""

SAME = 1e-9
"""Part by which two numbers may differ and be the same: load and pressure follow from one another. Accuracy."""

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
        If the Dataset does not say it: one that was computed from a result, or solved before results said it; or a
        case of an opened study, whose own file says it.

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
        One that says nothing of its case is taken as it is.
    given : Case or Body
        What was given beside it.
    argument : str
        Name of the result among the arguments, for the message.
    only : tuple of str
        Parts of the case that have to agree. Default: all.

    Raises
    ------
    InvalidInputError
        With the values that differ.
    """
    stored = attribute(result, INPUTS_ATTRIBUTE).get("case")
    if stored is None:
        return
    solved = case_from(stored)
    pair = [_compared(each) for each in ((solved, given) if isinstance(given, Case) else (solved.body, given))]
    names = [
        name
        for name in {**pair[0], **pair[1]}
        if (not only or name.split(".")[0] in only) and not _same(pair[0].get(name), pair[1].get(name))
    ]
    if names:
        found, wanted = (", ".join(_said(name, each.get(name)) for name in names[:MOST_SHOWN]) for each in pair)
        what = "case" if isinstance(given, Case) else "body"
        raise InvalidInputError(argument, f"solved with {found}", f"a result of the {what} that is given, {wanted}")


def _compared(part: Case | Body) -> dict[str, Any]:
    """Values of a case or a body by name, the same for the same contact however it was prescribed."""
    if not isinstance(part, Case):
        return dict(_leaves({"body": table_of(part)}))
    table = case_table(part) | {"end_distance": part.roller_start}
    if part.approach is None:
        table |= {"load": part.normal_load, "max_pressure": part.hertz_max_pressure}
    return dict(_leaves(table))


def _leaves(entry: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Yield what a table holds, with dotted names."""
    if isinstance(entry, Mapping):
        for key, value in entry.items():
            yield from _leaves(value, f"{name}.{key}" if name else str(key))
    elif isinstance(entry, (list, tuple)):
        for number, value in enumerate(entry):
            yield from _leaves(value, f"{name}.{number}")
    else:
        yield name, entry


def _said(name: str, value: Any) -> str:
    """Return a value with its name."""
    return f"{name} = {value:.6g}" if isinstance(value, float) else f"{name} = {value}"


def _same(one: Any, other: Any) -> bool:
    """Whether two values are the same but for rounding."""
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=SAME)
    return bool(one == other)
