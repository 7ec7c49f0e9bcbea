"""Two elastic bodies pressed on each other: their displacements add up, each on a grid of its own along x."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.counterbody import Counterbody
from contactstudy.bodies.models import Body
from contactstudy.checks import FloatArray
from contactstudy.fields.surface import SurfaceOperator, surface_operator


class PairOperator:
    """Displacement of two bodies towards each other, as one operator on the first one's grid.

    With the loads carried over to the second body's cells and its displacements back by the same overlaps, the sum is
    symmetric as each part is. The friction acts on the second body the other way round.

    Parameters
    ----------
    body : Body
        The first body.
    counterbody : Counterbody
        The second.
    grid : Grid
        Cells on the first body.
    tangential : bool
        Whether the displacement from traction is needed.
    """

    def __init__(self, body: Body, counterbody: Counterbody, grid: Grid, *, tangential: bool) -> None:
        self.body = surface_operator(body, grid, tangential=tangential)
        own = counterbody.own_grid(grid)
        self.counterbody = surface_operator(counterbody.body, own, tangential=tangential)
        overlap = counterbody.overlap(grid)
        identity = overlap.shape[0] == overlap.shape[1] and np.allclose(overlap, grid.dx * np.eye(len(overlap)))
        self._to_own = None if identity else overlap / own.dx
        self._from_own = None if identity else overlap.T / grid.dx
        first, second = (each.material.plane_strain_modulus for each in (body, counterbody.body))
        self._softer = 1 + first / second

    def __call__(self, pressure: FloatArray, traction: FloatArray | None = None) -> FloatArray:
        """Displacement (m) of the cell centres under `pressure` and, if given, `traction` on the first body (Pa)."""
        own = self.counterbody(self._carried(pressure), None if traction is None else -self._carried(traction))
        return self.body(pressure, traction) + self._returned(own)

    def _carried(self, load: FloatArray) -> FloatArray:
        return load if self._to_own is None else np.asarray(self._to_own @ load)

    def _returned(self, displacement: FloatArray) -> FloatArray:
        return displacement if self._from_own is None else np.asarray(self._from_own @ displacement)

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Roughly the pressure that closes the gap."""
        return self.body.precondition(gap) / self._softer

    @cached_property
    def coarse(self) -> PairOperator | ScaledOperator:
        """Roughly this operator on cells of twice the size.

        If the second body's cells cannot be joined in twos, the first body is taken, as much softer as the two are.
        """
        if self.counterbody.grid.cells_x % 2:
            return ScaledOperator(self.body.coarse, self._softer)
        coarse = copy(self)
        coarse.body, coarse.counterbody = self.body.coarse, self.counterbody.coarse
        if self._to_own is not None and self._from_own is not None:
            coarse._to_own, coarse._from_own = _joined(self._to_own), _joined(self._from_own)
        return coarse


def _joined(shares: FloatArray) -> FloatArray:
    """Shares of cells of twice the size in each other."""
    rows, columns = shares.shape
    return np.asarray(0.5 * shares.reshape(rows // 2, 2, columns // 2, 2).sum(axis=(1, 3)))


@dataclass(frozen=True, eq=False)
class ScaledOperator:
    """An operator times a factor."""

    operator: SurfaceOperator
    factor: float

    def __call__(self, pressure: FloatArray, traction: FloatArray | None = None) -> FloatArray:
        """Displacement (m) of the cell centres."""
        return self.factor * self.operator(pressure, traction)

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Roughly the pressure that sinks the cells by `gap`."""
        return self.operator.precondition(gap) / self.factor

    @property
    def coarse(self) -> ScaledOperator:
        """The operator on cells of twice the size."""
        return ScaledOperator(self.operator.coarse, self.factor)
