"""The page in a notebook."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contactstudy import checks
from contactstudy.errors import ContactStudyError

if TYPE_CHECKING:
    import xarray as xr  # takes long to import: a server listens before

    from contactstudy.explorer.cases import Cases


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
    >>> import xarray as xr
    >>> pressure = xr.DataArray([[1e9, 2e9], [2e9, 1e9]], dims=("x", "y"), coords={"x": [0.0, 1e-3], "y": [0.0, 1e-4]})
    >>> page = explore(xr.Dataset({"pressure": pressure}))
    >>> type(page).__name__
    'Column'
    """
    check_installed()
    import panel as pn

    from contactstudy.explorer.page import Page

    pn.extension(inline=True)  # the scripts are in the notebook, none is fetched
    return Page(cases_of(study)).view()


def cases_of(study: xr.Dataset | str | Path) -> Cases:
    """Return the cases of a study, or of its folder."""
    import xarray as xr

    from contactstudy.explorer.cases import of_dataset, of_folder

    if isinstance(study, xr.Dataset):
        return of_dataset(study)
    checks.instance("study", study, (str, Path), "an opened study, a result, or a study's folder")
    return of_folder(study)
