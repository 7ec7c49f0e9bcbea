"""Which variables of a result are taken together: fields on the same points."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr

from contactstudy.analysis.axes import axis_dimensions
from contactstudy.analysis.measures import measure
from contactstudy.errors import InvalidInputError


def fields_on_one_grid(
    dataset: xr.Dataset, variables: str | Sequence[str] | None, *, along: Sequence[str] = ()
) -> dict[str, xr.DataArray]:
    """Fields on the same points, by name.

    Parameters
    ----------
    dataset : Dataset
        One case.
    variables : str or sequence of str, optional
        Variables or measures; default: all fields in the body, or all on its surface if there are none in the body.
    along : sequence of str
        Axes that the fields of the default extend along; at least two of the three in any case.

    Raises
    ------
    InvalidInputError
        If there is no such variable or measure, or they lie on different points.

    Examples
    --------
    >>> surface = xr.DataArray([[1.0]], dims=("x", "y"))
    >>> list(fields_on_one_grid(xr.Dataset({"pressure": surface, "line_load": surface[:, 0]}), None))
    ['pressure']
    """
    if variables is not None:
        names = [variables] if isinstance(variables, str) else list(variables)
        fields = {name: measure(dataset, name) for name in names}
    else:
        axes = {str(name): axis_dimensions(array) for name, array in dataset.data_vars.items()}
        wide = [name for name, own in axes.items() if len(own) > 1 and set(along) <= set(own)]
        inside = [name for name in wide if "z" in axes[name]]
        fields = {name: dataset[name] for name in inside or wide}
    grids = {tuple(axis_dimensions(array).values()) for array in fields.values()}
    if len(grids) != 1 or grids == {()}:
        raise InvalidInputError(
            "variables", variables or "all", "fields on the same points along x, y or z", points_in_words(fields)
        )
    return fields


def points_in_words(arrays: dict[str, xr.DataArray]) -> str:
    """Return which of the variables lie on the same points, as a hint.

    Examples
    --------
    >>> points_in_words({"pressure": xr.DataArray([[1.0]], dims=("x", "y")), "normal_load": xr.DataArray(1.0)})
    'name some on the same points: pressure (x, y) or normal_load (a single number)'
    """
    groups: dict[tuple[str, ...], list[str]] = {}
    for name, array in arrays.items():
        groups.setdefault(tuple(map(str, array.dims)), []).append(name)
    told = [f"{', '.join(names)} ({', '.join(dims) or 'a single number'})" for dims, names in groups.items()]
    return f"name some on the same points: {' or '.join(told)}" if told else "there is no such variable in the dataset"
