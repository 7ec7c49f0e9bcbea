"""HTML page of a result or of a study, from a Dataset, a file or a folder."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from datetime import UTC, datetime
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import jinja2
import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import single_case, solved_case
from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, RUN_ATTRIBUTE, attribute
from contactstudy.arrays.variables import UNKNOWN_ERROR, package_version
from contactstudy.errors import InvalidInputError
from contactstudy.plots.study_lines import figures_with_selections
from contactstudy.report.assessment import CAUTION, NO, UNKNOWN, YES, assess_case
from contactstudy.report.figures import PIXELS_PER_INCH, Picture, case_pictures, encode_figure, side_view
from contactstudy.report.sources import citations
from contactstudy.report.tables import Summary, case_table, summary
from contactstudy.study import collect
from contactstudy.study.files import load_result
from contactstudy.study.folder import Folder
from contactstudy.study.parameters import PARAMETERS, with_defaults
from contactstudy.study.plan import Plan, PlannedCase, format_list, format_value, label
from contactstudy.versions import PACKAGES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CELL_DESCRIPTIONS = {  # Description of the cells by the setting of `solve`
    "refined": "columns refined along the axis until the accuracy was reached",
    "chosen": "uniform cells, chosen by the package",
    "given": "given by the user",
}
ROUGHNESS_NOTE = "the surfaces are rough; the report does not contain their heights"
VERSION_ENTRIES = ("contactstudy", "commit", "python", *PACKAGES)  # Entries of a run with a version
HEADINGS = {  # Columns of the table and their headings
    "peak_pressure": "largest pressure",
    "end_pressure_first": "at end I",
    "end_pressure_last": "at end II",
    "central_film": "central film",
    "least_film": "least film",
    "least_film_ratio": "least film over roughness",
    "peak_von_mises": "largest von Mises",
    "peak_von_mises_x": "at x",
    "peak_von_mises_z": "at z",
    "corner_x": "corner at x",
    "corner_slope": "slope of the corner",
    "corner_intensity": "intensity of the corner",
    "corner_distance": "d0 of the corner",
    "end_intensity_first": "K at end I",
    "end_intensity_last": "K at end II",
    "end_load_first": "load on the last a, end I",
    "end_load_last": "load on the last a, end II",
}
SINGULAR_NUMBERS = ("end_intensity_first", "end_intensity_last", "end_load_first", "end_load_last")
"""Columns that replace the pressure at a singular end."""
NOT_LOADED, SINGULAR = "not loaded", "singular"  # texts instead of a number

CAPTIONS = {  # Captions of figures by name
    "edge_effect": "Pressure along the axis, and von Mises stress in the plane y = 0, for several distances "
    "from the end.",
    "study": "Largest values of the cases over the swept parameters; where all are singular, the loads on the last "
    "half-width a at the ends. Bars: estimated errors; open marks: error not estimated. Open triangle at the top: "
    "singular, without a largest value.",
}

FIELDS = ("pressure", "initial_gap", "von_mises")  # Variables of a case in the figures of a study
PERCENTAGE = re.compile(r" ([0-9.]+)%$")  # Size of an error at the end of a reason
ANSWER_ORDER = (NO, CAUTION, UNKNOWN, YES)


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
        If the source is no result or several cases; if the selection names no swept value, or the source is no study.

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
        raise InvalidInputError("selection", dict(selection), "absent for the report of a single case")
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
    source, title, selection
        As for :func:`html`.
    path : str or Path, optional
        The file, ``.html``; an existing link is replaced, not followed. Default: next to the netCDF file, or
        ``report.html`` in the study's folder.

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
    versions = ", ".join(f"{name} {run[name]}" for name in VERSION_ENTRIES if name in run)
    cells, stages = str(settings.get("cells", "")), run.get("stages", {}).items()
    times = [f"{stage} {seconds:.2f} s" for stage, seconds in stages if isinstance(seconds, Real)]
    total = f"{run['seconds']:.2f} s" if "seconds" in run else ""
    rows = {
        "solved": f"{run['time'][:16].replace('T', ' ')} UTC" if "time" in run else "",
        "study": str(run.get("study") or ""),
        "versions": versions or str(dataset.attrs.get("source", "not known")),
        "cells": CELL_DESCRIPTIONS.get(cells, cells),
        "accuracy": f"{settings['accuracy']:g} of the peak pressure" if "accuracy" in settings else "",
        "tolerance of the iteration": f"{settings['tolerance']:g}" if "tolerance" in settings else "",
        "roughness": ROUGHNESS_NOTE if settings.get("rough") else "",
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


class Row(NamedTuple):
    """A case in the table: swept values, numbers with errors, status, assessment."""

    anchor: str
    swept_values: list[str]
    numbers: dict[str, str]  # by name
    status: str
    note: str
    answer: str
    reason: str


def study_context(path: Path, selection: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Return the template's context for a study's page; the selection of swept values applies only to the figures."""
    folder = Folder(path)
    study = folder.read_study()
    plan = study.plan()
    states = folder.states(plan)
    records = [states.record(index) for index in range(len(plan))]
    swept_names = list(dict.fromkeys([*study.sweep, *(name for table in (*study.zip, *study.cases) for name in table)]))
    rows = [
        _create_row(f"case-{number}", str(status), reason, record, _swept_values(plan, case, swept_names))
        for number, (case, status, reason, record) in enumerate(
            zip(plan, states.status, states.reasons, records, strict=True), 1
        )
    ]
    names = [name for name in HEADINGS if _has_number(rows, name)]
    sizes = ", ".join(f"{_heading_of(dim)}: {size}" for dim, size in zip(plan.cube.dims, plan.cube.shape, strict=True))
    return {
        "title": f"Study {study.name}",
        "description": study.description,
        "shape": f"{len(plan)} cases ({sizes})",
        "counts": Counter(row.status for row in rows),
        "base": [(_meaning_of(name), format_value(name, value)) for name, value in study.base.items()],
        "swept": [
            (
                _meaning_of(name),
                format_list(list(dict.fromkeys(row.swept_values[column] for row in rows if row.swept_values[column]))),
            )
            for column, name in enumerate(swept_names)
        ],
        "headings": [_heading_of(name) for name in swept_names],
        "number_headings": {name: HEADINGS[name] for name in names},
        "intensities": any(name.startswith("end_intensity") for name in names),
        "rows": rows,
        "reasons": _group_rows((row for row in rows if row.status != "ok"), lambda row: (row.status, row.note)),
        "answers": _count_answers(rows),
        "verdict": _summarise_answers(rows),
        "pictures": _draw_pictures(path, selection),
        "provenance": _summarise_runs([attribute(record, RUN_ATTRIBUTE) for record in records if record]),
    }


