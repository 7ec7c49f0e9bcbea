"""The folder of a study: its files, what each case's state is, and the manifest as a cache of that.

::

    FOLDER/study.json            the study
    FOLDER/cases/<id>.nc         one finished case
    FOLDER/cases/<id>.failed     one failed case, as JSON
    FOLDER/set-aside/            damaged or foreign files
    FOLDER/manifest.jsonl        cache of the above; may be deleted at any time
    FOLDER/run.log, run.lock     log of all runs; who runs now
"""

from __future__ import annotations

import json
import os
import stat
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from contactstudy import checks
from contactstudy.arrays.variables import package_version
from contactstudy.errors import InvalidInputError
from contactstudy.study.definition import Study
from contactstudy.study.errors import StoreError, StudyFileError
from contactstudy.study.manifest import Manifest
from contactstudy.study.parameters import PARAMETERS
from contactstudy.study.plan import LEVELS, Plan
from contactstudy.study.store import read_header, remove_dead_parts, write_text

SCHEMA = 2
"""Number of the meaning of study.json: 1 had uniform cells where nothing was said, and did not state its number."""

CELLS = ("cells_x", "cells_y")

ID_DIGITS = 16
"""Digits of the identity in a file's name; the file holds all 64."""


@dataclass(frozen=True)
class Entry:
    """State of one case.

    Parameters
    ----------
    status : {"ok", "failed", "skipped", "stale", "missing"}
        Stale: solved by another version of the package, or kept at a lower level than asked for now.
    reason : str
        Why it is not ok.
    path : str
        The file, relative to the folder; empty if there is none.
    scalars : dict
        Summary values.
    run : dict
        Versions, time, seconds and level.
    usable : bool
        Whether the file has what was asked for (a stale case of another version has).
    """

    status: str
    reason: str = ""
    path: str = ""
    scalars: dict[str, float] = field(default_factory=dict)
    run: dict[str, Any] = field(default_factory=dict)
    usable: bool = False


