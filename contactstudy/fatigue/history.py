"""Stress histories of material points that pass the contact, and the smallest ball around a history.

The number of points that support the ball exceeds the number of dimensions by at most one. In each step the farthest
point outside joins the support, and one of the circumscribed balls of the support's subsets is the next ball: an exact
method (E. Welzl, LNCS 555 (1991) 359-370; B. Gaertner, Fast and robust smallest enclosing balls, ESA 1999).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np
import xarray as xr

from contactstudy.analysis import dimension_along
from contactstudy.analysis.axes import reduce_dims
from contactstudy.arrays.variables import ERROR_KIND, NOT_ESTIMATED, STRESSES, Variable, name_array, require_in_si
from contactstudy.checks import Array
from contactstudy.errors import InvalidInputError

HISTORY_COMMENT = "of the stresses at the given points"  # Attribute `comment` of values computed from histories
MIN_POSITIONS = 3  # Minimum number of positions along y in a history
COMPONENT = "stress_component"  # Dimension of the six components of a history


def stack_history(stress: xr.Dataset) -> tuple[xr.DataArray, str]:
    """Six stress components, with rolling direction and component as last dimensions, and the rolling dimension."""
    stress = require_in_si(stress, *STRESSES, argument="stress")
    rolling_dim = rolling_dimension(stress["tau_yz"])
    tensor = stress[list(STRESSES)].to_dataarray(COMPONENT).drop_vars(COMPONENT)
    return tensor.transpose(..., rolling_dim, COMPONENT), rolling_dim


def rolling_dimension(stress: xr.DataArray) -> str:
    """Name of the dimension along y of a stress, which must have at least three positions."""
    rolling_dim = dimension_along(stress, "y")
    size = stress.sizes[rolling_dim]
    if size < MIN_POSITIONS:
        allowed = f"at least {MIN_POSITIONS}: the positions along y are the history"
        hint = "solve with y over the whole passage, for example from -3 to 3 half-widths"
        raise InvalidInputError(f"stress.sizes[{rolling_dim!r}]", size, allowed, hint)
    return rolling_dim


def map_histories(
    function: Callable[[Array], dict[str, Array]], stress: xr.Dataset, names: Sequence[str]
) -> dict[str, xr.DataArray]:
    """Map the histories (point, instant, 6) of a result, the last instant unloaded, to two or more arrays (point)."""
    tensor, rolling_dim = stack_history(stress)

    def map_points(values: Array) -> tuple[Array, ...]:
        points = values.reshape(-1, *values.shape[-2:]).astype(np.float64)
        is_padding = np.isnan(points).any(axis=-1)
        is_loaded = ~is_padding.all(axis=-1)
        # Positions that pad a shorter window are unloaded.
        points[is_padding] = 0.0
        results = np.full((len(names), is_loaded.size), np.nan)
        if is_loaded.any():
            terms = function(np.concatenate([points, np.zeros_like(points[:, :1])], axis=1)[is_loaded])
            results[:, is_loaded] = [terms[name] for name in names]
        return tuple(results.reshape(len(names), *values.shape[:-2]))

    return dict(zip(names, reduce_dims(map_points, [(tensor, [rolling_dim, COMPONENT])], len(names)), strict=True))


def label_points(name: str, array: xr.DataArray, specification: Variable | None = None) -> xr.DataArray:
    """Label values computed from histories: name, unit, and the attribute that marks a missing error estimate."""
    return name_array(name, array, specification).assign_attrs({"comment": HISTORY_COMMENT, ERROR_KIND: NOT_ESTIMATED})


def window_remainder(stress: xr.Dataset) -> xr.DataArray:
    """Stress at the window's borders in y over the largest stress of the passage: the truncation of a history.

    The remainder has an influence only if an extreme lies beyond the window. Extremes of the orthogonal shear lie at
    ``y = 0.87 a`` near the surface, and move out to ``y = z / sqrt(3)`` at depths of several half-widths.

    Parameters
    ----------
    stress : Dataset
        The six components `sigma_xx` ... `tau_yz`, with the rolling direction `y`, `y_field` or ``y_index``.

    Returns
    -------
    DataArray
        Largest magnitude of the stress tensor (root of the sum of its squared components) at the first and the last
        position along y, over the largest magnitude along y; 0 for a history that begins and ends unloaded, at most 1.

    Raises
    ------
    InvalidInputError
        If a component or the rolling direction is missing, or the latter has fewer than three positions.

    Examples
    --------
    >>> passage = xr.DataArray([0.0, 1.0, 0.25], dims="y", coords={"y": [-1.0, 0.0, 1.0]})
    >>> float(window_remainder(xr.Dataset({name: passage for name in STRESSES})))
    0.25
    """

    def find_magnitudes(history: Array) -> dict[str, Array]:
        weights = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
        magnitude = np.sqrt((history[:, :-1] ** 2) @ weights)
        return {"border": np.maximum(magnitude[:, 0], magnitude[:, -1]), "largest": magnitude.max(axis=1)}

    stress = require_in_si(stress, *STRESSES, argument="stress")
    rolling_dim = dimension_along(stress["tau_yz"], "y")
    # Positions may be in any order.
    sorted_stress = stress.sortby(rolling_dim) if rolling_dim in stress.indexes else stress
    stresses = map_histories(find_magnitudes, sorted_stress, ("border", "largest"))
    remainder = (stresses["border"] / stresses["largest"]).where(stresses["largest"] != 0, 0.0)
    return name_array("window_remainder", remainder)


ROUNDING = 1e-10  # A point may lie outside a ball by this fraction of its radius
REGULARISATION = 1e-15  # Fraction of the trace added to the diagonal of a singular system of points
MAX_STEPS = 500  # Bound on the steps of a ball: a safeguard


def enclosing_balls(points: Array, heights: Array | None = None) -> tuple[Array, Array]:
    """Centre (path, axis) and radius (path) of the smallest ball around each path of points (path, instant, axis).

    With `heights` (path, instant) the centre lies in a plane: `points` are projections, `heights` their distances.
    """
    origin = points.mean(axis=1)
    local_points = points - origin[:, None]
    squares = np.zeros(points.shape[:2]) if heights is None else heights**2
    scale = np.sqrt((local_points**2).sum(axis=-1) + squares).max(axis=1)
    centre, radius = origin.copy(), np.zeros(len(points))
    open_paths = np.flatnonzero(scale > 0)
    paths = local_points[open_paths] / scale[open_paths, None, None]
    squares = squares[open_paths] / scale[open_paths, None] ** 2
    centres = paths[:, 0].copy()
    radii = np.sqrt(squares[:, 0])
    support = np.full((open_paths.size, points.shape[-1] + 1), -1)  # indices of points, the occupied places first
    support[:, 0] = 0
    for _ in range(MAX_STEPS):
        distance = np.sqrt(((paths - centres[:, None]) ** 2).sum(axis=-1) + squares)
        farthest = distance.argmax(axis=1)
        is_enclosed = distance[np.arange(open_paths.size), farthest] <= radii * (1 + ROUNDING) + ROUNDING
        finished = open_paths[is_enclosed]
        centre[finished] += centres[is_enclosed] * scale[finished, None]
        radius[finished] = radii[is_enclosed] * scale[finished]
        is_open = ~is_enclosed
        open_paths, paths, squares, support, farthest = (
            values[is_open] for values in (open_paths, paths, squares, support, farthest)
        )
        if not open_paths.size:
            return centre, radius
        centres, radii, support = _add_point(paths, squares, support, farthest)
    raise ArithmeticError(f"no smallest ball after {MAX_STEPS} steps for {open_paths.size} paths")


def _add_point(path: Array, squares: Array, support: Array, farthest: Array) -> tuple[Array, Array, Array]:
    """Smallest balls around their support and the farthest point, and the new support; `squares`: squared heights."""
    rows = np.arange(len(path))
    max_support_size = support.shape[1]
    subset_size = int((support >= 0).sum(axis=1).max())
    new_point, new_height = path[rows, farthest], squares[rows, farthest]
    offsets = path[rows[:, None], support[:, :subset_size]] - new_point[:, None]
    gram = np.einsum("pia,pja->pij", offsets, offsets)
    height_rises = squares[rows[:, None], support[:, :subset_size]] - new_height[:, None]
    square = np.einsum("pii->pi", gram) + height_rises
    is_present = support[:, :subset_size] >= 0
    min_squared_radius = np.full(len(path), np.inf)
    centre, best_subset = np.zeros_like(new_point), np.zeros_like(is_present)
    for subset in product((False, True), repeat=subset_size):
        mask, size = np.array(subset), sum(subset)
        if size >= max_support_size:  # more points than support a ball
            continue
        # The circumcentre has equal distances from the new point and from the subset.
        matrix = gram[:, mask][:, :, mask]
        system = matrix + REGULARISATION * np.eye(size) * (1 + np.trace(matrix, axis1=1, axis2=2))[:, None, None]
        factors = np.linalg.solve(system, 0.5 * square[:, mask][..., None])[..., 0] if size else square[:, mask]
        offset = np.einsum("pi,pia->pa", factors, offsets[:, mask])
        squared_radius = (offset**2).sum(axis=1) + new_height
        distances = ((offsets - offset[:, None]) ** 2).sum(axis=-1) + height_rises + new_height[:, None]
        farthest_distance = np.where(is_present, distances, 0.0).max(axis=1)
        is_valid = (
            (farthest_distance <= squared_radius * (1 + ROUNDING))
            & ~(mask & ~is_present).any(axis=1)
            & (squared_radius < min_squared_radius)
        )
        min_squared_radius = np.where(is_valid, squared_radius, min_squared_radius)
        centre[is_valid] = (new_point + offset)[is_valid]
        best_subset[is_valid] = mask
    if not np.isfinite(min_squared_radius).all():
        raise ArithmeticError("no ball around the support and a new point")
    # The points that support the new ball move to the front.
    is_support = np.zeros((len(path), max_support_size + 1), dtype=bool)
    is_support[:, :subset_size], is_support[:, max_support_size] = best_subset, True
    order = np.argsort(~is_support, axis=1, kind="stable")[:, :max_support_size]
    candidates = np.where(is_support, np.concatenate([support, farthest[:, None]], axis=1), -1)
    return centre, np.sqrt(min_squared_radius), np.take_along_axis(candidates, order, axis=1)
