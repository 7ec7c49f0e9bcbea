"""Make the table of faults: ``python -m benchmarks.faults [--page docs/explanation/reliability.md] [--kills 100]``."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from benchmarks.faults import hosts, scenarios, studies
from benchmarks.faults.table import Row, write_table


def rows(kills: int) -> list[Row]:
    """Try everything."""
    calm = studies.calm_values()
    tries = (
        lambda: scenarios.kills(calm, kills - kills // 4),
        lambda: scenarios.kills(calm, kills // 4, workers=2),
        lambda: scenarios.full_disks(calm, max(2, kills // 10)),
        lambda: scenarios.dead_schedulers(calm, max(1, kills // 33)),
        lambda: scenarios.damaged_files(calm, max(7, kills * 7 // 20)),
        lambda: scenarios.damaged_records(calm, max(4, kills // 5)),
        lambda: scenarios.two_runs(calm, max(2, kills // 12)),
        lambda: hosts.two_systems(calm, max(4, kills // 12)),
        lambda: scenarios.at_once(calm, max(2, kills // 12)),
        lambda: scenarios.clock_steps(calm, max(2, kills // 12)),
        lambda: scenarios.edited_study(calm, max(2, kills // 20)),
    )
    found = []
    for each in tries:
        began = time.monotonic()
        found.append(each())
        print(found[-1], f"{time.monotonic() - began:.0f} s", flush=True)
    return found


def main() -> int:
    """Try everything, and write the page that is asked for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults", description=__doc__)
    parser.add_argument("--page", type=Path, help="page whose table is written")
    parser.add_argument("--kills", type=int, default=100, help="kills in all; the other numbers go with it")
    asked = parser.parse_args()
    found = rows(asked.kills)
    if asked.page:
        write_table(asked.page, found)
    return int(any(row.passed < row.tried for row in found))


if __name__ == "__main__":
    raise SystemExit(main())
