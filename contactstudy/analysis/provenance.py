"""Where a result comes from: the case that was solved, with what settings, by what, when, and in which time.

Both stand in attributes of the Dataset as JSON, so that they are in every file that it is written to.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

import xarray as xr

from contactstudy.arrays.required import require
from contactstudy.case.case import Case
from contactstudy.case.stored import case_from, case_table
from contactstudy.errors import InvalidInputError
from contactstudy.versions import versions

INPUTS_ATTRIBUTE, RUN_ATTRIBUTE = "contactstudy_inputs", "contactstudy_run"
"""What was solved; and by what, when and how long. The files of a study have the second one, too."""


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
        If the Dataset does not say it: one that was computed from a result, or solved before results said it.

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
        raise InvalidInputError(
            "dataset", sorted(map(str, dataset.attrs)), f"a result of solve, with the attribute {INPUTS_ATTRIBUTE}"
        )
    return case_from(inputs["case"])
