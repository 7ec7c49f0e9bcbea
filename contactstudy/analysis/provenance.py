"""Provenance of a result: solved case, settings, versions, date and times, as JSON in attributes of the Dataset."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from numbers import Real
from operator import attrgetter
from typing import Any

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.variables import require
from contactstudy.bodies.models import Body
from contactstudy.case.case import Case
from contactstudy.case.serialization import from_dict, to_dict
from contactstudy.errors import InvalidInputError
from contactstudy.versions import versions

# Attributes: case and settings; versions, date and times, also in files of a study; definition of a study
INPUTS_ATTRIBUTE, RUN_ATTRIBUTE, STUDY_ATTRIBUTE = "contactstudy_inputs", "contactstudy_run", "contactstudy_study"
# Largest differences of equal numbers, relative and in SI: a solved load is accurate to the iteration's tolerance
RELATIVE_TOLERANCE, ABSOLUTE_TOLERANCE = 1e-6, 1e-15
# Values of a case that follow from the solution unless the case prescribes them
DEPENDENT_INPUTS = ("approach", "load_position", "load", "tilt")
# Values of a case without influence on its dry contact
FILM_ONLY = ("motion.body_speed", "motion.roller_speed", "motion.speed", "lubricant")
CASE_PARTS = ("roller.profile", "friction", "motion")  # Parts of a case that a message contains as a whole
# Types of entries in the attributes of inputs and run
ATTRIBUTE_TYPES: dict[str, type | tuple[type, ...]] = {
    **dict.fromkeys(("seconds", "accuracy", "tolerance"), Real),
    **dict.fromkeys(("stages", "settings", "case", "body", "roller", "motion", "profile"), dict),
    "time": str,
    "warnings": list,
}


def with_provenance(
    result: xr.Dataset, case: Case, settings: Mapping[str, Any], stages: Mapping[str, float]
) -> xr.Dataset:
    """Return a result with case, settings, versions and seconds of each stage in its attributes."""
    timestamp = datetime.now(UTC).isoformat(timespec="seconds")
    rounded_seconds = {name: round(seconds, 4) for name, seconds in stages.items()}
    inputs = {"case": to_dict(case), "settings": dict(settings)}
    run = {**versions(), "time": timestamp, "seconds": round(sum(stages.values()), 4), "stages": rounded_seconds}
    return result.assign_attrs({INPUTS_ATTRIBUTE: json.dumps(inputs), RUN_ATTRIBUTE: json.dumps(run)})


def attribute(dataset: xr.Dataset, name: str) -> dict[str, Any]:
    """Return the table in an attribute of a Dataset, without entries of a wrong type; empty without the attribute."""
    try:
        table = checks.read_tables(dataset.attrs.get(name, "{}"))
    except (TypeError, ValueError):
        raise InvalidInputError(f"attribute {name}", str(dataset.attrs[name])[:60], "JSON") from None
    if not isinstance(table, dict):
        return {}
    return _drop_invalid_entries(table) if name in (INPUTS_ATTRIBUTE, RUN_ATTRIBUTE) else table


def study_title(study: Mapping[str, Any], name: str) -> str:
    """Return name and description of a study; `name` is the default."""
    title = str(study.get("name", name))
    return f"{title}: {study['description']}" if study.get("description") else title


def _drop_invalid_entries(table: dict[str, Any]) -> dict[str, Any]:
    """Return a table and its nested tables without entries of a wrong type."""
    invalid = {name for name, kind in ATTRIBUTE_TYPES.items() if name in table and not isinstance(table[name], kind)}
    return {
        name: _drop_invalid_entries(value) if name in ("settings", "case", "roller") else value
        for name, value in table.items()
        if name not in invalid
    }


def solved_case(dataset: xr.Dataset) -> Case:
    """Return the case of a result, from the result alone.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`, or its file reopened with xarray.

    Returns
    -------
    Case
        Equal to the solved case. A profile from outside the package is piecewise linear.

    Raises
    ------
    InvalidInputError
        If the Dataset lacks the inputs, as a case of an opened study does, see :func:`contactstudy.study.load_case`.

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
    if "case" in inputs:
        return from_dict(inputs["case"], Case)
    hint = "load the case with contactstudy.study.load_case(folder, case_id)" if "case_id" in dataset else ""
    allowed = f"a result of solve, with the attribute {INPUTS_ATTRIBUTE}"
    raise InvalidInputError("dataset", sorted(map(str, dataset.attrs)), allowed, hint)


def check_solved_for(
    result: xr.Dataset, case_or_body: Case | Body, argument: str = "result", *, compared_names: tuple[str, ...] = ()
) -> None:
    """Raise if the case (or body) of a result differs from the given case (or body), by default in any value."""
    try:
        stored_case = from_dict(attribute(result, INPUTS_ATTRIBUTE)["case"], Case)
    except (InvalidInputError, KeyError, TypeError):
        return
    if isinstance(case_or_body, Case):
        # Scalars of the result prevail: unlike the attributes, they follow a selection from joined results.
        variables = {"load": "normal_load", "tilt": "tilt", "friction": "friction"}
        scalars = {
            name: float(result[variable])
            for name, variable in variables.items()
            if variable in result and result[variable].ndim == 0 and np.isfinite(result[variable])
        }
        actual, expected = _comparable_values(stored_case) | scalars, _comparable_values(case_or_body)
    else:
        actual, expected = (dict(_leaves({"body": to_dict(body)})) for body in (stored_case.body, case_or_body))
    names = [
        name
        for name in {**actual, **expected}
        if (not compared_names or name.startswith(compared_names))
        and not _are_equal(actual.get(name), expected.get(name))
        and not (name in DEPENDENT_INPUTS and None in (actual.get(name), expected.get(name)))
        and not name.startswith(FILM_ONLY)
    ]
    if names:
        kind = "case" if isinstance(case_or_body, Case) else "body"
        raise InvalidInputError(
            argument,
            f"solved with {_describe_values(actual, stored_case, names)}",
            f"a result of the given {kind}, {_describe_values(expected, case_or_body, names)}",
            f"if the Dataset was joined or changed, drop its attribute {INPUTS_ATTRIBUTE}",
        )


def _comparable_values(case: Case) -> dict[str, Any]:
    """Values of a case by name; cases with equal contacts have equal values, however the contacts are prescribed."""
    values = dict(_leaves(to_dict(case))) | {"end_distance": case.roller_start}
    for name in ("load", "max_pressure"):
        values.pop(name, None)
    if case.approach is None:
        values |= {"load": case.normal_load}
    if case.load_position is not None:
        values.pop("tilt")
    return values


def _leaves(entry: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the values of a table with dotted names, without the name of a sampled profile."""
    if isinstance(entry, Mapping):
        for key, value in entry.items():
            if (entry.get("kind"), key) != ("Sampled", "label"):
                yield from _leaves(value, f"{name}.{key}" if name else str(key))
    elif isinstance(entry, (list, tuple)):
        for index, value in enumerate(entry):
            yield from _leaves(value, f"{name}.{index}")
    else:
        yield name, entry


def _describe_values(values: Mapping[str, Any], case_or_body: Case | Body, names: list[str]) -> str:
    """Text of the first three named values, or of the part of the case that contains a value."""
    texts: dict[str, str] = {}
    for name in names:
        case_part = next((prefix for prefix in CASE_PARTS if name.startswith(prefix)), name)
        value = values.get(name) if name == case_part else attrgetter(case_part)(case_or_body)
        texts[case_part] = f"{case_part} = {value:.6g}" if isinstance(value, float) else f"{case_part} = {value}"
    return ", ".join(list(texts.values())[:3])


def _are_equal(value: Any, expected: Any) -> bool:
    """Whether two values are equal within rounding."""
    if isinstance(value, float) and isinstance(expected, float):
        return math.isclose(value, expected, rel_tol=RELATIVE_TOLERANCE, abs_tol=ABSOLUTE_TOLERANCE)
    return bool(value == expected)
