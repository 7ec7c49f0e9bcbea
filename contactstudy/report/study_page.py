"""What the page of a study shows: its cases in a table, figures over the swept parameters, failures with reasons."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from contactstudy.analysis.certainty import CARE, NO, UNKNOWN, YES, certainty
from contactstudy.analysis.provenance import RUN_ATTRIBUTE
from contactstudy.arrays.engineering import with_error
from contactstudy.report.figures import PIXELS, Picture, as_address
from contactstudy.report.study_pictures import figures_of_folder
from contactstudy.study.definition import Study
from contactstudy.study.folder import Entry, Folder
from contactstudy.study.parameters import PARAMETERS, with_defaults
from contactstudy.study.plan import Plan, PlannedCase, in_engineers_words, label

SHOWN = {
    "peak_pressure": "largest pressure",
    "end_pressure_first": "at end I",
    "end_pressure_last": "at end II",
    "peak_von_mises": "largest von Mises",
}
"""Numbers of a case in the table, with their headings."""

SINGULAR_SHOWN = {
    "end_intensity_first": "K at end I",
    "end_intensity_last": "K at end II",
    "end_load_first": "load on the last a, end I",
    "end_load_last": "load on the last a, end II",
}
"""Numbers that stand for the pressure at a singular end, with their headings: only of such ends."""

CAPTIONS = {
    "edge_effect": "Pressure along the axis, and von Mises stress in the plane y = 0, for several distances "
    "from the end.",
    "study": "Largest values of the cases over the swept parameters; where all are singular, the loads on the last "
    "half-width a at the ends. Bars: stated errors; open marks: no error is "
    "known. An open triangle at the top: singular, there is no largest value.",
}
"""What figures show, by name."""


SIZE = re.compile(r" to ([0-9.]+)%$")
"""Size of an error at the end of a reason."""

WORST_FIRST = (NO, CARE, UNKNOWN, YES)
"""Answers."""


class Row(NamedTuple):
    """One case in the table."""

    anchor: str
    values: list[str]
    numbers: list[str]
    status: str
    note: str
    real: str
    reason: str


def study_context(path: Path, selection: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Everything that the template of a study needs.

    Parameters
    ----------
    path : Path
        The study's folder.
    selection : mapping, optional
        Values of swept parameters to which the figures keep; the table has all cases.
    """
    folder = Folder(path)
    study = folder.read_study()
    plan = study.plan()
    entries = folder.entries(plan)
    numbers = [name for name in SHOWN if any(_has_more(entry, name) for entry in entries)]
    numbers += [name for name in SINGULAR_SHOWN if any(_is_singular(entry, name) for entry in entries)]
    swept = list(dict.fromkeys([*study.sweep, *(name for group in study.zip for name in group), *_explicit(study)]))
    rows = [
        _row(case, entry, _swept_values(plan, case, swept), numbers, number)
        for number, (case, entry) in enumerate(zip(plan.cases, entries, strict=True), 1)
    ]
    runs = [entry.run for entry in entries if entry.run]
    return {
        "title": f"Study {study.name}",
        "description": study.description,
        "shape": _shape(plan),
        "counts": Counter(entry.status for entry in entries),
        "base": [(_meaning(name), in_engineers_words(name, value)) for name, value in study.base.items()],
        "swept": [(_meaning(name), _values(name, rows, at)) for at, name in enumerate(swept)],
        "headings": [_called(name) for name in swept],
        "number_headings": [(SHOWN | SINGULAR_SHOWN)[name] for name in numbers],
        "intensities": any(name.startswith("end_intensity") for name in numbers),
        "rows": rows,
        "reasons": _reasons(rows),
        "answers": _answers(rows),
        "verdict": _verdict(rows),
        "pictures": _pictures(path, selection),
        "provenance": _provenance(runs),
    }


def _explicit(study: Study) -> list[str]:
    """Parameters in which explicit cases differ from the base."""
    return [name for case in study.cases for name in case]


def _meaning(name: str) -> str:
    """Meaning of a parameter, for a heading."""
    return PARAMETERS[name].meaning if name in PARAMETERS else name.replace("_", " ")


