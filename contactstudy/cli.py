"""The command ``contactstudy``."""

from __future__ import annotations

import argparse
import signal
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from contactstudy.study.folder import Entry
    from contactstudy.study.plan import Plan
    from contactstudy.study.run import RunReport
    from contactstudy.study.work import Solver

ALL_OK, SOME_FAILED, USAGE = 0, 1, 2
SHOWN = 20
"""Longest list of cases on the screen; ``--all`` shows every one."""


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="contactstudy",
        description="Rolling-sliding contact of a roller on an elastic body with free end faces: parametric studies.",
        epilog="Exit codes: 0 all cases or checks ok, 1 some failed or are not done, 2 wrong usage or input, "
        "130 after Ctrl-C, 143 after SIGTERM.",
    )
    parser.add_argument("--version", action="store_true", help="show the version and end")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND")

    def command(name: str, text: str, *, takes_study: bool) -> argparse.ArgumentParser:
        added = commands.add_parser(name, help=text, description=text)
        if takes_study:
            added.add_argument("study", metavar="STUDY", type=Path, help="study file (TOML)")
            added.add_argument("--out", metavar="FOLDER", type=Path, help="results; default results/<study name>")
        else:
            added.add_argument("folder", metavar="FOLDER", type=Path, help="results of a study")
        return added

    def parallel(added: argparse.ArgumentParser) -> None:
        added.add_argument("--workers", metavar="N", type=int, help="local processes; default one per core")
        added.add_argument("--scheduler", metavar="ADDRESS", help="dask scheduler to use instead, tcp://...")
        added.add_argument("--no-figure", action="store_true", help="draw no figure")

    parallel(command("run", "Solve the cases of a study that are not solved yet.", takes_study=True))
    plan = command("plan", "Say what a run would do; solve nothing.", takes_study=True)
    status = command("status", "Say what is done, failed, stale or missing.", takes_study=False)
    for added in (plan, status):
        added.add_argument("--all", action="store_true", help="list every case")
    added = command("collect", "Merge the summaries of all cases into one netCDF file.", takes_study=False)
    added.add_argument("--out", metavar="FILE", type=Path, help="default FOLDER/summary.nc")
    parallel(command("rerun", "Solve failed, stale and missing cases again.", takes_study=False))
    text = "Check the solver against closed forms, finite elements and published numbers."
    added = commands.add_parser("verify", help=text, description=text)
    added.add_argument("--level", choices=("quick", "full"), default="quick", help="a minute, or a few (default quick)")
    added.add_argument("--out", metavar="FOLDER", type=Path, help="default results/verification")
    text = "Write a study's summaries as a table (CSV), or fields of one case as CSV or VTK."
    added = commands.add_parser("export", help=text, description=text)
    added.add_argument("path", metavar="FILE_OR_FOLDER", type=Path, help="netCDF file of a case, or a study's folder")
    added.add_argument("--format", choices=("csv", "vtk"), help="default csv")
    added.add_argument("--variable", metavar="NAME", action="append", help="variable or stress measure; repeatable")
    added.add_argument("--line", metavar="X,Y,Z:X,Y,Z", help="ends of a line in metres, for csv (--line=-1e-4,0,0:...)")
    added.add_argument("--points", metavar="N", type=int, default=101, help="points of the line; default 101")
    added.add_argument("--select", metavar="NAME=VALUE", action="append", help="swept parameter of a study; repeatable")
    added.add_argument("--out", metavar="FILE", type=Path, help="default beside the results; - for the screen")
    return parser


def main(arguments: Sequence[str] | None = None, *, solver: Solver | None = None) -> int:
    """Run the command line and return the exit code.

    Parameters
    ----------
    arguments : sequence of str, optional
        Default: those of the process.
    solver : callable, optional
        Called instead of :func:`contactstudy.solve`.

    Examples
    --------
    >>> main(["plan", "no_such_study.toml"])
    2
    """
    parser = _parser()
    options = parser.parse_args(arguments)
    if options.version:
        from contactstudy.arrays.variables import package_version

        print(f"contactstudy {package_version()}")
        return ALL_OK
    if options.command is None:
        parser.print_help()
        return USAGE
    from contactstudy.errors import ContactStudyError

    try:
        actions = {
            "run": _run,
            "rerun": _rerun,
            "plan": _plan,
            "status": _status,
            "collect": _collect,
            "export": _export,
            "verify": _verify,
        }
        return actions[options.command](options, solver)
    except ContactStudyError as error:
        print(f"contactstudy: {error}", file=sys.stderr)
        return USAGE
    except KeyboardInterrupt as interrupt:
        print("contactstudy: interrupted; finished cases are kept, the same command goes on", file=sys.stderr)
        terminated = type(interrupt).__name__ == "Terminated"
        return 128 + (signal.SIGTERM if terminated else signal.SIGINT)


