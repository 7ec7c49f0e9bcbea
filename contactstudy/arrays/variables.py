"""Units and names of everything that the package returns, attached from the one table of variables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import xarray as xr

from contactstudy.arrays.vocabulary import AXES, COORDINATES, RULES, STRESSES, VARIABLES, Variable
from contactstudy.versions import version_of

__all__ = [
    "AXES",
    "COORDINATES",
    "DERIVED",
    "RULES",
    "STRESSES",
    "UNBOUNDED",
    "VARIABLES",
    "Variable",
    "describe",
    "labels",
    "named",
    "package_version",
    "specification",
    "variable_of",
    "without_error",
]

DERIVED = "follows from the other parameters"
"""Comment of a coordinate that a study does not sweep."""

UNBOUNDED = "no error known"
"""Comment, or a part of it, of a number that is shown without an error."""

_AFFIXES = sorted((tuple(pattern.split("{name}")) for pattern in RULES), key=lambda pair: -len("".join(pair)))
"""What each rule puts before and after a name, the longest first: `peak_gap_x` is where a peak is, not a peak."""


def specification(name: str, base: Variable | None = None, *, coordinate: bool = False) -> Variable | None:
    """Specification of a variable or coordinate by its name; None if the package has none of that name.

    Parameters
    ----------
    name : str
        Name in the table, or one that a rule makes of another.
    base : Variable, optional
        What a derived quantity is derived from; default: what its name says.
    coordinate : bool
        Whether the name is that of a coordinate.

    Examples
    --------
    >>> specification("peak_von_mises_z").attrs
    {'units': 'm', 'long_name': 'z of the largest von Mises stress'}
    >>> specification("peak_luck") is None
    True
    """
    known = (COORDINATES if coordinate else VARIABLES).get(name)
    if known is not None:
        return _filled(known, base or Variable((), "", "", "value"))
    for prefix, suffix in _AFFIXES:
        middle = name.removeprefix(prefix).removesuffix(suffix)
        if name == f"{prefix}{middle}{suffix}" and middle:
            of = base or specification(middle) or specification(middle, coordinate=True)
            return of and _filled(RULES[f"{prefix}{{name}}{suffix}"], of)
    return None


def _filled(row: Variable, base: Variable) -> Variable:
    """Row of a table with what its braces stand for."""
    words = {"name": "", "variable": base.long_name, "units": base.units, "symbol": base.symbol or base.long_name}
    dims = base.dims if row.dims == ("{name}",) else row.dims
    symbol = row.symbol
    if "{symbol}" in symbol:
        symbol = symbol.format(**words) if base.symbol else ""
    long_name = row.long_name.format(**words)
    words["variable"] = ", ".join(filter(None, (base.long_name, base.comment)))
    return Variable(dims, row.units.format(**words), symbol, long_name, row.comment.format(**words))


def variable_of(name: str, attributes: Mapping[Any, Any], *, coordinate: bool = False) -> Variable:
    """Specification of a variable that carries labels: these count first, the table where they say nothing.

    Examples
    --------
    >>> variable_of("pressure", {"units": "1"}).units, variable_of("pressure", {}).units
    ('1', 'Pa')
    """
    known = specification(name, coordinate=coordinate) or Variable((), "", "", name)
    return known._replace(
        units=str(attributes.get("units", known.units)), long_name=str(attributes.get("long_name", known.long_name))
    )


def labels(name: str, base: Variable | None = None, *, coordinate: bool = False) -> dict[str, str]:
    """Attributes of a variable or coordinate by its name; empty if the package has none of that name.

    Examples
    --------
    >>> labels("x", coordinate=True)["units"], labels("anything")
    ('m', {})
    """
    known = specification(name, base, coordinate=coordinate)
    return known.attrs if known else {}


def named(name: str, array: xr.DataArray, base: Variable | None = None) -> xr.DataArray:
    """Return `array` with a name of the table and its unit and meaning, instead of what it carried.

    Parameters
    ----------
    name : str
        In the table, or made by a rule.
    array : DataArray
        Values.
    base : Variable, optional
        What the quantity is derived from; default: what its name says.

    Examples
    --------
    >>> named("normal_load", xr.DataArray(1.0)).attrs
    {'units': 'N', 'long_name': 'normal load'}
    """
    renamed = array.rename(name)
    renamed.attrs = labels(name, base)
    return renamed


def package_version() -> str:
    """Version of the installed package."""
    return version_of("contactstudy")


def without_error(dataset: xr.Dataset, *names: str) -> xr.Dataset:
    """Return `dataset` with the mark that no error is known on those of the named variables that it has.

    Examples
    --------
    >>> without_error(xr.Dataset({"approach": 1e-6}), "approach", "tilt").approach.attrs["comment"]
    'no error known'
    """
    marked = dataset.copy()
    for name in names:
        if name in marked:
            said = str(marked[name].attrs.get("comment", ""))
            marked[name].attrs["comment"] = said if UNBOUNDED in said else ", ".join(filter(None, (said, UNBOUNDED)))
    return marked


def describe(dataset: xr.Dataset, title: str | None = None) -> xr.Dataset:
    """Return `dataset` with units and meanings from the table; attributes already there stay.

    Parameters
    ----------
    dataset : Dataset
        Variables and coordinates that the table does not know stay as they are.
    title : str, optional
        Of a Dataset that stands alone: adds the attributes that the CF conventions ask of it.

    Examples
    --------
    >>> describe(xr.Dataset({"normal_load": 1.0}), "a load")["normal_load"].attrs["units"]
    'N'
    """
    described = dataset.copy()
    for name, variable in described.variables.items():
        variable.attrs = labels(str(name), coordinate=name in described.coords) | variable.attrs
    if title is not None:
        own = {"Conventions": "CF-1.11", "source": f"contactstudy {package_version()}"}
        described.attrs = own | described.attrs | {"title": title}
    for name in described.coords:
        # By CF a coordinate has no missing values, and so no mark for them.
        described[name].encoding["_FillValue"] = None
    return described
