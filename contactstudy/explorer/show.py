"""The page in a notebook, and on a server of this machine alone."""

from __future__ import annotations

import logging
import socket
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import xarray as xr

from contactstudy import checks
from contactstudy.errors import ContactStudyError, InvalidInputError

LOGGER = logging.getLogger(__name__)

HOST = "localhost"
"""Nobody else can open the page: a study's folder is nobody else's business."""

PORT, PORTS = 5006, 20
"""First port that is tried, and how many."""


def check_installed() -> None:
    """Raise unless the packages of the extra are installed, and say how to install them."""
    missing = [name for name in ("panel", "bokeh") if find_spec(name) is None]
    if missing:
        raise ContactStudyError(
            f"the page to explore a study needs {' and '.join(missing)}, which the extra `explore` brings: "
            'pip install "contactstudy[explore]"'
        )


def explore(study: xr.Dataset | str | Path) -> Any:
    """Page to look through a study, for a notebook: the last expression of a cell shows it.

    Parameters
    ----------
    study : Dataset, str or Path
        An opened study, or a result; or the folder of a study, of which each case is read when it is looked at.

    Returns
    -------
    panel.Column
        Choices for what was swept; pressure along the axis and on the top, von Mises stress in planes, main numbers
        with errors, edge factors, two cases side by side, and any number of all cases over a swept parameter.

    Raises
    ------
    ContactStudyError
        If the extra `explore` is not installed.
    InvalidInputError
        If there is no study or result.

    Examples
    --------
    >>> pressure = xr.DataArray([[1e9, 2e9], [2e9, 1e9]], dims=("x", "y"), coords={"x": [0.0, 1e-3], "y": [0.0, 1e-4]})
    >>> page = explore(xr.Dataset({"pressure": pressure}))
    >>> type(page).__name__
    'Column'
    """
    check_installed()
    import panel as pn

    from contactstudy.explorer.page import Page

    pn.extension(inline=True)  # the scripts are in the notebook, none is fetched
    return Page(_cases(study)).view()


def _cases(study: xr.Dataset | str | Path) -> Any:
    """Return the cases of a study, or of its folder."""
    from contactstudy.explorer.cases import of_dataset, of_folder

    if isinstance(study, xr.Dataset):
        return of_dataset(study)
    checks.instance("study", study, (str, Path), "an opened study, a result, or a study's folder")
    return of_folder(study)


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
    cases = _cases(folder)
    chosen = _free_port() if port is None else _checked_port(port)
    import panel as pn

    from contactstudy.explorer.page import Page

    def page() -> Any:
        return Page(cases).view()

    print(f"http://{HOST}:{chosen} shows the study until Ctrl-C", flush=True)
    pn.serve(
        {"/": page},
        port=chosen,
        address=HOST,
        websocket_origin=[f"{HOST}:{chosen}", f"127.0.0.1:{chosen}"],
        show=show,
        title=cases.title,
        verbose=False,
    )


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
