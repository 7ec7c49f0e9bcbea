"""The command ``contactstudy``."""

from __future__ import annotations

import argparse
import contextlib
import gc
import logging
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contactstudy.errors import ContactStudyError, InvalidInputError, Terminated

if TYPE_CHECKING:
    from contactstudy.study import RunReport, Study
    from contactstudy.study.folder import States
    from contactstudy.study.worker import Solver

ALL_OK, SOME_FAILED, USAGE = 0, 1, 2
MAX_REASONS = 20  # Maximum number of reasons on the screen; ``--all`` lists every case with its reason
MANY_CASES = 100_000  # Combinations of a study that needs a confirmation, or --yes


def main(arguments: Sequence[str] | None = None, *, solver: Solver | None = None) -> int:
    """Run the command line and return the exit code; `solver` is called instead of :func:`contactstudy.solve`."""
    parser = command_parser()
    options = parser.parse_args(arguments)
    options.whole_process, options.solver = arguments is None, solver
    try:
        if options.version:
            from contactstudy.arrays.variables import package_version

            print(f"contactstudy {package_version()}")
            return ALL_OK
        if options.versions:
            from contactstudy.versions import show_versions

            show_versions()
            return ALL_OK
        if options.verbose:
            logging.basicConfig(format="%(asctime)s %(message)s")
            logging.getLogger("contactstudy").setLevel(logging.INFO)
        if options.command is None:
            parser.print_help()
            return USAGE
        if options.whole_process and options.action in (_report, _explore):
            gc.set_threshold(50_000)  # with Python's default, collection takes a tenth of the time of a page or report
        code: int = options.action(options)
        print(end="", flush=True)  # without an output `sys.stdout` is None
    except ContactStudyError as error:
        print(f"contactstudy: {error}", file=sys.stderr)
        return USAGE
    except KeyboardInterrupt as interrupt:
        if arguments is None and threading.current_thread() is threading.main_thread():
            signal.signal(signal.SIGINT, signal.SIG_IGN)  # further signals would interrupt the cleanup
        message = str(interrupt) or "interrupted; finished cases are kept, the same command goes on"
        print(f"contactstudy: {message}", file=sys.stderr)
        return 128 + (interrupt.signal_number if isinstance(interrupt, Terminated) else signal.SIGINT)
    except OSError as error:  # the output is closed or full
        # Otherwise Python would flush the output at exit, and fail.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):
            return 128 + signal.SIGPIPE
        print(f"contactstudy: {error}", file=sys.stderr)
        return USAGE
    return code


def _print_written(*paths: Path) -> None:
    """Print the paths of written files."""
    print(*(f"wrote {_format_path(path.resolve())}" for path in paths), sep="\n")


def _read_study(options: argparse.Namespace) -> Study:
    """Read a study; a very large study needs a confirmation."""
    from contactstudy.study import Study

    study = Study.from_toml(options.path)
    if study.size < MANY_CASES or options.yes:
        return study
    print(f"study {study.name}: {study.size} combinations", flush=True)
    if not sys.stdin.isatty():
        raise InvalidInputError("study", f"{study.size} combinations", f"fewer than {MANY_CASES}", "or give --yes")
    if input("Go on? [y/N] ").strip().lower() not in ("y", "yes"):
        raise ContactStudyError("nothing done")
    return study


def _select_workers(options: argparse.Namespace) -> dict[str, Any]:
    """Arguments of `run_study` that choose workers and solver."""
    names = ("workers", "scheduler", "wait", "solver")
    return {name: value for name in names if (value := getattr(options, name)) is not None}


def _run(options: argparse.Namespace) -> int:
    from contactstudy.study import run_study

    share = None
    if options.share is not None:
        share_number, _, count = options.share.partition("/")
        if not (share_number.isdecimal() and count.isdecimal()):
            allowed = "two numbers with a slash, such as 3/40 for the third of forty shares"
            raise InvalidInputError("share", options.share, allowed)
        share = (int(share_number), int(count))
    report = run_study(_read_study(options), options.out, share=share, **_select_workers(options))
    return _finish_run(report, complete=share is None, figure=not options.no_figure)


def _rerun(options: argparse.Namespace) -> int:
    from contactstudy.study import rerun_study

    report = rerun_study(options.path, **_select_workers(options))
    return _finish_run(report, complete=True, figure=not options.no_figure)


def _finish_run(report: RunReport, *, complete: bool, figure: bool) -> int:
    """Write summary and figures of all shares, then print: the files are complete if the output is closed."""
    lines: list[str] = []
    if complete and report.files:
        lines.append(f"wrote {_format_path(_write_summary(report.folder))}")
        try:
            figure_paths = _draw_figures(report.folder) if figure else []
            lines += [f"wrote {_format_path(path)}" for path in figure_paths]
        except ContactStudyError as error:
            lines.append(f"  no figure: {error}")
    print(*_run_lines(report), *lines, sep="\n")
    return ALL_OK if not report.failures else SOME_FAILED


