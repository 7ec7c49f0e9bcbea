"""Two elastic bodies pressed on each other: how far they move apart, each on cells along x that suit it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse.linalg import LinearOperator

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.counterbody import Counterbody
from contactstudy.bodies.models import Body
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.problem import cell_means
from contactstudy.fields.surface import SurfaceOperator, surface_operator
from contactstudy.kernels.load import Load


@dataclass(frozen=True, eq=False)
class Shares:
    """How much of each cell of one body each cell of the other takes; `to` carries loads over, `back` displacements."""

    to: FloatArray
    back: FloatArray

    @classmethod
    def of(cls, counterbody: Counterbody, grid: Grid) -> Shares | None:
        """Shares of the counterbody's cells in those of `grid`; None if they are the same cells."""
        overlap, widths = counterbody.overlap(grid), grid.widths
        square = overlap.shape[0] == overlap.shape[1]
        if square and np.allclose(overlap, np.diag(widths), atol=1e-9 * widths.min()):
            return None
        return cls(overlap / counterbody.grid_on_body(grid).widths[:, None], overlap.T / widths[:, None])


def _opposed(direction: Load, values: FloatArray) -> FloatArray:
    """Reverse a load or a displacement along the surface, as the second body has it."""
    return values if direction is Load.NORMAL else -values


class PairOperator:
    """Displacement of two bodies relative to each other, on the first one's grid: normal ones add, others subtract."""

    # Loads go to the second body's cells and its displacements back by the same overlaps: the sum is symmetric. A
    # traction acts on the second body in the opposite direction.

    def __init__(self, body: SurfaceOperator, counterbody: SurfaceOperator, shares: Shares | None) -> None:
        self.body, self.counterbody, self._shares = body, counterbody, shares
        first, second = (operator.body.material.plane_strain_modulus for operator in (body, counterbody))
        self._softer = 1 + first / second

    @classmethod
    def of(
        cls,
        body: Body,
        counterbody: Counterbody,
        grid: Grid,
        loads: tuple[Load, ...],
        directions: tuple[Load, ...] = (Load.NORMAL,),
    ) -> PairOperator:
        """Operator of two bodies for `loads` and displacements of given directions, on the cells of the first."""
        first = surface_operator(body, grid, loads, directions=directions)
        shares = Shares.of(counterbody, grid)
        # Cells from labels may miss the counterbody's own by rounding; like bodies share one operator all the same.
        alike = replace(counterbody.body, reference_depth=body.reference_depth) == body
        if shares is None and alike and counterbody.start == 0:
            return cls(first, first, None)
        own = counterbody.grid_on_body(grid)
        return cls(first, surface_operator(counterbody.body, own, loads, directions=directions), shares)

    def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
        """Displacement (m) of the cells towards each other under `loads` on the first body (Pa)."""
        return self.displaced(loads, (Load.NORMAL,))[Load.NORMAL]

    def displaced(self, loads: Mapping[Load, FloatArray], directions: Sequence[Load]) -> dict[Load, FloatArray]:
        """Relative displacements (m) in some `directions` under `loads` on the first body (Pa)."""
        if self.counterbody is self.body and self._shares is None:
            return self._twice(loads, directions)
        shares = self._shares
        reaction = {
            load: _opposed(load, cells if shares is None else shares.to @ cells) for load, cells in loads.items()
        }
        relative = self.body.displaced(loads, directions)
        for direction, other in self.counterbody.displaced(reaction, directions).items():
            moved = other if shares is None else shares.back @ other
            relative[direction] = relative[direction] + _opposed(direction, moved)
        return relative

    def _twice(self, loads: Mapping[Load, FloatArray], directions: Sequence[Load]) -> dict[Load, FloatArray]:
        """Relative displacements of equal bodies: tangential ones of a pressure, normal ones of tractions cancel."""
        relative = {direction: np.zeros(self.body.grid.shape) for direction in directions}
        for normal in (True, False):
            own = {load: cells for load, cells in loads.items() if (load is Load.NORMAL) == normal}
            asked = [direction for direction in directions if (direction is Load.NORMAL) == normal]
            if own and asked:
                for direction, each in self.body.displaced(own, asked).items():
                    relative[direction] = 2 * each
        return relative

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Roughly the pressure that closes the gap."""
        return self.body.precondition(gap) / self._softer

    @cached_property
    def coarse(self) -> PairOperator | ScaledOperator:
        """Approximate operator on cells of twice the size; without pairs of cells the softened first body."""
        if self.counterbody.grid.cells_x % 2:
            return ScaledOperator(self.body.coarse, self._softer)
        shares = self._shares and Shares(2 * cell_means(self._shares.to), 2 * cell_means(self._shares.back))
        return PairOperator(self.body.coarse, self.counterbody.coarse, shares)


@dataclass(frozen=True, eq=False)
class ScaledOperator:
    """An operator times a factor."""

    operator: SurfaceOperator
    factor: float

    def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
        """Displacement (m) of the cell centres under `loads` (Pa)."""
        return self.factor * self.operator(loads)

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Roughly the pressure that sinks the cells by `gap`."""
        return self.operator.precondition(gap) / self.factor

    @property
    def coarse(self) -> ScaledOperator:
        """The operator on cells of twice the size."""
        return ScaledOperator(self.operator.coarse, self.factor)


@dataclass(frozen=True, eq=False)
class PrescribedSurface:
    """A user's operator of the surface; preconditioner and coarse cells are those of a body."""

    operator: LinearOperator
    body: SurfaceOperator

    def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
        """Displacement (m) of the surfaces towards each other under a pressure (Pa)."""
        return np.asarray(self.operator.matvec(loads[Load.NORMAL].ravel()).reshape(self.body.grid.shape))

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Pressure that roughly closes the gap."""
        return self.body.precondition(gap)

    @property
    def coarse(self) -> SurfaceOperator:
        """Operator of the body on cells of twice the size, for a first guess."""
        return self.body.coarse
