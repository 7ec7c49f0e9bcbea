"""Page in a notebook, or on a server for this machine only, which reads the study while the browser loads scripts."""

from __future__ import annotations

import contextlib
import hmac
import json
import logging
import secrets
import socket
import sys
from asyncio import wrap_future
from collections.abc import Mapping, Sequence
from concurrent.futures import Future
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from contactstudy import checks
from contactstudy.errors import ContactStudyError, InvalidInputError

if TYPE_CHECKING:
    import xarray as xr

    from contactstudy.explorer.cases import Cases

HOST = "localhost"
LOCAL_HOSTS = frozenset({"localhost", "127.0.0.1", "::1"})  # any port: users forward ports
PORT, PORT_COUNT = 5006, 20  # First port, and number of ports that are tried
SWITCH_INTERVAL = 2e-4  # Seconds, while a thread reads the study and the server answers; Python's default is 5 ms


def explore(study: xr.Dataset | str | Path) -> Any:
    """Return the page of a study for a notebook: the last expression of a cell displays the page.

    Parameters
    ----------
    study : Dataset, str or Path
        An opened study, a result, or the folder of a study, whose cases are read on demand.

    Returns
    -------
    panel.Column
        Choices of swept parameters; pressure along the axis and on the top, stresses in planes, main numbers with
        errors, edge factors, a second case, and any number of all cases over a swept parameter.

    Raises
    ------
    ContactStudyError
        If the extra `explore` is not installed.
    InvalidInputError
        If the argument is no study and no result.

    Examples
    --------
    >>> import xarray as xr
    >>> pressure = xr.DataArray([[1e9, 2e9], [2e9, 1e9]], dims=("x", "y"), coords={"x": [0.0, 1e-3], "y": [0.0, 1e-4]})
    >>> type(explore(xr.Dataset({"pressure": pressure}))).__name__
    'Column'
    """
    _check_installed()
    import panel as pn
    import xarray as xr

    checks.instance("study", study, (xr.Dataset, str, Path), "an opened study, a result, or a study's folder")
    from contactstudy.explorer.cases import open_cases
    from contactstudy.explorer.page import Page

    pn.extension(inline=True)  # the page contains its scripts and loads none from the network
    return Page(open_cases(study)).view()


def _check_installed() -> None:
    """Raise unless the packages of the extra are installed."""
    missing = [name for name in ("panel", "bokeh") if find_spec(name) is None]
    if missing:
        raise ContactStudyError(
            f"the page of a study needs {' and '.join(missing)}, of the extra `explore`: "
            'pip install "contactstudy[explore]"'
        )


class AccessControl:
    """Access to the server: checks hosts, against pages of other sites, and a token, against users of this machine."""

    def __init__(self, port: int, hosts: Sequence[str] = ()) -> None:
        self.token = secrets.token_urlsafe(24)
        self.address = f"http://{HOST}:{port}/?token={self.token}"
        self.cookie = f"contactstudy-{port}"
        self._hosts = LOCAL_HOSTS | {host.lower() for host in hosts}

    def allows_host(self, request: Any) -> bool:
        """Whether the host of a request is allowed, and the request's origin, if any, is the same host."""
        origin = request.headers.get("Origin")
        try:
            return urlsplit(f"//{request.host}").hostname in self._hosts and (
                origin is None or urlsplit(origin).netloc.lower() == request.host.lower()
            )
        except ValueError:  # an invalid address
            return False

    def _is_token(self, text: str) -> bool:
        return hmac.compare_digest(text.encode(), self.token.encode())

    def protect(self, application: Any) -> None:
        """Refuse requests to a Tornado application from another host, or without the token."""
        from tornado.web import ErrorHandler, RequestHandler

        cookie, token, find_handler = self.cookie, self.token, application.find_handler

        class SetCookie(RequestHandler):
            """Set the cookie and reload the page at the address without the token."""

            def get(self) -> None:
                self.set_cookie(cookie, token, httponly=True, samesite="Strict")
                self.redirect("/")

        def find_allowed(request: Any, **arguments: Any) -> Any:
            texts = [text.decode(errors="replace") for text in request.query_arguments.get("token", [])]
            sent_cookie = request.cookies.get(cookie)
            if self.allows_host(request) and request.path == "/" and any(map(self._is_token, texts)):
                return application.get_handler_delegate(request, SetCookie)
            if self.allows_host(request) and sent_cookie is not None and self._is_token(sent_cookie.value):
                return find_handler(request, **arguments)
            return application.get_handler_delegate(request, ErrorHandler, {"status_code": 403})

        application.find_handler = find_allowed


