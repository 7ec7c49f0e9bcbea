"""What the study layer costs beside solving, what a second worker gains, and whether the parent's memory stays flat.

Usage: ``python -m tests.benchmarks.study_layer [--cases 1000] [--pairs 48] [--rounds 1] [--memory 500]``; 0 leaves a
part out. All of it with the package's own solver on a small grid. Leave the machine alone meanwhile: the gain of a
second worker is stated beside what two bare processes, without the layer, gain on the same cases.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import tempfile
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import psutil
import xarray as xr

from contactstudy import Case, Grid, Study, run_study, solve
from contactstudy.study import RunReport
from contactstudy.study.executor import WORKER_ENVIRONMENT
from contactstudy.study.setup import build_setup
from contactstudy.study.work import single_threaded

BASE = {
    "young": 210e9,
    "poisson": 0.3,
    "radius": 5e-3,
    "roller_length": 0.5e-3,
    "cells_x": 4,
    "cells_y": 8,
    "stresses": False,
}
GIGAPASCAL = 1e9


def sweep(cases: int) -> Study:
    """Study of about `cases` cases with free ends, four frictions for each operator and load."""
    pressures = max(1, cases // 20)
    return Study(
        name="benchmark",
        level="summary",
        base=BASE,
        sweep={
            "e_over_a": [0.0, 0.5, 1.0, 2.0, 4.0],
            "max_pressure": [GIGAPASCAL * (1 + index / pressures) for index in range(pressures)],
            "friction": [0.0, 0.05, 0.1, 0.2],
        },
    )


def timed_solve(case: Case, grid: Grid, **settings: object) -> xr.Dataset:
    """Solve, and keep the time in the result."""
    began = time.perf_counter()
    result = solve(case, grid, **settings)  # type: ignore[arg-type]
    result["solver_seconds"] = time.perf_counter() - began
    result["solver_seconds"].attrs = {"units": "s", "long_name": "time in the solver"}
    return result


def run(study: Study, workers: int) -> tuple[RunReport, float]:
    """Run a study in a fresh folder; return the report and the seconds on the wall clock, start of workers included."""
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        report = run_study(study, folder, workers=workers, progress=False, solver=timed_solve)
        seconds = time.perf_counter() - began
    assert report.counts == {"ok": len(report.entries)}, report.counts
    return report, seconds


def overhead(cases: int) -> None:
    """Print the time of everything that is not the solver, in this process: plan, files, log, manifest."""
    study = sweep(cases)
    report, seconds = run(study, workers=0)
    solving = sum(entry.scalars["solver_seconds"] for entry in report.entries)
    number = len(report.entries)
    print(
        f"overhead: {number} cases in {seconds:.1f} s, {solving:.1f} s of it in the solver: "
        f"{1e3 * (seconds - solving) / number:.1f} ms per case, {100 * (seconds / solving - 1):.1f} % (bar 10 %)",
        flush=True,
    )


def solve_bare(parameters: list[dict[str, object]]) -> float:
    """Solve cases without the layer; return the seconds."""
    began = time.perf_counter()
    with single_threaded():
        for values in parameters:
            setup = build_setup(values)
            solve(setup.case, setup.grid, **setup.options)
    return time.perf_counter() - began


def bare(parameters: list[dict[str, object]], processes: int) -> float:
    """Return the seconds that cases take in `processes` bare processes, start and imports not counted."""
    with ProcessPoolExecutor(processes, mp_context=multiprocessing.get_context("spawn")) as pool:
        list(pool.map(solve_bare, [parameters[:1]] * processes))
        began = time.perf_counter()
        list(pool.map(solve_bare, [parameters[index::processes] for index in range(processes)]))
        return time.perf_counter() - began


def scaling(cases: int, rounds: int) -> None:
    """Print how much faster two workers are than one, in the layer and bare."""
    study = Study(
        name="scaling",
        level="summary",
        base=BASE | {"cells_x": 8, "cells_y": 16, "friction": 0.1},
        sweep={"e_over_a": [0.0, 1.0], "max_pressure": [GIGAPASCAL * (1 + i / cases) for i in range(cases // 2)]},
    )
    parameters = [case.parameters for case in study.plan().cases]
    for _ in range(rounds):
        seconds = {}
        for workers in (1, 2):
            seconds[workers] = run(study, workers)[1]
        alone = {processes: bare(parameters, processes) for processes in (1, 2)}
        print(
            f"scaling: {len(parameters)} cases, 1 worker {seconds[1]:.1f} s, 2 workers {seconds[2]:.1f} s: "
            f"{seconds[1] / seconds[2]:.2f} times as fast (bar 1.7); bare processes {alone[1]:.1f} s, "
            f"{alone[2]:.1f} s: {alone[1] / alone[2]:.2f} times; load of the machine {os.getloadavg()[0]:.1f}",
            flush=True,
        )


def memory(cases: int) -> None:
    """Print the parent's memory at a tenth, half and all of a study with two workers that keeps its fields."""
    base = {name: value for name, value in BASE.items() if name != "stresses"}
    points = {"field_x_over_a": [0.0, 1.0, 2.0], "field_y_over_a": [0.0], "field_z_over_a": [0.0, 0.5, 1.0]}
    pressures = max(1, cases // 5)
    study = Study(
        name="memory",
        level="fields",
        base=base | points | {"e_over_a": 1.0, "body": "half-space"},
        sweep={
            "max_pressure": [GIGAPASCAL * (1 + index / pressures) for index in range(pressures)],
            "friction": [0.0, 0.05, 0.1, 0.2, 0.3],
        },
    )
    samples: list[tuple[int, int]] = []
    with tempfile.TemporaryDirectory() as folder, sampled(Path(folder) / "cases", samples):
        report = run_study(study, folder, workers=2, progress=False)
    assert report.counts == {"ok": len(report.entries)}, report.counts
    number = len(report.entries)
    shown = []
    for share in (0.1, 0.5, 1.0):
        at = next((size for count, size in samples if count >= share * number), samples[-1][1])
        shown.append(f"{at / 1e6:.1f} MB at case {share * number:.0f}")
    print(
        f"memory of the parent: {', '.join(shown)}; largest {max(size for _, size in samples) / 1e6:.1f} MB", flush=True
    )


@contextmanager
def sampled(folder: Path, samples: list[tuple[int, int]]) -> Iterator[None]:
    """Sample (finished cases, this process's resident bytes) while the block runs."""
    process, ended = psutil.Process(), threading.Event()

    def watch() -> None:
        last = False
        while not last:
            last = ended.wait(0.2)
            count = sum(entry.name.endswith(".nc") for entry in os.scandir(folder)) if folder.is_dir() else 0
            samples.append((count, process.memory_info().rss))

    thread = threading.Thread(target=watch, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def main() -> None:
    """Measure what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=1000, help="cases for the overhead")
    parser.add_argument("--pairs", type=int, default=48, help="cases for one and two workers")
    parser.add_argument("--rounds", type=int, default=1, help="times to compare these")
    parser.add_argument("--memory", type=int, default=500, help="cases for the parent's memory")
    options = parser.parse_args()
    os.environ.update(WORKER_ENVIRONMENT)
    if options.memory:
        memory(options.memory)
    if options.pairs:
        scaling(options.pairs, options.rounds)
    if options.cases:
        overhead(options.cases)


if __name__ == "__main__":
    main()
