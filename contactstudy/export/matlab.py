"""MATLAB files: every variable by name, with units, meaning and dimensions in structs."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.cuts import named_arrays
from contactstudy.arrays.variables import require, variable_of
from contactstudy.errors import InvalidInputError
from contactstudy.export.table import output_path

NAME = re.compile(r"[A-Za-z]\w{0,62}", re.ASCII)  # Valid name in MATLAB
STRUCTS = ("units", "meaning", "dims", "about")  # Names of the structs
MAX_BYTES = 2**31 - 1  # Bytes of an array in the format's version 5


def to_mat(dataset: xr.Dataset, path: str | Path, variables: str | Sequence[str] | None = None) -> Path:
    """Write a result, or the cases of a study, for MATLAB (version 5, which Octave and others read too).

    Parameters
    ----------
    dataset : Dataset
        A result, an opened study, whose variables are read one at a time, or a Dataset of `contactstudy.analysis`.
    path : str or Path
        File to write, ending with ``.mat``.
    variables : str or sequence of str, optional
        Variables or measures, see :func:`contactstudy.analysis.measure`; default: all. Coordinates are added.

    Returns
    -------
    Path
        Every variable and coordinate is an array: numbers unchanged, a single dimension as a column, texts as cells.
        The structs ``units``, ``meaning`` and ``dims`` have a field for each name; ``dims.pressure`` is
        ``{'x', 'y'}``. ``about`` contains the attributes of the Dataset, such as versions and inputs.

    Raises
    ------
    InvalidInputError
        If the path ends otherwise, or a variable is missing, has an invalid name in MATLAB or more than 2 GB.
    StoreError
        If the file cannot be written.

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
    target = output_path(path, ".mat")
    content: dict[str, Any] = {name: {} for name in STRUCTS}
    arrays = named_arrays(dataset, variables)
    for array in list(arrays.values()):
        arrays |= {str(name): coordinate for name, coordinate in array.coords.items()}
    for name, array in arrays.items():
        if not NAME.fullmatch(name) or name in STRUCTS:
            allowed = f"a name of up to 63 letters, digits and _ that begins with a letter, not {', '.join(STRUCTS)}"
            raise InvalidInputError("variables", name, allowed, "rename it")
        if array.nbytes > MAX_BYTES:
            hint = "select a part of it, or read the netCDF file, which MATLAB can"
            raise InvalidInputError("variables", f"{name} of {array.nbytes / 1e9:.1f} GB", "at most 2 GB each", hint)
        values = array.values
        specification = variable_of(name, array.attrs, coordinate=name in dataset.coords)
        content[name] = values if values.dtype.kind in "biuf" else values.astype(str).astype(object)
        content["units"][name] = specification.units
        content["meaning"][name] = specification.long_name
        content["dims"][name] = np.array([str(dim) for dim in array.dims], dtype=object)
    content["about"] = {
        str(name): str(value) for name, value in dataset.attrs.items() if NAME.fullmatch(str(name))
    } or {"source": ""}
    with checks.writing(target) as temporary_path, temporary_path.open("wb") as file:
        savemat(file, content, long_field_names=True, do_compression=True, oned_as="column")
    return target