def _run(options: argparse.Namespace, solver: Solver | None) -> int:
    from contactstudy.study import Study, run_study

    study = Study.from_toml(options.study)
    report = run_study(study, options.out, workers=options.workers, scheduler=options.scheduler, solver=solver)
    return _report(report, figure=not options.no_figure)


def _rerun(options: argparse.Namespace, solver: Solver | None) -> int:
    from contactstudy.study import rerun_study

    report = rerun_study(options.folder, workers=options.workers, scheduler=options.scheduler, solver=solver)
    return _report(report, figure=not options.no_figure)


def _report(report: RunReport, *, figure: bool) -> int:
    """Say what a run did and wrote."""
    from contactstudy.errors import ContactStudyError

    counts = ", ".join(f"{count} {status}" for status, count in report.counts.items())
    print(f"{len(report.plan.cases)} cases: {counts}; {report.solved} solved now")
    reasons: dict[str, list[str]] = {}
    for case, entry in report.failures:
        reasons.setdefault(entry.reason, []).append(case.name)
    for reason, names in list(reasons.items())[:SHOWN]:
        print(f"  failed: {names[0]}: {reason}{f' (and {len(names) - 1} more)' if len(names) > 1 else ''}")
    if report.failures:
        print(f"  details in {_shown(report.folder / 'run.log')}")
        print(f"  again with: contactstudy rerun {_shown(report.folder)}")
    for case in report.plan.skipped[:SHOWN]:
        print(f"  skipped: {case.name}: {case.reason}")
    for case in report.not_converged[:SHOWN]:
        print(f"  not converged, do not rely on it: {case.name}")
    files = report.files
    if files:
        size = sum(path.stat().st_size for path in files)
        print(f"wrote {len(files)} netCDF files, {_bytes(size)}, in {_shown(files[0].parent)}")
        print(f"wrote {_shown(_write_summary(report.folder))}")
        try:
            for drawn in _draw(report.folder) if figure else []:
                print(f"wrote {_shown(drawn)}")
        except ContactStudyError as error:
            print(f"  no figure: {error}")
    stale = [entry for entry in report.entries if entry.status == "stale"]
    if stale:
        print(f"{len(stale)} stale ({stale[0].reason}); again with: contactstudy rerun {_shown(report.folder)}")
    return ALL_OK if not report.failures else SOME_FAILED


def _shown(path: Path) -> str:
    """Path relative to the current folder where that is shorter."""
    try:
        return str(path.relative_to(Path.cwd()))
    except ValueError:
        return str(path)


def _bytes(size: float) -> str:
    for unit in ("bytes", "kB", "MB"):
        if size < 1000:
            return f"{size:.3g} {unit}"
        size /= 1000
    return f"{size:.3g} GB"


def _write_summary(folder: Path, target: Path | None = None) -> Path:
    from contactstudy.study import collect
    from contactstudy.study.store import write_dataset

    path = target if target is not None else folder / "summary.nc"
    write_dataset(path, collect(folder))
    return path


def _draw(folder: Path) -> list[Path]:
    """Draw the figures that suit the study, without a screen."""
    import matplotlib

    previous = matplotlib.get_backend()
    matplotlib.use("Agg")
    try:
        from matplotlib import pyplot

        from contactstudy.plots import study_figures
        from contactstudy.study import open_study

        paths = []
        for name, figure in study_figures(open_study(folder)).items():
            paths.append(folder / f"{name}.png")
            figure.savefig(paths[-1], dpi=150)
            pyplot.close(figure)
        return paths
    finally:
        matplotlib.use(previous)


def _list(plan: Plan, entries: list[Entry], *, everything: bool) -> None:
    """Print counts, and the cases that need attention."""
    for status, count in Counter(entry.status for entry in entries).items():
        print(f"  {count} {status}")
    listed = [(case, entry) for case, entry in zip(plan.cases, entries, strict=True) if everything or entry.reason]
    for case, entry in listed if everything else listed[:SHOWN]:
        print(f"  {entry.status}: {case.id[:16]} {case.name}" + (f": {entry.reason}" if entry.reason else ""))
    if not everything and len(listed) > SHOWN:
        print(f"  ... and {len(listed) - SHOWN} more (--all)")


