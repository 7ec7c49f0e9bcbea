"""Tables: one row per point, one column per variable, units in the heading."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from contactstudy import checks
from contactstudy.analysis import along_line, measure, single_case
from contactstudy.analysis.fields import points_in_words
from contactstudy.arrays.required import require
from contactstudy.arrays.variables import UNBOUNDED, variable_of
from contactstudy.errors import InvalidInputError

if TYPE_CHECKING:
    import pandas as pd

Line = tuple[Sequence[float], Sequence[float]]


def headings(dataset: xr.Dataset, names: Sequence[str]) -> dict[str, str]:
    """Headings of columns: the names, with their units where they have some.

    Examples
    --------
    >>> headings(xr.Dataset({"peak_pressure": 1e9, "friction": 0.1}), ["peak_pressure", "friction", "other"])
    {'peak_pressure': 'peak_pressure [Pa]', 'friction': 'friction'}
    """
    known = [name for name in names if name in dataset.variables]
    units = {name: variable_of(name, dataset[name].attrs, coordinate=name in dataset.coords).units for name in known}
    return {name: f"{name} [{unit}]" if unit and unit != "1" else name for name, unit in units.items()}


def marked_headings(dataset: xr.Dataset, names: Sequence[str]) -> dict[str, str]:
    """Headings of columns, with the mark of variables that say of themselves that they have no error.

    A column of errors says it by its empty cells.

    Examples
    --------
    >>> marked_headings(xr.Dataset({"half_width": ((), 1e-4, {"comment": "no error known"})}), ["half_width"])
    {'half_width': 'half_width [m] (no error known)'}
    """
    unknown = {
        name
        for name in names
        if name in dataset.variables
        and not name.endswith("_error")
        and UNBOUNDED in str(dataset[name].attrs.get("comment", ""))
    }
    plain = headings(dataset, names)
    return {name: f"{heading} ({UNBOUNDED})" if name in unknown else heading for name, heading in plain.items()}


def _on_the_same_points(dataset: xr.Dataset, variables: str | Sequence[str] | None) -> xr.Dataset:
    """Variables to be listed; all that are no scalars if none is named."""
    if variables is None:
        chosen = {str(name): array for name, array in dataset.data_vars.items() if array.ndim}
    else:
        names = [variables] if isinstance(variables, str) else list(variables)
        chosen = {name: measure(dataset, name) for name in names}
    shapes = [array.dims for array in chosen.values()]
    if len({frozenset(dims) for dims in shapes}) != 1 or not all(shapes):
        raise InvalidInputError(
            "variables", variables or "all", "variables on the same points", points_in_words(chosen)
        )
    return xr.Dataset(chosen)


def to_table(
    dataset: xr.Dataset,
    variables: str | Sequence[str] | None = None,
    *,
    line: Line | None = None,
    points: int = 101,
) -> pd.DataFrame:
    """Variables at their points, or interpolated along a line, as a table.

    Parameters
    ----------
    dataset : Dataset
        One case, or anything that :mod:`contactstudy.analysis` returns.
    variables : str or sequence of str, optional
        Variables or measures, see :func:`contactstudy.analysis.measure`, on the same points; default: all, or along a
        line all stresses.
    line : pair of sequences, optional
        Its ends, (x, y, z) or (x, y), metres.
    points : int
        Number of points of the line.

    Returns
    -------
    pandas.DataFrame
        Positions first; headings with units, such as ``von_mises [Pa]``, and with ``(no error known)`` where the
        `comment` of a variable says so.

    Raises
    ------
    InvalidInputError
        If there is more than one case, the variables are missing or lie on different points, or the line leaves the
        result.

    Examples
    --------
    >>> stress = xr.DataArray([1.0, 2.0], dims="z", coords={"z": [0.0, 0.5]}, attrs={"units": "Pa"})
    >>> to_table(xr.Dataset({"von_mises": stress})).columns.tolist()
    ['z [m]', 'von_mises [Pa]']
    """
    require(dataset)
    one = single_case(dataset)
    if line is None:
        chosen = _on_the_same_points(one, variables)
    else:
        if not isinstance(line, Sequence) or len(line) != 2:
            raise InvalidInputError("line", line, "a pair of points, each (x, y, z) or (x, y) in metres")
        chosen = along_line(one, *line, points=points, variables=variables)
    dims = list(chosen.sizes)
    along = [str(name) for name, coordinate in chosen.coords.items() if coordinate.ndim and name not in dims]
    frame = chosen.to_dataframe().reset_index()
    names = [name for name in [*dims, *along, *chosen.data_vars] if name in frame]
    return frame[names].rename(columns=marked_headings(chosen, [str(name) for name in names]))


# A spreadsheet takes a cell that begins so for a formula, and would run it.
FORMULA = ("=", "+", "-", "@", "\t", "\r")


def _plain(entry: object) -> object:
    """Return a cell as it is, but a text that a spreadsheet would calculate with an apostrophe before it."""
    return f"'{entry}" if isinstance(entry, str) and entry.startswith(FORMULA) else entry


def csv_text(table: pd.DataFrame) -> str:
    r"""Return a table as CSV whose texts no spreadsheet takes for formulas.

    Examples
    --------
    >>> import pandas as pd
    >>> csv_text(pd.DataFrame({"profile": ["=1+1", "sharp"], "load": [-1.0, 2.0]}))
    "profile,load\n'=1+1,-1.0\nsharp,2.0\n"
    """
    texts = {name: column.map(_plain) for name, column in table.items() if column.dtype.kind not in "fiub"}
    return str(table.assign(**texts).rename(columns=_plain).to_csv(index=False))


def to_csv(
    dataset: xr.Dataset,
    path: str | Path,
    variables: str | Sequence[str] | None = None,
    *,
    line: Line | None = None,
    points: int = 101,
) -> Path:
    """Write variables at their points, or interpolated along a line, as CSV.

    Parameters
    ----------
    dataset, variables, line, points
        As for :func:`to_table`.
    path : str or Path
        File to write.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InvalidInputError
        As :func:`to_table`, or if the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> stress = xr.DataArray([1.0, 2.0], dims="z", coords={"z": [0.0, 0.5]}, attrs={"units": "Pa"})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     print(to_csv(xr.Dataset({"von_mises": stress}), Path(folder) / "depth.csv").read_text().splitlines()[1])
    0.0,1.0
    """
    checks.instance("path", path, (str, Path), "a path")
    target = Path(path)
    table = to_table(dataset, variables, line=line, points=points)
    with checks.writing(target):
        target.write_text(csv_text(table), encoding="utf-8")
    return target
