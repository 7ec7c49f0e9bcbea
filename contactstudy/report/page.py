"""HTML page of a result or of a study, from a Dataset, a file or a folder."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from numbers import Real
from pathlib import Path
from typing import Any

import jinja2
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import single_case, solved_case
from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, RUN_ATTRIBUTE, attribute
from contactstudy.arrays.variables import package_version
from contactstudy.errors import InvalidInputError
from contactstudy.report.assessment import assess_case
from contactstudy.report.figures import case_pictures, side_view
from contactstudy.report.sources import citations
from contactstudy.report.study_page import study_context
from contactstudy.report.tables import case_table, summary
from contactstudy.study.files import load_result
from contactstudy.versions import PACKAGES

CELLS = {  # Description of the cells by the setting of `solve`
    "refined": "columns refined along the axis until the accuracy was reached",
    "chosen": "uniform cells, chosen by the package",
    "given": "given by the user",
}
ROUGH = "the surfaces are rough; the report does not contain their heights"


def html(
    source: xr.Dataset | str | Path, *, title: str | None = None, selection: Mapping[str, Any] | None = None
) -> str:
    """Return the report of a result or of a study as the text of one HTML page.

    Parameters
    ----------
    source : Dataset, str or Path
        A result of one case, its netCDF file, or the folder of a study.
    title : str, optional
        Heading of the page; default: from the name of the file or of the study.
    selection : mapping, optional
        Values of swept parameters in the figures of a study, such as ``{"profile": "crowned"}``; the table has all
        cases. Default: a figure with more parameters than axes shows one value of each further parameter and names it.

    Returns
    -------
    str
        Self-contained page. Of a case: inputs, side view to scale, numbers with their errors, figures, assessment and
        provenance. Of a study: table of its cases, figures over the swept parameters, and failed cases with the reason.

    Raises
    ------
    InvalidInputError
        If the source is no result or more than one case; if the selection names no swept parameter or value, or the
        source is no study.

    Examples
    --------
    >>> pressure = xr.DataArray([[1e9, 2e9], [2e9, 1e9]], dims=("x", "y"), coords={"x": [0.0, 1e-3], "y": [0.0, 1e-4]})
    >>> page = html(xr.Dataset({"pressure": pressure}), title="Two cells")
    >>> page.startswith("<!DOCTYPE html>"), "Two cells" in page
    (True, True)
    """
    if not isinstance(source, xr.Dataset):
        checks.instance("source", source, (str, Path), "a Dataset, a netCDF file or a study's folder")
        path = Path(source)
        if path.is_dir():
            return _render("study.html", study_context(path, selection) | ({"title": title} if title else {}))
        source = load_result(path, "source")
        study = attribute(source, RUN_ATTRIBUTE).get("study", "")
        title = title or (f"Study {study}, case {path.stem}" if study else path.stem)
    if selection:
        raise InvalidInputError("selection", dict(selection), "left out: the report of one case shows that case")
    result = single_case(source)
    case, table = solved_case(result) if INPUTS_ATTRIBUTE in result.attrs else None, summary(result)
    context = {
        "title": title or "Contact of a roller",
        "inputs": case_table(case).subjects if case is not None else {},
        "drawing": side_view(case) if case is not None else None,
        "numbers": table.numbers,
        "assessment": assess_case(result, table),
        "pictures": case_pictures(result, case),
        "provenance": provenance(result),
        "citations": citations(result).entries,
    }
    return _render("case.html", context)


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
        The file, ``.html``; an existing link is replaced, not followed. Default: next to the netCDF file, or
        ``report.html`` in the study's folder.
    title, selection : optional
        As for :func:`html`.

    Raises
    ------
    InvalidInputError
        As :func:`html`; if the path is missing for a Dataset in memory or does not end in .html.
    StoreError
        If the file cannot be written.

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
        results = Path(source)
        path = results / "report.html" if results.is_dir() else results.with_suffix(".html")
    target = Path(path)
    if target.suffix.lower() not in (".html", ".htm"):
        hint = "a browser prints the page to PDF" if target.suffix.lower() == ".pdf" else ""
        raise InvalidInputError("path", str(path), "a name that ends in .html: the report is a page", hint)
    page = html(source, title=title, selection=selection)
    with checks.writing(target) as temporary_path:
        temporary_path.write_text(page, encoding="utf-8")
    return target


def provenance(dataset: xr.Dataset) -> list[tuple[str, str]]:
    """Return date, versions, settings and times of a result.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`, its file, or one case of a study.

    Returns
    -------
    list of (str, str)
        Subjects and values; without a record of the run, the source of the Dataset.

    Examples
    --------
    >>> provenance(xr.Dataset(attrs={"source": "contactstudy 0.1.0"}))
    [('versions', 'contactstudy 0.1.0')]
    """
    run = attribute(dataset, RUN_ATTRIBUTE)
    settings = attribute(dataset, INPUTS_ATTRIBUTE).get("settings", {})
    names = ("contactstudy", "commit", "python", *PACKAGES)
    versions = ", ".join(f"{name} {run[name]}" for name in names if name in run)
    cells, stages = str(settings.get("cells", "")), run.get("stages", {}).items()
    times = [f"{stage} {seconds:.2f} s" for stage, seconds in stages if isinstance(seconds, Real)]
    total = f"{run['seconds']:.2f} s" if "seconds" in run else ""
    rows = {
        "solved": f"{run['time'][:16].replace('T', ' ')} UTC" if "time" in run else "",
        "study": str(run.get("study") or ""),
        "versions": versions or str(dataset.attrs.get("source", "not known")),
        "cells": CELLS.get(cells, cells),
        "accuracy": f"{settings['accuracy']:g} of the peak pressure" if "accuracy" in settings else "",
        "tolerance of the iteration": f"{settings['tolerance']:g}" if "tolerance" in settings else "",
        "roughness": ROUGH if settings.get("rough") else "",
        "cells along x and y": " x ".join(map(str, dataset["pressure"].shape)) if "pressure" in dataset else "",
        "time": f"{', '.join(times)}; {total} in all" if times and total else total,
    }
    return [(subject, text) for subject, text in rows.items() if text]


def _render(template: str, context: dict[str, Any]) -> str:
    """Fill a template with a context, the date and the version."""
    date = datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC")
    templates = jinja2.Environment(
        loader=jinja2.PackageLoader("contactstudy.report", "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return templates.get_template(template).render({"made": date, "version": package_version()} | context)
