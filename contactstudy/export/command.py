"""Command ``contactstudy export``: from a file or a study's folder to CSV, VTK or MATLAB."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import xarray as xr

from contactstudy.arrays.selections import place_of, selection_of
from contactstudy.errors import InvalidInputError
from contactstudy.export.matlab import to_mat
from contactstudy.export.table import Line, csv_text, headings, to_csv, to_table
from contactstudy.export.vtk import to_vtk

SUFFIXES = {"csv": ".csv", "vtk": ".vtr", "mat": ".mat"}


def parse_line(text: str) -> Line:
    """Return the ends of a line from ``X,Y,Z:X,Y,Z`` in metres."""
    try:
        start, end = ([float(number) for number in part.split(",")] for part in text.split(":"))
    except ValueError:
        raise InvalidInputError("line", text, "X,Y,Z:X,Y,Z in metres, for example 0,0,0:0,0,2e-4") from None
    return start, end


def _open(path: Path) -> xr.Dataset:
    """Open the result in a netCDF file, or the study in a folder."""
    if path.is_dir():
        from contactstudy.study import open_study

        return open_study(path)
    try:
        with xr.open_dataset(path, engine="netcdf4") as dataset:
            return dataset.load()
    except (OSError, ValueError) as error:
        missing = isinstance(error, FileNotFoundError)
        reason = "there is no such file" if missing else "this file is not netCDF"
        raise InvalidInputError("path", str(path), "a netCDF file or a study's folder", reason) from None


def export(
    path: Path,
    *,
    kind: str = "csv",
    variables: Sequence[str] | None = None,
    line: str | None = None,
    points: int = 101,
    select: Sequence[str] = (),
    out: Path | None = None,
) -> Path | None:
    """Write a field or a line of a case as CSV or VTK, or a case or a study for MATLAB; None if ``-`` prints it."""
    dataset = _open(path)
    for name, value in selection_of(select).items():
        dataset = dataset.isel({name: place_of(dataset, name, value, "select")})
    swept = [str(dim) for dim in dataset["status"].dims if dataset.sizes[dim] > 1] if "status" in dataset else []
    if line is not None and kind != "csv":
        raise InvalidInputError("line", line, f"left out for {kind.upper()}", "write the line as CSV")
    if swept and kind != "mat":
        example = f"--select {swept[0]}={dataset[swept[0]].values[0]}"
        raise InvalidInputError("select", list(select), f"with a value of {', '.join(swept)} too", f"such as {example}")
    default = path / f"export{SUFFIXES[kind]}" if path.is_dir() else path.with_suffix(SUFFIXES[kind])
    target = default if out is None else out
    if kind == "vtk":
        return to_vtk(dataset, target, variables)
    if kind == "mat":
        if swept and variables is None:
            dataset = dataset.drop_dims([dim for dim in dataset.dims if dim not in dataset["status"].dims])
        return to_mat(dataset, target, variables)
    ends = None if line is None else parse_line(line)
    if str(target) == "-":
        print(csv_text(to_table(dataset, variables, line=ends, points=points)), end="")
        return None
    return to_csv(dataset, target, variables, line=ends, points=points)


def export_summaries(folder: Path, out: Path | None = None) -> Path | None:
    """Write the summaries of a study as CSV, one row per case; None if ``-`` prints it."""
    from contactstudy.study import collect
    from contactstudy.study.files import write_text

    collected = collect(folder)
    table = collected.to_dataframe().reset_index()
    text = csv_text(table.rename(columns=headings(collected, [str(name) for name in table.columns])))
    if str(out) == "-":
        print(text, end="")
        return None
    path = out if out is not None else folder / "summary.csv"
    write_text(path, text)
    return path
