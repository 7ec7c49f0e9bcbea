"""Peak memory of one long roller: prints megabytes after the imports, after the contact and after the stresses.

``python -m benchmarks.performance.memory`` runs in a process of its own, because the peak is that of a process.
"""

from __future__ import annotations

import resource
import sys
from pathlib import Path

import numpy as np

from benchmarks.performance.peers import solve_peer_contact
from benchmarks.performance.problems import HALF_WIDTH, roller
from contactstudy import stress_field


def measure_peak_memory() -> float:
    """Return the peak memory of the process so far, megabytes."""
    status = Path("/proc/self/status")
    if status.exists():  # `ru_maxrss` includes the memory of the parent process
        line = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return float(line.split()[1]) * 1024 / 1e6
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6


def main() -> None:
    """Solve the contact and the stresses of one section, and print the peak after each step."""
    peaks = [measure_peak_memory()]
    problem = roller((1000, 48), 100.0, free_ends=True)
    contact = solve_peer_contact(problem)
    peaks.append(measure_peak_memory())
    depths, pressure = np.linspace(0.0, 5 * HALF_WIDTH, 25), contact["pressure"]
    stress_field(problem.body, pressure, y=[0.0], z=depths, inside_cells=pressure)
    peaks.append(measure_peak_memory())
    print(*(f"{value:.1f}" for value in peaks))


if __name__ == "__main__":
    main()