def figures_of_folder(
    path: Path, selection: Mapping[str, Any] | None = None
) -> dict[str, tuple[Figure, dict[str, str]]]:
    """Draw a study's figures; with each, the parameters shown at one value only, and another value of each."""
    results = Folder(path).results()
    study = collect(path)

    # Surfaces are lazy: only the files of drawn cases are opened.
    def load(case: xr.Dataset) -> xr.Dataset:
        return single_case(results.case(str(case["case_id"].item()), FIELDS))

    def find_last_value(dim: str) -> str:
        value = study.indexes[dim][-1]
        return value if isinstance(value, str) else f"{float(value):.10g}"

    return {
        name: (figure, {dim: find_last_value(dim) for dim in fixed_values})
        for name, (figure, fixed_values) in figures_with_selections(study, selection or {}, load).items()
    }


def _meaning_of(name: str) -> str:
    """Meaning of a parameter."""
    return PARAMETERS[name].meaning if name in PARAMETERS else name.replace("_", " ")


def _heading_of(name: str) -> str:
    """Heading of a parameter; zipped parameters have the name that the study gives them."""
    return PARAMETERS[name].attrs["long_name"] if name in PARAMETERS else name.replace("_", " ")


def _swept_values(plan: Plan, case: PlannedCase, swept_names: list[str]) -> list[str]:
    """Values of the swept parameters of a case, with the study's names."""
    parameters = with_defaults(case.parameters)
    texts = []
    for name in swept_names:
        dim, labels = plan.cube.labels.get(name, ("", ()))
        value = labels[case.position[plan.cube.dims.index(dim)]] if dim in plan.cube.dims else parameters.get(name)
        if isinstance(parameters.get(name), dict) and value == label(parameters[name]):
            value = parameters[name]  # the text of an unnamed table lists its values
        texts.append("" if value is None else format_value(name, value))
    return texts


def _create_row(anchor: str, status: str, reason: str, record: xr.Dataset, swept_values: list[str]) -> Row:
    """Row of a case, with all numbers of the table."""
    if not record:
        return Row(anchor, swept_values, {}, status, note=reason, answer="", reason="")
    table = summary(record)
    assessment = assess_case(record, table)
    return Row(
        anchor,
        swept_values,
        {name: _format_number(table, name) for name in HEADINGS},
        status,
        note=assessment.verdict if assessment.overall == NO else reason,
        answer=assessment.overall,
        reason=assessment.verdict,
    )


