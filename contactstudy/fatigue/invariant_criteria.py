"""Dang Van's and Crossland's criteria: a shear measure of the whole history, and the hydrostatic stress.

Sources: K. Dang Van, G. Cailletaud, J. F. Flavenot, A. Le Douaron, H. P. Lieurade, Criterion for high cycle fatigue
failure under multiaxial loading, in: Biaxial and Multiaxial Fatigue, EGF 3 (1989) 459-478; B. Crossland, Effect of
large hydrostatic pressures on the torsional fatigue strength of an alloy steel, Proc. Int. Conf. on Fatigue of Metals,
IMechE (1956) 138-149; amplitude as the radius of the smallest hypersphere: I. V. Papadopoulos et al., A comparative
study of multiaxial high-cycle fatigue criteria for metals, International Journal of Fatigue 19 (1997) 219-235.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import positions
from contactstudy.arrays.variables import VARIABLES
from contactstudy.checks import Array
from contactstudy.fatigue.enclosing_ball import enclosing_balls
from contactstudy.fatigue.history import histories, of_points, over_history
from contactstudy.fatigue.limits import FatigueLimits


def _deviators(history: Array) -> tuple[Array, Array]:
    """Deviators (point, instant, 5) in axes where their length is the tensor's, and hydrostatic stresses."""
    xx, yy, zz, xy, xz, yz = np.moveaxis(history, -1, 0)
    mean = (xx + yy + zz) / 3
    root = np.sqrt(2.0)
    # Ilyushin's axes: the sum of the squares is s:s.
    vector = [np.sqrt(1.5) * (xx - mean), (yy - zz) / root, root * xy, root * xz, root * yz]
    return np.stack(vector, axis=-1), mean


def _largest_shear(deviator: Array) -> Array:
    """Half of Tresca's stress of deviators in Ilyushin's axes."""
    first, difference, xy, xz, yz = np.moveaxis(deviator, -1, 0)
    root = np.sqrt(2.0)
    xx = first / np.sqrt(1.5)
    yy, zz = 0.5 * (-xx + root * difference), 0.5 * (-xx - root * difference)
    rows = [np.stack(row, axis=-1) for row in ((xx, xy / root, xz / root), (xy / root, yy, yz / root))]
    rows.append(np.stack((xz / root, yz / root, zz), axis=-1))
    principal = np.linalg.eigvalsh(np.stack(rows, axis=-2))
    return np.asarray(0.5 * (principal[..., 2] - principal[..., 0]))


def _labelled(criterion: str, values: dict[str, xr.DataArray]) -> xr.Dataset:
    """Results of a criterion with their names and units; the utilisation is that of its sum."""
    return xr.Dataset({name: of_points(name, array, VARIABLES[criterion]) for name, array in values.items()})


