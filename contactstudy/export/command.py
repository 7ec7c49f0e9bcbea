"""Command ``contactstudy export``: converts a file or a study's folder to CSV, VTK or MATLAB."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from contactstudy.arrays.variables import index_of, selection_of
from contactstudy.errors import InvalidInputError
from contactstudy.export.matlab import to_mat
from contactstudy.export.table import Line, csv_text, headings, to_table
from contactstudy.export.vtk import to_vtk

if TYPE_CHECKING:
    import pandas as pd

SUFFIXES = {"csv": ".csv", "vtk": ".vtr", "mat": ".mat"}


def parse_line(text: str) -> Line:
    """Return the ends of a line from ``X,Y,Z:X,Y,Z`` in metres."""
    try:
        start, end = ([float(coordinate) for coordinate in point.split(",")] for point in text.split(":"))
    except ValueError:
        raise InvalidInputError("line", text, "X,Y,Z:X,Y,Z in metres, for example 0,0,0:0,0,2e-4") from None
    return start, end


def export(
    path: Path,
    *,
    kind: str | None = None,
    variables: Sequence[str] | None = None,
    line: str | None = None,
    points: int = 101,
    select: Sequence[str] = (),
    out: Path | None = None,
) -> Path | None:
    """Write CSV (summaries of a study, field or line of a case), VTK or MATLAB; None if ``-`` prints the table."""
    from contactstudy.study import collect, open_study
    from contactstudy.study.files import load_result

    if path.is_dir() and not (kind or variables or line or select):
        collected = collect(path)
        rows = collected.to_dataframe().reset_index()
        rows = rows.rename(columns=headings(collected, [str(name) for name in rows.columns]))
        return _write_csv(rows, out or path / "summary.csv")
    kind = kind or "csv"
    dataset = open_study(path) if path.is_dir() else load_result(path, "path")
    for name, value in selection_of(select).items():
        dataset = dataset.isel({name: index_of(dataset, name, value, "select")})
    names = [str(dim) for dim in dataset["status"].dims if dataset.sizes[dim] > 1] if "status" in dataset else []
    if line is not None and kind != "csv":
        raise InvalidInputError("line", line, f"left out for {kind.upper()}", "write the line as CSV")
    if names and kind != "mat":
        example = f"--select {names[0]}={dataset[names[0]].values[0]}"
        raise InvalidInputError("select", list(select), f"with a value of {', '.join(names)} too", f"such as {example}")
    target = out or (path / f"export{SUFFIXES[kind]}" if path.is_dir() else path.with_suffix(SUFFIXES[kind]))
    if kind == "vtk":
        return to_vtk(dataset, target, variables)
    if kind == "mat":
        if names and variables is None:
            dataset = dataset.drop_dims([dim for dim in dataset.dims if dim not in dataset["status"].dims])
        return to_mat(dataset, target, variables)
    line_ends = None if line is None else parse_line(line)
    return _write_csv(to_table(dataset, variables, line=line_ends, points=points), target)


def _write_csv(table: pd.DataFrame, path: Path) -> Path | None:
    """Write a table as CSV; print it and return None if the path is ``-``."""
    from contactstudy.study.files import write_text

    if str(path) == "-":
        print(csv_text(table), end="")
        return None
    write_text(path, csv_text(table))
    return path
