"""MATLAB's files: every variable under its own name, and what it is in structs beside it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import measure
from contactstudy.arrays.required import require
from contactstudy.arrays.variables import variable_of
from contactstudy.checks import Array
from contactstudy.errors import InvalidInputError

SUFFIX = ".mat"

NAME = re.compile(r"[A-Za-z]\w{0,62}", re.ASCII)
"""A name that MATLAB takes."""

STRUCTS = ("units", "meaning", "dims", "about")
"""Names in the file that are none of the Dataset's."""

LARGEST = 2**31 - 1
"""Bytes of an array in the format's version 5."""


def to_mat(dataset: xr.Dataset, path: str | Path, variables: str | Sequence[str] | None = None) -> Path:
    """Write a result, or the cases of a study, for MATLAB (version 5, which Octave and others read too).

    Parameters
    ----------
    dataset : Dataset
        A result, an opened study, or anything that :mod:`contactstudy.analysis` returns. Of a study all cases are
        written, along its dimensions; what lies on the disk is read one variable at a time.
    path : str or Path
        File to write, ending with ``.mat``.
    variables : str or sequence of str, optional
        Variables or measures, see :func:`contactstudy.analysis.measure`; default: all. Coordinates come along.

    Returns
    -------
    Path
        The file. It holds every variable and coordinate as an array under its own name: numbers as they are, a single
        dimension as a column, texts as cells. The structs ``units``, ``meaning`` and ``dims`` have a field of each
        name; ``dims.pressure`` is ``{'x', 'y'}``, the order of the array's dimensions. ``about`` holds the attributes
        of the Dataset, such as versions and inputs.

    Raises
    ------
    InvalidInputError
        If the path ends otherwise, a variable is missing, has a name that MATLAB does not take or is larger than the
        format allows, or the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from scipy.io import loadmat
    >>> pressure = xr.DataArray([1.0, 2.0], dims="x", coords={"x": [0.0, 1e-3]}, attrs={"units": "Pa"})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     read = loadmat(to_mat(xr.Dataset({"pressure": pressure}), Path(folder) / "line.mat"))
    >>> read["pressure"].tolist(), read["units"]["pressure"].item().item()
    ([[1.0], [2.0]], 'Pa')
    """
    from scipy.io import savemat

    require(dataset)
    checks.instance("path", path, (str, Path), "a path")
    target = Path(path)
    if target.suffix != SUFFIX:
        raise InvalidInputError("path", str(path), f"a file name that ends with {SUFFIX}")
    content: dict[str, Any] = {name: {} for name in STRUCTS}
    for name, array in _chosen(dataset, variables).items():
        said = variable_of(name, array.attrs, coordinate=name in dataset.coords)
        content[name] = _values(name, array)
        content["units"][name] = said.units
        content["meaning"][name] = said.long_name
        content["dims"][name] = np.array([str(dim) for dim in array.dims], dtype=object)
    content["about"] = {
        str(name): str(value) for name, value in dataset.attrs.items() if NAME.fullmatch(str(name))
    } or {"source": ""}
    with checks.writing(target), target.open("wb") as file:
        savemat(file, content, long_field_names=True, do_compression=True, oned_as="column")
    return target


def _chosen(dataset: xr.Dataset, variables: str | Sequence[str] | None) -> dict[str, xr.DataArray]:
    """Return what is to be written, by name, the coordinates last."""
    if variables is None:
        found = {str(name): array for name, array in dataset.data_vars.items()}
    else:
        names = [variables] if isinstance(variables, str) else list(variables)
        found = {name: measure(dataset, name) for name in names}
    for array in list(found.values()):
        found |= {str(name): coordinate for name, coordinate in array.coords.items()}
    for name in found:
        if not NAME.fullmatch(name) or name in STRUCTS:
            allowed = f"a name of up to 63 letters, digits and _ that begins with a letter, not {', '.join(STRUCTS)}"
            raise InvalidInputError("variables", name, allowed, "rename it")
    return found


def _values(name: str, array: xr.DataArray) -> Array:
    """Return the values as MATLAB holds them: numbers, or a cell for each text."""
    if array.nbytes > LARGEST:
        hint = "select a part of it, or read the netCDF file, which MATLAB can"
        raise InvalidInputError("variables", f"{name} of {array.nbytes / 1e9:.1f} GB", "at most 2 GB each", hint)
    values = array.values
    return values if values.dtype.kind in "biuf" else values.astype(str).astype(object)
