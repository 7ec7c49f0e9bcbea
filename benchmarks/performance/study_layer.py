"""Cost of the study layer beside solving: planning, overhead of a case, files, opening, speed-up by a second worker.

Usage: ``python -m benchmarks.performance.study_layer [--frictions 50] [--pairs 48] [--cases 100000]``; 0 omits a
measurement. The speed-up by a second worker is printed beside the speed-up by a second process without the layer, on
the same cases. The option ``--level surface`` retains surfaces; ``--client`` solves on an existing dask cluster.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import resource
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import xarray as xr
from distributed import Client

from contactstudy import Study, open_study, run_study, solve
from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.fields import surface
from contactstudy.study import RunReport
from contactstudy.study.case_setup import build_setup
from contactstudy.study.engine import WORKER_ENVIRONMENT
from contactstudy.study.worker import Solver, single_threaded
from tests.stand_in_solver import solve_fake
from tests.study.cluster import cluster

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


TABLE: dict[str, Any] = {
    "young": 210e9,
    "poisson": 0.3,
    "radius": 5e-3,
    "roller_length": 10e-3,
    "profile": {"kind": "cylinder", "fillet_radius": 5e-5},
    "stresses": False,
}
"""Case of a table of numbers: a roller with an edge radius, on refined columns."""


def time_study(study: Study, folder: Path, workers: int, solver: Solver | None = None) -> tuple[RunReport, float]:
    """Run a study; return the report and the elapsed seconds, start of workers included."""
    start_time = time.perf_counter()
    report = run_study(study, folder, workers=workers, progress=False, solver=solver)
    seconds = time.perf_counter() - start_time
    assert report.counts == {"ok": len(report.plan)}, report.counts
    return report, seconds


def print_overhead(frictions: int) -> None:
    """Print the processor time of cases without their contact: the 8 contacts are in the cache."""
    contacts = {"max_pressure": [1e9, 1.5e9], "e_over_a": [0.0, 1.0, 2.0, 4.0]}
    seconds = []
    for friction_count in (2, 1, frictions):  # the first run solves the contacts
        swept = contacts | {"friction": (0.3 * np.arange(1, friction_count + 1) / friction_count).tolist()}
        study = Study(name="overhead", level="summary", base=TABLE, sweep=swept)
        with tempfile.TemporaryDirectory() as folder:
            start_time = time.process_time()
            time_study(study, Path(folder), workers=0)
            seconds.append(time.process_time() - start_time)
    seconds_per_case = (seconds[2] - seconds[1]) / (8 * (frictions - 1))
    print(
        f"overhead: {1e3 * seconds_per_case:.2f} ms of processor time per case beyond its contact (bar 5 ms)",
        flush=True,
    )


def print_stacking_gain(contacts: int = 10) -> None:
    """Print the fraction of the time of a contact that a common product of the spectra of several contacts would
    save."""
    single_seconds = stacked_seconds = 0.0
    multiply = surface._multiply_matrices

    def multiply_timed(matrices: FloatArray, spectrum: ComplexArray) -> ComplexArray:
        nonlocal single_seconds, stacked_seconds
        stacked_spectra = np.repeat(spectrum[..., None], contacts, axis=-1).view(np.float64)
        start_time = time.process_time()
        product = multiply(matrices, spectrum)
        single_end = time.process_time()
        _ = matrices @ stacked_spectra
        single_seconds, stacked_seconds = (
            single_seconds + single_end - start_time,
            stacked_seconds + time.process_time() - single_end,
        )
        return product

    study = Study(name="stacking", level="summary", base=TABLE, sweep={"e_over_a": [1.0], "max_pressure": [1e9, 1.5e9]})
    with tempfile.TemporaryDirectory() as folder, mock.patch.object(surface, "_multiply_matrices", multiply_timed):
        start_time = time.process_time()
        time_study(study, Path(folder), workers=0)
        seconds = time.process_time() - start_time - stacked_seconds
    saved_fraction = (single_seconds - stacked_seconds / contacts) / seconds
    print(
        f"stacking: {contacts} contacts at once would save {100 * saved_fraction:.1f} % of the time of each", flush=True
    )


def print_scaling_error(factor: float = 1.7) -> None:
    """Print the difference between the dimensionless results of two rollers with equal ratios of lengths."""
    lengths = {name: [TABLE[name], factor * TABLE[name]] for name in ("radius", "roller_length")}
    profiles = [{"kind": "cylinder", "fillet_radius": scale * 5e-5} for scale in (1.0, factor)]
    base = {"max_pressure": 1.5e9, "e_over_a": 1.0} | TABLE
    study = Study(name="scaled", level="summary", base=base, zip=lengths | {"profile": profiles})
    with tempfile.TemporaryDirectory() as folder:
        results = time_study(study, Path(folder), workers=0)[0].states
    ratios = [
        results.numbers(name)[1] / results.numbers(name)[0] / factor**power
        for name, power in (("peak_pressure", 0), ("approach", 1), ("end_load_last", 2))
    ]
    print(f"scaled: numbers differ by at most {np.abs(np.array(ratios) - 1).max():.0e}", flush=True)


def print_overhead_of_distinct_contacts(contacts: int = 1000) -> None:
    """Print the processor time of cases that share no contact, less the time of the stand-in solver."""
    solver_seconds = 0.0

    def solve_timed(*arguments: Any, **options: Any) -> xr.Dataset:
        nonlocal solver_seconds
        start_time = time.process_time()
        result = solve_fake(*arguments, **options)
        solver_seconds += time.process_time() - start_time
        return result

    sweep = {"max_pressure": np.linspace(1e9, 2e9, contacts).tolist()}
    study = Study(name="distinct", level="summary", base=BASE | {"e_over_a": 1.0}, sweep=sweep)
    with tempfile.TemporaryDirectory() as folder:
        start_time = time.process_time()
        time_study(study, Path(folder), 0, solve_timed)
        seconds = time.process_time() - start_time - solver_seconds
    print(f"overhead: {1e3 * seconds / contacts:.2f} ms per case, {contacts} distinct contacts (bar 5 ms)", flush=True)


def measure_peak_memory() -> float:
    """Largest memory of this process, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


