"""Invariants of the stress tensor, and the shear range of a rolling cycle."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy.arrays.variables import AXES, STRESSES, describe, name_array, require
from contactstudy.checks import FloatArray
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
    >>> shear = xr.Dataset(dict.fromkeys(STRESSES, 0.0) | {"tau_xy": 1.0})
    >>> round(float(von_mises(shear)), 6)
    1.732051
    """
    require(stress, *STRESSES, argument="stress")
    return name_array("von_mises", xr.apply_ufunc(von_mises_of, *(stress[name] for name in STRESSES), dask="allowed"))


def von_mises_of(
    xx: FloatArray, yy: FloatArray, zz: FloatArray, xy: FloatArray, xz: FloatArray, yz: FloatArray
) -> FloatArray:
    """Equivalent stress of arrays of components, Pa."""
    squared_stress: FloatArray = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy**2 + xz**2 + yz**2)
    root: FloatArray = squared_stress**0.5
    return root


def principal_stresses(stress: xr.Dataset) -> xr.Dataset:
    """Principal stresses and their directions.

    Parameters
    ----------
    stress : Dataset
        The six components `sigma_xx` ... `tau_yz`, Pa, of any dimensions.

    Returns
    -------
    Dataset
        `principal_stress` (..., principal) in Pa, in descending order along the new dimension `principal` = 1, 2, 3,
        and `principal_direction` (..., principal, axis): unit vectors with the components `axis` = x, y, z. The sign
        of a direction is arbitrary, as are the directions of two equal principal stresses in their plane.

    Raises
    ------
    InvalidInputError
        If a component is missing, or not finite.

    Examples
    --------
    >>> shear = xr.Dataset(dict.fromkeys(STRESSES, 0.0) | {"tau_xy": 1.0})
    >>> principal_stresses(shear).principal_stress.values.round(6).tolist()
    [1.0, 0.0, -1.0]
    """
    require(stress, *STRESSES, argument="stress")
    components = xr.broadcast(*(stress[name] for name in STRESSES))
    xx, yy, zz, xy, xz, yz = (component.values for component in components)
    tensor = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=-1).astype(np.float64)
    if not np.isfinite(tensor).all():
        raise InvalidInputError("stress", "values that are not finite", "finite stresses")
    values, vectors = np.linalg.eigh(tensor.reshape(*tensor.shape[:-1], 3, 3))
    first_component = components[0]
    dims = tuple(first_component.dims)
    # eigh sorts upwards and keeps the vectors in columns.
    result = xr.Dataset(
        {
            "principal_stress": ((*dims, "principal"), values[..., ::-1]),
            "principal_direction": ((*dims, "principal", "axis"), np.swapaxes(vectors[..., ::-1], -1, -2)),
        },
        coords={**first_component.coords, "principal": [1, 2, 3], "axis": list(AXES)},
    )
    return describe(result)


def tresca(stress: xr.Dataset) -> xr.DataArray:
    """Tresca's equivalent stress: the largest principal stress minus the smallest.

    Parameters
    ----------
    stress : Dataset
        The six components as for :func:`von_mises`, finite.

    Returns
    -------
    DataArray
        Pa, with the dimensions of the components.

    Examples
    --------
    >>> shear = xr.Dataset(dict.fromkeys(STRESSES, 0.0) | {"tau_xy": 1.0})
    >>> round(float(tresca(shear)), 6)
    2.0
    """
    principal = principal_stresses(stress)["principal_stress"]
    shear_diameter = principal.sel(principal=1, drop=True) - principal.sel(principal=3, drop=True)
    return name_array("tresca", shear_diameter)


def maximum_shear(stress: xr.Dataset) -> xr.DataArray:
    """Largest shear stress on any plane through the point: half of Tresca's stress.

    Parameters
    ----------
    stress : Dataset
        The six components as for :func:`von_mises`, finite.

    Returns
    -------
    DataArray
        Pa, with the dimensions of the components.

    Examples
    --------
    >>> tension = xr.Dataset(dict.fromkeys(STRESSES, 0.0) | {"sigma_xx": 1.0})
    >>> float(maximum_shear(tension))
    0.5
    """
    return name_array("maximum_shear", 0.5 * tresca(stress))


def hydrostatic(stress: xr.Dataset) -> xr.DataArray:
    """Hydrostatic (mean) stress, a third of the trace, positive in tension.

    Parameters
    ----------
    stress : Dataset
        With `sigma_xx`, `sigma_yy` and `sigma_zz` as for :func:`von_mises`.

    Returns
    -------
    DataArray
        Pa, with the dimensions of the components.

    Examples
    --------
    >>> float(hydrostatic(xr.Dataset({"sigma_xx": -3.0, "sigma_yy": -2.0, "sigma_zz": -1.0})))
    -2.0
    """
    normal_names = STRESSES[:3]
    require(stress, *normal_names, argument="stress")
    xx, yy, zz = (stress[name] for name in normal_names)
    return name_array("hydrostatic", (xx + yy + zz) / 3)


def orthogonal_shear_range(stress: xr.Dataset) -> xr.Dataset:
    """Range of the orthogonal shear stress `tau_yz` of a material point under the rolling contact.

    The field along y at one (x, z) is the history of this material point during one passage. The extremes are
    values at the given positions: choose y close enough together.

    Parameters
    ----------
    stress : Dataset
        With `tau_yz` in Pa and a dimension `y` or `y_field` with coordinates in metres.

    Returns
    -------
    Dataset
        Without the rolling dimension: `orthogonal_shear_range` (Pa), the largest minus the smallest `tau_yz` along
        y; `orthogonal_shear_amplitude` (Pa), half the range, the amplitude of Lundberg and Palmgren's theory; and the
        positions (metres) `y_of_largest_shear` and `y_of_smallest_shear`.

    Raises
    ------
    InvalidInputError
        If `tau_yz` or the rolling dimension with its coordinate is missing, or a value is not finite.

    Examples
    --------
    >>> shear = xr.DataArray([0.0, -0.25, 0.25], coords={"y": [0.0, 0.9, -0.9]}, dims="y")
    >>> cycle = orthogonal_shear_range(xr.Dataset({"tau_yz": shear}))
    >>> float(cycle.orthogonal_shear_range), float(cycle.orthogonal_shear_amplitude), float(cycle.y_of_largest_shear)
    (0.5, 0.25, -0.9)
    """
    require(stress, "tau_yz", argument="stress")
    shear = stress["tau_yz"]
    rolling_dims = [str(dim) for dim in shear.dims if dim in ("y", "y_field")]
    if len(rolling_dims) != 1 or rolling_dims[0] not in shear.coords:
        raise InvalidInputError("stress.dims", shear.dims, "with the rolling direction y or y_field, and its positions")
    rolling_dim = rolling_dims[0]
    if not shear.sizes[rolling_dim] or not np.isfinite(shear.values).all():
        raise InvalidInputError("stress.tau_yz", "empty or not finite", "finite stresses")
    shear_range = shear.max(rolling_dim) - shear.min(rolling_dim)
    values = {
        "orthogonal_shear_range": shear_range,
        "orthogonal_shear_amplitude": 0.5 * shear_range,
        "y_of_largest_shear": shear.idxmax(rolling_dim),
        "y_of_smallest_shear": shear.idxmin(rolling_dim),
    }
    return xr.Dataset({name: name_array(name, value) for name, value in values.items()})
