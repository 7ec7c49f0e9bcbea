"""Run every benchmark and print one Markdown table.

Usage: ``python -m benchmarks.performance [--repeats N] [--only WORD ...] [--markdown FILE]``.

The peers are optional (``pip install -e ".[benchmark]"``); the table names each missing peer.
`aspher` is built from source and needs the Eigen headers: if the system has none,
``pip install cmeel-eigen`` and ``CMAKE_ARGS=-DEigen3_DIR=<its share/eigen3/cmake>`` before ``pip install aspher``.
"""

from __future__ import annotations

import os

THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")


def run_single_threaded() -> None:
    """Limit every library to one thread before its import; then run."""
    for name in THREAD_VARIABLES:
        os.environ[name] = "1"
    from benchmarks.performance.report import main

    main()


if __name__ == "__main__":
    run_single_threaded()
