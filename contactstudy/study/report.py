"""Lines of text that the command line prints on a study, from plans, states and reports."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from contactstudy.study.folder import States
from contactstudy.study.progress import format_duration
from contactstudy.study.run import RunReport

MAX_REASONS = 20  # Reasons on the screen; ``--all`` lists every case with its reason


def format_path(path: Path) -> str:
    """Return a path, relative to the current folder if inside the folder."""
    with contextlib.suppress(ValueError, OSError):
        return str(path.relative_to(Path.cwd()))
    return str(path)


def format_bytes(size: float) -> str:
    """Return a size of files with a unit."""
    for unit in ("bytes", "kB", "MB"):
        if size < 1000:
            return f"{size:.3g} {unit}"
        size /= 1000
    return f"{size:.3g} GB"


def run_lines(report: RunReport) -> Iterator[str]:
    """Lines on the result of a run."""
    yield f"{len(report.plan)} cases: {report.states.summary}; {report.solved} solved now"
    yield from _group_reasons(("failed", reason, case.name) for case, reason in report.failures)
    if report.failures:
        yield f"  details in {format_path(report.folder / 'run.log')}"
        yield f"  again with: contactstudy rerun {format_path(report.folder)}"
    yield from _reasons(report.states, "skipped")
    for case in report.unconverged_cases[:MAX_REASONS]:
        yield f"  not converged, do not rely on it: {case.name}"
    for remark in report.remarks:
        yield f"  {remark}"
    if files := report.files:
        size = sum(path.stat().st_size for path in files)
        folder, plural = format_path(files[0].parent), "s" * (len(files) > 1)
        yield f"{len(files)} netCDF file{plural}, {format_bytes(size)}, in {folder}"
    if stale_cases := report.states.indices("stale"):
        rerun_command = f"contactstudy rerun {format_path(report.folder)}"
        yield f"{len(stale_cases)} stale ({report.states.reasons[stale_cases[0]]}); again with: {rerun_command}"


def _reasons(states: States, *statuses: str) -> Iterator[str]:
    """Lines on cases of some states, with their reasons."""
    cases = [states.plan[index] for index in states.indices(*statuses) if states.reasons[index]]
    yield from _group_reasons(
        (states.status[case.index], states.reasons[case.index], f"{case.id[:16]} {case.name}") for case in cases
    )


def _group_reasons(cases: Iterable[tuple[str, str, str]]) -> Iterator[str]:
    """Lines on cases (status, reason, name): for each reason the first case and the number of other cases."""
    groups: dict[tuple[str, str], list[str]] = {}
    for status, reason, name in cases:
        groups.setdefault((status, reason), []).append(name)
    for (status, reason), names in list(groups.items())[:MAX_REASONS]:
        yield f"  {status}: {names[0]}: {reason}{f' (and {len(names) - 1} more)' if len(names) > 1 else ''}"
    if len(groups) > MAX_REASONS:
        yield f"  ... and {len(groups) - MAX_REASONS} more reasons"


def state_lines(states: States, *, everything: bool) -> Iterator[str]:
    """Lines of counts, of the cases that need attention, or of every case, and on the remaining cases."""
    for status, count in states.counts.items():
        yield f"  {count} {status}"
    if everything:
        for case in states.plan:
            reason = states.reasons[case.index]
            state = f"  {states.status[case.index]}: {case.id[:16]} {case.name}"
            yield f"{state}: {reason}" if reason else state
    else:
        yield from _reasons(states, "skipped")
        yield from _reasons(states, "failed", "stale", "missing")
        if sum(map(bool, states.reasons)) > 1:
            yield "  every case: --all"
    yield from _forecast_lines(states)


def _forecast_lines(states: States) -> Iterator[str]:
    """Lines on exclusions without effect, unusual magnitudes, and bytes and time of the remaining cases."""
    plan = states.plan
    yield from (f"  {message}" for message in plan.unknown[:MAX_REASONS])
    for warning in plan.doubts[:MAX_REASONS]:
        yield f"  doubtful magnitude in SI units: {warning}"
    review = plan.review
    if review.checked < review.groups:
        yield f"  {review.checked} of {review.groups} contacts were checked; a run checks all"
    unique = plan.unique
    if duplicates := len(plan) - len(plan.skipped) - len(unique):
        yield f"  {duplicates} duplicates, solved once"
    missing, seconds = len(set(states.indices("missing")) & set(unique)), states.numbers("seconds")
    solved = int(np.isfinite(seconds).sum())
    if solved:
        size = sum(path.stat().st_size for path in states.results.paths)
        total = format_bytes(size / solved * len(plan.unique))
        yield f"files: about {total} at level {plan.level}, from {solved} solved cases"
    else:
        yield f"files: about {format_bytes(plan.size)} at level {plan.level} before compression"
    if missing and solved:
        yield (
            f"time: about {format_duration(float(np.nanmean(seconds)) * missing)} of one core for {missing} cases, "
            f"from {solved} solved ones"
        )
    elif missing:
        yield f"time: not estimated for {missing} cases; `plan --sample N` solves N of them for an estimate"