def _called(name: str) -> str:
    """Return what a parameter is called on axes; groups of parameters have the study's names.

    Examples
    --------
    >>> _called("e_over_a"), _called("tilt"), _called("case")
    ('end distance over a', 'tilt', 'case')
    """
    return PARAMETERS[name].attrs["long_name"] if name in PARAMETERS else name.replace("_", " ")


def _swept_values(plan: Plan, case: PlannedCase, swept: list[str]) -> list[str]:
    """Values of the swept parameters of a case, as the study names them."""
    given = with_defaults(case.parameters)
    found = []
    for name in swept:
        dim, labels = plan.cube.labels.get(name, ("", ()))
        value = labels[case.position[plan.cube.dims.index(dim)]] if dim in plan.cube.dims else given.get(name)
        if isinstance(given.get(name), dict) and value == label(name, given[name]):
            value = given[name]  # it has no name of its own: say its values
        found.append("" if value is None else in_engineers_words(name, value))
    return found


def _row(case: PlannedCase, entry: Entry, values: list[str], numbers: list[str], number: int) -> Row:
    """One case with its numbers and errors."""
    scalars = entry.scalars
    found = []
    for name in numbers:
        if name not in scalars or (name in SINGULAR_SHOWN and not _is_singular(entry, name)):
            found.append("")
        elif name.startswith("end_intensity"):
            found.append(_intensity(scalars, name))
        elif _not_pressed(scalars, name):
            found.append("not pressed")
        elif np.isinf(scalars[name]) or (name == "peak_von_mises" and np.isinf(scalars.get("peak_pressure", 0.0))):
            found.append("singular")
        else:
            units = "N" if name.startswith("end_load") else "Pa"
            found.append(_with_mark(scalars[name], scalars.get(f"{name}_error"), units))
    real, reason = _certainty(entry) if scalars else ("", "")
    note = reason if real == NO else entry.reason
    return Row(f"case-{number}", values, found, entry.status, note, real, reason)


def _has_more(entry: Entry, name: str) -> bool:
    """Whether a case has a number; that an end is singular its K says already, and one not pressed has no pressure."""
    if name not in entry.scalars or _not_pressed(entry.scalars, name):
        return False
    said = f"end_intensity_{name.rpartition('_')[2]}" in entry.scalars and name.startswith("end_pressure")
    return not (said and np.isinf(entry.scalars[name]))


def _not_pressed(scalars: Mapping[str, float], name: str) -> bool:
    """Whether a number is the pressure of an end that is not pressed."""
    return name.startswith("end_pressure") and scalars[name] == 0


def _is_singular(entry: Entry, name: str) -> bool:
    """Whether the end that a number belongs to is singular, and the number is known."""
    end = name.rpartition("_")[2]
    return f"end_intensity_{end}" in entry.scalars and np.isfinite(entry.scalars.get(name, np.nan))


def _intensity(scalars: Mapping[str, float], name: str) -> str:
    """K of the law of a singular end; its unit says the exponent."""
    exponent = scalars[name.replace("intensity", "exponent")]
    factor = 1e9 * 1e-3**exponent
    error = scalars.get(f"{name}_error", np.nan)
    return _with_mark(scalars[name] / factor, error / factor, f"GPa mm^{exponent:.3g}")


def _with_mark(value: float, error: float | None, units: str) -> str:
    """Write a number with its error, or with the mark that it has none."""
    known = error is not None and np.isfinite(error)
    text = with_error(value, error if known else None, units)
    return text if known else f"{text} (error not known)"


def _certainty(entry: Entry) -> tuple[str, str]:
    """Whether the numbers of a case are real, and why not if so, from the scalars that the study keeps."""
    known = {name: value for name, value in entry.scalars.items() if not np.isnan(value)}
    found = certainty(xr.Dataset(known, attrs={RUN_ATTRIBUTE: json.dumps(entry.run)}))
    return found.overall, found.summary