def _format_number(table: Summary, name: str) -> str:
    """Text of a number with its error; empty for a number of a singular end at a regular end."""
    end = name.rpartition("_")[2]
    if name.startswith("peak_von_mises") and "peak_von_mises" in table and np.isinf(table["peak_von_mises"].value):
        return SINGULAR  # omit the position
    if name not in table or (name in SINGULAR_NUMBERS and f"end_intensity_{end}" not in table):
        return ""
    number = table[name]
    if name.startswith("end_pressure") and number.value == 0:
        return NOT_LOADED
    if np.isinf(number.value):
        return SINGULAR
    is_exact = name.endswith(("_x", "_z", "corner_slope", "corner_intensity"))
    return number.text if is_exact or np.isfinite(number.error) else f"{number.text} ({UNKNOWN_ERROR})"


def _has_number(rows: list[Row], name: str) -> bool:
    """Whether a column has a number; at a singular end the intensity replaces the pressure."""
    empty_texts = {"", NOT_LOADED, SINGULAR} if name.startswith("end_") else {"", NOT_LOADED}
    return any(row.numbers.get(name, "") not in empty_texts for row in rows)


def _group_rows(rows: Iterable[Row], key: Callable[[Row], tuple[str, str]]) -> list[tuple[str, str, list[Row]]]:
    """Group rows by a key of two texts; return each key with its rows, in the order of first rows."""
    groups: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return [(*texts, group) for texts, group in groups.items()]


def _count_answers(rows: list[Row]) -> list[tuple[str, str, list[Row]]]:
    """Answers and reasons with the rows of the cases they apply to, worst answers first."""
    # The percentage in a reason differs from case to case: omit it, to group equal reasons.
    groups = _group_rows((row for row in rows if row.answer), lambda row: (row.answer, PERCENTAGE.sub("", row.reason)))
    groups.sort(key=lambda group: ANSWER_ORDER.index(group[0]))
    answers = []
    for answer, reason, cases in groups:
        percents = sorted(float(match[1]) for row in cases if (match := PERCENTAGE.search(row.reason)))
        if percents:
            reason += f" {percents[-1]:.1f}%"
            reason += f" in the worst case, {percents[0]:.1f}% in the best" if percents[0] < percents[-1] else ""
        answers.append((answer, reason, cases))
    return answers


def _summarise_answers(rows: list[Row]) -> tuple[str, str]:
    """Worst answer of all cases, and the number of cases with each answer; an unsolved case counts as "with care"."""
    counts = Counter(row.answer for row in rows if row.answer)
    worst_answer = next((answer for answer in ANSWER_ORDER if answer in counts), UNKNOWN)
    if worst_answer in (YES, UNKNOWN) and any(row.status != "ok" for row in rows):
        worst_answer = CAUTION
    phrases = {NO: "not to be relied on", CAUTION: "real with care", UNKNOWN: "not known to be real", YES: "real"}
    return worst_answer, ", ".join(f"{counts[answer]} {phrases[answer]}" for answer in ANSWER_ORDER if counts[answer])


def _draw_pictures(path: Path, selection: Mapping[str, Any] | None) -> list[Picture]:
    """Figures of the study with captions."""
    from matplotlib import pyplot

    pictures = []
    for name, (figure, fixed_values) in figures_of_folder(path, selection).items():
        caption = CAPTIONS.get(name, name.replace("_", " "))
        for parameter, value in list(fixed_values.items())[:1]:
            option = f"{parameter}={value}"
            option = f'"{option}"' if set(option) & set(" $\\'\"()&;|<>*?#`!") else option
            headings = " and ".join(map(_heading_of, fixed_values))
            caption += f" The figure's title contains the value of {headings}. Another value: "
            caption += f"contactstudy report FOLDER --select {option}"
        pictures.append(Picture(encode_figure(figure), caption, round(PIXELS_PER_INCH * figure.get_figwidth())))
        pyplot.close(figure)
    return pictures


def _summarise_runs(runs: list[dict[str, Any]]) -> list[tuple[str, str]]:
    """Dates, versions and solution time of the cases."""
    if not runs:
        return []
    dates = sorted(str(run["time"])[:10] for run in runs if "time" in run)
    rows = [("solved", dates[0] if dates[0] == dates[-1] else f"{dates[0]} to {dates[-1]}")] if dates else []
    for name in VERSION_ENTRIES:
        versions = sorted({str(run[name]) for run in runs if name in run})
        if versions:
            rows.append((name, ", ".join(versions)))
    return [*rows, ("time of solving", f"{sum(run.get('seconds', 0.0) for run in runs):.0f} s of one core")]