class StudyLoader:
    """Study that a thread reads while browsers load the page's scripts."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._cases: Future[Cases] = Future()
        self.error: Exception | None = None

    async def read(self) -> None:
        """Read the study in a thread; an error stops the server."""
        from tornado.ioloop import IOLoop

        def open_folder() -> Cases:
            import_module("contactstudy.explorer.page")
            from contactstudy.explorer.cases import open_cases

            return open_cases(self._folder)

        loop, switch_interval = IOLoop.current(), sys.getswitchinterval()
        sys.setswitchinterval(SWITCH_INTERVAL)
        try:
            self._cases.set_result(await loop.run_in_executor(None, open_folder))
        except Exception as error:  # `serve` raises it
            self.error = error
            loop.stop()
        finally:
            sys.setswitchinterval(switch_interval)

    def page(self) -> Any:
        """Page of a new visitor: empty until the browser has its scripts and the study is read."""
        import panel as pn

        column = pn.Column(sizing_mode="stretch_width")

        async def fill_column() -> None:
            """Put the study into the page."""
            from contactstudy.explorer.page import Page

            column.objects = [Page(await wrap_future(self._cases)).view()]

        pn.state.onload(fill_column)
        return column


def serve(folder: str | Path, *, port: int | None = None, hosts: Sequence[str] = (), show: bool = True) -> None:
    """Serve the page of a study on this machine until Ctrl-C.

    Parameters
    ----------
    folder : str or Path
        The study's folder.
    port : int, optional
        Port of the page; default: the first free port from 5006 on.
    hosts : sequence of str
        Host names, in addition to localhost, 127.0.0.1 and [::1], that a browser may use, such as the name of a proxy.
    show : bool
        Whether to open the page in the browser.

    Raises
    ------
    ContactStudyError
        If the extra `explore` is not installed.
    StudyFileError
        If the folder holds no study.
    InvalidInputError
        If the port is taken.
    """
    _check_installed()
    checks.instance("folder", folder, (str, Path), "the path of a study's folder")
    path = Path(folder)
    if not (path / "study.json").is_file():
        from contactstudy.explorer.cases import open_cases

        open_cases(path)  # raises the reason
    port = _choose_port(port)
    # Import before the thread reads the study: the server's packages look in `sys.modules` for a complete pandas.
    import pandas  # noqa: F401
    import panel as pn
    from tornado.ioloop import IOLoop

    loader, access = StudyLoader(path.resolve()), AccessControl(port, hosts)
    # Access checks host and origin of every request; Bokeh's own list of origins would need the forwarded ports.
    logging.getLogger("bokeh.server.util").setLevel(logging.ERROR)
    event_loop = IOLoop(make_current=False)
    server = pn.io.server.get_server(
        {"/": loader.page},
        port=port,
        loop=event_loop,
        address=HOST,
        websocket_origin="*",
        location=False,  # Panel's own cannot parse [::1]
        title=_title(path),
    )
    access.protect(server._tornado)
    print(f"{access.address} shows the study until Ctrl-C", flush=True)
    event_loop.add_callback(loader.read)
    if show:
        import webbrowser

        event_loop.add_callback(webbrowser.open, access.address)
    server.start()
    event_loop.start()
    if loader.error is not None:
        server.stop()
        raise loader.error


def _title(path: Path) -> str:
    """Name of the study for the browser's tab; the name of the folder if the study is unreadable."""
    try:
        return study_title(json.loads((path / "study.json").read_text(encoding="utf-8")), path.resolve().name)
    except (OSError, ValueError, TypeError, AttributeError):
        return path.resolve().name


def study_title(study: Mapping[str, Any], name: str) -> str:
    """Return name and description of a study; `name` is the default."""
    title = str(study.get("name", name))
    return f"{title}: {study['description']}" if study.get("description") else title


def _choose_port(port: int | None) -> int:
    """Return the port if it is free; without a port, the first free port; raise if no port is free."""
    for candidate_port in range(PORT, PORT + PORT_COUNT) if port is None else (checks.count("port", port),):
        with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe, contextlib.suppress(OSError, OverflowError):
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # a recently closed port is free
            probe.bind((HOST, candidate_port))
            return candidate_port
    if port is None:
        raise InvalidInputError("port", None, f"given: all from {PORT} to {PORT + PORT_COUNT - 1} are taken")
    raise InvalidInputError("port", port, "a free port, at most 65535", "leave it out to take the next free one")
