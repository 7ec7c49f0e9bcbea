"""Two elastic bodies in contact: their relative displacement, each body on its own cells along x."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse.linalg import LinearOperator

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.models import Body, Counterbody
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.problem import cell_means
from contactstudy.fields.surface import SurfaceOperator, surface_operator
from contactstudy.kernels.load import Load


@dataclass(frozen=True, eq=False)
class CellTransfer:
    """Matrices of overlaps: `to_second` moves loads to the second body's cells, `to_first` moves displacements back."""

    to_second: FloatArray
    to_first: FloatArray

    @classmethod
    def of(cls, counterbody: Counterbody, grid: Grid) -> CellTransfer | None:
        """Transfer between the cells of `grid` and of the counterbody; None for equal cells."""
        overlap, widths = counterbody.overlap(grid), grid.widths
        square = overlap.shape[0] == overlap.shape[1]
        if square and np.allclose(overlap, np.diag(widths), atol=1e-9 * widths.min()):
            return None
        return cls(overlap / counterbody.grid_on_body(grid).widths[:, None], overlap.T / widths[:, None])


def _reverse_tangential(direction: Load, values: FloatArray) -> FloatArray:
    """Reverse a tangential load or displacement, which has the opposite sign on the second body."""
    return values if direction is Load.NORMAL else -values


class PairOperator:
    """Relative displacement of two bodies on the first body's grid: normal parts add, tangential parts subtract."""

    # The same overlaps move loads to the second body's cells and displacements back: the sum is symmetric. A
    # traction acts on the second body in the opposite direction.

    def __init__(
        self, body: SurfaceOperator, counterbody: SurfaceOperator | None, transfer: CellTransfer | None, factor: float
    ) -> None:
        # Without a second operator the second body is displaced like the first one. `factor`: the normal
        # displacement of both bodies over that of the first one.
        self.body, self._counterbody, self._transfer, self._factor = body, counterbody, transfer, factor

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
        transfer = CellTransfer.of(counterbody, grid)
        factor = 1 + body.material.plane_strain_modulus / counterbody.body.material.plane_strain_modulus
        # Equal bodies share one operator although the cells may differ by rounding.
        same_body = replace(counterbody.body, reference_depth=body.reference_depth) == body
        if transfer is None and same_body and counterbody.start == 0:
            return cls(first, None, None, factor)
        second = surface_operator(counterbody.body, counterbody.grid_on_body(grid), loads, directions=directions)
        return cls(first, second, transfer, factor)

    def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
        """Displacement (m) of the cells towards each other under `loads` on the first body (Pa)."""
        return self.compute_displacements(loads, (Load.NORMAL,))[Load.NORMAL]

    def compute_displacements(
        self, loads: Mapping[Load, FloatArray], directions: Sequence[Load]
    ) -> dict[Load, FloatArray]:
        """Relative displacements (m) in some `directions` under `loads` on the first body (Pa)."""
        if self._counterbody is None:
            return self._displacements_of_equal_bodies(loads, directions)
        transfer = self._transfer
        reaction = {
            load: _reverse_tangential(load, cell_loads if transfer is None else transfer.to_second @ cell_loads)
            for load, cell_loads in loads.items()
        }
        relative = self.body.compute_displacements(loads, directions)
        for direction, values in self._counterbody.compute_displacements(reaction, directions).items():
            second = values if transfer is None else transfer.to_first @ values
            relative[direction] = relative[direction] + _reverse_tangential(direction, second)
        return relative

    def _displacements_of_equal_bodies(
        self, loads: Mapping[Load, FloatArray], directions: Sequence[Load]
    ) -> dict[Load, FloatArray]:
        """Relative displacements of equal bodies: none tangentially under a pressure, none normally under tractions."""
        relative = {direction: np.zeros(self.body.grid.shape) for direction in directions}
        for is_normal in (True, False):
            acting = {load: cell_loads for load, cell_loads in loads.items() if (load is Load.NORMAL) == is_normal}
            observed = [direction for direction in directions if (direction is Load.NORMAL) == is_normal]
            if acting and observed:
                for direction, displacement in self.body.compute_displacements(acting, observed).items():
                    relative[direction] = self._factor * displacement
        return relative

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Approximate pressure that closes the gap."""
        return self.body.precondition(gap) / self._factor

    @property
    def has_paired_cells(self) -> bool:
        """Whether the second body's cells can be joined in pairs."""
        return self._counterbody is None or self._counterbody.grid.cells_x % 2 == 0

    @cached_property
    def coarse(self) -> PairOperator:
        """Approximate operator on cells of twice the size; if cells cannot be paired, a multiple of the first one."""
        if self._counterbody is None or not self.has_paired_cells:
            return PairOperator(self.body.coarse, None, None, self._factor)
        transfer = self._transfer and CellTransfer(
            2 * cell_means(self._transfer.to_second), 2 * cell_means(self._transfer.to_first)
        )
        return PairOperator(self.body.coarse, self._counterbody.coarse, transfer, self._factor)


@dataclass(frozen=True, eq=False)
class PrescribedSurface:
    """A user's operator of the surface, with the preconditioner and the coarse cells of a body."""

    operator: LinearOperator
    body: SurfaceOperator

    def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
        """Displacement (m) of the surfaces towards each other under a pressure (Pa)."""
        return np.asarray(self.operator.matvec(loads[Load.NORMAL].ravel()).reshape(self.body.grid.shape))

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Approximate pressure that closes the gap."""
        return self.body.precondition(gap)

    @property
    def coarse(self) -> SurfaceOperator:
        """Operator of the body on cells of twice the size, for a first guess."""
        return self.body.coarse
