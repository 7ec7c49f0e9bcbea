"""From a result, a file or a folder to one HTML page."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

import jinja2
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import certainty, citations, short, single_case
from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, RUN_ATTRIBUTE, attribute
from contactstudy.arrays.old_names import with_present_names
from contactstudy.arrays.variables import package_version
from contactstudy.case.words import inputs
from contactstudy.errors import InvalidInputError
from contactstudy.report.drawing import draw
from contactstudy.report.figures import case_pictures
from contactstudy.report.inputs import case_of
from contactstudy.report.study_page import study_context

CELLS = {
    "refined": "columns refined along the axis until the accuracy was reached",
    "chosen": "uniform cells, chosen by the package",
    "given": "given by the user",
}
"""What `solve` notes of the cells, in words."""


@cache
def _templates() -> jinja2.Environment:
    """Templates of the pages; everything that goes into them is escaped."""
    loader = jinja2.PackageLoader("contactstudy.report", "templates")
    return jinja2.Environment(
        loader=loader, autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )


def html(
    source: xr.Dataset | str | Path, *, title: str | None = None, selection: Mapping[str, Any] | None = None
) -> str:
    """Report of a result or of a study as the text of one HTML page.

    Parameters
    ----------
    source : Dataset, str or Path
        A result of one case; the netCDF file of one; or the folder of a study.
    title : str, optional
        Heading of the page; default: from the file's or the study's name.
    selection : mapping, optional
        Of a study: values of swept parameters to which the figures keep, such as ``{"profile": "crowned"}``. Its table
        has all cases. Default: figures with more parameters than axes show one value of the others, and say which.

    Returns
    -------
    str
        A page that needs nothing else: inputs, drawing to scale, numbers with their errors, figures, what makes the
        numbers trustworthy, and where they come from. Of a study: a table of its cases, figures over the swept
        parameters, and the cases that failed with the reason.

    Raises
    ------
    InvalidInputError
        If there is no such result, or more than one case; if the selection names no swept parameter or value, or
        there is one and the source is no study.

    Examples
    --------
    >>> pressure = xr.DataArray([[1e9, 2e9], [2e9, 1e9]], dims=("x", "y"), coords={"x": [0.0, 1e-3], "y": [0.0, 1e-4]})
    >>> page = html(xr.Dataset({"pressure": pressure}), title="Two cells")
    >>> page.startswith("<!DOCTYPE html>"), "Two cells" in page
    (True, True)
    """
    made = datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC")
    shared: dict[str, Any] = {"made": made, "version": package_version()}
    if not isinstance(source, xr.Dataset):
        checks.instance("source", source, (str, Path), "a Dataset, a netCDF file or a study's folder")
        path = Path(source)
        if path.is_dir():
            context = study_context(path, selection)
            return (
                _templates().get_template("study.html").render(shared | context | ({"title": title} if title else {}))
            )
        source = _opened(path)
        title = title or _called(source, path)
    if selection:
        raise InvalidInputError("selection", dict(selection), "left out: the report of one case shows that case")
    context = _case_context(source) | {"title": title or "Contact of a roller"}
    return _templates().get_template("case.html").render(shared | context)


def write(
    source: xr.Dataset | str | Path,
    path: str | Path | None = None,
    *,
    title: str | None = None,
    selection: Mapping[str, Any] | None = None,
) -> Path:
    """Write the report of a result or of a study as one HTML file.

    Parameters
    ----------
    source : Dataset, str or Path
        As for :func:`html`.
    path : str or Path, optional
        The file, ``.html``. Default: beside the netCDF file, or ``report.html`` in the study's folder.
    title, selection : optional
        As for :func:`html`.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InvalidInputError
        If there is no such result, the path is missing for a Dataset in memory or does not end in .html, or the file
        cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> pressure = xr.DataArray([[1e9, 2e9], [2e9, 1e9]], dims=("x", "y"), coords={"x": [0.0, 1e-3], "y": [0.0, 1e-4]})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write(xr.Dataset({"pressure": pressure}), f"{folder}/case.html").name
    'case.html'
    """
    if path is None:
        if isinstance(source, xr.Dataset):
            raise InvalidInputError("path", None, "given: a result in memory has no name")
        checks.instance("source", source, (str, Path), "a Dataset, a netCDF file or a study's folder")
        place = Path(source)
        path = place / "report.html" if place.is_dir() else place.with_suffix(".html")
    target = Path(path)
    if target.suffix.lower() not in (".html", ".htm"):
        hint = "a browser prints the page to PDF" if target.suffix.lower() == ".pdf" else ""
        raise InvalidInputError("path", str(path), "a name that ends in .html: the report is a page", hint)
    page = html(source, title=title, selection=selection)
    with checks.writing(target):
        target.write_text(page, encoding="utf-8")
    return target


def _opened(path: Path) -> xr.Dataset:
    """Open the result in a netCDF file, and hold it in memory."""
    try:
        with xr.open_dataset(path, engine="netcdf4") as dataset:
            return with_present_names(dataset.load())
    except (OSError, ValueError) as error:
        reason = "there is no such file" if isinstance(error, FileNotFoundError) else "this file is not netCDF"
        raise InvalidInputError("source", str(path), "a netCDF file or a study's folder", reason) from None


def _called(dataset: xr.Dataset, path: Path) -> str:
    """Heading of a file's page: its name; of a study's case, whose name is a part of its identity, with the study's."""
    study = attribute(dataset, RUN_ATTRIBUTE).get("study", "")
    return f"Study {study}, case {path.stem}" if study else path.stem


