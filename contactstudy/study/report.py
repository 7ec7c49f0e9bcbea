"""What the command line says of a study: lines of text from plans, states and reports."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

from contactstudy.study.folder import Entry
from contactstudy.study.plan import Plan
from contactstudy.study.progress import duration
from contactstudy.study.run import RunReport

# Most reasons on the screen; ``--all`` lists every case with its own.
SHOWN = 20


def shown(path: Path) -> str:
    """Path relative to the current folder where that is shorter."""
    try:
        return str(path.relative_to(Path.cwd()))
    except ValueError:
        return str(path)


def in_bytes(size: float) -> str:
    """Size of files in words.

    Examples
    --------
    >>> in_bytes(20), in_bytes(123456), in_bytes(5e12)
    ('20 bytes', '123 kB', '5e+03 GB')
    """
    for unit in ("bytes", "kB", "MB"):
        if size < 1000:
            return f"{size:.3g} {unit}"
        size /= 1000
    return f"{size:.3g} GB"


def run_lines(report: RunReport) -> Iterator[str]:
    """Lines on what a run did."""
    counts = ", ".join(f"{count} {status}" for status, count in report.counts.items())
    yield f"{len(report.plan.cases)} cases: {counts}; {report.solved} solved now"
    yield from _alike(("failed", entry.reason, case.name) for case, entry in report.failures)
    if report.failures:
        yield f"  details in {shown(report.folder / 'run.log')}"
        yield f"  again with: contactstudy rerun {shown(report.folder)}"
    yield from skipped_lines(report.plan)
    for case in report.not_converged[:SHOWN]:
        yield f"  not converged, do not rely on it: {case.name}"
    for remark in report.remarks:
        yield f"  {remark}"
    files = report.files
    if files:
        size = sum(path.stat().st_size for path in files)
        kind = "netCDF files" if len(files) > 1 else "netCDF file"
        yield f"{len(files)} {kind}, {in_bytes(size)}, in {shown(files[0].parent)}"


def stale_lines(report: RunReport) -> Iterator[str]:
    """Lines on what a run left as it was because another version solved it."""
    stale = [entry for entry in report.entries if entry.status == "stale"]
    if stale:
        again = f"contactstudy rerun {shown(report.folder)}"
        yield f"{len(stale)} stale ({stale[0].reason}); again with: {again}"


def skipped_lines(plan: Plan) -> Iterator[str]:
    """Lines on the cases that cannot be solved."""
    yield from _alike(("skipped", case.reason, case.name) for case in plan.skipped)


def _alike(cases: Iterable[tuple[str, str, str]]) -> Iterator[str]:
    """Lines on cases, each its status, reason and name: of those that are alike the first, and how many more."""
    groups: dict[tuple[str, str], list[str]] = {}
    for status, reason, name in cases:
        groups.setdefault((status, reason), []).append(name)
    for (status, reason), names in list(groups.items())[:SHOWN]:
        yield f"  {status}: {names[0]}: {reason}{f' (and {len(names) - 1} more)' if len(names) > 1 else ''}"
    if len(groups) > SHOWN:
        yield f"  ... and {len(groups) - SHOWN} more reasons"


def state_lines(plan: Plan, entries: list[Entry], *, everything: bool) -> Iterator[str]:
    """Lines of counts, and of the cases that need attention, or of every case."""
    for status, count in Counter(entry.status for entry in entries).items():
        yield f"  {count} {status}"
    named = [(case, entry, f"{case.id[:16]} {case.name}") for case, entry in zip(plan.cases, entries, strict=True)]
    if everything:
        for _, entry, name in named:
            yield f"  {entry.status}: {name}" + (f": {entry.reason}" if entry.reason else "")
        return
    yield from skipped_lines(plan)
    listed = [(entry.status, entry.reason, name) for case, entry, name in named if entry.reason and not case.reason]
    yield from _alike(listed)
    if len(listed) > 1:
        yield "  every case: --all"


def forecast_lines(plan: Plan, entries: list[Entry]) -> Iterator[str]:
    """Lines on exclusions without effect and doubtful magnitudes, and on bytes and time of the cases to come."""
    yield from (f"  {unknown}" for unknown in plan.unknown[:SHOWN])
    for doubt in plan.doubts[:SHOWN]:
        yield f"  doubtful, for units are SI: {doubt}"
    pairs = list(zip(plan.cases, entries, strict=True))
    done = {case.id: (case.cost, entry.scalars["seconds"]) for case, entry in pairs if "seconds" in entry.scalars}
    todo = {case.id: case for case, entry in pairs if entry.status == "missing"}
    unique = plan.unique
    duplicates = len(plan.cases) - len(plan.skipped) - len(unique)
    if duplicates:
        yield f"  {duplicates} duplicates, solved once"
    yield f"files: at most {in_bytes(sum(case.size(plan.level) for case in unique))} at level {plan.level}"
    effort = sum(cost for cost, _ in done.values())
    if todo and effort:
        seconds = sum(taken for _, taken in done.values()) / effort * sum(case.cost for case in todo.values())
        yield f"time: about {duration(seconds)} of one core for {len(todo)} cases"
    elif todo:
        yield f"time: known when the first of {len(todo)} cases is solved"
