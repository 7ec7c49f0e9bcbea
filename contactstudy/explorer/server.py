"""Page in a notebook, or on a server for this machine only, which reads the study while the browser loads scripts."""

from __future__ import annotations

import contextlib
import hmac
import logging
import secrets
import socket
from asyncio import wrap_future
from collections.abc import Sequence, Set
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


def restrict_access(application: Any, port: int, hosts: Sequence[str]) -> str:
    """Refuse requests to a Tornado application from another host, or without a token; return the address with it.

    The host protects against pages of other sites, the token against users of this machine.
    """
    from tornado.web import ErrorHandler, RequestHandler

    token, cookie, find_handler = secrets.token_urlsafe(24), f"contactstudy-{port}", application.find_handler
    allowed_hosts = LOCAL_HOSTS | {host.lower() for host in hosts}

    class CookieHandler(RequestHandler):
        """Set the cookie and reload the page at the address without the token."""

        def get(self) -> None:
            self.set_cookie(cookie, token, httponly=True, samesite="Strict")
            self.redirect("/")

    def is_token(text: str) -> bool:
        return hmac.compare_digest(text.encode(), token.encode())

    def find_allowed_handler(request: Any, **arguments: Any) -> Any:
        if _has_allowed_host(request, allowed_hosts):
            texts = [text.decode(errors="replace") for text in request.query_arguments.get("token", [])]
            if request.path == "/" and any(map(is_token, texts)):
                return application.get_handler_delegate(request, CookieHandler)
            if cookie in request.cookies and is_token(request.cookies[cookie].value):
                return find_handler(request, **arguments)
        return application.get_handler_delegate(request, ErrorHandler, {"status_code": 403})

    application.find_handler = find_allowed_handler
    return f"http://{HOST}:{port}/?token={token}"


def _has_allowed_host(request: Any, hosts: Set[str]) -> bool:
    """Whether the host of a request is among `hosts`, and the request's origin, if any, is the same host."""
    origin = request.headers.get("Origin")
    try:
        return urlsplit(f"//{request.host}").hostname in hosts and (
            origin is None or urlsplit(origin).netloc.lower() == request.host.lower()
        )
    except ValueError:  # an invalid address
        return False


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

    # Access checks host and origin of every request; Bokeh's own list of origins would need the forwarded ports.
    logging.getLogger("bokeh.server.util").setLevel(logging.ERROR)
    event_loop = IOLoop(make_current=False)
    cases: Future[Cases] = Future()

    def open_page() -> Any:
        """Page of a new visitor: empty until the browser has its scripts and the study is read."""
        column = pn.Column(sizing_mode="stretch_width")

        async def fill_column() -> None:
            from contactstudy.explorer.page import Page

            column.objects = [Page(await wrap_future(cases)).view()]

        pn.state.onload(fill_column)
        return column

    def read_study() -> None:
        """Read the study; an error stops the server."""
        try:
            import_module("contactstudy.explorer.page")
            from contactstudy.explorer.cases import open_cases

            cases.set_result(open_cases(path.resolve()))
        except Exception as error:
            cases.set_exception(error)
            event_loop.add_callback(event_loop.stop)

    server = pn.io.server.get_server(
        {"/": open_page},
        port=port,
        loop=event_loop,
        address=HOST,
        websocket_origin="*",
        location=False,  # Panel's own cannot parse [::1]
        title=_title(path),
    )
    address = restrict_access(server._tornado, port, hosts)
    print(f"{address} shows the study until Ctrl-C", flush=True)
    event_loop.add_callback(event_loop.run_in_executor, None, read_study)
    if show:
        import webbrowser

        event_loop.add_callback(webbrowser.open, address)
    server.start()
    event_loop.start()
    if cases.done():
        server.stop()
        cases.result()  # raises the reason


def _title(path: Path) -> str:
    """Name of the study for the browser's tab; the name of the folder if the study is unreadable."""
    from contactstudy.analysis.provenance import study_title

    try:
        return study_title(checks.read_tables(path / "study.json"), path.resolve().name)
    except (OSError, ValueError, TypeError, AttributeError):
        return path.resolve().name


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
