"""Rows on contact: point contact and roller against peers, then the free ends against the half-space."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from benchmarks.performance.peers import (
    LIMIT_SETTING,
    OURS,
    SETTINGS,
    Solver,
    ignore_warnings,
    load_codes,
    solve_ours,
    solve_peer_contact,
)
from benchmarks.performance.problems import FloatArray, Problem, roller, sphere
from benchmarks.performance.timing import Report, Row, compute_medians, format_time, join_times
from contactstudy import solve_contact
from contactstudy.contact import ContactSettings

ERROR_BOUND = 1e-6
ROLLER_CELLS, ROLLER_WINDOW = (512, 64), 40.0
PEERS = ("aspher", "tamaas", "ContactMechanics", "plain SciPy")


def compute_relative_difference(pressure: FloatArray, converged_pressure: FloatArray) -> float:
    """Sum of the absolute differences of two pressures over the sum of the converged pressure."""
    return float(np.abs(pressure - converged_pressure).sum() / converged_pressure.sum())


def find_loosest_setting(solve: Solver, problem: Problem, goal: float = ERROR_BOUND) -> tuple[float, float]:
    """Loosest tolerance with an error below `goal` relative to the code's limit, and this error.

    Parameters
    ----------
    solve : callable
        Contact code.
    problem : Problem
        Solved contact.
    goal : float
        Allowed difference from the code's pressure at its tightest setting.

    Raises
    ------
    RuntimeError
        If no setting is tight enough.
    """
    converged_pressure = solve(problem, LIMIT_SETTING)
    errors: dict[int, float] = {}

    def error(setting_index: int) -> float:
        if setting_index not in errors:
            errors[setting_index] = compute_relative_difference(
                solve(problem, SETTINGS[setting_index]), converged_pressure
            )
        return errors[setting_index]

    setting_index = SETTINGS.index(min(SETTINGS, key=lambda setting: abs(np.log10(setting / goal))))
    while setting_index < len(SETTINGS) - 1 and error(setting_index) > goal:
        setting_index += 1
    while setting_index > 0 and error(setting_index - 1) <= goal:
        setting_index -= 1
    if error(setting_index) > goal:
        raise RuntimeError(f"no setting comes within {goal:g} of the limit")
    return SETTINGS[setting_index], error(setting_index)


def compare(problem: Problem, names: tuple[str, ...], repeats: int, report: Report) -> tuple[dict[str, float], str]:
    """Median seconds of each code at equal measured accuracy, and a note on its settings."""
    timed_functions: dict[str, Callable[[], object]] = {}
    notes = []
    converged_pressures: dict[str, FloatArray] = {}
    for name, solve in load_codes(names, report.add_remark):
        with ignore_warnings():
            try:
                setting, error = find_loosest_setting(solve, problem)
            except RuntimeError as reason:
                report.add_remark(f"{name} is skipped for {problem.gap.shape} cells: {reason}")
                continue
            converged_pressures[name] = solve(problem, setting)
        timed_functions[name] = partial(solve, problem, setting)
        notes.append(f"{name} {error:.0e} at {setting:.0e}")
    with ignore_warnings():
        seconds = compute_medians(timed_functions, repeats, warm_up=False)
    max_difference = max(
        compute_relative_difference(pressure, converged_pressures[OURS]) for pressure in converged_pressures.values()
    )
    return seconds, f"measured error at setting: {', '.join(notes)}; codes agree within {max_difference:.0e}"


def point_contact(repeats: int, report: Report) -> Iterator[Row]:
    """Sphere on a half-space, square grids."""
    for cells in (128, 256, 512):
        problem = sphere(cells)
        seconds, note = compare(problem, PEERS, repeats if cells < 512 else min(repeats, 3), report)
        our_seconds = seconds.pop(OURS)
        iterations = float(solve_peer_contact(problem)["iterations"])
        fastest_peer = seconds.get("aspher")
        yield Row(
            work=f"half-space point contact {cells}²",
            ours=format_time(our_seconds),
            peers=join_times(seconds),
            ratio=", ".join(f"{our_seconds / duration:.2f}" for duration in seconds.values()),
            bar="no slower than aspher",
            met=None if fastest_peer is None else our_seconds <= fastest_peer,
            notes=f"{note}; {iterations:.0f} operator applications at the default 1e-6",
        )


def half_space_roller(repeats: int, report: Report) -> Iterator[Row]:
    """Cylinder with sharp ends on a half-space, rectangular cells."""
    problem = roller(ROLLER_CELLS, ROLLER_WINDOW, free_ends=False)
    seconds, note = compare(problem, PEERS[1:], repeats, report)
    report.add_remark("aspher has square cells only: no roller on 512 x 64")
    our_seconds = seconds.pop(OURS)
    yield Row(
        work="half-space roller 512 x 64",
        ours=format_time(our_seconds),
        peers=join_times(seconds),
        ratio=", ".join(f"{our_seconds / duration:.2f}" for duration in seconds.values()),
        bar="0.15 s",
        met=our_seconds <= 0.15,
        notes=note,
    )


def finite_length_roller(repeats: int, report: Report) -> Iterator[Row]:
    """Contact with free ends on the same cells, once the operator is built."""
    bar = 2.0
    half_space = roller(ROLLER_CELLS, ROLLER_WINDOW, free_ends=False)
    for overhang, label in ((2.0, "ends 2a inside the body's"), (0.0, "roller as long as the body")):
        roller_with_ends = roller(ROLLER_CELLS, ROLLER_WINDOW, free_ends=True, overhang=overhang)
        timed_functions: dict[str, Callable[[], object]] = {
            "finite": partial(solve_peer_contact, roller_with_ends),
            "built": partial(solve_peer_contact, half_space),
            "cold": partial(solve_ours, half_space, 1e-6),
        }
        seconds = compute_medians(timed_functions, repeats)
        application_counts = {
            name: int(solve_peer_contact(problem)["iterations"])
            for name, problem in (("f", roller_with_ends), ("h", half_space))
        }
        ratio = seconds["finite"] / seconds["built"]
        yield Row(
            work=f"finite-length contact 512 x 64, built; {label}",
            ours=format_time(seconds["finite"]),
            peers=f"our half-space: {format_time(seconds['built'])} built, {format_time(seconds['cold'])} cold",
            ratio=f"{ratio:.2f}, {seconds['finite'] / seconds['cold']:.2f}",
            bar=f"{bar:g}x the half-space",
            met=ratio <= bar,
            notes=f"all at the default 1e-6; operator applications {application_counts['f']}, "
            f"half-space {application_counts['h']}",
        )


def iterations(_: int, report: Report) -> Iterator[Row]:
    """Operator applications of this package for each case, at two tolerances."""
    cases = {
        **{f"sphere {cells}²": sphere(cells) for cells in (128, 256, 512)},
        "half-space roller 512 x 64": roller(ROLLER_CELLS, ROLLER_WINDOW, free_ends=False),
        "finite-length 512 x 64": roller(ROLLER_CELLS, ROLLER_WINDOW, free_ends=True),
        "finite-length 1000 x 48": roller((1000, 48), 100.0, free_ends=True),
    }
    for tolerance in (1e-4, 1e-6, 1e-8):
        counts = []
        for name, problem in cases.items():
            contact = solve_contact(
                problem.body, problem.make_gap_array(), load=problem.load, settings=ContactSettings(tolerance=tolerance)
            )
            if not bool(contact["converged"]):
                report.add_remark(f"not converged: {name} at {tolerance:g}")
            counts.append(f"{name}: {int(contact['iterations'])}")
        yield Row(work=f"operator applications at {tolerance:.0e}", ours=", ".join(counts), bar="aspher: 8 at 1e-6")