def print_client_memory(cases: int) -> None:
    """Print the memory of a scheduler, two workers and the run for a tenth of the cases and for all cases; 100
    contacts."""
    contacts = {"max_pressure": np.linspace(1e9, 2e9, 10).tolist(), "e_over_a": np.linspace(0.0, 4.5, 10).tolist()}
    with tempfile.TemporaryDirectory() as name, cluster(Path(name)) as address, Client(str(address)) as client:
        for count in (cases // 10, cases):
            sweep = contacts | {"friction": np.linspace(0.0, 0.2, count // 100).tolist()}
            study = Study(name="client", level="summary", base=TABLE, sweep=sweep)
            start_time = time.perf_counter()
            report = run_study(study, Path(name, f"{count}"), scheduler=client, progress=False)
            seconds = time.perf_counter() - start_time
            assert report.counts == {"ok": count}, report.counts
            workers = ", ".join(f"{memory:.0f}" for memory in client.run(measure_peak_memory).values())
            scheduler_memory = client.run_on_scheduler(measure_peak_memory)
            print(
                f"client: {count} cases, {seconds:.0f} s, {len(report.files)} files; largest memory so far: scheduler "
                f"{scheduler_memory:.0f} MB, workers {workers} MB, run {measure_peak_memory():.0f} MB",
                flush=True,
            )


def print_files(cases: int, level: str) -> None:
    """Print files, bytes, memory and time to open a study of many cases with the stand-in solver."""
    sweep = {"max_pressure": np.linspace(1e9, 2e9, 10).tolist(), "friction": np.linspace(0, 0.2, cases // 100).tolist()}
    base = BASE | {"roller_length": 0.3e-3}
    study = Study(name="files", level=level, base=base, sweep=sweep | {"e_over_a": np.linspace(0, 4, 10).tolist()})
    with tempfile.TemporaryDirectory() as name:
        start_time = time.process_time()
        report, _ = time_study(study, Path(name), 0, solve_fake)
        solving_seconds = time.process_time() - start_time
        size = sum(path.stat().st_size for path in report.files)
        count = len(report.files)
        del report
        start_time = time.process_time()
        dataset = open_study(name)
        opening_seconds = time.process_time() - start_time
        start_time = time.process_time()
        max_pressure = float(dataset["peak_pressure"].max())
        reading_seconds = time.process_time() - start_time
    print(
        f"files, level {level}: {study.size} cases, {count} files, {size / study.size:.0f} bytes per case, "
        f"{1e3 * solving_seconds / study.size:.1f} ms per case with the stand-in solver in this process, opened in "
        f"{opening_seconds:.1f} s of processor time, one number of all ({max_pressure:.3g}) in "
        f"{reading_seconds:.2f} s, largest memory {measure_peak_memory():.0f} MB",
        flush=True,
    )


def print_planning() -> None:
    """Print time and memory of the plan of a million combinations."""
    sweep = {
        "max_pressure": np.linspace(1e9, 2e9, 100).tolist(),
        "e_over_a": np.linspace(0, 5, 100).tolist(),
        "friction": np.linspace(0, 0.2, 100).tolist(),
    }
    study = Study(name="million", base=TABLE, sweep=sweep)
    start_time = time.process_time()
    plan = study.plan()
    unique_count, checked_count = len(plan.unique), plan.review.checked
    seconds = time.process_time() - start_time
    memory = measure_peak_memory()
    print(
        f"plan: {unique_count} cases, {checked_count} contacts checked, {seconds:.1f} s (bar 10 s), "
        f"{memory:.0f} MB (bar 1000 MB)"
    )


def solve_without_study(parameters: list[dict[str, object]]) -> float:
    """Solve cases without the layer; return the seconds."""
    start_time = time.perf_counter()
    with single_threaded():
        for values in parameters:
            setup = build_setup(values)
            solve(setup.case, setup.grid, **setup.options)
    return time.perf_counter() - start_time


def time_without_study(parameters: list[dict[str, object]], processes: int) -> float:
    """Return the seconds of cases in `processes` processes without the layer, after start and imports."""
    with ProcessPoolExecutor(processes, mp_context=multiprocessing.get_context("spawn")) as pool:
        list(pool.map(solve_without_study, [parameters[:1]] * processes))
        start_time = time.perf_counter()
        list(pool.map(solve_without_study, [parameters[index::processes] for index in range(processes)]))
        return time.perf_counter() - start_time


def print_speed_up(cases: int, rounds: int) -> None:
    """Print the speed-up by a second worker, and by a second process without the layer."""
    study = Study(
        name="scaling",
        level="summary",
        base=BASE | {"cells_x": 8, "cells_y": 16, "friction": 0.1},
        sweep={"e_over_a": [0.0, 1.0], "max_pressure": [GIGAPASCAL * (1 + i / cases) for i in range(cases // 2)]},
    )
    parameters = [case.parameters for case in study.plan()]
    for _ in range(rounds):
        seconds = {}
        for workers in (1, 2):
            with tempfile.TemporaryDirectory() as folder:
                seconds[workers] = time_study(study, Path(folder), workers)[1]
        bare_seconds = {processes: time_without_study(parameters, processes) for processes in (1, 2)}
        print(
            f"scaling: {len(parameters)} cases, 1 worker {seconds[1]:.1f} s, 2 workers {seconds[2]:.1f} s: "
            f"{seconds[1] / seconds[2]:.2f} times as fast (bar 1.7); bare processes {bare_seconds[1]:.1f} s, "
            f"{bare_seconds[2]:.1f} s: {bare_seconds[1] / bare_seconds[2]:.2f} times; "
            f"load of the machine {os.getloadavg()[0]:.1f}",
            flush=True,
        )


def main() -> None:
    """Run the selected measurements."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frictions", type=int, default=50, help="frictions of each contact, for the overhead")
    parser.add_argument("--pairs", type=int, default=48, help="cases for one and two workers")
    parser.add_argument("--rounds", type=int, default=1, help="repetitions of this comparison")
    parser.add_argument("--cases", type=int, default=100_000, help="cases of the stand-in solver, for the files")
    parser.add_argument("--level", default="summary", help="stored arrays of these cases")
    parser.add_argument(
        "--client", action="store_true", help="solve `--cases` cases on a cluster of two workers, nothing else"
    )
    options = parser.parse_args()
    os.environ.update(WORKER_ENVIRONMENT)
    if options.client:  # the other measurements would determine the peak memory
        print_client_memory(options.cases)
        return
    print_planning()
    if options.frictions:
        print_overhead(options.frictions)
        print_overhead_of_distinct_contacts()
        print_stacking_gain()
        print_scaling_error()
    if options.pairs:
        print_speed_up(options.pairs, options.rounds)
    if options.cases:
        print_files(options.cases, options.level)


if __name__ == "__main__":
    main()
