"""Findley's criterion: the plane on which shear amplitude and largest normal stress together are worst.

Source: W. N. Findley, A theory for the effect of mean stress on fatigue of metals under combined torsion and axial
load or bending, Journal of Engineering for Industry 81 (1959) 301-306; the constants from two fully reversed limits as
in the manuals of PragTic (Findley method) and COMSOL (Findley criterion).
"""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.variables import AXES, VARIABLES, describe
from contactstudy.checks import Array
from contactstudy.fatigue.history import of_points, over_history
from contactstudy.fatigue.limits import FatigueLimits

NORMALS, DIRECTIONS = 200, 8
"""Planes of the first search, evenly over a hemisphere (10 degrees apart), and shear directions in each. Accuracy."""

STARTS = 4
"""Best frames of the first search that are refined. Accuracy."""

FIRST_TURN, LAST_TURN = np.radians(8.0), np.radians(1e-3)
"""Largest and smallest rotation of plane and direction in the refinement. Accuracy."""

ROUNDING = 1e-11
"""Gain, over the largest stress, below which a plane is no worse than another. Accuracy."""

BLOCK = 2**24
"""Numbers held at once in the first search. Speed."""


@cache
def _frames() -> Array:
    """Frames (number, 2, 3): a normal and a shear direction in its plane."""
    number = np.arange(NORMALS) + 0.5
    height = 1 - number / NORMALS
    azimuth = np.pi * (1 + np.sqrt(5)) * number
    radius = np.sqrt(1 - height**2)
    normal = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), height], axis=-1)
    aside = np.cross(normal, np.where(np.abs(normal[:, :1]) < 0.7, [[1.0, 0, 0]], [[0, 1.0, 0]]))
    aside /= np.linalg.norm(aside, axis=-1, keepdims=True)
    upwards = np.cross(normal, aside)
    angle = np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    direction = (
        aside[:, None] * np.cos(angle)[None, :, None] + upwards[:, None] * np.sin(angle)[None, :, None]
    ).reshape(-1, 3)
    return np.stack([np.repeat(normal, DIRECTIONS, axis=0), direction], axis=1)


def _resolvers(frames: Array) -> tuple[Array, Array]:
    """Vectors (..., 6) that give shear ``n.sigma.m`` and normal stress ``n.sigma.n`` of the six components."""
    normal, direction = frames[..., 0, :], frames[..., 1, :]

    def resolver(first: Array, second: Array) -> Array:
        (ax, ay, az), (bx, by, bz) = np.moveaxis(first, -1, 0), np.moveaxis(second, -1, 0)
        mixed = (ax * by + ay * bx, ax * bz + az * bx, ay * bz + az * by)
        return np.stack([ax * bx, ay * by, az * bz, *mixed], axis=-1)

    # Off the diagonal, n.sigma.n counts each component twice; the resolver does so already.
    return resolver(normal, direction), resolver(normal, normal)


def _damage(history: Array, frames: Array, slope: float) -> tuple[Array, Array, Array]:
    """Sum, shear amplitude and largest normal stress on one frame per point and candidate (point, candidate)."""
    shear_of, normal_of = _resolvers(frames)
    shear = np.einsum("ptc,pkc->pkt", history, shear_of)
    largest = np.einsum("ptc,pkc->pkt", history, normal_of).max(axis=-1)
    amplitude = 0.5 * (shear.max(axis=-1) - shear.min(axis=-1))
    return amplitude + slope * largest, amplitude, largest


