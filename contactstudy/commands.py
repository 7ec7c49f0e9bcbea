"""The commands of ``contactstudy`` and their arguments."""

from __future__ import annotations

import argparse
from pathlib import Path

MANY_CASES = 100_000  # Combinations of a study that needs a confirmation, or --yes


def command_parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parsed = argparse.ArgumentParser(
        prog="contactstudy",
        description="Rolling-sliding contact of a roller on an elastic body with free end faces: parametric studies.",
        epilog="Exit codes: 0 all cases or checks ok, 1 some failed or are not done, 2 wrong usage or input, "
        "129 after SIGHUP, 130 after Ctrl-C, 141 if nobody reads the output any more, 143 after SIGTERM.",
    )
    parsed.add_argument("--version", action="store_true", help="show the version and end")
    parsed.add_argument("--versions", action="store_true", help="show it with those of all that a result depends on")
    parsed.add_argument("--verbose", action="store_true", help="log to the error output")
    commands = parsed.add_subparsers(dest="command", metavar="COMMAND")

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
        added.add_argument(
            "--wait", metavar="SECONDS", type=float, help="longest wait for a worker of the scheduler; default 300"
        )
        added.add_argument("--no-figure", action="store_true", help="draw no figure")

    run = command("run", "Solve the cases of a study that are not solved yet.", takes_study=True)
    parallel(run)
    run.add_argument("--share", metavar="K/N", help="solve share K of N, such as 3/40: for job arrays")
    text = "State of every case, errors in the study, and bytes and time of a run; solves nothing without --sample."
    plan = command("plan", text, takes_study=True)
    plan.add_argument("--sample", metavar="N", type=int, help="solve N cases, evenly spaced, to estimate the time")
    plan.add_argument("--workers", metavar="N", type=int, help="local processes for the sample; default one per core")
    for added in (run, plan):
        added.add_argument("--yes", action="store_true", help=f"do not ask about {MANY_CASES} cases and more")
    status = command("status", "State of every case: done, failed, stale or missing.", takes_study=False)
    for added in (plan, status):
        added.add_argument("--all", action="store_true", help="list every case")
    added = command("collect", "Merge the summaries of all cases into one netCDF file.", takes_study=False)
    added.add_argument("--out", metavar="FILE", type=Path, help="default FOLDER/summary.nc")
    parallel(command("rerun", "Solve failed, stale and missing cases again.", takes_study=False))
    text = "Check the solver against closed forms, finite elements and published numbers."
    added = commands.add_parser("verify", help=text, description=text)
    added.add_argument("--level", choices=("quick", "full"), default="quick", help="a minute, or a few (default quick)")
    added.add_argument("--out", metavar="FOLDER", type=Path, help="default results/verification")
    text = "Write a study's summaries as a table (CSV), or fields of one case as CSV, VTK or MATLAB."
    added = commands.add_parser("export", help=text, description=text)
    added.add_argument("path", metavar="FILE_OR_FOLDER", type=Path, help="netCDF file of a case, or a study's folder")
    added.add_argument("--format", choices=("csv", "vtk", "mat"), help="default csv")
    added.add_argument("--variable", metavar="NAME", action="append", help="variable or stress measure; repeatable")
    added.add_argument("--line", metavar="X,Y,Z:X,Y,Z", help="ends of a line in metres, for csv (--line=-1e-4,0,0:...)")
    added.add_argument("--points", metavar="N", type=int, default=101, help="points of the line; default 101")
    added.add_argument("--select", metavar="NAME=VALUE", action="append", help="swept parameter of a study; repeatable")
    added.add_argument("--out", metavar="FILE", type=Path, help="default beside the results; - for the screen")
    explore = command("explore", "Serve a page to look through a study, on this machine.", takes_study=False)
    explore.add_argument("--port", metavar="N", type=int, help="default: the first free one from 5006 on")
    text = "host name that a browser may use beside localhost, such as that of a proxy; repeatable"
    explore.add_argument("--host", metavar="NAME", action="append", default=[], help=text)
    explore.add_argument("--no-browser", action="store_true", help="do not open the page in the browser")
    text = "Write one HTML page of a case or of a study, for a reader without Python."
    added = commands.add_parser("report", help=text, description=text)
    added.add_argument("path", metavar="FILE_OR_FOLDER", type=Path, help="netCDF file of a case, or a study's folder")
    added.add_argument("--title", metavar="TEXT", help="heading; default: the name of the file or of the study")
    text = "value of a swept parameter that a study's figures keep to; repeatable"
    added.add_argument("--select", metavar="NAME=VALUE", action="append", help=text)
    added.add_argument("--out", metavar="FILE", type=Path, help="default beside the file, or report.html in the folder")
    return parsed
