"""Reynolds' equation on cells: residual and derivatives, in finite volumes.

Lengths are in Hertz half-widths a, heights in a**2 / R, pressures in p0; the surfaces move along +y.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.interpolate import PchipInterpolator

from contactstudy.bodies.lubricant import Lubricant
from contactstudy.checks import FloatArray

FLUIDITY_NODES, FLUIDITY_RATIO = 1600, 1.005  # Pressures of the fluidity's table, ratio of successive steps. Accuracy
FACE_RANGE = (0.2, 2.0)  # Range of the film on a face over the film upstream, since parabolas overshoot. Accuracy


class Law(NamedTuple):
    """Values of a law and their derivatives."""

    value: FloatArray
    slope: FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Fluid:
    """Dimensionless laws of a lubricant."""

    density: Callable[[FloatArray], Law]  # over the ambient density, at a pressure
    reduced_pressure: Callable[
        [FloatArray], Law
    ]  # integral of density over viscosity, both over ambient, up to a pressure
    flow_number: float  # ``12 eta0 um R**2 / (a**3 p0)``

    @classmethod
    def of(cls, oil: Lubricant, p0: float, flow_number: float) -> Fluid:
        """Laws of a lubricant for pressures over `p0`, Pa."""

        def density(pressure: FloatArray) -> Law:
            return Law(oil.density_ratio(p0 * pressure), p0 * oil.density_ratio_slope(p0 * pressure))

        steps = np.asarray(FLUIDITY_RATIO ** np.arange(FLUIDITY_NODES) - 1, dtype=np.float64)
        node_pressures = steps / (1 + p0 * oil.pressure_viscosity)
        viscosity = oil.viscosity_at(p0 * node_pressures) / oil.viscosity
        fluidity = PchipInterpolator(node_pressures, oil.density_ratio(p0 * node_pressures) / viscosity)
        integral = fluidity.antiderivative()

        def reduced_pressure(pressure: FloatArray) -> Law:
            viscous_pressure = np.clip(pressure, 0.0, node_pressures[-1])
            return Law(np.minimum(pressure, 0.0) + integral(viscous_pressure), fluidity(viscous_pressure))

        return cls(density=density, reduced_pressure=reduced_pressure, flow_number=flow_number)


class Flow(NamedTuple):
    """Net outflow of each cell per width along x, and its derivatives."""

    outflow: FloatArray  # (cell): net outflow
    by_pressure: sparse.csr_array  # (cell, cell): derivatives at a fixed film
    by_film: sparse.csr_array  # (cell, cell): derivatives at a fixed pressure
    face_flow: FloatArray  # (x, y + 1): flow along y through the faces, per width


@dataclass(frozen=True, kw_only=True, eq=False)
class FilmCells:
    """Cells of the film, their faces, and the differences between them."""

    x_edges: FloatArray  # in half-widths
    y_edges: FloatArray  # in half-widths
    open_ends: bool = True  # whether both ends along x have ambient pressure; otherwise no flow through the ends

    @cached_property
    def x(self) -> FloatArray:
        """Centres along x."""
        return np.asarray(0.5 * (self.x_edges[1:] + self.x_edges[:-1]))

    @cached_property
    def y(self) -> FloatArray:
        """Centres along y."""
        return np.asarray(0.5 * (self.y_edges[1:] + self.y_edges[:-1]))

    @cached_property
    def widths(self) -> FloatArray:
        """Widths along x."""
        return np.diff(self.x_edges)

    @cached_property
    def lengths(self) -> FloatArray:
        """Widths along y."""
        return np.diff(self.y_edges)

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of cells along x and y."""
        return self.widths.size, self.lengths.size

    @cached_property
    def areas(self) -> FloatArray:
        """Areas of the cells: array (x, y)."""
        return np.multiply.outer(self.widths, self.lengths)

    @cached_property
    def faces_y(self) -> Faces:
        """Faces between neighbours along y."""
        rows = sparse.eye_array(self.shape[0])
        matrices = (*_neighbours(self.y.size), _gradient(self.y_edges, self.y, closed=False))
        return Faces(*(sparse.csr_array(sparse.kron(rows, matrix)) for matrix in matrices))

    @cached_property
    def faces_x(self) -> Faces:
        """Faces between neighbours along x."""
        columns = sparse.eye_array(self.shape[1])
        matrices = (*_neighbours(self.x.size), _gradient(self.x_edges, self.x, closed=not self.open_ends))
        return Faces(*(sparse.csr_array(sparse.kron(matrix, columns)) for matrix in matrices))

    @cached_property
    def parabolas(self) -> sparse.csr_array:
        """Matrix (face, cell): values on the faces along y, by parabolas through two cells upstream, one downstream."""
        cell_count = self.y.size
        matrix = np.zeros((cell_count + 1, cell_count))
        for face, position in enumerate(self.y_edges):
            stencil = np.arange(max(face - 2, 0), min(face + 1, cell_count)) if face else np.arange(min(2, cell_count))
            for cell in stencil:
                neighbours = self.y[stencil[stencil != cell]]
                matrix[face, cell] = np.prod((position - neighbours) / (self.y[cell] - neighbours))
        return sparse.csr_array(sparse.kron(sparse.eye_array(self.shape[0]), matrix))

    def upwind(self, height: FloatArray) -> sparse.csr_array:
        """Film on the faces by parabolas, bounded to stay positive where the film varies much: (face, cell)."""
        upstream = self.faces_y.upstream
        face_film, min_film, max_film = (
            self.parabolas @ height,
            *(bound * (upstream @ height) for bound in FACE_RANGE),
        )
        below_bound, above_bound = face_film < min_film, face_film > max_film
        bounds = np.where(below_bound, FACE_RANGE[0], np.where(above_bound, FACE_RANGE[1], 0.0))
        unbounded = sparse.diags_array(np.where(below_bound | above_bound, 0.0, 1.0))
        return sparse.csr_array(unbounded @ self.parabolas + sparse.diags_array(bounds) @ upstream)

    @cached_property
    def outflow_y(self) -> sparse.csr_array:
        """Matrix (cell, face): net outflow of the cells per flow through the faces along y."""
        return sparse.csr_array(sparse.kron(sparse.eye_array(self.shape[0]), _outflow(self.shape[1])))

    @cached_property
    def outflow_x(self) -> sparse.csr_array:
        """Matrix (cell, face): net outflow of the cells, per width, per flow through the faces along x."""
        per_width = sparse.diags_array(1 / self.widths) @ _outflow(self.shape[0])
        return sparse.csr_array(sparse.kron(per_width, sparse.diags_array(self.lengths)))

    def flow(self, fluid: Fluid, pressure: FloatArray, film: Law) -> Flow:
        """Net outflow of each cell, eq. (401), from fluid pressure and mean height (x, y) by the surfaces' distance."""
        height, pressure = film.value.ravel(), pressure.ravel()
        density, reduced = fluid.density(pressure), fluid.reduced_pressure(pressure)
        upwind = self.upwind(height)
        pressure_flow = self.faces_y.conduct_flow(fluid.flow_number, reduced, height)
        face_flow = upwind @ (density.value * height) - pressure_flow.flow
        by_pressure = upwind @ sparse.diags_array(density.slope * height) - pressure_flow.by_pressure
        by_film = upwind @ sparse.diags_array(density.value) - pressure_flow.by_film
        outflow = self.outflow_y @ face_flow
        by_pressure, by_film = self.outflow_y @ by_pressure, self.outflow_y @ by_film
        if self.shape[0] > 1 or self.open_ends:
            axial_flow = self.faces_x.conduct_flow(fluid.flow_number, reduced, height)
            outflow = outflow - self.outflow_x @ axial_flow.flow
            by_pressure = by_pressure - self.outflow_x @ axial_flow.by_pressure
            by_film = by_film - self.outflow_x @ axial_flow.by_film
        by_film = by_film @ sparse.diags_array(film.slope.ravel())
        return Flow(
            outflow, sparse.csr_array(by_pressure), sparse.csr_array(by_film), face_flow.reshape(self.shape[0], -1)
        )


