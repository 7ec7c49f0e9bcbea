"""The overlapping method as linear operators between the cells of the top, the modes of H and the faces of V.

A *band* is one equation set: a node of the wavenumber along y in one set of axial modes. Every operator is block
diagonal over the bands; within a band it is a real matrix along x and z, equal at all positions y. Vectors:

* cells: load per area on the cells of the grid, (x, y);
* modes: per band the weighted spectrum of a load on H on the ends, real parts before imaginary parts, (wavenumber, y);
* faces: per band the normal stress that V removes from the ends, at the depth wavenumbers, (wavenumber, y).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse.linalg import LinearOperator

from contactstudy.arrays.grid import Points
from contactstudy.checks import FloatArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.equations import EquationSet
from contactstudy.overlapping.problem import EndProblem, LateralColumns, View, make_views
from contactstudy.threads import one_blas_thread


@dataclass(frozen=True, eq=False)
class Band:
    """One equation set."""

    system: EquationSet  # equation set at the node
    view: View  # unit loads on the cells along x in the axial modes
    filters: dict[int, FloatArray]  # (cell_y, y): from loads even (1) or odd (-1) along y to the node's field at y


def stack_real_and_imaginary(columns: Any) -> FloatArray:
    """Real matrix to modes, from a complex matrix with wavenumbers as rows: real parts before imaginary parts."""
    return np.concatenate([np.real(columns), np.imag(columns)])


def real_part_matrix(rows: Any) -> FloatArray:
    """Real matrix from modes to the real part of their product with `rows`, whose columns are wavenumbers."""
    return np.concatenate([np.real(rows), -np.imag(rows)], axis=1)


class BandOperator(LinearOperator):  # type: ignore[misc]
    """Block diagonal operator: per band a real matrix (row, column) times an array (column, y) of `count` positions."""

    def __init__(self, matrices: Sequence[Any], count: int) -> None:
        self.matrices, self.count = matrices, count
        super().__init__(np.float64, tuple(count * sum(matrix.shape[axis] for matrix in matrices) for axis in (0, 1)))

    def _matvec(self, vector: FloatArray) -> FloatArray:
        blocks = _split_by_band(vector, [matrix.shape[1] for matrix in self.matrices], self.count)
        return np.concatenate([(matrix @ block).ravel() for matrix, block in zip(self.matrices, blocks, strict=True)])

    def _rmatvec(self, vector: FloatArray) -> FloatArray:
        blocks = _split_by_band(vector, [matrix.shape[0] for matrix in self.matrices], self.count)
        return np.concatenate([(matrix.T @ block).ravel() for matrix, block in zip(self.matrices, blocks, strict=True)])


def solution_matrix(system: EquationSet) -> LinearOperator:
    """Operator that solves an equation set: from the stress of the load alone on the ends to the faces."""
    scale = system.scale[:, None]

    def solve(source: FloatArray) -> FloatArray:
        return system.solve(source) / scale  # eq. (27)

    def solve_transposed(faces: FloatArray) -> FloatArray:
        return system.solve(faces / scale, transposed=True)

    return LinearOperator(
        (scale.size, scale.size),
        matvec=solve,
        rmatvec=solve_transposed,
        matmat=solve,
        rmatmat=solve_transposed,
        dtype=np.float64,
    )


class SumOperator(LinearOperator):  # type: ignore[misc]
    """Values (position, y): the sum over the bands of a real matrix times an array (row, y), with filters along y."""

    def __init__(
        self,
        matrices: Sequence[FloatArray],
        count: int,
        *,
        filters: Sequence[FloatArray] | None = None,
        y_first: bool = False,
    ) -> None:
        # Without filters the values have the positions y of the arrays; with `y_first` they are (y, position).
        self.matrices, self.count, self._y_first = matrices, count, y_first
        self.filters = [None] * len(matrices) if filters is None else filters
        self._values_y = count if filters is None else filters[0].shape[1]
        columns = sum(matrix.shape[1] for matrix in matrices)
        super().__init__(np.float64, (self._values_y * matrices[0].shape[0], count * columns))

    def _matvec(self, vector: FloatArray) -> FloatArray:
        blocks = _split_by_band(vector, [matrix.shape[1] for matrix in self.matrices], self.count)
        total = np.zeros((self.matrices[0].shape[0], self._values_y))
        for matrix, filter_y, block in zip(self.matrices, self.filters, blocks, strict=True):
            total += matrix @ block if filter_y is None else (matrix @ block) @ filter_y
        return np.asarray((total.T if self._y_first else total).ravel())

    def _rmatvec(self, vector: FloatArray) -> FloatArray:
        total = vector.reshape(self._values_y, -1).T if self._y_first else vector.reshape(-1, self._values_y)
        filtered = (total if filter_y is None else total @ filter_y.T for filter_y in self.filters)
        return np.concatenate(
            [(matrix.T @ block).ravel() for matrix, block in zip(self.matrices, filtered, strict=True)]
        )


def _split_by_band(vector: FloatArray, rows: Sequence[int], count: int) -> list[FloatArray]:
    """Parts (row, y) of a vector, one per band."""
    return [block.reshape(-1, count) for block in np.split(vector.ravel(), count * np.cumsum(rows)[:-1])]


class EquivalentOperators(NamedTuple):
    """Operators from a load on the cells to the equivalent loads, positive in compression."""

    top_load: LinearOperator  # to the load of V on the top of H, (x, y): ``P_h1`` less the pressure
    faces: list[LinearOperator]  # to ``P_v1`` and, with two ends, ``P_v2``: (y, z)


@dataclass(frozen=True, eq=False)
class OverlappingOperators:
    """Operators of the overlapping for loads that mirror images all keep or all reverse."""

    # Equivalent loads grow like a logarithm towards a corner, and are evaluated a fraction of a cell from it.
    # Loads that only tilt H and V against each other are relative to a reference.

    problem: EndProblem  # body, directions of the loads, grid and quadratures; the load of the problem is not used
    positions: Points  # positions of the equivalent loads: `x` and `y` on the top, `y` and depths `z` on the ends
    bands: list[Band]  # the equation sets
    reference: float | None  # distance along y at which loads without stress are zero, metres; None without such loads

    @classmethod
    def of(cls, problem: EndProblem, positions: Points, reference: float | None) -> OverlappingOperators:
        """Operators of a problem."""
        offset, length = problem.corner_offset, problem.length
        x, y, z = positions
        x = np.where(problem.from_end(x) < offset, np.where(x < offset, offset, length - offset), x)
        z = np.maximum(z, offset)
        shortest = problem.smallest_scale(float(min(problem.from_end(x).min(), z.min())))
        unit_loads = np.eye(problem.grid.cells_x)[problem.cell_of_column]
        parities = np.zeros(problem.grid.cells_x, dtype=np.int64)
        bands = []
        with one_blas_thread():
            for panel in problem.panels(y, shortest, reference):
                columns = LateralColumns(nodes=panel.nodes, along_x=unit_loads[:, None, :], parities=parities)
                even_filters, odd_filters = panel.filters(problem.grid, y)
                for view in make_views(problem, columns, shortest):
                    for node, lateral in enumerate(panel.nodes.tolist()):
                        system = EquationSet.build(view.modes, lateral, problem.poisson, shortest, problem.resolution)
                        bands.append(Band(system, view, {1: even_filters[node], -1: odd_filters[node]}))
        return cls(problem, Points(x, y, z), bands, reference)

    @cached_property
    def _shortest(self) -> float:
        return float(min(self.problem.from_end(self.positions.x).min(), self.positions.z.min()))

    def _band_operator(self, matrix: Callable[[Band], Any]) -> BandOperator:
        return BandOperator([matrix(band) for band in self.bands], self.positions.y.size)

    def modes(self, load: Load) -> LinearOperator:
        """Return the operator from a load on the cells to modes, eqs. (6) and (7)."""
        matrices = {
            id(view): stack_real_and_imaginary(view.spectra[:, 0])
            for view in {id(b.view): b.view for b in self.bands}.values()
        }
        return SumOperator(
            [matrices[id(band.view)].T for band in self.bands],
            self.positions.y.size,
            filters=[band.filters[load.sign_y].T for band in self.bands],
        ).T

    def to_faces(self, load: Load) -> LinearOperator:
        """Return the operator from modes of a load on H to the reversed normal stress of the load on the ends."""
        return self._band_operator(lambda band: real_part_matrix(band.system.load_to_faces(load)))

    @cached_property
    def to_top(self) -> LinearOperator:
        """Operator from faces to the modes of the load of V on the top of H."""
        return self._band_operator(
            # eq. (26a)
            lambda band: stack_real_and_imaginary(band.view.modes.on_end[:, None] * band.system.top * band.system.scale)
        )

    @cached_property
    def solution(self) -> LinearOperator:
        """Operator from the stress of the loads alone on the ends to the faces: the sum of all rounds of iteration."""
        return self._band_operator(lambda band: solution_matrix(band.system))

    @cached_property
    def top_values(self) -> LinearOperator:
        """Operator from faces to the load of V on the top of H at the positions (x, y), eqs. (4) and (6)."""

        def matrix(band: Band) -> FloatArray:
            values = np.zeros((self.positions.x.size, band.system.depth.size))
            rows, distance = band.view.positions(self.positions.x)
            values[rows] = np.real(band.view.modes.cosine(distance).T @ band.system.top) * band.system.scale
            return values

        return SumOperator([matrix(band) for band in self.bands], self.positions.y.size)

    def face_values(self, load: Load, end: int) -> LinearOperator:
        """Return the operator from modes of a load to the equivalent load on the face of end I (0) or II, (y, z)."""
        matrices = [self._face_matrix(band, load, end) for band in self.bands]
        return SumOperator(matrices, self.positions.y.size, y_first=True)

    def _face_matrix(self, band: Band, load: Load, end: int) -> FloatArray:
        """Matrix from the modes of a band to the equivalent load on one face at the depths."""
        modes, system = band.view.modes, band.system
        depth, weights = system.ray_nodes(self._shortest, self.problem.resolution)
        mode_matrix, conjugate_matrix = system.ray_to_faces(load, depth)
        waves = np.exp(1j * np.outer(self.positions.z, depth))  # eq. (8)
        waves = waves * weights * modes.load_on_face(np.sqrt(depth**2 + system.lateral**2))
        # The second end's load follows from the first's by parity; separate ends have a view each.
        sign = modes.parity**end if modes.parity else int(bool(band.view.end) == bool(end))
        return -sign * real_part_matrix(waves @ mode_matrix + np.conj(waves @ conjugate_matrix))

    def equivalent(self, load: Load) -> EquivalentOperators:
        """Return the operators from a load on the cells to the equivalent loads, without iteration."""
        modes = self.modes(load)
        faces = self.solution @ self.to_faces(load) @ modes  # eqs. (3) and (4)
        face_operators = [
            self.face_values(Load.NORMAL, end) @ self.to_top @ faces + self.face_values(load, end) @ modes
            for end in range(1 if np.isinf(self.problem.length) else 2)
        ]
        return EquivalentOperators(self.top_values @ faces, face_operators)
