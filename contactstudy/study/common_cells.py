"""One axis for the cells of all cases: positions over the half-width, on which the surfaces of a study lie together.

Cases of a study have cells of their own. The common edges are edges of the cases, thinned to half the width of the
narrowest cell that any case has there. Pressure and traction are averaged over a common cell, so loads are kept; flags
are those of the case's own cell there; other quantities are interpolated linearly between the case's own centres.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from contactstudy.arrays.grid import SPACING_TOLERANCE
from contactstudy.checks import FloatArray

LEAST_WIDTH = 0.5
"""Width of a common cell over the narrowest of the cases' own there, at least. Accuracy."""

AVERAGED = frozenset({"pressure", "traction_x", "traction_y"})
"""Variables that are averaged over a common cell."""

FLAGS = frozenset({"stick"})
"""Variables that are true or false."""

AVERAGE = "averaged over cells that all cases share: loads are kept, peaks may be a little lower"
LINEAR = "interpolated linearly from the case's own cells"
HOLDING = "that of the case's own cell which holds the common cell's centre; false beyond the case's cells"


def comment_of(name: str) -> str:
    """Say how a variable comes onto the common cells.

    Examples
    --------
    >>> comment_of("gap")
    "interpolated linearly from the case's own cells"
    """
    if name in AVERAGED:
        return AVERAGE
    return HOLDING if name in FLAGS else LINEAR


def common_columns(edges: Sequence[FloatArray]) -> FloatArray:
    """Edges along x that resolve the cells of all cases.

    Parameters
    ----------
    edges : sequence of array
        Edges of each case, over its half-width.

    Examples
    --------
    >>> common_columns([np.array([0.0, 1.0, 2.0, 4.0]), np.array([0.0, 0.9, 4.0, 5.0])]).tolist()
    [0.0, 0.9, 2.0, 4.0, 5.0]
    """
    union = np.unique(np.concatenate(edges))
    middles = 0.5 * (union[1:] + union[:-1])
    narrowest = np.full(middles.size, np.inf)
    for own in edges:
        at = np.searchsorted(own, middles) - 1
        inside = (at >= 0) & (at < own.size - 1)
        narrowest[inside] = np.minimum(narrowest[inside], np.diff(own)[at[inside]])
    kept = [union[0]]
    for edge, width in zip(union[1:], narrowest, strict=True):
        if edge - kept[-1] >= LEAST_WIDTH * width:
            kept.append(edge)
    # The last edge counts more than the one before it, which may be close to it.
    if kept[-1] != union[-1]:
        kept[-1 if len(kept) > 1 else 1 :] = [union[-1]]
    return np.array(kept)


def common_rows(edges: Sequence[FloatArray]) -> FloatArray:
    """Uniform edges along y over the widest window, with the narrowest cells of all cases.

    Examples
    --------
    >>> common_rows([np.array([-2.0, 0.0, 2.0]), np.array([-1.5, -0.5, 0.5, 1.5])]).tolist()
    [-2.0, -1.0, 0.0, 1.0, 2.0]
    """
    reach = max(float(np.abs(own).max()) for own in edges)
    width = min(float(np.diff(own).min()) for own in edges)
    return np.linspace(-reach, reach, 1 + int(np.ceil(2 * reach / width * (1 - SPACING_TOLERANCE))))


@dataclass(frozen=True, eq=False)
class OntoCommon:
    """From a case's own cells to the common ones, along one axis.

    Attributes
    ----------
    own, common : array
        Edges, over the half-width.
    outside : float
        Value of an average beyond the case's own cells: 0 where nothing is pressed, NaN where there is no body.
    """

    own: FloatArray
    common: FloatArray
    outside: float

    @property
    def beyond(self) -> npt.NDArray[np.bool_]:
        """Common cells whose centre lies beyond the case's own."""
        centres = _centres(self.common)
        return np.asarray((centres < self.own[0]) | (centres > self.own[-1]))

    def averages(self, values: FloatArray) -> FloatArray:
        """Average values (cell, ...) over the common cells, straight within each own cell: integrals are kept.

        The slopes are limited by either neighbour, so no value is beyond those of the cells around.
        """
        from scipy import sparse  # long to import, and a summary or a page of a study does without

        low = np.maximum(self.common[:-1, None], self.own[None, :-1])
        high = np.minimum(self.common[1:, None], self.own[None, 1:])
        shared = np.maximum(high - low, 0.0) / np.diff(self.common)[:, None]
        centres = _centres(self.own)
        arms = np.where(shared > 0, 0.5 * (low + high) - centres, 0.0)
        found = sparse.csr_array(shared) @ values + sparse.csr_array(shared * arms) @ _limited_slopes(centres, values)
        found[~shared.any(axis=1)] = self.outside
        return np.asarray(found)

    def holding(self, values: FloatArray) -> FloatArray:
        """Values along the first axis of the own cells that hold the common centres; 0 beyond the own cells."""
        at = np.clip(np.searchsorted(self.own, _centres(self.common)) - 1, 0, self.own.size - 2)
        found = values[at]
        found[self.beyond] = 0.0
        return np.asarray(found)

    def between(self, values: FloatArray) -> FloatArray:
        """Interpolate values along the first axis linearly at the common centres; NaN beyond the own cells."""
        centres, own = _centres(self.common), _centres(self.own)
        if own.size == 1:
            found = np.repeat(values, centres.size, axis=0)
        else:
            at = np.clip(np.searchsorted(own, centres) - 1, 0, own.size - 2)
            part = np.clip((centres - own[at]) / (own[at + 1] - own[at]), 0.0, 1.0)
            part = part.reshape(-1, *(1,) * (values.ndim - 1))
            with np.errstate(invalid="ignore"):
                found = (1 - part) * values[at] + part * values[at + 1]
            # Beside an infinite gap there is nothing to interpolate.
            holding = np.clip(np.searchsorted(self.own, centres) - 1, 0, own.size - 1)
            found = np.where(np.isfinite(found), found, values[holding])
        found[self.beyond] = np.nan
        return found


def resampled(name: str, values: npt.NDArray[Any], along: Iterable[OntoCommon | None]) -> npt.NDArray[Any]:
    """Values of a variable on the common cells; axes without a way onto them stay as they are."""
    result = np.asarray(values, dtype=np.float64)
    # Along x last: beyond the body nothing is known, beside the window there is no pressure.
    for axis, way in reversed(list(enumerate(along))):
        if way is None:
            continue
        moved = np.moveaxis(result, axis, 0)
        if name in AVERAGED:
            flat = way.averages(moved.reshape(moved.shape[0], -1))
            moved = flat.reshape(-1, *moved.shape[1:])
        elif name in FLAGS:
            moved = way.holding(moved)
        else:
            moved = way.between(moved)
        result = np.moveaxis(moved, 0, axis)
    return result


def _limited_slopes(centres: FloatArray, values: FloatArray) -> FloatArray:
    """Slope of each cell: the smaller one to either neighbour, 0 at a local extreme and at the outermost cells."""
    slopes = np.zeros_like(values)
    if centres.size > 2:
        steps = np.diff(values, axis=0) / np.diff(centres)[:, None]
        before, after = steps[:-1], steps[1:]
        smaller = np.minimum(np.abs(before), np.abs(after))
        slopes[1:-1] = np.where(before * after > 0, np.sign(before) * smaller, 0.0)
    return slopes


def _centres(edges: FloatArray) -> FloatArray:
    """Middles of the cells between `edges`."""
    return np.asarray(0.5 * (edges[1:] + edges[:-1]))
