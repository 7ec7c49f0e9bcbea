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
    """Matrices from overlaps: for loads to the counterbody's cells, for displacements back to the body's cells."""

    to_counterbody: FloatArray
    to_body: FloatArray

    @classmethod
    def of(cls, counterbody: Counterbody, grid: Grid) -> CellTransfer | None:
        """Transfer between the cells of `grid` and of the counterbody; None for equal cells."""
        overlap, widths = counterbody.overlap(grid), grid.widths
        is_square = overlap.shape[0] == overlap.shape[1]
        if is_square and np.allclose(overlap, np.diag(widths), atol=1e-9 * widths.min()):
            return None
        return cls(overlap / counterbody.grid_on_body(grid).widths[:, None], overlap.T / widths[:, None])


def _reverse_tangential(direction: Load, values: FloatArray) -> FloatArray:
    """Reverse a tangential load or displacement, which has the opposite sign on the second body."""
    return values if direction is Load.NORMAL else -values


class PairOperator:
    """Relative displacement of two bodies on the first body's grid: normal parts add, tangential parts subtract."""

    # The same overlaps transfer loads to the counterbody's cells and displacements back: the sum is symmetric. A
    # traction acts on the counterbody in the opposite direction.

    def __init__(
        self, body: SurfaceOperator, counterbody: SurfaceOperator | None, transfer: CellTransfer | None, factor: float
    ) -> None:
        # Without a `counterbody` operator both bodies deform alike. `factor` is the normal displacement of both bodies
        # over that of the first.
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
        """Operator of two bodies for `loads` and displacements in given directions, on the cells of the first body."""
        body_operator = surface_operator(body, grid, loads, directions=directions)
        transfer = CellTransfer.of(counterbody, grid)
        factor = 1 + body.material.plane_strain_modulus / counterbody.body.material.plane_strain_modulus
        # Equal bodies share one operator although the cells may differ by rounding.
        same_body = replace(counterbody.body, reference_depth=body.reference_depth) == body
        if transfer is None and same_body and counterbody.start == 0:
            return cls(body_operator, None, None, factor)
        cells = counterbody.grid_on_body(grid)
        counter_operator = surface_operator(counterbody.body, cells, loads, directions=directions)
        return cls(body_operator, counter_operator, transfer, factor)

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
            load: _reverse_tangential(load, cell_loads if transfer is None else transfer.to_counterbody @ cell_loads)
            for load, cell_loads in loads.items()
        }
        displacements = self.body.compute_displacements(loads, directions)
        for direction, values in self._counterbody.compute_displacements(reaction, directions).items():
            counter_displacement = values if transfer is None else transfer.to_body @ values
            displacements[direction] = displacements[direction] + _reverse_tangential(direction, counter_displacement)
        return displacements

    def _displacements_of_equal_bodies(
        self, loads: Mapping[Load, FloatArray], directions: Sequence[Load]
    ) -> dict[Load, FloatArray]:
        """Relative displacements of equal bodies: none tangentially under a pressure, none normally under tractions."""
        displacements = {direction: np.zeros(self.body.grid.shape) for direction in directions}
        for is_normal in (True, False):
            acting_loads = {load: values for load, values in loads.items() if (load is Load.NORMAL) == is_normal}
            components = [direction for direction in directions if (direction is Load.NORMAL) == is_normal]
            if acting_loads and components:
                for direction, displacement in self.body.compute_displacements(acting_loads, components).items():
                    displacements[direction] = self._factor * displacement
        return displacements

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Approximate pressure that closes the gap."""
        return self.body.precondition(gap) / self._factor

    @property
    def has_paired_cells(self) -> bool:
        """Whether the counterbody's cells can be joined in pairs."""
        return self._counterbody is None or self._counterbody.grid.cells_x % 2 == 0

    @cached_property
    def coarse(self) -> PairOperator:
        """Approximate operator on cells of twice the size; without pairs of cells a multiple of the first body's."""
        if self._counterbody is None or not self.has_paired_cells:
            return PairOperator(self.body.coarse, None, None, self._factor)
        transfer = self._transfer and CellTransfer(
            2 * cell_means(self._transfer.to_counterbody), 2 * cell_means(self._transfer.to_body)
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
        """Operator of the body on cells of twice the size, for an initial guess."""
        return self.body.coarse
