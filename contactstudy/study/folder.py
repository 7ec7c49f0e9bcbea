"""The folder of a study: its files, its locks, and the state of every case (docs/reference/results_files.md)."""

from __future__ import annotations

import contextlib
import json
import os
import socket
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cached_property, partial, reduce
from itertools import chain, count
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd
import xarray as xr
from filelock import FileLock, Timeout

from contactstudy import checks
from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE
from contactstudy.arrays.variables import package_version
from contactstudy.case.serialization import to_dict
from contactstudy.checks import TEMPORARY_SUFFIX, FloatArray
from contactstudy.errors import InvalidInputError, LockedError, StoreError, StudyFileError
from contactstudy.study.batches import (
    CASE_ATTRIBUTE,
    STATUSES,
    Batch,
    batch_paths,
    common_attributes,
    count_cases,
    find_damage,
    join_batches,
    latest_rows,
    read_batch,
    read_case,
    write_batch,
)
from contactstudy.study.case_setup import build_setup
from contactstudy.study.definition import Study
from contactstudy.study.files import UNFINISHED, is_regular, write_text
from contactstudy.study.plan import LEVELS, Plan
from contactstudy.study.profile_tables import check_without_files, user_profiles
from contactstudy.study.settings import RUN

SCHEMA = 2  # Version of the format of study.json
STATES = (*STATUSES, "stale", "missing", "excluded")  # States of a case of a study


@dataclass(frozen=True)
class Share:
    """Part `number`, from 1, of `count` independent parts of a study."""

    number: int = 1
    count: int = 1

    @property
    def name(self) -> str:
        """Start of the names of the share's log and lock."""
        return "run" if self.count == 1 else f"run-{self.number}-of-{self.count}"

    @property
    def prefix(self) -> str:
        """Start of the names of the share's batches."""
        return "" if self.count == 1 else f"{self.number}-of-{self.count}-"


UNDIVIDED = Share()  # A study in one run


class Results:
    """Current results of a folder: columns of all intact batches, in memory."""

    def __init__(self, paths: list[Path]) -> None:
        self.paths: list[Path] = []
        self.batches: list[Batch] = []
        self.damaged: dict[Path, str] = {}
        for path in paths:
            try:
                self.batches.append(read_batch(path))
                self.paths.append(path)
            except StoreError as error:
                if path.exists() or path.is_symlink():  # another run may have joined the batch meanwhile
                    self.damaged[path] = str(error)

    @cached_property
    def cases(self) -> pd.DataFrame:
        """Latest result of each case, by identity: status, message, and run with version and level; batch and row."""
        columns = ("status", "message", "run", "batch", "row", "version", "level")
        tables = [
            batch.cases.assign(
                batch=index,
                row=range(len(batch)),
                version=batch.run_context.get("contactstudy"),
                level=batch.run_context.get("level"),
            ).reindex(columns=columns)
            for index, batch in enumerate(self.batches)
        ]
        table = pd.concat(tables) if tables else pd.DataFrame(columns=columns)
        return table.iloc[latest_rows(table)]

    def case(self, identity: str, names: Iterable[str] | None = None) -> xr.Dataset:
        """Return one solved case on its cells, with all arrays or only the named arrays."""
        if identity not in self.cases.index or self.cases["status"][identity] != "ok":
            raise InvalidInputError("case_id", identity, "that of a solved case of the study")
        batch, row = self.cases.loc[identity, ["batch", "row"]]
        case = read_case(self.paths[batch], row, names)
        parameters = json.loads(case.attrs[CASE_ATTRIBUTE])
        with contextlib.suppress(InvalidInputError):  # parameters of another version, or an unknown user's profile
            user_profiles(parameters)
            setup = build_setup(parameters)
            settings = {name: setup.options[name] for name in ("tolerance", "accuracy") if name in setup.options}
            case.attrs[INPUTS_ATTRIBUTE] = json.dumps({"case": to_dict(setup.case), "settings": settings})
        return case


