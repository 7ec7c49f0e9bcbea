"""Cache of what the files of a study say, so that a thousand of them need not be opened to know their state.

One line for each file, written at its end as cases finish: a check sum and JSON. Of two lines for one file the later
one counts. Lines that are not as they were written are passed over, because everything in the cache can be read again
from the files.
"""

from __future__ import annotations

import json
import sys
import zlib
from pathlib import Path
from typing import Any

from contactstudy.study.errors import StoreError
from contactstudy.study.store import write_text

SCHEMA = 3

# Lines per file beyond which the cache is written anew.
MOST_LINES = 2


def _sound(entry: object) -> bool:
    """Whether an entry has what its readers rely on."""
    return (
        isinstance(entry, dict)
        and all(isinstance(entry.get(name), str) for name in ("name", "id"))
        and all(type(entry.get(name)) is int for name in ("size", "changed"))
        and isinstance(entry.get("run"), dict)
        and isinstance(entry.get("scalars"), dict)
        and all(isinstance(value, (int, float)) for value in entry["scalars"].values())
    )


def as_line(entry: dict[str, Any]) -> str:
    """Write an entry as a line; a digit that changes on a disk would make another number of it."""
    text = json.dumps(entry)
    return f"{zlib.crc32(text.encode()):08x} {text}"


def _entry_of(line: str) -> dict[str, Any] | None:
    """Entry that a line holds; None if it is not as it was written."""
    found, _, text = line.partition(" ")
    if found != f"{zlib.crc32(text.encode()):08x}":
        return None
    try:
        entry = json.loads(text)
    except (ValueError, RecursionError):
        return None
    return entry if _sound(entry) else None


class Manifest:
    """The cache of one folder.

    Parameters
    ----------
    path : Path
        Its file, which need not exist.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._entries: dict[str, dict[str, Any]] | None = None
        self._new: list[str] = []
        self._lines = 0

    def _known(self) -> dict[str, dict[str, Any]]:
        """Entries by file name, read when they are first needed."""
        if self._entries is None:
            self._entries = {}
            try:
                first, *lines = self._path.read_text(encoding="utf-8", errors="replace").split("\n")
                known = json.loads(first) == {"schema": SCHEMA}
            except (OSError, ValueError, RecursionError):
                known, lines = False, []
            self._lines = len(lines) + 1 if known else 0
            for line in lines if known else ():
                if entry := _entry_of(line):
                    self._entries[entry["name"]] = entry
        return self._entries

    def get(self, name: str) -> dict[str, Any] | None:
        """Entry of a file; None if it is not known."""
        return self._known().get(name)

    def put(
        self, name: str, size: int, changed: int, identity: str, run: dict[str, Any], scalars: dict[str, float]
    ) -> dict[str, Any]:
        """Enter a file's size, time of change, case, circumstances and scalars; return the entry."""
        # Words that came from another process or a file are new ones each time: keep one of each.
        run = {sys.intern(key): sys.intern(value) if isinstance(value, str) else value for key, value in run.items()}
        scalars = {sys.intern(key): value for key, value in scalars.items()}
        entry = {"name": name, "size": size, "changed": changed, "id": identity, "run": run, "scalars": scalars}
        self._known()[name] = entry
        self._new.append(as_line(entry))
        return entry

    def forget(self, name: str) -> None:
        """Leave out a file that has changed."""
        self._known().pop(name, None)

    def save(self) -> None:
        """Write what is new at the end of the file, or all of it if the file is none of this schema or mostly outdated.

        Raises
        ------
        StoreError
            If it cannot be written.
        """
        known = self._known()
        lines = self._lines + len(self._new)
        if self._lines == 0 or lines > MOST_LINES * len(known) + 100:
            content = [json.dumps({"schema": SCHEMA}), *map(as_line, known.values())]
            write_text(self._path, "\n".join(content))
            lines = len(content)
        elif self._new:
            try:
                with open(self._path, "a", encoding="utf-8") as file:
                    # A line that a killed process left half written must not swallow the next one.
                    file.write("\n" + "\n".join(self._new))
            except OSError as error:
                raise StoreError(f"cannot write {self._path}: {error.strerror or error}") from error
        self._new, self._lines = [], lines
