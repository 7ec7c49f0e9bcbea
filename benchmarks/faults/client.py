"""Times of a study on a cluster of two worker processes and on two local workers, by turns.

``python -m benchmarks.faults.client --cases 4000`` prints the times and their ratio; then it kills one worker of the
cluster during a run, and compares the results bit for bit.
"""

from __future__ import annotations

import argparse
import os
import signal
import statistics
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
from distributed import Client, LocalCluster

from contactstudy.study import Study, open_study, run_study
from contactstudy.study.engine import WORKER_ENVIRONMENT
from contactstudy.study.folder import Folder
from tests.small_study import small_study
from tests.stand_in_solver import solve_fake


def make_stand_in_study(cases: int) -> Study:
    """Return a study for the stand-in solver."""
    count = round(cases**0.5)
    sweep = {"e_over_a": np.linspace(0.0, 4.0, count).tolist(), "tilt": np.linspace(0.0, 1e-4, cases // count).tolist()}
    return small_study("client", sweep=sweep, level="summary")


def measure_seconds(study: Study, folder: Path, client: Client | None) -> float:
    """Time of a run on the client, or on two local workers."""
    start_time = time.monotonic()
    options = {"workers": 2} if client is None else {"scheduler": client}
    report = run_study(study, folder, solver=solve_fake, progress=False, **options)
    assert report.counts == {"ok": study.size}, report.counts
    return time.monotonic() - start_time


def kill_one_worker(client: Client, folder: Path) -> None:
    """Kill a worker process as soon as the folder contains results."""
    pids = list(client.run(os.getpid).values())
    while not list((folder / "batches").glob("*.nc")):
        time.sleep(0.05)
    os.kill(pids[0], signal.SIGKILL)


def main() -> int:
    """Compare times, and results after the death of a worker."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults.client", description=__doc__)
    parser.add_argument("--cases", type=int, default=4000, help="number of cases")
    parser.add_argument("--rounds", type=int, default=3, help="number of runs of either kind")
    options = parser.parse_args()
    os.environ.update(WORKER_ENVIRONMENT)
    study = make_stand_in_study(options.cases)
    times: dict[str, list[float]] = {"client": [], "local": []}
    with (
        tempfile.TemporaryDirectory(prefix="client-") as folder_name,
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, memory_limit=0) as cluster,
        Client(cluster) as client,
    ):
        root = Path(folder_name)
        for round_index in range(options.rounds):
            times["local"].append(measure_seconds(study, root / f"local-{round_index}", None))
            times["client"].append(measure_seconds(study, root / f"client-{round_index}", client))
            print({kind: round(entries[-1], 1) for kind, entries in times.items()}, flush=True)
        ratio = statistics.median(times["client"]) / statistics.median(times["local"])
        print(f"{study.size} cases: a client takes {ratio:.2f} of the time of workers=2")
        killer = threading.Thread(target=kill_one_worker, args=(client, root / "killed"))
        killer.start()
        measure_seconds(study, root / "killed", client)
        killer.join()
        killed_dataset, local_dataset = (
            open_study(root / run_name).drop_vars("seconds").load() for run_name in ("killed", "local-0")
        )
        comparison = "equal" if killed_dataset.identical(local_dataset) else "DIFFER"
        print(f"one worker killed: results {comparison}, bit for bit")
        assert not Folder(root / "killed").holders
    return int(not killed_dataset.identical(local_dataset) or ratio > 1.1)


if __name__ == "__main__":
    raise SystemExit(main())
