"""Text of measurements as programs write it, and what a file is that holds no text.

Text is UTF-8, or UTF-16 with its mark. Of an older encoding one sign only is taken: the byte 0xB5, which is the micro
sign in all of Latin-1, Windows-1252 and their kin, in which Excel writes CSV. Any other sign stays unread, so that a
unit which has one is unknown.
"""

from __future__ import annotations

import codecs
import stat
import zipfile
from collections.abc import Iterator
from pathlib import Path

from contactstudy.errors import InvalidInputError

COMMENT = "#"
"""Begins a line of a text file that is not read."""

# Of a file with measurements; a height map of ten million points has as many.
MOST_BYTES = 500_000_000

LOOKED_AT = 4096
"""First bytes of a file, in which anything but text shows."""

NEVER_TEXT = bytes(set(range(32)) - set(b"\t\n\v\f\r\x1a\x1b"))
"""Bytes that text in no encoding of single bytes has."""

MICRO = "\N{MICRO SIGN}"

FOREIGN_MICRO = "\udcb5"
"""What Python makes of the byte 0xB5 where it is not UTF-8."""

PICTURE = "a picture, which shows heights but does not hold them: export them from the instrument's software"
SHEET = "a workbook of a spreadsheet program: save the sheet as 'CSV UTF-8'"

BEGINNINGS = (
    (b"\x89PNG", PICTURE),
    (b"\xff\xd8\xff", PICTURE),
    (b"GIF8", PICTURE),
    (b"BM", PICTURE),
    (b"%PDF", "a PDF document: export the heights from the instrument's software"),
    (b"CDF", "netCDF: let its name end with .nc"),
    (b"\x89HDF", "netCDF or HDF5: let the name of a netCDF file end with .nc"),
)
"""First bytes of files that are given instead of measurements, and what to do about them."""

SHORT = 3
"""Length of beginnings that a word in a text may have as well: they count in files that are no text."""

READ = (
    "columns as text (.csv, .txt, .tsv, .dat), netCDF (.nc), or with the extra `measured` x3p (.x3p) "
    "and the formats of profilometers that SurfaceTopography knows"
)
"""What is read, as the end of the sentence "must be ..."."""


def regular_file(path: Path, kind: str = "text") -> None:
    """Raise unless `path` is a file of a sensible size: a pipe or a device would never end."""
    try:
        state = path.stat()
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InvalidInputError("path", str(path), f"a {kind} file that can be read", reason) from error
    if not stat.S_ISREG(state.st_mode):
        raise InvalidInputError("path", str(path), "a regular file, not a folder, pipe or device")
    if state.st_size > MOST_BYTES:
        raise InvalidInputError("path", str(path), f"at most {MOST_BYTES:.0e} bytes", f"it has {state.st_size}")


def lines_of(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the lines of a text file with their numbers, but for empty ones and comments.

    Raises
    ------
    InvalidInputError
        If it is no regular file, cannot be read or is no text.
    """
    regular_file(path)
    try:
        with open(path, encoding=_encoding(path), errors="surrogateescape") as file:
            for number, line in enumerate(file, start=1):
                if (content := line.strip()) and not content.startswith(COMMENT):
                    yield number, line.replace(FOREIGN_MICRO, MICRO)
    except (OSError, UnicodeError) as error:
        reason = error.strerror or str(error) if isinstance(error, OSError) else "it is no text"
        raise InvalidInputError("path", str(path), "a text file that can be read", reason.lower()) from error


def is_unread(text: str) -> bool:
    r"""Whether text has a sign of an encoding that is not known.

    Examples
    --------
    >>> is_unread("µm"), is_unread(b"\xe6m".decode("utf-8", "surrogateescape"))
    (False, True)
    """
    return any("\udc80" <= sign <= "\udcff" for sign in text)


def known_otherwise(path: Path) -> str:
    """Return what a file is that holds no measurements, and what to do about it; empty if that is not known."""
    head = _head(path)
    for beginning, words in BEGINNINGS:
        if head.startswith(beginning) and (len(beginning) > SHORT or _is_no_text(head)):
            return words
    if head.startswith(b"PK"):
        try:
            with zipfile.ZipFile(path) as archive:
                names = archive.namelist()
        except (OSError, zipfile.BadZipFile, ValueError):
            return ""
        if any(name.startswith("xl/") for name in names) or "content.xml" in names:
            return SHEET
        return "x3p: let its name end with .x3p" if "main.xml" in names else ""
    return SHEET if path.suffix.lower() == ".xls" else ""


def _head(path: Path) -> bytes:
    """First bytes of a file."""
    try:
        with open(path, "rb") as file:
            return file.read(LOOKED_AT)
    except OSError:
        return b""  # whoever opens it next says why


def _is_no_text(head: bytes) -> bool:
    """Whether the first bytes of a file are those of no text in an encoding of single bytes."""
    return head.translate(None, NEVER_TEXT) != head


def _encoding(path: Path) -> str:
    """Return the encoding of a text file by its first bytes, or raise with what it is instead."""
    head = _head(path)
    if head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    if words := known_otherwise(path):
        raise InvalidInputError("path", str(path), READ, f"it is {words}")
    if _is_no_text(head):
        hint = "named as text, it holds none: give a profilometer's file its own ending, or export columns"
        raise InvalidInputError("path", str(path), READ, hint)
    return "utf-8-sig"
