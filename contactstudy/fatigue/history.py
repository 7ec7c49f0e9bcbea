"""Stress histories of material points that pass the contact, and the smallest ball around a history.

At most one point more than the dimensions supports the ball. The farthest point outside joins the support, and the
smallest ball around it is one of the circumscribed balls of its subsets, until all points are inside: exact (E. Welzl,
LNCS 555 (1991) 359-370, and of B. Gaertner, Fast and robust smallest enclosing balls, ESA 1999).
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import numpy as np
import xarray as xr

from contactstudy.analysis import dimension_along
from contactstudy.analysis.axes import reduce_dims
from contactstudy.arrays.variables import ERROR_KIND, NOT_ESTIMATED, STRESSES, Variable, name_array, require_in_si
from contactstudy.checks import Array
from contactstudy.errors import InvalidInputError

OF_POINTS = "of the stresses at the given points"  # Comment of values from histories
FEWEST_POSITIONS = 3  # Along y, for a history
COMPONENT = "stress_component"  # Dimension of the six components while a history is worked on


def histories(stress: xr.Dataset) -> tuple[xr.DataArray, str]:
    """Six stress components with the rolling direction and the component last, and the name of the former."""
    stress = require_in_si(stress, *STRESSES, argument="stress")
    rolling = rolling_dimension(stress["tau_yz"])
    tensor = xr.concat([stress[name] for name in STRESSES], dim=COMPONENT, coords="minimal", compat="override")
    lead = [dim for dim in tensor.dims if dim not in (rolling, COMPONENT)]
    return tensor.transpose(*lead, rolling, COMPONENT), rolling


def rolling_dimension(stress: xr.DataArray) -> str:
    """Dimension along y of a stress over a whole passage, at least three positions."""
    rolling = dimension_along(stress, "y")
    if stress.sizes[rolling] < FEWEST_POSITIONS:
        raise InvalidInputError(
            f"stress.sizes[{rolling!r}]",
            stress.sizes[rolling],
            f"at least {FEWEST_POSITIONS}: the positions along y are the history",
            "solve with y over the whole passage, for example from -3 to 3 half-widths",
        )
    return rolling


def over_history(
    function: Callable[[Array], tuple[Array, ...]], stress: xr.Dataset, outputs: int
) -> tuple[xr.DataArray, ...]:
    """Map the histories (point, instant, 6) of a result, the last instant unloaded, to two or more arrays (point)."""
    tensor, rolling = histories(stress)

    def apply(values: Array) -> tuple[Array, ...]:
        flat = values.reshape(-1, *values.shape[-2:]).astype(np.float64)
        absent = np.isnan(flat).any(axis=-1)
        loaded = ~absent.all(axis=-1)
        # Positions that pad a shorter window are as unloaded as those beyond it.
        flat[absent] = 0.0
        results = np.full((outputs, loaded.size), np.nan)
        if loaded.any():
            results[:, loaded] = function(np.concatenate([flat, np.zeros_like(flat[:, :1])], axis=1)[loaded])
        return tuple(results.reshape(outputs, *values.shape[:-2]))

    return reduce_dims(apply, [(tensor, [rolling, COMPONENT])], outputs)


def of_points(name: str, array: xr.DataArray, base: Variable | None = None) -> xr.DataArray:
    """Values from the histories at points with name, unit and the mark of a value without an error estimate."""
    return name_array(name, array, base).assign_attrs({"comment": OF_POINTS, ERROR_KIND: NOT_ESTIMATED})


def window_remainder(stress: xr.Dataset) -> xr.DataArray:
    """Stress at the window's borders in y over the largest of the passage: how much of a history is left out.

    The remainder matters only where an extreme lies beyond the window. The extremes of the orthogonal shear lie at
    ``y = 0.87 a`` near the surface, and move out to ``y = z / sqrt(3)`` at depths of several half-widths.

    Parameters
    ----------
    stress : Dataset
        The six components `sigma_xx` ... `tau_yz`, with the rolling direction `y`, `y_field` or ``y_index``.

    Returns
    -------
    DataArray
        Largest magnitude of the stress tensor (root of the sum of its squared components) at the first and the last
        position along y, over that anywhere along y; 0 for a history that begins and ends unloaded, 1 at most.

    Raises
    ------
    InvalidInputError
        If a component or the rolling direction is missing, or there are fewer than three positions along it.

    Examples
    --------
    >>> passage = xr.DataArray([0.0, 1.0, 0.25], dims="y", coords={"y": [-1.0, 0.0, 1.0]})
    >>> float(window_remainder(xr.Dataset({name: passage for name in STRESSES})))
    0.25
    """

    def magnitudes(history: Array) -> tuple[Array, ...]:
        weights = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
        magnitude = np.sqrt((history[:, :-1] ** 2) @ weights)
        return np.maximum(magnitude[:, 0], magnitude[:, -1]), magnitude.max(axis=1)

    stress = require_in_si(stress, *STRESSES, argument="stress")
    rolling = dimension_along(stress["tau_yz"], "y")
    # Positions may be in any order.
    ordered = stress.sortby(rolling) if rolling in stress.indexes else stress
    border, largest = over_history(magnitudes, ordered, 2)
    return name_array("window_remainder", (border / largest).where(largest != 0, 0.0))


ROUNDING = 1e-10  # A point may lie outside a ball by this fraction of its radius
REGULAR = 1e-15  # Part of the trace added to the diagonal of a system of points, lest it be singular
MOST_STEPS = 500  # Points that may join a ball before it counts as not found: a safeguard


def enclosing_balls(points: Array, heights: Array | None = None) -> tuple[Array, Array]:
    """Centre (path, axis) and radius (path) of the smallest ball around each path of points (path, instant, axis).

    With `heights` (path, instant) the centre is bound to a plane: points are projections on it, heights distances.
    """
    origin = points.mean(axis=1)
    local = points - origin[:, None]
    above = np.zeros(points.shape[:2]) if heights is None else heights**2
    size = np.sqrt((local**2).sum(axis=-1) + above).max(axis=1)
    centre, radius = origin.copy(), np.zeros(len(points))
    open_paths = np.flatnonzero(size > 0)
    path, above = local[open_paths] / size[open_paths, None, None], above[open_paths] / size[open_paths, None] ** 2
    middle = path[:, 0].copy()
    reach = np.sqrt(above[:, 0])
    slots = points.shape[-1] + 1
    support = np.zeros((open_paths.size, slots), dtype=np.int64)
    occupied = np.zeros((open_paths.size, slots), dtype=bool)
    occupied[:, 0] = True
    for _ in range(MOST_STEPS):
        distance = np.sqrt(((path - middle[:, None]) ** 2).sum(axis=-1) + above)
        farthest = distance.argmax(axis=1)
        enclosed = distance[np.arange(open_paths.size), farthest] <= reach * (1 + ROUNDING) + ROUNDING
        finished = open_paths[enclosed]
        centre[finished] += middle[enclosed] * size[finished, None]
        radius[finished] = reach[enclosed] * size[finished]
        remaining = ~enclosed
        open_paths, path, above, support, occupied, farthest = (
            values[remaining] for values in (open_paths, path, above, support, occupied, farthest)
        )
        if not open_paths.size:
            return centre, radius
        middle, reach, support, occupied = _join(path, above, support, occupied, farthest)
    raise ArithmeticError(f"no smallest ball after {MOST_STEPS} steps for {open_paths.size} paths")


def _join(path: Array, above: Array, support: Array, used: Array, farthest: Array) -> tuple[Array, Array, Array, Array]:
    """Smallest balls around their support and one more point, which they touch; `above`: squared heights."""
    rows = np.arange(len(path))
    slots = support.shape[1]
    occupied = int(used.sum(axis=1).max())
    new, height = path[rows, farthest], above[rows, farthest]
    offsets = path[rows[:, None], support[:, :occupied]] - new[:, None]
    gram = np.einsum("pia,pja->pij", offsets, offsets)
    higher = above[rows[:, None], support[:, :occupied]] - height[:, None]
    square = np.einsum("pii->pi", gram) + higher
    present = used[:, :occupied]
    best = np.full(len(path), np.inf)
    middle, chosen = np.zeros_like(new), np.zeros_like(present)
    for subset in product((False, True), repeat=occupied):
        mask = np.array(subset)
        if mask.sum() >= slots:  # more points than a ball can be held by
            continue
        # Circumcentre new + sum(share * others): equally far from the new point and from the subset.
        count = int(mask.sum())
        part = gram[:, mask][:, :, mask]
        regular = part + REGULAR * np.eye(count) * (1 + np.trace(part, axis1=1, axis2=2))[:, None, None]
        share = np.linalg.solve(regular, 0.5 * square[:, mask][..., None])[..., 0] if count else square[:, mask]
        offset = np.einsum("pi,pia->pa", share, offsets[:, mask])
        squared = (offset**2).sum(axis=1) + height
        beyond = ((offsets - offset[:, None]) ** 2).sum(axis=-1) + higher + height[:, None]
        outside = np.where(present, beyond, 0.0).max(axis=1)
        valid = (outside <= squared * (1 + ROUNDING)) & ~(mask & ~present).any(axis=1) & (squared < best)
        best = np.where(valid, squared, best)
        middle[valid] = (new + offset)[valid]
        chosen[valid] = mask
    if not np.isfinite(best).all():
        raise ArithmeticError("no ball around the points that held the last one and a new one")
    # The points that hold the new ball move to the front, the new one among them.
    supporting = np.zeros((len(path), slots + 1), dtype=bool)
    supporting[:, :occupied], supporting[:, slots] = chosen, True
    order = np.argsort(~supporting, axis=1, kind="stable")[:, :slots]
    everyone = np.concatenate([support, farthest[:, None]], axis=1)
    return (
        middle,
        np.sqrt(best),
        np.take_along_axis(everyone, order, axis=1),
        np.take_along_axis(supporting, order, axis=1),
    )
