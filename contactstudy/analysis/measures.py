"""Stress measures by name: what a result holds already, or what follows from its six stress components."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.invariants import hydrostatic, maximum_shear, orthogonal_shear_range, tresca, von_mises
from contactstudy.arrays.required import require
from contactstudy.arrays.units import required_in_si
from contactstudy.arrays.variables import STRESSES
from contactstudy.errors import InvalidInputError

MEASURES: dict[str, tuple[tuple[str, ...], Callable[[xr.Dataset], xr.DataArray]]] = {
    "von_mises": (STRESSES, von_mises),
    "tresca": (STRESSES, tresca),
    "maximum_shear": (STRESSES, maximum_shear),
    "hydrostatic": (STRESSES[:3], hydrostatic),
    "orthogonal_shear_range": (("tau_yz",), lambda stress: orthogonal_shear_range(stress)["orthogonal_shear_range"]),
    "orthogonal_shear_amplitude": (
        ("tau_yz",),
        lambda stress: orthogonal_shear_range(stress)["orthogonal_shear_amplitude"],
    ),
}
"""Measures that can be computed: the components that each needs, and its function."""


def measure(dataset: xr.Dataset, name: str) -> xr.DataArray:
    """Return a variable of a result, or compute a stress measure from its components.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve` or of :func:`contactstudy.open_study`.
    name : str
        A variable of the Dataset; or `von_mises`, `tresca`, `maximum_shear`, `hydrostatic`,
        `orthogonal_shear_range`, `orthogonal_shear_amplitude`.

    Returns
    -------
    DataArray
        NaN where a study is padded.

    Raises
    ------
    InvalidInputError
        If there is neither such a variable nor such a measure, or a component is missing.

    Examples
    --------
    >>> shear = xr.Dataset({name: ("z", [0.0]) for name in STRESSES} | {"tau_xy": ("z", [2.0])}, {"z": [0.0]})
    >>> measure(shear, "maximum_shear").values.round(6).tolist()
    [2.0]
    """
    require(dataset)
    checks.instance("variable", name, str, "a name")
    if name in dataset.data_vars:
        return dataset[name]
    checks.known_name("variable", name, {*map(str, dataset.data_vars), *MEASURES})
    components, function = MEASURES[name]
    stress = required_in_si(dataset, *components, normalized=True)[list(components)]
    padded = xr.apply_ufunc(np.isnan, stress[components[0]], dask="allowed").compute()
    if not padded.any():
        return function(stress)
    if padded.all():
        raise InvalidInputError(name, "nan everywhere", "a field with at least one number")
    value = function(stress.fillna(0.0))
    absent = padded.all([dim for dim in padded.dims if dim not in value.dims])
    return value.where(~absent).assign_attrs(value.attrs)
