"""Tables: one row per point, one column per variable, units in the heading."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from contactstudy import checks
from contactstudy.analysis import along_line, single_case
from contactstudy.analysis.cuts import named_arrays, points_hint
from contactstudy.arrays.variables import ERROR_KIND, NOT_ESTIMATED, require, variable_of
from contactstudy.errors import InvalidInputError

if TYPE_CHECKING:
    import pandas as pd

Line = tuple[Sequence[float], Sequence[float]]


def headings(dataset: xr.Dataset, names: Sequence[str]) -> dict[str, str]:
    """Return headings of columns: names with units, and a mark on numbers whose error is not estimated."""
    texts = {}
    for name in names:
        if name in dataset.variables:
            array = dataset[name]
            unit = variable_of(name, array.attrs, coordinate=name in dataset.coords).units
            has_error_estimate = name.endswith("_error") or array.attrs.get(ERROR_KIND) != NOT_ESTIMATED
            texts[name] = f"{name} [{unit}]" if unit and unit != "1" else name
            texts[name] += "" if has_error_estimate else f" (error {NOT_ESTIMATED})"
    return texts


def output_path(path: str | Path, *suffixes: str) -> Path:
    """Return the path of a file to write, whose name must end with one of the `suffixes`."""
    checks.instance("path", path, (str, Path), "a path")
    target = Path(path)
    if suffixes and target.suffix not in suffixes:
        raise InvalidInputError("path", str(path), f"a file name that ends with {' or '.join(suffixes)}")
    return target


def to_table(
    dataset: xr.Dataset, variables: str | Sequence[str] | None = None, *, line: Line | None = None, points: int = 101
) -> pd.DataFrame:
    """Return variables at their points, or interpolated along a line, as a table.

    Parameters
    ----------
    dataset : Dataset
        One case, or a Dataset of :mod:`contactstudy.analysis`.
    variables : str or sequence of str, optional
        Variables or measures, see :func:`contactstudy.analysis.measure`; default: all, or along a line all stresses.
    line : pair of sequences, optional
        Ends of the line, (x, y, z) or (x, y), metres.
    points : int
        Number of points of the line.

    Returns
    -------
    pandas.DataFrame
        Positions first; headings such as ``von_mises [Pa]``, and ``(error not estimated)`` if this is the `error_kind`.

    Raises
    ------
    InvalidInputError
        If the Dataset contains several cases, variables are missing or on different points, or the line leaves it.

    Examples
    --------
    >>> stress = xr.DataArray([1.0, 2.0], dims="z", coords={"z": [0.0, 0.5]}, attrs={"units": "Pa"})
    >>> to_table(xr.Dataset({"von_mises": stress})).columns.tolist()
    ['z [m]', 'von_mises [Pa]']
    """
    require(dataset)
    case = single_case(dataset)
    if line is None:
        arrays = named_arrays(case, variables)
        if variables is None:
            arrays = {name: array for name, array in arrays.items() if array.ndim}
        points_of_arrays = {frozenset(array.dims) for array in arrays.values()}
        if len(points_of_arrays) != 1 or frozenset() in points_of_arrays:
            allowed = "variables on the same points"
            raise InvalidInputError("variables", variables or "all", allowed, points_hint(arrays))
        fields = xr.Dataset(arrays)
    else:
        if not isinstance(line, Sequence) or len(line) != 2:
            raise InvalidInputError("line", line, "a pair of points, each (x, y, z) or (x, y) in metres")
        fields = along_line(case, *line, points=points, variables=variables)
    dims = list(fields.sizes)
    coordinates = [str(name) for name, array in fields.coords.items() if array.ndim and name not in dims]
    frame = fields.to_dataframe().reset_index()
    names = [name for name in [*dims, *coordinates, *fields.data_vars] if name in frame]
    return frame[names].rename(columns=headings(fields, [str(name) for name in names]))


FORMULA = ("=", "+", "-", "@", "\t", "\r")  # First characters of a formula, which a spreadsheet would run


def _escape(entry: object) -> object:
    """Return a cell with an apostrophe before a formula."""
    return f"'{entry}" if isinstance(entry, str) and entry.startswith(FORMULA) else entry


def csv_text(table: pd.DataFrame) -> str:
    """Return a table as CSV, with an apostrophe before texts that a spreadsheet would run as formulas."""
    texts = {name: column.map(_escape) for name, column in table.items() if column.dtype.kind not in "fiub"}
    return str(table.assign(**texts).rename(columns=_escape).to_csv(index=False))


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

    Raises
    ------
    InvalidInputError
        As :func:`to_table`.
    StoreError
        If the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> stress = xr.DataArray([1.0, 2.0], dims="z", coords={"z": [0.0, 0.5]}, attrs={"units": "Pa"})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     print(to_csv(xr.Dataset({"von_mises": stress}), Path(folder) / "depth.csv").read_text().splitlines()[1])
    0.0,1.0
    """
    target = output_path(path)
    table = to_table(dataset, variables, line=line, points=points)
    with checks.writing(target) as temporary_path:
        temporary_path.write_text(csv_text(table), encoding="utf-8")
    return target