class Folder:
    """A study's folder.

    Parameters
    ----------
    path : str or Path
        The folder; need not exist yet.
    """

    def __init__(self, path: str | Path) -> None:
        checks.instance("folder", path, (str, Path), "the path of a study's folder")
        self.path = Path(path).resolve()
        self.cases = self.path / "cases"
        self._manifest = Manifest(self.path / "manifest.jsonl")

    def create(self) -> None:
        """Make the folder, or raise :class:`StoreError`."""
        try:
            self.cases.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise StoreError(f"cannot make {self.cases}: {error.strerror or error}") from error

    def case_path(self, identity: str) -> Path:
        """File of a finished case."""
        return self.cases / f"{identity[:ID_DIGITS]}.nc"

    def failure_path(self, identity: str) -> Path:
        """File of a failed case."""
        return self.cases / f"{identity[:ID_DIGITS]}.failed"

    def write_study(self, study: Study) -> None:
        """Keep the study's definition; a folder belongs to one study, which may grow."""
        existing = self.path / "study.json"
        if existing.exists():
            name = self.read_study().name
            if name != study.name:
                raise StoreError(f"{self.path} holds the study {name!r}, not {study.name!r}: choose another folder")
        write_text(existing, json.dumps({"schema": SCHEMA, **json.loads(study.to_json())}, indent=1))

    def read_study(self) -> Study:
        """Return the study's definition.

        Raises
        ------
        StudyFileError
            If the folder holds none.
        """
        path = self.path / "study.json"
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            reason = "it holds no study.json; give what `contactstudy run` wrote into, such as results/NAME"
            if not self.path.exists():
                reason = "there is no such folder"
            elif self.path.is_file():
                reason = "it is a file; give the folder that `contactstudy run` wrote into, such as results/NAME"
            elif path.exists():
                reason = f"study.json: {error.strerror}"
            raise StudyFileError(f"{self.path} is not the folder of a study: {reason}") from error
        except ValueError as error:
            raise StudyFileError(f"{self.path} is not the folder of a study: study.json: {error}") from error
        except RecursionError:
            raise StudyFileError(f"{path}: nested too deeply to be a study") from None
        try:
            if isinstance(content, dict) and content.pop("schema", 1) == 1:
                # Such a folder was solved before columns were refined: its cases have uniform cells.
                content["base"] = {name: PARAMETERS[name].default for name in CELLS} | dict(content.get("base", {}))
            return Study.from_mapping(content)
        except InvalidInputError as error:
            raise StudyFileError(f"{path} is not the definition of a study: {error}") from error

    def write_failure(self, identity: str, parameters: dict[str, Any], kind: str, message: str) -> None:
        """Record why a case failed."""
        content = {
            "id": identity,
            "parameters": parameters,
            "type": kind,
            "message": message,
            "version": package_version(),
        }
        write_text(self.failure_path(identity), json.dumps(content, indent=1))

    def clean(self) -> int:
        """Remove what dead processes left unfinished; return how many files."""
        return sum(remove_dead_parts(folder) for folder in (self.path, self.cases))

    def set_aside(self, path: Path) -> Path:
        """Move a damaged or foreign file out of the way; return where it is now."""
        folder = self.path / "set-aside"
        try:
            folder.mkdir(exist_ok=True)
            target, number = folder / path.name, 1
            while target.exists():
                number += 1
                target = folder / f"{path.stem}-{number}{path.suffix}"
            os.replace(path, target)
        except OSError as error:
            raise StoreError(f"cannot move {path}: {error.strerror or error}") from error
        return target

    def save_manifest(self) -> None:
        """Write the cache."""
        self._manifest.save()

    def remember(self, path: Path, identity: str, run: dict[str, Any], scalars: dict[str, float]) -> dict[str, Any]:
        """Enter a file, just written or checked, in the cache; return its entry."""
        state = path.stat()
        return self._manifest.put(path.name, state.st_size, state.st_mtime_ns, identity, run, scalars)

    def _checked(self, path: Path) -> dict[str, Any]:
        """Cache entry of a file, read and verified anew if the file has changed since.

        Raises
        ------
        FileNotFoundError
            If there is none.
        StoreError
            If the file is damaged or foreign.
        """
        try:
            state = path.stat()
        except FileNotFoundError:
            raise
        except OSError as error:
            raise StoreError(f"cannot read {path}: {error.strerror or error}") from error
        if not stat.S_ISREG(state.st_mode):
            raise StoreError(f"{path} is not a regular file")
        known = self._manifest.get(path.name)
        if known and (known["size"], known["changed"]) == (state.st_size, state.st_mtime_ns):
            return known
        self._manifest.forget(path.name)
        header = read_header(path, verify=True)
        return self.remember(path, header.id, header.run, header.scalars)

    def _of_case(self, path: Path, identity: str) -> dict[str, Any]:
        """Cache entry of a case's file, which must hold this case."""
        known = self._checked(path)
        if known["id"] != identity:
            raise StoreError(f"{path} holds another case, {known['id'][:ID_DIGITS]}")
        return known

    def state(self, identity: str, level: str) -> tuple[Entry, str]:
        """State of a case that can be solved, and what is wrong with its file (empty if nothing)."""
        path, problem = self.case_path(identity), ""
        try:
            known = self._of_case(path, identity)
        except FileNotFoundError:
            known = None
        except StoreError as error:
            known, problem = None, str(error)
        if known is not None:
            name, run = f"cases/{path.name}", known["run"]
            kept = run.get("level")
            if kept not in LEVELS or LEVELS.index(kept) < LEVELS.index(level):
                reason = f"keeps {kept}, not {level}"
                return Entry("stale", reason, name, known["scalars"], run), ""
            if run.get("contactstudy") != package_version():
                reason = f"solved by version {run.get('contactstudy')}"
                return Entry("stale", reason, name, known["scalars"], run, usable=True), ""
            return Entry("ok", "", name, known["scalars"], run, usable=True), ""
        try:
            failure = json.loads(self.failure_path(identity).read_text(encoding="utf-8"))
            return Entry("failed", f"{failure['type']}: {failure['message']}"), problem
        except FileNotFoundError:
            return Entry("missing", problem), problem
        except (OSError, ValueError, KeyError, TypeError) as error:
            return Entry("missing", f"unreadable failure record: {error}"), problem

    def entries(self, plan: Plan) -> list[Entry]:
        """State of every case of a plan, in its order; reads only."""
        found: dict[str, Entry] = {}
        result = []
        for case in plan.cases:
            if case.reason:
                result.append(Entry("skipped", case.reason))
                continue
            if case.id not in found:
                found[case.id] = self.state(case.id, plan.level)[0]
            result.append(found[case.id])
        return result

    def foreign_files(self) -> list[tuple[Path, str]]:
        """Files among the cases that are no case of this package, each with what is wrong."""
        wrong = []
        for path in sorted(self.cases.glob("*")):
            # What a user keeps beside the cases, such as a report of one, is left alone.
            if path.suffix != ".nc" or ".part-" in path.name:
                continue
            try:
                identity = self._checked(path)["id"]
                if self.case_path(identity) != path:
                    wrong.append((path, f"{path} holds the case {identity[:ID_DIGITS]} under a wrong name"))
            except FileNotFoundError:
                if path.is_symlink():
                    wrong.append((path, f"{path} is a link to a file that is not there"))
            except StoreError as error:
                wrong.append((path, str(error)))
        return wrong
