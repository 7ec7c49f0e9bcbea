"""All rows in order, and their output."""

from __future__ import annotations

import argparse
import platform
import time
from collections.abc import Callable, Iterator
from importlib import metadata
from pathlib import Path

from benchmarks.performance import bodies, contacts, film, refinement, rolling
from benchmarks.performance.timing import Report, Row

BENCHMARKS: dict[str, Callable[[int, Report], Iterator[Row]]] = {
    "point": contacts.point_contact,
    "roller": contacts.half_space_roller,
    "finite": contacts.finite_length_roller,
    "building": bodies.build_bodies,
    "stresses": bodies.stresses,
    "long": bodies.long_rollers,
    "rolling": rolling.steady_rolling,
    "refined": refinement.refined_columns,
    "film": film.films,
    "iterations": contacts.iterations,
}
VERSIONS = ("contactstudy", "numpy", "scipy", "pyfftw", "aspher", "tamaas", "ContactMechanics")


def describe_versions() -> str:
    """Return the versions of Python and of the compared codes."""
    version_texts = []
    for name in VERSIONS:
        try:
            version_texts.append(f"{name} {metadata.version(name)}")
        except metadata.PackageNotFoundError:
            version_texts.append(f"{name} absent")
    return f"Python {platform.python_version()}, {', '.join(version_texts)}; one thread"


def main() -> None:
    """Run the selected benchmarks; print each row, and the table at the end."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.performance", description=__doc__)
    parser.add_argument("--repeats", type=int, default=5, help="rounds of each median")
    parser.add_argument("--only", nargs="+", choices=BENCHMARKS, default=list(BENCHMARKS), help="benchmarks to run")
    parser.add_argument("--markdown", type=Path, help="file to write the table to")
    arguments = parser.parse_args()
    start_time = time.perf_counter()
    report = Report()
    for name in arguments.only:
        for row in BENCHMARKS[name](max(1, arguments.repeats), report):
            report.rows.append(row)
            print(row.plain(), flush=True)
    report.add_remark(
        f"{describe_versions()}; medians of {arguments.repeats}; {time.perf_counter() - start_time:.0f} s in all"
    )
    print("\n" + report.markdown())
    if arguments.markdown:
        arguments.markdown.write_text(report.markdown() + "\n", encoding="utf-8")