def _search(history: Array, slope: float) -> Array:
    """Best frames (point, start, 2, 3) among those of the first search."""
    frames = _frames()
    shear_of, normal_of = _resolvers(frames)
    normal_of = normal_of[::DIRECTIONS]
    best = np.empty((len(history), STARTS, 2, 3))
    block = max(1, BLOCK // (history.shape[1] * len(frames)))
    for start in range(0, len(history), block):
        part = history[start : start + block]
        shear = part @ shear_of.T
        amplitude = 0.5 * (shear.max(axis=1) - shear.min(axis=1))
        largest = np.repeat((part @ normal_of.T).max(axis=1), DIRECTIONS, axis=1)
        damage = amplitude + slope * largest
        best[start : start + block] = frames[np.argpartition(damage, -STARTS, axis=1)[:, -STARTS:]]
    return best


def _turned(frames: Array, turn: Array) -> Array:
    """Frames (frame, candidate, 2, 3): as they are, and turned by `turn` about 14 axes around each."""
    from scipy.spatial.transform import Rotation

    corners = np.array(list(product((-1.0, 1.0), repeat=3))) / np.sqrt(3)
    axes = np.concatenate([np.eye(3), -np.eye(3), corners])
    vectors = turn[:, None, None] * np.concatenate([np.zeros((1, 3)), axes])
    turns = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_matrix().reshape(len(frames), -1, 3, 3)
    return np.asarray(np.einsum("fkij,fnj->fkni", turns, frames))


def _worst_planes(history: Array, slope: float) -> tuple[Array, ...]:
    """Sum, shear amplitude, largest normal stress and normal of the worst plane of each history."""
    frames = _search(history, slope).reshape(-1, 2, 3)
    owner = np.repeat(np.arange(len(history)), STARTS)
    turn = np.full(len(frames), FIRST_TURN)
    active = np.arange(len(frames))
    # Gains of rounding errors are none: where all planes are alike the search would wander for ever.
    least = ROUNDING * np.abs(history).max(axis=(1, 2))
    while active.size:
        candidates = _turned(frames[active], turn[active])
        damage, _, _ = _damage(history[owner[active]], candidates, slope)
        best = np.where(damage.max(axis=1) > damage[:, 0] + least[owner[active]], damage.argmax(axis=1), 0)
        frames[active] = candidates[np.arange(active.size), best]
        turn[active[best == 0]] *= 0.5
        active = active[turn[active] > LAST_TURN]
    refined = frames.reshape(-1, STARTS, 2, 3)
    found = _damage(history, refined, slope)
    worst = found[0].argmax(axis=1)[:, None]
    normal = np.take_along_axis(refined[:, :, 0], worst[..., None], axis=1)[:, 0]
    normal = normal * np.where(normal[:, 2] < 0, -1.0, 1.0)[:, None]
    return (*(np.take_along_axis(values, worst, axis=1)[:, 0] for values in found), normal)


def findley(stress: xr.Dataset, limits: FatigueLimits) -> xr.Dataset:
    """Findley's criterion ``max over planes of tau_a + k sigma_n,max <= f`` for every material point.

    On a plane, ``tau_a`` is half of the largest range of the shear stress resolved in one direction during the history,
    and ``sigma_n,max`` the largest normal stress, positive in tension, and not below zero since the point is unloaded
    before and after. The worst planes are searched over a hemisphere in steps of about 10 degrees, and turned until no
    rotation by 0.001 degrees makes it worse. ``k`` and ``f`` follow from the limits.

    Parameters
    ----------
    stress : Dataset
        As for :func:`contactstudy.fatigue.dang_van`.
    limits : FatigueLimits
        Of the material.

    Returns
    -------
    Dataset
        Without the rolling direction: `findley` (Pa), the sum on the worst plane; `utilisation` (1), that over ``f``;
        `findley_shear` and `findley_normal` (Pa), ``tau_a`` and ``sigma_n,max`` there; `findley_plane` (..., axis),
        its unit normal with the components `axis` = x, y, z, turned towards larger depth. A `comment` says that they
        have no error.

    Raises
    ------
    InvalidInputError
        If a component or the rolling direction is missing, or the limits are none.

    Examples
    --------
    A cycle of pure shear at the limit in torsion: on the limit.

    >>> from contactstudy.arrays.variables import STRESSES
    >>> wave = xr.DataArray([0.0, 1.0, 0.0, -1.0], dims="y", coords={"y": [0.0, 1.0, 2.0, 3.0]})
    >>> shear = xr.Dataset({name: 0 * wave for name in STRESSES} | {"tau_yz": wave})
    >>> round(float(findley(shear, FatigueLimits(bending=1.6, torsion=1.0)).utilisation), 9)
    1.0
    """
    checks.instance("limits", limits, FatigueLimits, "a FatigueLimits")
    total, shear, normal, plane = over_history(
        lambda history: _worst_planes(history, limits.findley_slope), stress, (None, None, None, ("axis", 3))
    )
    values = {
        "findley": total,
        "utilisation": total / limits.findley_limit,
        "findley_shear": shear,
        "findley_normal": normal,
        "findley_plane": plane,
    }
    result = xr.Dataset({name: of_points(name, value, VARIABLES["findley"]) for name, value in values.items()})
    return describe(result.assign_coords(axis=list(AXES)))