def dang_van(stress: xr.Dataset, limits: FatigueLimits) -> xr.Dataset:
    """Dang Van's criterion ``max over time of tau(t) + alpha sigma_h(t) <= tau_w`` for every material point.

    ``tau(t)`` is half of Tresca's stress of the deviator less the centre of the smallest hypersphere around its
    history (the grains shake down elastically to that centre), ``sigma_h`` the hydrostatic stress, positive in
    tension, ``alpha = 3 (tau_w / sigma_w - 1/2)``. The history is the field along y, and the unloaded state.

    Parameters
    ----------
    stress : Dataset
        The six components with the rolling direction y over the whole passage, see
        :func:`contactstudy.fatigue.window_remainder`; residual stresses may be added to them beforehand.
    limits : FatigueLimits
        Of the material.

    Returns
    -------
    Dataset
        Without the rolling direction: `dang_van` (Pa), the largest of the sum; `utilisation` (1), that over
        ``tau_w``; `dang_van_shear` and `dang_van_hydrostatic` (Pa), both terms at that instant, and `dang_van_y` (m),
        where that is (NaN for the unloaded state). A `comment` says that they have no error.

    Raises
    ------
    InvalidInputError
        If a component or the rolling direction is missing, or the limits are none.

    Examples
    --------
    A cycle of pure shear of amplitude 1: the criterion is the amplitude.

    >>> from contactstudy.arrays.variables import STRESSES
    >>> wave = xr.DataArray([0.0, 1.0, 0.0, -1.0], dims="y", coords={"y": [0.0, 1.0, 2.0, 3.0]})
    >>> shear = xr.Dataset({name: 0 * wave for name in STRESSES} | {"tau_yz": wave})
    >>> result = dang_van(shear, FatigueLimits(bending=1.8, torsion=1.0))
    >>> round(float(result.dang_van), 9), round(float(result.utilisation), 9)
    (1.0, 1.0)
    """
    checks.instance("limits", limits, FatigueLimits, "a FatigueLimits")
    tensor, rolling = histories(stress)

    def criterion(history: Array) -> tuple[Array, ...]:
        deviator, mean = _deviators(history)
        centre, _ = enclosing_balls(deviator)
        shear = _largest_shear(deviator - centre[:, None])
        total = shear + limits.dang_van_slope * mean
        at = total.argmax(axis=1)[:, None]
        chosen = [np.take_along_axis(values, at, axis=1)[:, 0] for values in (total, shear, mean)]
        return (*chosen, at[:, 0].astype(np.float64))

    total, shear, mean, instant = over_history(criterion, stress, (None,) * 4)
    values = {
        "dang_van": total,
        "utilisation": total / limits.torsion,
        "dang_van_shear": shear,
        "dang_van_hydrostatic": mean,
        "dang_van_y": _position(tensor, rolling, instant),
    }
    return _labelled("dang_van", values)


def _position(tensor: xr.DataArray, rolling: str, instant: xr.DataArray) -> xr.DataArray:
    """Position along the rolling direction of the instants with these numbers; NaN for the unloaded state."""
    instant = instant.compute()
    loaded = instant < tensor.sizes[rolling]
    number = instant.where(loaded, 0).astype(np.int64).reset_coords(drop=True)
    return positions(tensor, "y").isel({rolling: number}).where(loaded)


def crossland(stress: xr.Dataset, limits: FatigueLimits) -> xr.Dataset:
    """Crossland's criterion ``sqrt(J2,a) + A sigma_h,max <= tau_w`` for every material point.

    ``sqrt(J2,a)`` is the radius of the smallest hypersphere around the history of the deviator, over sqrt(2);
    ``sigma_h,max`` the largest hydrostatic stress of the history, positive in tension, and not below zero since the
    point is unloaded before and after; ``A = 3 tau_w / sigma_w - sqrt(3)``.

    Parameters
    ----------
    stress : Dataset
        As for :func:`dang_van`.
    limits : FatigueLimits
        Of the material, with a torsion limit of at least the bending limit over sqrt(3).

    Returns
    -------
    Dataset
        Without the rolling direction: `crossland` (Pa), the sum; `utilisation` (1), that over ``tau_w``;
        `crossland_shear` and `crossland_hydrostatic` (Pa), the two terms without the factor. A `comment` says that they
        have no error.

    Raises
    ------
    InvalidInputError
        If a component or the rolling direction is missing, or the limits do not suit.

    Examples
    --------
    A push-pull cycle at the limit in bending: on the limit.

    >>> from contactstudy.arrays.variables import STRESSES
    >>> wave = xr.DataArray([0.0, 1.0, 0.0, -1.0], dims="y", coords={"y": [0.0, 1.0, 2.0, 3.0]})
    >>> tension = xr.Dataset({name: 0 * wave for name in STRESSES} | {"sigma_xx": wave})
    >>> round(float(crossland(tension, FatigueLimits(bending=1.0, torsion=0.65)).utilisation), 9)
    1.0
    """
    checks.instance("limits", limits, FatigueLimits, "a FatigueLimits")
    slope = limits.crossland_slope

    def criterion(history: Array) -> tuple[Array, ...]:
        deviator, mean = _deviators(history)
        _, radius = enclosing_balls(deviator)
        return radius / np.sqrt(2.0), mean.max(axis=1)

    shear, mean = over_history(criterion, stress, (None, None))
    total = shear + slope * mean
    values = {
        "crossland": total,
        "utilisation": total / limits.torsion,
        "crossland_shear": shear,
        "crossland_hydrostatic": mean,
    }
    return _labelled("crossland", values)