def _answers(rows: list[Row]) -> list[tuple[str, str, list[Row]]]:
    """Answers and reasons with their cases, the worst first."""
    grouped: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        if row.real:
            # The size of an error differs from case to case; the sentence before it is the reason.
            grouped.setdefault((row.real, SIZE.sub("", row.reason)), []).append(row)
    keys = sorted(grouped, key=lambda key: WORST_FIRST.index(key[0]))
    return [(answer, _sized(reason, grouped[answer, reason]), grouped[answer, reason]) for answer, reason in keys]


def _sized(reason: str, cases: list[Row]) -> str:
    """Reason of several cases, with the range of the errors that their own reasons end with."""
    sizes = [float(found[1]) for row in cases if (found := SIZE.search(row.reason))]
    if not sizes:
        return reason
    low, high = min(sizes), max(sizes)
    return f"{reason} to {high:.1f}%" + (f" in the worst case, {low:.1f}% in the best" if low < high else "")


def _verdict(rows: list[Row]) -> tuple[str, str]:
    """Worst answer of a study's cases, and how many have which; what is not solved needs care."""
    count = Counter(row.real for row in rows if row.real)
    worst = next((answer for answer in WORST_FIRST if answer in count), UNKNOWN)
    if worst in (YES, UNKNOWN) and any(row.status != "ok" for row in rows):
        worst = CARE
    words = {NO: "not to be relied on", CARE: "real with care", UNKNOWN: "not known to be real", YES: "real"}
    return worst, ", ".join(f"{count[answer]} {words[answer]}" for answer in WORST_FIRST if count[answer])


def _values(name: str, rows: list[Row], at: int) -> str:
    """Different values of a swept parameter, in order."""
    found = list(dict.fromkeys(row.values[at] for row in rows if row.values[at]))
    return ", ".join(found) if len(found) <= 12 else f"{len(found)} values, {found[0]} to {found[-1]}"


def _shape(plan: Plan) -> str:
    """Dimensions of the study in words."""
    pairs = zip(plan.cube.dims, plan.cube.shape, strict=True)
    said = ", ".join(f"{_called(dim)}: {size}" for dim, size in pairs)
    return f"{len(plan.cases)} cases ({said})"


def _reasons(rows: list[Row]) -> list[tuple[str, str, list[Row]]]:
    """Status, reason and cases of everything that is not solved, equal reasons together."""
    grouped: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        if row.status != "ok":
            grouped.setdefault((row.status, row.note), []).append(row)
    return [(status, reason, cases) for (status, reason), cases in grouped.items()]


def _pictures(path: Path, selection: Mapping[str, Any] | None) -> list[Picture]:
    """Figures that suit the study; none if nothing of it can be drawn."""
    from matplotlib import pyplot

    found = []
    for name, (figure, others) in figures_of_folder(path, selection).items():
        caption = CAPTIONS.get(name, name.replace("_", " "))
        found.append(
            Picture(as_address(figure), f"{caption}{_to_choose(others)}", round(PIXELS * figure.get_figwidth()))
        )
        pyplot.close(figure)
    return found


def _to_choose(others: dict[str, str]) -> str:
    """Say of which parameters one value is drawn, and how to draw another."""
    if not others:
        return ""
    name, value = next(iter(others.items()))
    command = f"{name}={value}" if not set(f"{name}{value}") & set(" $\\'\"()&;|<>*?#`!") else f'"{name}={value}"'
    return (
        f" Of {' and '.join(_called(each) for each in others)} one value is drawn, which the title says. Another is "
        f"drawn by: contactstudy report FOLDER --select {command}"
    )


def _provenance(runs: list[dict[str, Any]]) -> list[tuple[str, str]]:
    """Versions and dates of the files."""
    if not runs:
        return []
    times = sorted(str(run["time"])[:10] for run in runs if "time" in run)
    rows = [("solved", times[0] if times[0] == times[-1] else f"{times[0]} to {times[-1]}")] if times else []
    for name in ("contactstudy", "commit", "python", "numpy", "scipy"):
        known = sorted({str(run[name]) for run in runs if name in run})
        if known:
            rows.append((name, ", ".join(known)))
    seconds = sum(float(run.get("seconds", 0.0)) for run in runs)
    return [*rows, ("time of solving", f"{seconds:.0f} s of one core")]
