"""Names that variables had in files of earlier versions."""

from __future__ import annotations

import xarray as xr

OLD_NAMES = {"load": "normal_load", "shear_traction": "traction_y"}
"""Name of today by the one in old files: `load` is a method of Datasets, and tractions have two directions."""


def with_present_names(dataset: xr.Dataset) -> xr.Dataset:
    """Give the variables of a file that an earlier version wrote the names of today.

    Examples
    --------
    >>> list(with_present_names(xr.Dataset({"pressure": 1.0, "load": 2.0})).data_vars)
    ['pressure', 'normal_load']
    """
    present = dataset.data_vars
    return dataset.rename({old: new for old, new in OLD_NAMES.items() if old in present and new not in present})
