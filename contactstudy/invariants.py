"""Invariants of the stress tensor."""

from __future__ import annotations

import xarray as xr

from contactstudy.dataset import STRESSES, VARIABLES
from contactstudy.errors import InvalidInputError


def von_mises(stress: xr.Dataset) -> xr.DataArray:
    """Von Mises equivalent stress.

    Parameters
    ----------
    stress : Dataset
        The six components `sigma_xx` ... `tau_yz`, Pa, of any dimensions.

    Returns
    -------
    DataArray
        Pa, with the dimensions of the components.

    Raises
    ------
    InvalidInputError
        If a component is missing.

    Examples
    --------
    >>> zero = xr.DataArray(0.0)
    >>> shear = xr.Dataset({name: zero for name in STRESSES} | {"tau_xy": zero + 1.0})
    >>> round(float(von_mises(shear)), 6)
    1.732051
    """
    missing = [name for name in STRESSES if name not in stress]
    if missing:
        raise InvalidInputError("stress", sorted(map(str, stress.data_vars)), f"a Dataset with {', '.join(missing)}")
    xx, yy, zz, xy, xz, yz = (stress[name] for name in STRESSES)
    squared = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy**2 + xz**2 + yz**2)
    result: xr.DataArray = (squared**0.5).rename("von_mises")
    result.attrs = {"units": "Pa", "long_name": VARIABLES["von_mises"].long_name}
    return result
