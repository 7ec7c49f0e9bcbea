"""Time, memory and bytes of a table of contact numbers: 1000 distinct contacts, each with ten frictions.

Usage: ``python -m benchmarks.performance.contact_table [--sample 20] [--workers 0] [--profile]``; ``--sample 1000``
solves all contacts. A cylindrical roller with an edge radius and a logarithmic crown: 10 loads, 10 end distances, 10
tilts. The program solves a random sample of the contacts with all their frictions and extrapolates from the processor
time.
"""

from __future__ import annotations

import argparse
import cProfile
import itertools
import os
import pstats
import resource
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from contactstudy import Study, run_study
from contactstudy.study.engine import WORKER_ENVIRONMENT

CROWN = {"kind": "lundberg", "design_pressure": 1.5e9}
BASE: dict[str, Any] = {
    "young": 210e9,
    "poisson": 0.3,
    "radius": 5e-3,
    "roller_length": 10e-3,
    "profile": {"kind": "sum", "terms": [CROWN, {"kind": "cylinder", "fillet_radius": 0.2e-3}]},
    "accuracy": 0.01,
    "stresses": False,
}
LOADS = np.linspace(1e9, 2e9, 10)
DISTANCES = (0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0)
TILTS = np.linspace(0.0, 2e-4, 10)
FRICTIONS = np.linspace(0.01, 0.1, 10)
CORES, MINUTES = 2, 10.0


def make_contact_table_study(contacts: int) -> Study:
    """Study of a random sample of the contacts."""
    combinations = np.array(list(itertools.product(LOADS, DISTANCES, TILTS)))
    selected_combinations = np.random.default_rng(1).permutation(combinations)[:contacts]
    load, distance, tilt = selected_combinations.T.tolist()
    return Study(
        name="contact_table",
        level="summary",
        base=BASE,
        zip={"max_pressure": load, "e_over_a": distance, "tilt": tilt},
        sweep={"friction": FRICTIONS.tolist()},
    )


def measure_processor_seconds() -> float:
    """Processor time of this process and its finished workers."""
    return time.process_time() + sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])


def main() -> None:
    """Solve the sample and print the extrapolation."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sample", type=int, default=20, help="contacts to solve")
    parser.add_argument("--workers", type=int, default=0, help="number of processes; 0: this process")
    parser.add_argument("--profile", action="store_true", help="print the functions with the most processor time")
    options = parser.parse_args()
    os.environ.update(WORKER_ENVIRONMENT)
    with tempfile.TemporaryDirectory() as folder:
        # Imports and plans of transforms are made once per process.
        run_study(make_contact_table_study(1), Path(folder) / "first", workers=0, progress=False)
        profile = cProfile.Profile(time.process_time)
        start_seconds, start_time = measure_processor_seconds(), time.perf_counter()
        if options.profile:
            profile.enable()
        report = run_study(
            make_contact_table_study(options.sample), Path(folder) / "table", workers=options.workers, progress=False
        )
        profile.disable()
        seconds, elapsed_seconds = measure_processor_seconds() - start_seconds, time.perf_counter() - start_time
        bytes_written = sum(path.stat().st_size for path in report.files)
    assert set(report.counts) == {"ok"}, report.counts
    cases, seconds_per_contact = len(report.plan), seconds / options.sample
    contacts = len(LOADS) * len(DISTANCES) * len(TILTS)
    memory = (
        max(
            resource.getrusage(process_kind).ru_maxrss
            for process_kind in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
        )
        / 1e3
    )
    print(
        f"contact table: {options.sample} of {contacts} contacts, {cases} cases in {seconds:.1f} s of processor time, "
        f"{elapsed_seconds:.1f} s on the clock; {seconds_per_contact:.2f} s per contact, "
        f"{1e3 * seconds / cases:.0f} ms per case; all on "
        f"{CORES} cores: {contacts * seconds_per_contact / CORES / 60:.1f} min (bar {MINUTES:.0f} min); "
        f"{bytes_written / cases:.0f} bytes per case (bar 1000), largest memory {memory:.0f} MB"
    )
    if options.profile:
        pstats.Stats(profile).sort_stats("cumulative").print_stats(80)


if __name__ == "__main__":
    main()