def _write_summary(folder: Path, target: Path | None = None) -> Path:
    from contactstudy.study import collect
    from contactstudy.study.files import write_dataset

    path = folder / "summary.nc" if target is None else target
    write_dataset(path, collect(folder))
    return path


def _draw_figures(folder: Path) -> list[Path]:
    """Draw the figures that suit the study, without a screen."""
    import matplotlib

    previous_backend = matplotlib.get_backend()
    matplotlib.use("Agg")
    try:
        from matplotlib import pyplot

        from contactstudy.checks import writing
        from contactstudy.report.page import figures_of_folder

        paths = []
        for name, (figure, _) in figures_of_folder(folder).items():
            paths.append(folder / f"{name}.png")
            with writing(paths[-1]) as temporary_path:
                figure.savefig(temporary_path, dpi=150, format="png")
            pyplot.close(figure)
        return paths
    finally:
        matplotlib.use(previous_backend)


def _plan(options: argparse.Namespace) -> int:
    from contactstudy.study import run_study
    from contactstudy.study.folder import Folder

    study = _read_study(options)
    folder = Folder(options.out if options.out is not None else Path("results") / study.name)
    print(f"study {study.name}: {study.size} combinations, results in {_format_path(folder.path)}", flush=True)
    if options.sample is not None:
        run_options = {"sample": options.sample, "workers": options.workers, "solver": options.solver}
        states = run_study(study, folder.path, **run_options).states
    else:
        states = folder.states(study.plan())
    plan = states.plan
    cube_text = " x ".join(f"{dim} {size}" for dim, size in zip(plan.cube.dims, plan.cube.shape, strict=True))
    print(f"{len(plan)} cases ({cube_text})")
    print(*_state_lines(states, all_cases=options.all), sep="\n")
    return ALL_OK if plan.unique else USAGE  # `run` also refuses a study without cases to solve


def _status(options: argparse.Namespace) -> int:
    from contactstudy.study.folder import Folder

    folder = Folder(options.path)
    study = folder.read_study()
    states = folder.states(study.plan())
    print(f"study {study.name}: {len(states.plan)} cases, results in {_format_path(folder.path)}")
    for holder in folder.holders:
        print(f"locked: {holder}")
    print(*_state_lines(states, all_cases=options.all), sep="\n")
    return ALL_OK if set(states.counts) <= {"ok", "skipped"} else SOME_FAILED


def _collect(options: argparse.Namespace) -> int:
    _print_written(_write_summary(options.path, options.out))
    return ALL_OK


def _export(options: argparse.Namespace) -> int:
    from contactstudy.export import export_results

    path = export_results(
        options.path,
        kind=options.format,
        variables=options.variable,
        line=options.line,
        points=options.points,
        select=options.select or (),
        out=options.out,
    )
    if path is not None:
        _print_written(path)
    return ALL_OK


def _report(options: argparse.Namespace) -> int:
    from contactstudy.arrays.variables import selection_of
    from contactstudy.report import write

    selection = selection_of(options.select or ())
    _print_written(write(options.path, options.out, title=options.title, selection=selection))
    return ALL_OK


def _explore(options: argparse.Namespace) -> int:
    from contactstudy.explorer import serve

    if options.whole_process and "dask" not in sys.modules:
        # xarray would import dask, which takes longer than xarray itself and is not used; None prevents the import.
        sys.modules["dask"] = None  # type: ignore[assignment]
    serve(options.path, port=options.port, hosts=options.host, show=not options.no_browser)
    return ALL_OK


def _verify(options: argparse.Namespace) -> int:
    from contactstudy.verification import Check, suite

    folder = options.out if options.out is not None else Path("results/verification")
    suite.make_folder(folder)  # before the work, not after
    shown_groups: set[str] = set()

    def show(group: str, check: Check) -> None:
        if group not in shown_groups:
            print(f"\n{group}\n{suite.HEADING}")
        shown_groups.add(group)
        print(suite.format_line(check), flush=True)

    verification = suite.run(options.level, show)
    print(f"\n{suite.format_summary(verification)}")
    _print_written(*suite.write(verification, folder))
    return ALL_OK if verification.passed else SOME_FAILED


def _format_path(path: Path) -> str:
    """Return a path, relative to the current folder if inside the folder."""
    with contextlib.suppress(ValueError, OSError):
        return str(path.relative_to(Path.cwd()))
    return str(path)