class PressureFlow(NamedTuple):
    """Flow through faces by the gradient of the pressure, with reversed sign, and its derivatives."""

    flow: FloatArray
    by_pressure: sparse.csr_array
    by_film: sparse.csr_array


@dataclass(frozen=True, eq=False)
class Faces:
    """Faces along one axis: matrices (face, cell)."""

    upstream: sparse.csr_array  # selection of the cells upstream
    downstream: sparse.csr_array  # and downstream: the same cell at the outermost faces
    gradient: sparse.csr_array  # beyond the outermost faces the pressure is ambient

    def conduct_flow(self, flow_number: float, reduced: Law, height: FloatArray) -> PressureFlow:
        """Return the flow by the gradient of the reduced pressure, eq. (402); the flow rises with any pressure step."""
        # The flow is constant between two centres, and the film linear: the thinner film determines the flow.
        upstream, downstream = self.upstream @ height, self.downstream @ height
        factor = 2 * (upstream * downstream) ** 2 / (upstream + downstream) / flow_number
        slopes = self.gradient @ reduced.value
        by_pressure = sparse.diags_array(factor) @ self.gradient @ sparse.diags_array(reduced.slope)
        by_before, by_after = (
            sparse.diags_array(factor * slopes * (2 / film - 1 / (upstream + downstream))) @ selection
            for film, selection in ((upstream, self.upstream), (downstream, self.downstream))
        )
        return PressureFlow(factor * slopes, sparse.csr_array(by_pressure), sparse.csr_array(by_before + by_after))


def _outflow(cell_count: int) -> sparse.sparray:
    """Matrix of the differences of neighbouring faces: array (cell, face)."""
    return sparse.diags_array(
        [-np.ones(cell_count), np.ones(cell_count)], offsets=[0, 1], shape=(cell_count, cell_count + 1)
    )


def _neighbours(cell_count: int) -> tuple[sparse.sparray, sparse.sparray]:
    """Cells upstream and downstream of faces; at the outermost faces both are the outermost cell: (face, cell)."""
    identity = sparse.eye_array(cell_count, format="csr")
    return sparse.vstack([identity[:1], identity]), sparse.vstack([identity, identity[-1:]])


def _gradient(edges: FloatArray, centres: FloatArray, *, closed: bool) -> sparse.sparray:
    """Gradients on the faces; at the outermost faces the value is zero, or, if `closed`, the gradient: (face, cell)."""
    cell_count = centres.size
    matrix = np.zeros((cell_count + 1, cell_count))
    for face in range(1, cell_count):
        slope = 1 / (centres[face] - centres[face - 1])
        matrix[face, face - 1 : face + 1] = -slope, slope
    if not closed:
        matrix[0, 0] = 1 / (centres[0] - edges[0])
        matrix[-1, -1] = -1 / (edges[-1] - centres[-1])
    return sparse.csr_array(matrix)