class States:
    """State of every case of a plan."""

    def __init__(self, plan: Plan, results: Results) -> None:
        self.plan, self.results = plan, results
        stored = results.cases.reindex(plan.ids.astype(np.str_))
        is_ok, is_current = stored["status"] == "ok", stored["version"] == package_version()
        is_complete = stored["level"].isin(LEVELS[LEVELS.index(plan.level) :])
        is_absent = stored["status"].isna() | (~is_current & (stored["status"] == "skipped"))
        skip_reasons = pd.Series(plan.groups).map(plan.review.reasons)
        conditions, statuses, reasons = zip(
            (skip_reasons.notna(), "skipped", skip_reasons),
            (is_absent, "missing", "; ".join(results.damaged.values())),
            (is_ok & ~is_complete, "stale", stored["level"].map(f"retains {{}}, not {plan.level}".format)),
            (is_ok & ~is_current, "stale", stored["version"].map("solved by version {}".format)),
            strict=True,
        )
        self.status: npt.NDArray[np.str_] = np.select(conditions, statuses, stored["status"]).astype("U8")
        self.reasons: list[str] = np.select(conditions, reasons, stored["message"]).tolist()
        is_solved = np.isin(self.status, ("ok", "stale"))
        self.usable = is_solved & is_complete.to_numpy()
        # batch and row of each case; -1 for a case without numbers
        self.batch, self.row = (stored[name].where(is_solved, -1).to_numpy(np.int64) for name in ("batch", "row"))

    @property
    def counts(self) -> dict[str, int]:
        """Number of cases of each status that occurs."""
        return {status: count for status in STATES if (count := int(np.count_nonzero(self.status == status)))}

    @property
    def summary(self) -> str:
        """Number of cases of each status, for messages."""
        return ", ".join(f"{count} {state}" for state, count in self.counts.items())

    def indices(self, *statuses: str) -> list[int]:
        """Numbers in the plan of the cases with one of the `statuses`."""
        return np.flatnonzero(np.isin(self.status, statuses)).tolist()

    def numbers(self, name: str) -> FloatArray:
        """Values of the number `name` for every case, in the order of the plan; NaN for an absent value."""
        values = np.full(len(self.plan), np.nan)
        for batch_index, batch in enumerate(self.results.batches):
            if name in batch.cases:
                cases = self.batch == batch_index
                values[cases] = batch.cases[name].to_numpy()[self.row[cases]]
        return values

    def attributes(self, name: str) -> dict[str, Any]:
        """Attributes that a number or array has in all batches."""
        entries = [dict(batch.attributes[name]) for batch in self.results.batches if name in batch.attributes]
        return reduce(partial(common_attributes, name), entries) if entries else {}

    def record(self, index: int) -> xr.Dataset:
        """Numbers of one case with the record of its run; empty for a case without numbers."""
        batch = self.batch[index]
        return self.results.batches[batch].record(self.row[index]) if batch >= 0 else xr.Dataset()