def format_bytes(size: float) -> str:
    """Return a size of files with a unit."""
    for unit in ("bytes", "kB", "MB"):
        if size < 1000:
            return f"{size:.3g} {unit}"
        size /= 1000
    return f"{size:.3g} GB"


def _run_lines(report: RunReport) -> Iterator[str]:
    """Lines on the result of a run."""
    yield f"{len(report.plan)} cases: {report.states.summary}; {report.solved} solved now"
    yield from _reason_lines(report.states, "failed", identities=False)
    if report.failures:
        yield f"  details in {_format_path(report.folder / 'run.log')}"
        yield f"  again with: contactstudy rerun {_format_path(report.folder)}"
    yield from _reason_lines(report.states, "skipped")
    for case in report.unconverged_cases[:MAX_REASONS]:
        yield f"  not converged, do not rely on it: {case.name}"
    for remark in report.remarks:
        yield f"  {remark}"
    if files := report.files:
        size = sum(path.stat().st_size for path in files)
        folder, plural = _format_path(files[0].parent), "s" * (len(files) > 1)
        yield f"{len(files)} netCDF file{plural}, {format_bytes(size)}, in {folder}"
    if stale_cases := report.states.indices("stale"):
        rerun_command = f"contactstudy rerun {_format_path(report.folder)}"
        yield f"{len(stale_cases)} stale ({report.states.reasons[stale_cases[0]]}); again with: {rerun_command}"


def _reason_lines(states: States, *statuses: str, identities: bool = True) -> Iterator[str]:
    """Lines on cases of some states with a reason: for each reason the first case and the number of other cases."""
    groups: dict[tuple[str, str], list[int]] = {}
    for index in states.indices(*statuses):
        if reason := states.reasons[index]:
            groups.setdefault((states.status[index], reason), []).append(index)
    for (status, reason), indices in list(groups.items())[:MAX_REASONS]:
        case, others_text = states.plan[indices[0]], f" (and {len(indices) - 1} more)" if len(indices) > 1 else ""
        yield f"  {status}: {f'{case.id[:16]} ' if identities else ''}{case.name}: {reason}{others_text}"
    if len(groups) > MAX_REASONS:
        yield f"  ... and {len(groups) - MAX_REASONS} more reasons"


def _state_lines(states: States, *, all_cases: bool) -> Iterator[str]:
    """Lines on the status of cases: counts, cases that need attention (or all cases), and a forecast of the rest."""
    for status, count in states.counts.items():
        yield f"  {count} {status}"
    if all_cases:
        for case in states.plan:
            reason = states.reasons[case.index]
            text = f"  {states.status[case.index]}: {case.id[:16]} {case.name}"
            yield f"{text}: {reason}" if reason else text
    else:
        yield from _reason_lines(states, "skipped")
        yield from _reason_lines(states, "failed", "stale", "missing")
        if sum(map(bool, states.reasons)) > 1:
            yield "  every case: --all"
    yield from _forecast_lines(states)


def _forecast_lines(states: States) -> Iterator[str]:
    """Lines on exclusions without effect, unusual magnitudes, and bytes and time of the remaining cases."""
    from contactstudy.study.run import format_duration

    plan = states.plan
    yield from (f"  {message}" for message in plan.unknown[:MAX_REASONS])
    for warning in plan.doubts[:MAX_REASONS]:
        yield f"  doubtful magnitude in SI units: {warning}"
    review = plan.review
    if review.checked < review.groups:
        yield f"  {review.checked} of {review.groups} contacts were checked; a run checks all"
    unique = plan.unique
    if duplicates := len(plan) - len(plan.skipped) - len(unique):
        yield f"  {duplicates} duplicates, solved once"
    missing, seconds = len(set(states.indices("missing")) & set(unique)), states.numbers("seconds")
    seconds_of_solved = seconds[seconds >= 0]
    solved_count = len(seconds_of_solved)
    if solved_count:
        size = sum(path.stat().st_size for path in states.results.paths)
        total = format_bytes(size / solved_count * len(plan.unique))
        yield f"files: about {total} at level {plan.level}, from {solved_count} solved cases"
    else:
        yield f"files: about {format_bytes(plan.size)} at level {plan.level} before compression"
    if missing and solved_count:
        duration = format_duration(float(seconds_of_solved.mean()) * missing)
        yield f"time: about {duration} of one core for {missing} cases, from {solved_count} solved cases"
    elif missing:
        yield f"time: not estimated for {missing} cases; `plan --sample N` solves N of them for an estimate"


