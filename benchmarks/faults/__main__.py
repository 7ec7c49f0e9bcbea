"""Make the table of faults: ``python -m benchmarks.faults [--page docs/explanation/reliability.md] [--kills 100]``."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from benchmarks.faults import hosts, scenarios, studies
from benchmarks.faults.table import Row, write_table


def rows(kills: int) -> list[Row]:
    """Try everything."""
    undisturbed = studies.undisturbed_values()
    tries = (
        lambda: scenarios.kills(undisturbed, kills - kills // 4),
        lambda: scenarios.kills(undisturbed, kills // 4, workers=2),
        lambda: scenarios.full_disks(undisturbed, max(2, kills // 10)),
        lambda: scenarios.dead_schedulers(undisturbed, max(1, kills // 33)),
        lambda: scenarios.damaged_files(undisturbed, max(7, kills * 7 // 20)),
        lambda: scenarios.damaged_records(undisturbed, max(4, kills // 5)),
        lambda: scenarios.two_runs(undisturbed, max(2, kills // 12)),
        lambda: hosts.two_systems(undisturbed, max(4, kills // 12)),
        lambda: scenarios.at_once(undisturbed, max(2, kills // 12)),
        lambda: scenarios.clock_steps(undisturbed, max(2, kills // 12)),
        lambda: scenarios.edited_study(undisturbed, max(2, kills // 20)),
    )
    results = []
    for trial in tries:
        start_time = time.monotonic()
        results.append(trial())
        print(results[-1], f"{time.monotonic() - start_time:.0f} s", flush=True)
    return results


def main() -> int:
    """Try everything, and write the page of the option."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults", description=__doc__)
    parser.add_argument("--page", type=Path, help="page whose table is written")
    parser.add_argument("--kills", type=int, default=100, help="kills in all; the other numbers go with it")
    options = parser.parse_args()
    results = rows(options.kills)
    if options.page:
        write_table(options.page, results)
    return int(any(row.passed < row.trials for row in results))


if __name__ == "__main__":
    raise SystemExit(main())
