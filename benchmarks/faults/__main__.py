"""Make the table of faults: ``python -m benchmarks.faults [--page docs/explanation/reliability.md] [--kills 100]``."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from benchmarks.faults import hosts, scenarios, studies
from benchmarks.faults.table import Row, write_table


def run_trials(kills: int) -> list[Row]:
    """Table of the trials of every fault."""
    undisturbed_dataset = studies.compute_undisturbed_values()
    trials = (
        lambda: scenarios.kill_runs(undisturbed_dataset, kills - kills // 4),
        lambda: scenarios.kill_runs(undisturbed_dataset, kills // 4, workers=2),
        lambda: scenarios.fill_disks(undisturbed_dataset, max(2, kills // 10)),
        lambda: scenarios.kill_schedulers(undisturbed_dataset, max(1, kills // 33)),
        lambda: scenarios.damage_batches(undisturbed_dataset, max(7, kills * 7 // 20)),
        lambda: scenarios.damage_records(undisturbed_dataset, max(4, kills // 5)),
        lambda: scenarios.start_second_runs(undisturbed_dataset, max(2, kills // 12)),
        lambda: hosts.run_on_two_hosts(undisturbed_dataset, max(4, kills // 12)),
        lambda: scenarios.run_simultaneously(undisturbed_dataset, max(2, kills // 12)),
        lambda: scenarios.shift_clock(undisturbed_dataset, max(2, kills // 12)),
        lambda: scenarios.edit_study_file(undisturbed_dataset, max(2, kills // 20)),
    )
    results = []
    for trial in trials:
        start_time = time.monotonic()
        results.append(trial())
        print(results[-1], f"{time.monotonic() - start_time:.0f} s", flush=True)
    return results


def main() -> int:
    """Run the trials and write their table into the page of `--page`."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults", description=__doc__)
    parser.add_argument("--page", type=Path, help="page whose table is written")
    parser.add_argument(
        "--kills",
        type=int,
        default=100,
        help="total number of kills; the numbers of the other trials are in proportion",
    )
    options = parser.parse_args()
    results = run_trials(options.kills)
    if options.page:
        write_table(options.page, results)
    return int(any(row.passed < row.trials for row in results))


if __name__ == "__main__":
    raise SystemExit(main())