def command_parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog="contactstudy",
        description="Rolling-sliding contact of a roller on an elastic body with free end faces: parametric studies.",
        epilog="Exit codes: 0 all cases or checks ok, 1 some failed or are not done, 2 wrong usage or input, "
        "129 after SIGHUP, 130 after Ctrl-C, 141 if nobody reads the output any more, 143 after SIGTERM.",
    )
    parser.add_argument("--version", action="store_true", help="show the version and end")
    parser.add_argument("--versions", action="store_true", help="show the package's and its dependencies' versions")
    parser.add_argument("--verbose", action="store_true", help="log to the error output")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND")

    def add_command(
        action: Callable[[argparse.Namespace], int], path_kind: str, description: str
    ) -> argparse.ArgumentParser:
        command = commands.add_parser(action.__name__.strip("_"), help=description, description=description)
        command.set_defaults(action=action)
        meanings = {
            "study": "study file (TOML)",
            "folder": "results of a study",
            "file_or_folder": "netCDF file of a case, or a study's folder",
        }
        if path_kind:
            command.add_argument("path", metavar=path_kind.upper(), type=Path, help=meanings[path_kind])
        if path_kind == "study":
            command.add_argument("--out", metavar="FOLDER", type=Path, help="results; default results/<study name>")
        return command

    def add_worker_options(command: argparse.ArgumentParser) -> None:
        command.add_argument("--workers", metavar="N", type=int, help="local processes; default one per core")
        command.add_argument("--scheduler", metavar="ADDRESS", help="dask scheduler to use instead, tcp://...")
        command.add_argument(
            "--wait", metavar="SECONDS", type=float, help="longest wait for a worker of the scheduler; default 300"
        )
        command.add_argument("--no-figure", action="store_true", help="draw no figure")

    run = add_command(_run, "study", "Solve the cases of a study that are not solved yet.")
    add_worker_options(run)
    run.add_argument("--share", metavar="K/N", help="solve share K of N, such as 3/40: for job arrays")
    help_text = "State of every case, errors in the study, bytes and time of a run; solves nothing without --sample."
    plan = add_command(_plan, "study", help_text)
    plan.add_argument("--sample", metavar="N", type=int, help="solve N cases, films by groups, to estimate the time")
    plan.add_argument("--workers", metavar="N", type=int, help="local processes for the sample; default one per core")
    for command in (run, plan):
        command.add_argument("--yes", action="store_true", help=f"solve {MANY_CASES} cases or more unconfirmed")
    status = add_command(_status, "folder", "State of every case: done, failed, stale or missing.")
    for command in (plan, status):
        command.add_argument("--all", action="store_true", help="list every case")
    command = add_command(_collect, "folder", "Merge the summaries of all cases into one netCDF file.")
    command.add_argument("--out", metavar="FILE", type=Path, help="default FOLDER/summary.nc")
    add_worker_options(add_command(_rerun, "folder", "Solve failed, stale and missing cases again."))
    help_text = "Check the solver against closed forms, finite elements and published numbers."
    command = add_command(_verify, "", help_text)
    command.add_argument("--level", choices=("quick", "full"), default="quick", help="default quick, a minute")
    command.add_argument("--out", metavar="FOLDER", type=Path, help="default results/verification")
    help_text = "Write a study's summaries as a table (CSV), or fields of one case as CSV, VTK or MATLAB."
    command = add_command(_export, "file_or_folder", help_text)
    command.add_argument("--format", choices=("csv", "vtk", "mat"), help="default csv")
    command.add_argument("--variable", metavar="NAME", action="append", help="variable or stress measure; repeatable")
    command.add_argument("--line", metavar="X,Y,Z:X,Y,Z", help="ends of a line, m, for csv (--line=-1e-4,0,0:...)")
    command.add_argument("--points", metavar="N", type=int, default=101, help="points of the line; default 101")
    command.add_argument("--select", metavar="NAME=VALUE", action="append", help="swept parameter; repeatable")
    command.add_argument("--out", metavar="FILE", type=Path, help="default: next to the results; - for the screen")
    explore = add_command(_explore, "folder", "Serve a page to look through a study, on this machine.")
    explore.add_argument("--port", metavar="N", type=int, help="default: the first free one from 5006 on")
    help_text = "host name that a browser may use besides localhost, such as that of a proxy; repeatable"
    explore.add_argument("--host", metavar="NAME", action="append", default=[], help=help_text)
    explore.add_argument("--no-browser", action="store_true", help="do not open the page in the browser")
    help_text = "Write one HTML page of a case or of a study, for a reader without Python."
    command = add_command(_report, "file_or_folder", help_text)
    command.add_argument("--title", metavar="TEXT", help="heading; default: the name of the file or of the study")
    help_text = "value of a swept parameter that a study's figures keep to; repeatable"
    command.add_argument("--select", metavar="NAME=VALUE", action="append", help=help_text)
    command.add_argument("--out", metavar="FILE", type=Path, help="default: next to the file; report.html in a folder")
    return parser


if __name__ == "__main__":
    sys.exit(main())
