"""The page on a server of this machine alone; the study is read while the browser loads the page's scripts."""

from __future__ import annotations

import json
import socket
import sys
from asyncio import wrap_future
from concurrent.futures import Future
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contactstudy import checks
from contactstudy.errors import InvalidInputError
from contactstudy.explorer.show import cases_of, check_installed

if TYPE_CHECKING:
    from contactstudy.explorer.cases import Cases

HOST = "localhost"
"""Nobody else can open the page: a study's folder is nobody else's business."""

PORT, PORTS = 5006, 20
"""First port that is tried, and how many."""

SWITCH = 2e-4
"""Seconds after which the thread that reads the study lets the server answer; Python's own 5 ms add up. Speed."""


class Opening:
    """A study that is read while browsers load the page's scripts.

    Parameters
    ----------
    folder : Path
        The study's folder.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._cases: Future[Cases] = Future()
        self.error: Exception | None = None

    async def read(self) -> None:
        """Read the study in a thread; keep an error, and stop the server then."""
        from tornado.ioloop import IOLoop

        loop, usual = IOLoop.current(), sys.getswitchinterval()
        sys.setswitchinterval(SWITCH)
        try:
            self._cases.set_result(await loop.run_in_executor(None, self._cases_and_code))
        except Exception as error:  # raised again where the server was started
            self.error = error
            loop.stop()
        finally:
            sys.setswitchinterval(usual)

    def _cases_and_code(self) -> Cases:
        """Import what makes the page, and read the study."""
        import_module("contactstudy.explorer.page")
        return cases_of(self._folder)

    def page(self) -> Any:
        """Page of a new visitor: empty, and filled once the browser has its scripts and the study is read."""
        import panel as pn

        shown = pn.Column(sizing_mode="stretch_width")

        async def fill() -> None:
            """Put the study into the page."""
            from contactstudy.explorer.page import Page

            cases = await wrap_future(self._cases)
            shown.objects = [Page(cases).view()]

        pn.state.onload(fill)
        return shown


def serve(folder: str | Path, *, port: int | None = None, show: bool = True) -> None:
    """Serve the page of a study on this machine until Ctrl-C.

    Parameters
    ----------
    folder : str or Path
        The study's folder.
    port : int, optional
        Port of the page; default: the first free one from 5006 on.
    show : bool
        Whether to open it in the browser.

    Raises
    ------
    ContactStudyError
        If the extra `explore` is not installed.
    StudyFileError
        If the folder holds no study.
    InvalidInputError
        If the port is taken.
    """
    check_installed()
    checks.instance("folder", folder, (str, Path), "the path of a study's folder")
    place = Path(folder)
    if not (place / "study.json").is_file():
        cases_of(place)  # says what is wrong with it
    chosen = _free_port() if port is None else _checked_port(port)
    # Before the thread that reads the study: the server's packages look in `sys.modules` for a pandas that is complete.
    import pandas  # noqa: F401
    import panel as pn
    from tornado.ioloop import IOLoop

    opening = Opening(place.resolve())
    print(f"http://{HOST}:{chosen} shows the study until Ctrl-C", flush=True)
    IOLoop.current().add_callback(opening.read)
    server = pn.serve(
        {"/": opening.page},
        port=chosen,
        address=HOST,
        websocket_origin=[f"{HOST}:{chosen}", f"127.0.0.1:{chosen}"],
        show=show,
        title=_title(place),
        verbose=False,
    )
    if opening.error is not None:
        server.stop()
        raise opening.error


def _title(place: Path) -> str:
    """Name of the study for the browser's tab; of its folder where the study cannot be read, which is said later."""
    try:
        study = json.loads((place / "study.json").read_text(encoding="utf-8"))
        return f"{study['name']}: {study['description']}" if study.get("description") else str(study["name"])
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return place.resolve().name


def _taken(port: int) -> bool:
    """Whether something listens on a port of this machine."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as tried:
        tried.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # one that was just given back is free
        try:
            tried.bind((HOST, port))
        except OSError:
            return True
    return False


def _free_port() -> int:
    """Return the first free port."""
    for port in range(PORT, PORT + PORTS):
        if not _taken(port):
            return port
    raise InvalidInputError("port", None, f"given: all from {PORT} to {PORT + PORTS - 1} are taken")


def _checked_port(port: object) -> int:
    """Return a port that is free, or raise."""
    wanted = checks.count("port", port)
    if wanted > 65535 or _taken(wanted):
        raise InvalidInputError("port", wanted, "a free port, at most 65535", "leave it out to take the next free one")
    return wanted