def _forecast(plan: Plan, entries: list[Entry]) -> None:
    """Bytes and time that the cases to come will take."""
    from contactstudy.study.progress import duration

    pairs = list(zip(plan.cases, entries, strict=True))
    done = {case.id: (case.cost, entry.scalars["seconds"]) for case, entry in pairs if "seconds" in entry.scalars}
    todo = {case.id: case for case, entry in pairs if entry.status == "missing"}
    duplicates = len(plan.cases) - len(plan.skipped) - len(plan.unique)
    if duplicates:
        print(f"  {duplicates} duplicates, solved once")
    print(f"files: at most {_bytes(plan.size)} at level {plan.level}")
    if todo and done:
        speed = sum(seconds for _, seconds in done.values()) / sum(cost for cost, _ in done.values())
        seconds = speed * sum(case.cost for case in todo.values())
        print(f"time: about {duration(seconds)} of one core for {len(todo)} cases")
    elif todo:
        print(f"time: known when the first of {len(todo)} cases is solved")


def _plan(options: argparse.Namespace, solver: Solver | None) -> int:
    from contactstudy.study import Study
    from contactstudy.study.folder import Folder

    study = Study.from_toml(options.study)
    plan = study.plan()
    folder = Folder(options.out if options.out is not None else Path("results") / study.name)
    entries = folder.entries(plan)
    shape = " x ".join(f"{dim} {size}" for dim, size in zip(plan.cube.dims, plan.cube.shape, strict=True))
    print(f"study {study.name}: {len(plan.cases)} cases ({shape}), results in {_shown(folder.path)}")
    _list(plan, entries, everything=options.all)
    _forecast(plan, entries)
    return ALL_OK


def _status(options: argparse.Namespace, solver: Solver | None) -> int:
    from contactstudy.study.folder import Folder
    from contactstudy.study.lock import read_lock

    folder = Folder(options.folder)
    study = folder.read_study()
    plan = study.plan()
    entries = folder.entries(plan)
    print(f"study {study.name}: {len(plan.cases)} cases, results in {_shown(folder.path)}")
    holder = read_lock(folder.path)
    if holder is not None:
        print(f"locked by process {holder.get('process')} on {holder.get('host')} since {holder.get('time')}")
    _list(plan, entries, everything=options.all)
    _forecast(plan, entries)
    return ALL_OK if all(entry.status in ("ok", "skipped") for entry in entries) else SOME_FAILED


def _collect(options: argparse.Namespace, solver: Solver | None) -> int:
    print(f"wrote {_shown(_write_summary(options.folder.resolve(), options.out))}")
    return ALL_OK


def _export(options: argparse.Namespace, solver: Solver | None) -> int:
    wants_fields = options.format or options.variable or options.line or options.select
    if wants_fields or not options.path.is_dir():
        from contactstudy.export.command import export

        written = export(
            options.path,
            kind=options.format or "csv",
            variables=options.variable,
            line=options.line,
            points=options.points,
            select=options.select or (),
            out=options.out,
        )
        if written is not None:
            print(f"wrote {_shown(written.resolve())}")
        return ALL_OK
    from contactstudy.study import collect
    from contactstudy.study.store import write_text

    table = collect(options.path).to_dataframe().to_csv()
    if options.out is not None and str(options.out) == "-":
        print(table, end="")
        return ALL_OK
    path = options.out if options.out is not None else options.path / "summary.csv"
    write_text(path, table)
    print(f"wrote {_shown(path.resolve())}")
    return ALL_OK


def _verify(options: argparse.Namespace, solver: Solver | None) -> int:
    from contactstudy.verification import report, run
    from contactstudy.verification.check import Check

    folder = options.out if options.out is not None else Path("results/verification")
    report.make_folder(folder)  # before the work, not after
    shown: set[str] = set()

    def show(group: str, check: Check) -> None:
        if group not in shown:
            print(f"\n{group}\n{report.HEADING}")
        shown.add(group)
        print(report.line(check), flush=True)

    verification = run(options.level, show)
    for table in verification.tables:
        print(f"\n{report.convergence_table(table)}")
    print(f"\n{report.summary(verification)}")
    for path in report.write(verification, folder):
        print(f"wrote {_shown(path.resolve())}")
    return ALL_OK if verification.passed else SOME_FAILED


if __name__ == "__main__":
    sys.exit(main())
