"""A table of parameters as a study: a labelled Dataset, or a part of a study that was opened."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.provenance import STUDY_ATTRIBUTE
from contactstudy.errors import InvalidInputError
from contactstudy.study.parameter import points
from contactstudy.study.parameters import PARAMETERS
from contactstudy.unit_sizes import factor_to

if TYPE_CHECKING:
    from contactstudy.study.definition import Study


def is_opened(table: xr.Dataset) -> bool:
    """Whether a Dataset is an opened study, or a selection of one."""
    allowed = "an xarray.Dataset of parameters, such as a pandas table's .to_xarray(), or an opened study"
    checks.instance("table", table, xr.Dataset, allowed)
    return STUDY_ATTRIBUTE in table.attrs and "case_id" in table


def content_of_table(table: xr.Dataset, base: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a study whose cases are the entries of a table."""
    columns = {str(name): _column(str(name), array) for name, array in table.variables.items() if _said(table, name)}
    shared = {name: _plain(array.values[()]) for name, array in columns.items() if not array.dims}
    for name in {*base} & {*columns}:
        raise InvalidInputError("base", name, "a parameter that the table does not have")
    content: dict[str, Any] = {"base": {**base, **{name: value for name, value in shared.items() if value is not None}}}
    if any(array.ndim > 1 or _incomplete(array) for array in columns.values()):
        return content | {"cases": list(_rows(table, columns))}
    groups: dict[str, dict[str, list[Any]]] = {}
    for name, array in columns.items():
        if array.dims:
            groups.setdefault(str(array.dims[0]), {})[name] = [_plain(value) for value in array.values]
    alone = {name: values for group in groups.values() if len(group) == 1 for name, values in group.items()}
    return content | {"sweep": alone, "zip": [group for group in groups.values() if len(group) > 1]}


def _said(table: xr.Dataset, name: object) -> bool:
    """Whether a variable of a table is a parameter; a dimension may be numbered, all else is an error."""
    if name in PARAMETERS:
        return True
    used = any(name in array.dims for other, array in table.variables.items() if other in PARAMETERS)
    if name not in table.indexes or not used:
        checks.known_name("variable of the table", str(name), PARAMETERS)
    return False


def _column(name: str, array: xr.Variable) -> xr.Variable:
    """Values of a parameter, in SI."""
    said, unit = array.attrs.get("units"), PARAMETERS[name].units
    if PARAMETERS[name].check is points and array.dims:
        raise InvalidInputError(name, array.dims, "a list in base: it is one value of a case")
    factor = 1.0 if said is None or said == unit else factor_to(unit, f"{name}.attrs['units']", said)
    return array if factor == 1.0 else array * factor


def _plain(value: Any) -> Any:
    """Return a value of an array as Python's own; None where it is missing."""
    plain = value.item() if isinstance(value, np.generic) else value
    missing = plain is None or plain == "" or (isinstance(plain, float) and np.isnan(plain))
    return None if missing else plain


def _incomplete(array: xr.Variable) -> bool:
    """Whether some cases do not have a parameter."""
    return bool(array.dims) and any(_plain(value) is None for value in array.values.flat)


def _rows(table: xr.Dataset, columns: Mapping[str, xr.Variable]) -> Iterable[dict[str, Any]]:
    """Own parameters of every case, in the order of the table's dimensions."""
    varying = {name: array for name, array in columns.items() if array.dims}
    dims = [dim for dim in table.sizes if any(dim in array.dims for array in varying.values())]
    for place in itertools.product(*(range(table.sizes[dim]) for dim in dims)):
        at = dict(zip(dims, place, strict=True))
        row = {name: _plain(array[{dim: at[dim] for dim in array.dims}].values[()]) for name, array in varying.items()}
        yield {name: value for name, value in row.items() if value is not None}


def part_of_study(study: Study, table: xr.Dataset, base: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a study of those cases of a study that a Dataset of it still has.

    They stay a product where what is left is one.
    """
    kept = set(table["case_id"].values.ravel().tolist())
    combinations, planned = study.combinations(), study.plan().cases
    chosen = [entry for entry, case in zip(combinations, planned, strict=True) if case.id in kept]
    if not chosen:
        raise InvalidInputError("table", f"{table['case_id'].size} cases", f"with cases of the study {study.name!r}")
    content: dict[str, Any] = {
        "name": study.name,
        "level": study.level,
        "description": study.description,
        "base": {**study.base, **base},
    }
    for name in base:
        if any(name in entry.own for entry in chosen):
            raise InvalidInputError("base", name, "a parameter that is not swept")
    if study.cases:
        return content | {"cases": [entry.own for entry in chosen]}
    used = [sorted(set(places)) for places in zip(*(entry.position for entry in chosen), strict=True)]
    whole = [entry for entry in combinations if all(map(list.__contains__, used, entry.position))]
    if len(whole) != len(chosen):
        return content | {"cases": [entry.own for entry in chosen]}
    left = iter(used)
    sweep = {name: [values[place] for place in next(left)] for name, values in study.sweep.items()}
    groups = []
    for group in study.zip:
        places = next(left)
        groups.append({name: [values[place] for place in places] for name, values in group.items()})
    return content | {"sweep": sweep, "zip": groups, "exclude": list(study.exclude)}
