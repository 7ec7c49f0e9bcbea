"""Smallest ball that encloses a path, for many paths at once: the amplitude of a multiaxial stress history.

The ball is held by at most one point more than there are dimensions. Beginning with one point, the farthest point
outside joins those that hold the ball, the smallest ball around these few is found among the circumscribed balls of
their subsets, and so on until nothing lies outside. The radius grows with each step, so this ends with the exact ball.
The idea is that of E. Welzl, Smallest enclosing disks (balls and ellipsoids), in: New Results and New Trends in
Computer Science, LNCS 555 (1991) 359-370, and of B. Gaertner, Fast and robust smallest enclosing balls, ESA 1999.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from contactstudy.checks import Array

ROUNDING = 1e-10
"""A point may lie outside a ball by this fraction of its radius. Accuracy."""

REGULAR = 1e-15
"""Part of the trace added to the diagonal of a system of points, lest it be singular. Accuracy."""

MOST_STEPS = 500
"""Points that may join a ball before it counts as not found: a safeguard."""


def enclosing_balls(points: Array, heights: Array | None = None) -> tuple[Array, Array]:
    """Centre and radius of the smallest ball around each path, whose centre may be bound to a plane of the space.

    Parameters
    ----------
    points : array (path, instant, axis)
        Points in Euclidean space; if the centre is bound, their projections on the plane (or line) of the centre.
    heights : array (path, instant), optional
        Distances of the points from that plane; none if the centre may be anywhere.

    Returns
    -------
    centre : array (path, axis)
    radius : array (path)

    Examples
    --------
    >>> triangle = np.array([[[0.0, 0.0], [2.0, 0.0], [1.0, 0.5]]])
    >>> centre, radius = enclosing_balls(triangle)
    >>> centre.round(9).tolist(), radius.round(9).tolist()
    ([[1.0, 0.0]], [1.0])
    >>> centre, radius = enclosing_balls(triangle[..., :1], triangle[..., 1])
    >>> centre.round(9).tolist(), radius.round(9).tolist()
    ([[1.0]], [1.0])
    """
    origin = points.mean(axis=1)
    local = points - origin[:, None]
    above = np.zeros(points.shape[:2]) if heights is None else heights**2
    size = np.sqrt((local**2).sum(axis=-1) + above).max(axis=1)
    centre, radius = origin.copy(), np.zeros(len(points))
    left = np.flatnonzero(size > 0)
    path, above = local[left] / size[left, None, None], above[left] / size[left, None] ** 2
    middle = path[:, 0].copy()
    reach = np.sqrt(above[:, 0])
    slots = points.shape[-1] + 1
    held = np.zeros((left.size, slots), dtype=np.int64)
    used = np.zeros((left.size, slots), dtype=bool)
    used[:, 0] = True
    for _ in range(MOST_STEPS):
        distance = np.sqrt(((path - middle[:, None]) ** 2).sum(axis=-1) + above)
        far = distance.argmax(axis=1)
        done = distance[np.arange(left.size), far] <= reach * (1 + ROUNDING) + ROUNDING
        finished = left[done]
        centre[finished] += middle[done] * size[finished, None]
        radius[finished] = reach[done] * size[finished]
        keep = ~done
        left, path, above, held, used, far = (each[keep] for each in (left, path, above, held, used, far))
        if not left.size:
            return centre, radius
        middle, reach, held, used = _join(path, above, held, used, far)
    raise ArithmeticError(f"no smallest ball after {MOST_STEPS} steps for {left.size} paths")


def _join(path: Array, above: Array, held: Array, used: Array, far: Array) -> tuple[Array, Array, Array, Array]:
    """Smallest balls around the points that held them and one more, which the new ball must touch.

    `above` are the squares of the points' heights above the plane of the centres.
    """
    rows = np.arange(len(path))
    slots = held.shape[1]
    occupied = int(used.sum(axis=1).max())
    new, own = path[rows, far], above[rows, far]
    others = path[rows[:, None], held[:, :occupied]] - new[:, None]
    gram = np.einsum("pia,pja->pij", others, others)
    higher = above[rows[:, None], held[:, :occupied]] - own[:, None]
    square = np.einsum("pii->pi", gram) + higher
    present = used[:, :occupied]
    best = np.full(len(path), np.inf)
    middle, chosen = np.zeros_like(new), np.zeros_like(present)
    for subset in product((False, True), repeat=occupied):
        mask = np.array(subset)
        if mask.sum() >= slots:  # more points than a ball can be held by
            continue
        # Circumcentre new + sum(share * others): equally far from the new point and from those of the subset.
        count = int(mask.sum())
        part = gram[:, mask][:, :, mask]
        regular = part + REGULAR * np.eye(count) * (1 + np.trace(part, axis1=1, axis2=2))[:, None, None]
        share = np.linalg.solve(regular, 0.5 * square[:, mask][..., None])[..., 0] if count else square[:, mask]
        offset = np.einsum("pi,pia->pa", share, others[:, mask])
        squared = (offset**2).sum(axis=1) + own
        beyond = ((others - offset[:, None]) ** 2).sum(axis=-1) + higher + own[:, None]
        outside = np.where(present, beyond, 0.0).max(axis=1)
        valid = (outside <= squared * (1 + ROUNDING)) & ~(mask & ~present).any(axis=1) & (squared < best)
        best = np.where(valid, squared, best)
        middle[valid] = (new + offset)[valid]
        chosen[valid] = mask
    if not np.isfinite(best).all():
        raise ArithmeticError("no ball around the points that held the last one and a new one")
    # The points that hold the new ball move to the front, the new one among them.
    kept = np.zeros((len(path), slots + 1), dtype=bool)
    kept[:, :occupied], kept[:, slots] = chosen, True
    order = np.argsort(~kept, axis=1, kind="stable")[:, :slots]
    everyone = np.concatenate([held, far[:, None]], axis=1)
    return (
        middle,
        np.sqrt(best),
        np.take_along_axis(everyone, order, axis=1),
        np.take_along_axis(kept, order, axis=1),
    )
