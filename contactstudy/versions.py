"""Versions of the package and of its dependencies, for files and reports."""

from __future__ import annotations

import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version

PACKAGES = ("numpy", "scipy", "xarray", "netCDF4", "pyfftw")  # Packages on which results depend
OPTIONAL_PACKAGES = ("dask", "matplotlib", "pandas", "panel", "clarabel")  # the last two are extras


@cache
def version_of(package: str) -> str:
    """Version of an installed package; "unknown" without one. The result is cached."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "unknown"


@cache
def versions() -> dict[str, str]:
    """Versions of this package, of Python, and of the packages on which results depend."""
    core_versions = {"contactstudy": version_of("contactstudy"), "python": platform.python_version()}
    return core_versions | {package: version_of(package) for package in PACKAGES}


def show_versions() -> None:
    """Print the versions of the package, of Python, of the system and of everything that a result depends on.

    Examples
    --------
    >>> show_versions()  # doctest: +ELLIPSIS
    contactstudy ...
    """
    optional_versions = {name: release for name in OPTIONAL_PACKAGES if (release := version_of(name)) != "unknown"}
    rows = versions() | optional_versions | {"system": platform.platform()}
    width = max(map(len, rows))
    print("\n".join(f"{name:{width}} {release}" for name, release in rows.items()))
