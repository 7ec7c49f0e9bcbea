"""Versions of the package and of what it stands on, for files, reports and questions about a number."""

from __future__ import annotations

import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version

PACKAGES = ("numpy", "scipy", "xarray", "netCDF4", "pyfftw")
"""What a number depends on."""

OTHERS = ("dask", "matplotlib", "pandas", "panel", "clarabel")
"""What is worth knowing besides; the last two come with the extras `explore` and `shakedown`."""


@cache
def version_of(package: str) -> str:
    """Version of an installed package; "unknown" if there is none. It is looked up once: a study asks for each case.

    Examples
    --------
    >>> version_of("no-such-package")
    'unknown'
    """
    try:
        return version(package)
    except PackageNotFoundError:
        return "unknown"


@cache
def versions() -> dict[str, str]:
    """Versions of this package, of Python, and of the packages that a number depends on.

    Examples
    --------
    >>> list(versions())[:3]
    ['contactstudy', 'python', 'numpy']
    """
    own = {"contactstudy": version_of("contactstudy"), "python": platform.python_version()}
    return own | {package: version_of(package) for package in PACKAGES}


def show_versions() -> None:
    """Print the versions of the package, of Python, of the system and of everything that a result depends on.

    Examples
    --------
    >>> show_versions()  # doctest: +ELLIPSIS
    contactstudy ...
    """
    others = {name: found for name in OTHERS if (found := version_of(name)) != "unknown"}
    rows = versions() | others | {"system": platform.platform()}
    width = max(map(len, rows))
    print("\n".join(f"{name:{width}} {found}" for name, found in rows.items()))