def _case_context(dataset: xr.Dataset) -> dict[str, Any]:
    """Return what the page of a case shows."""
    one = single_case(dataset).assign_attrs(dataset.attrs)
    case = case_of(one)
    return {
        "inputs": inputs(case) if case is not None else {},
        "drawing": draw(case) if case is not None else None,
        "numbers": short(one).numbers,
        "certainty": certainty(one),
        "pictures": case_pictures(one, case),
        "provenance": _provenance(one),
        "citations": citations(one).entries,
    }


def _provenance(one: xr.Dataset) -> list[tuple[str, str]]:
    """Versions, date, settings and times of a result."""
    run = attribute(one, RUN_ATTRIBUTE)
    settings = attribute(one, INPUTS_ATTRIBUTE).get("settings", {})
    rows = []
    if "time" in run:
        rows.append(("solved", datetime.fromisoformat(run["time"]).strftime("%Y-%m-%d %H:%M UTC")))
    if run.get("study"):
        rows.append(("study", str(run["study"])))
    names = ("contactstudy", "commit", "python", "numpy", "scipy", "xarray", "netCDF4", "pyfftw")
    said = ", ".join(f"{name} {run[name]}" for name in names if name in run)
    rows.append(("versions", said or str(one.attrs.get("source", "not known"))))
    if "cells" in settings:
        rows.append(("cells", CELLS.get(settings["cells"], str(settings["cells"]))))
        if "accuracy" in settings:
            rows.append(("accuracy asked for", f"{settings['accuracy']:g} of the peak pressure"))
        rows.append(("tolerance of the iteration", f"{settings['tolerance']:g}"))
        if settings.get("rough"):
            rows.append(("roughness", "rough surfaces were given; they are not in this report"))
    if "pressure" in one:
        rows.append(("cells along x and y", " x ".join(str(size) for size in one["pressure"].shape)))
    if run.get("stages"):
        stages = ", ".join(f"{name} {seconds:.2f} s" for name, seconds in run["stages"].items())
        rows.append(("time taken", f"{stages}; {float(run.get('seconds', 0)):.2f} s in all"))
    elif "seconds" in run:
        rows.append(("time taken", f"{float(run['seconds']):.2f} s"))
    return rows