class Folder:
    """A study's folder, which need not exist yet, for one share of its cases."""

    def __init__(self, path: str | Path, share: Share = UNDIVIDED) -> None:
        checks.instance("folder", path, (str, Path), "the path of a study's folder")
        try:
            self.path = Path(path).resolve()
        except OSError as error:
            raise StoreError(f"the working directory of {path} does not exist: {error.strerror}") from error
        self.batches, self.share = self.path / "batches", share

    def create(self) -> None:
        """Make the folder, or raise :class:`StoreError`."""
        if self.batches.is_symlink():
            raise StoreError(f"{self.batches} is a link, and a study writes into folders: delete it")
        with checks.convert_os_errors(f"make {self.batches}"):
            self.batches.mkdir(parents=True, exist_ok=True)

    def write_study(self, study: Study) -> None:
        """Write the definition of the study; a folder belongs to one study, which may grow."""
        path = self.path / "study.json"
        if path.exists():
            name = self.read_study().name
            if name != study.name:
                raise StoreError(f"{self.path} contains the study {name!r}, not {study.name!r}: choose another folder")
        write_text(path, json.dumps({"schema": SCHEMA, **json.loads(study.to_json())}, indent=1))

    def read_study(self) -> Study:
        """Return the definition of the study, or raise :class:`StudyFileError`."""
        path = self.path / "study.json"
        if path.exists() and not is_regular(path):
            raise StudyFileError(f"{path} is not a regular file")
        try:
            content = checks.read_tables(path)
        except (OSError, ValueError) as error:
            remedy = "give the folder that `contactstudy run` wrote, such as results/NAME"
            if not self.path.exists():
                reason = "it does not exist"
            elif self.path.is_file():
                reason = f"it is a file; {remedy}"
            elif not path.exists():
                reason = f"without study.json; {remedy}"
            else:
                reason = f"study.json: {getattr(error, 'strerror', None) or error}"
            raise StudyFileError(f"{self.path} is not the folder of a study: {reason}") from error
        try:
            if isinstance(content, dict) and (schema := content.pop("schema", None)) != SCHEMA:
                raise InvalidInputError("schema", schema, f"{SCHEMA}: another version of the package wrote the folder")
            check_without_files(content)
            return Study.from_mapping(content)
        except InvalidInputError as error:
            raise StudyFileError(f"{path} is not the definition of a study: {error}") from error

    @contextlib.contextmanager
    def locked(self) -> Iterator[None]:
        """Hold a lock or raise :class:`LockedError`: runs of the whole study and of a share exclude each other."""
        with contextlib.ExitStack() as locks:
            if self.share.count == 1:
                # Another process that calls `holders` holds the lock for a moment.
                locks.enter_context(self._hold_lock("run", 0.5))
                for path in self.path.glob("run-*.lock"):
                    with self._hold_lock(path.stem, 0.0):
                        pass
            else:
                with self._hold_lock("run", RUN.share_seconds):
                    locks.enter_context(self._hold_lock(self.share.name, 0.0))
            yield

    @contextlib.contextmanager
    def _hold_lock(self, name: str, seconds: float) -> Iterator[None]:
        """Hold a lock; wait for some seconds."""
        path = self.path / f"{name}.lock"
        if os.path.lexists(path) and not is_regular(path):
            raise LockedError(f"{path} is not a regular file: delete it if no run uses {self.path}")
        lock = FileLock(path, timeout=seconds)
        try:
            lock.acquire()
        except Timeout:
            raise LockedError(f"{self.path} is in use by {self.holder(name)}") from None
        except (OSError, NotImplementedError) as error:
            raise StoreError(f"cannot write {path}: {getattr(error, 'strerror', None) or error}") from error
        try:
            now = datetime.now(UTC).isoformat(timespec="seconds")
            with contextlib.suppress(OSError):
                path.write_text(f"process {os.getpid()} on {socket.gethostname()} since {now}", encoding="utf-8")
            yield
        finally:
            lock.release()

    def holder(self, name: str) -> str:
        """Process, host and time of the latest holder of a lock."""
        with contextlib.suppress(OSError, ValueError):
            if text := (self.path / f"{name}.lock").read_text(encoding="utf-8")[:200]:
                return text
        return "another process"

    @property
    def holders(self) -> list[str]:
        """Processes that run the study, or shares of it, now."""
        holders = []
        for path in sorted(self.path.glob("run*.lock")):
            try:
                with FileLock(path, timeout=0.0):
                    pass
            except Timeout:
                holders.append(f"{path.stem}: {self.holder(path.stem)}")
            except (OSError, NotImplementedError):
                continue
        return holders

    def clean(self) -> None:
        """Remove unfinished files of runs that ended."""
        for folder in (self.batches, self.path) if self.share.count == 1 else (self.batches,):
            for path in folder.glob(f"{self.share.prefix}*{TEMPORARY_SUFFIX}"):
                if UNFINISHED.fullmatch(path.name):
                    with contextlib.suppress(OSError):
                        path.unlink()

    def set_aside(self, path: Path) -> Path:
        """Move a damaged or foreign file to ``set-aside``; return its new path."""
        folder = self.path / "set-aside"
        if folder.is_symlink():
            raise StoreError(f"{folder} is a link: delete it")
        with checks.convert_os_errors(f"move {path}"):
            folder.mkdir(exist_ok=True)
            names = chain([path.name], (f"{path.stem}-{number}{path.suffix}" for number in count(2)))
            target = next(folder / name for name in names if not os.path.lexists(folder / name))
            os.replace(path, target)
        return target

    def results(self) -> Results:
        """Read the current results of the folder."""
        return Results(batch_paths(self.batches))

    def states(self, plan: Plan) -> States:
        """State of every case of a plan; changes no file."""
        return States(plan, self.results())

    def verified_results(self) -> tuple[Results, list[str]]:
        """Verify every byte; return the intact results, and messages on damaged files, which are set aside."""
        paths = batch_paths(self.batches)
        damaged = {
            path: reason for path in paths if path.name.startswith(self.share.prefix) and (reason := find_damage(path))
        }
        results = Results([path for path in paths if path not in damaged])
        if self.share.count == 1:
            damaged |= results.damaged
        return results, [
            f"{path.name} is damaged, its cases are missing: {reason}; moved to {self.set_aside(path)}"
            for path, reason in damaged.items()
        ]

    def compact(self, *, at_end: bool = False) -> None:
        """Join small batches, without results that later runs replaced; `at_end` joins all small batches."""
        size_limit, min_count = (RUN.small_bytes, 2) if at_end else (RUN.batch_bytes, RUN.fan_in)
        tiers: dict[int, list[Path]] = {}
        for path in batch_paths(self.batches):
            with contextlib.suppress(OSError):
                size, is_full = path.lstat().st_size, count_cases(path) > RUN.batch_cases // 2
                if path.name.startswith(self.share.prefix) and not is_full and size < size_limit:
                    tiers.setdefault(0 if at_end else int(np.log(max(size, 1)) / np.log(RUN.fan_in)), []).append(path)
        for paths in tiers.values():
            if len(paths) >= min_count:
                self._join(paths)

    def _join(self, paths: list[Path]) -> None:
        """Join batches of equal structure, as far as the batches' sizes allow."""
        groups: dict[str, dict[Path, Batch]] = {}
        for path in paths:
            with contextlib.suppress(StoreError):
                batch = read_batch(path, arrays=None, parameters=True)
                groups.setdefault(batch.structure, {})[path] = batch
        for group in groups.values():
            for portion in _split_by_size(group):
                if len(portion) > 1:
                    joined_batch = select_latest(join_batches([*portion.values()]))
                    write_batch(self.batches, f"{self.share.prefix}{os.urandom(6).hex()}", joined_batch)
                    for path in portion:
                        path.unlink(missing_ok=True)


def _split_by_size(batches: Mapping[Path, Batch]) -> Iterator[dict[Path, Batch]]:
    """Yield portions of the batches that are not too large in total, small batches first."""
    portion: dict[Path, Batch] = {}
    for path, batch in sorted(batches.items(), key=lambda item: len(item[1])):
        entries = [*portion.values(), batch]
        is_large = sum(map(len, entries)) > RUN.batch_cases or sum(entry.nbytes for entry in entries) > RUN.batch_bytes
        if portion and is_large:
            yield portion
            portion = {}
        portion[path] = batch
    if portion:
        yield portion


def select_latest(batch: Batch) -> Batch:
    """Return a batch with the latest row of each case."""
    rows = latest_rows(batch.cases)
    return batch if len(rows) == len(batch) else batch.take(rows)
