"""Reynolds' equation on cells: residual and derivatives, in finite volumes.

Lengths are in Hertz half-widths a, heights in a**2 / R, pressures in p0; the surfaces move along +y.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy  # imports the interpolation, which is slow to import, on first use
from scipy import sparse

from contactstudy.arrays.peaks import lagrange_weights
from contactstudy.bodies.lubricant import Lubricant
from contactstudy.checks import FloatArray

FLUIDITY_NODES, FLUIDITY_RATIO = 1600, 1.005  # Fluidity's table: pressures, ratio of successive steps. Accuracy.
FACE_RANGE = (0.2, 2.0)  # Range of the film on a face over the film upstream, since parabolas overshoot. Accuracy.


class Law(NamedTuple):
    """Values of a law and their derivatives."""

    value: FloatArray
    slope: FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Fluid:
    """Dimensionless laws of a lubricant."""

    density: Callable[[FloatArray], Law]  # over the ambient density, at a pressure
    reduced_pressure: Callable[[FloatArray], Law]  # integral of density over viscosity, both over ambient, by pressure
    flow_number: float  # ``12 eta0 um R**2 / (a**3 p0)``

    @classmethod
    def of(cls, oil: Lubricant, p0: float, flow_number: float) -> Fluid:
        """Laws of a lubricant for pressures over `p0`, Pa."""

        def density(pressure: FloatArray) -> Law:
            return Law(oil.density_ratio(p0 * pressure), p0 * oil.density_ratio_slope(p0 * pressure))

        steps = np.asarray(FLUIDITY_RATIO ** np.arange(FLUIDITY_NODES) - 1, dtype=np.float64)
        node_pressures = steps / (1 + p0 * oil.pressure_viscosity)
        values = oil.density_ratio(p0 * node_pressures) / (oil.viscosity_at(p0 * node_pressures) / oil.viscosity)
        fluidity = scipy.interpolate.PchipInterpolator(node_pressures, values)
        integral = fluidity.antiderivative()

        def reduced_pressure(pressure: FloatArray) -> Law:
            viscous_pressure = np.clip(pressure, 0.0, node_pressures[-1])
            return Law(np.minimum(pressure, 0.0) + integral(viscous_pressure), fluidity(viscous_pressure))

        return cls(density=density, reduced_pressure=reduced_pressure, flow_number=flow_number)


class Flow(NamedTuple):
    """Flow through faces, or net outflow of cells per width along x, and its derivatives."""

    flow: FloatArray
    pressure_jacobian: sparse.csr_array  # (face or cell, cell): derivatives at a fixed film
    film_jacobian: sparse.csr_array  # derivatives at a fixed pressure


def scale_rows(factors: FloatArray, matrix: sparse.csr_array) -> sparse.csr_array:
    """Product of a diagonal and a matrix, several times as fast as the product of two sparse matrices."""
    product = matrix.copy()
    product.data *= np.repeat(factors, np.diff(matrix.indptr))
    return product


def scale_columns(matrix: sparse.csr_array, factors: FloatArray) -> sparse.csr_array:
    """Product of a matrix and a diagonal."""
    product = matrix.copy()
    product.data *= factors[matrix.indices]
    return product


def graded_edges(start: float, stop: float, cell_width: Callable[[float], float]) -> FloatArray:
    """Edges from `start` to `stop` of cells about as wide as `cell_width` at their midpoint.

    Examples
    --------
    >>> graded_edges(0.0, 1.0, lambda x: 0.25).tolist()
    [0.0, 0.25, 0.5, 0.75, 1.0]
    """
    # The integral of 1 / cell_width is equal over all cells.
    points = [start]
    while points[-1] < stop:
        points.append(points[-1] + 0.1 * cell_width(points[-1]))
    positions = np.minimum(np.array(points), stop)
    midpoints = 0.5 * (positions[1:] + positions[:-1])
    cell_numbers = np.concatenate([[0.0], np.cumsum(np.diff(positions) / [cell_width(x) for x in midpoints])])
    cell_count = max(2, int(np.ceil(cell_numbers[-1] - 1e-9)))
    edges = np.interp(np.linspace(0.0, cell_numbers[-1], cell_count + 1), cell_numbers, positions)
    edges[0], edges[-1] = start, stop
    return np.asarray(edges)


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
        matrices = _difference_matrices(self.y_edges, self.y, closed=False)
        return Faces(*(sparse.csr_array(sparse.kron(rows, matrix)) for matrix in matrices))

    @cached_property
    def faces_x(self) -> Faces:
        """Faces between neighbours along x."""
        columns = sparse.eye_array(self.shape[1])
        *matrices, outflow = _difference_matrices(self.x_edges, self.x, closed=not self.open_ends)
        per_width = sparse.diags_array(1 / self.widths) @ outflow
        factors = [*((matrix, columns) for matrix in matrices), (per_width, sparse.diags_array(self.lengths))]
        return Faces(*(sparse.csr_array(sparse.kron(along_x, along_y)) for along_x, along_y in factors))

    @cached_property
    def parabolas(self) -> sparse.csr_array:
        """Matrix (face, cell): values on the faces along y, by parabolas through two cells upstream, one downstream."""
        cell_count = self.y.size
        matrix = np.zeros((cell_count + 1, cell_count))
        for face, position in enumerate(self.y_edges):
            stencil = np.arange(max(face - 2, 0), min(face + 1, cell_count)) if face else np.arange(min(2, cell_count))
            matrix[face, stencil] = lagrange_weights(self.y[stencil], np.array([position]))[0]
        return sparse.csr_array(sparse.kron(sparse.eye_array(self.shape[0]), matrix))

    def upwind(self, height: FloatArray) -> sparse.csr_array:
        """Film on the faces by parabolas, bounded to stay positive where the film varies much: (face, cell)."""
        upstream = self.faces_y.upstream
        face_film, (min_film, max_film) = self.parabolas @ height, np.multiply.outer(FACE_RANGE, upstream @ height)
        bounds = np.select([face_film < min_film, face_film > max_film], FACE_RANGE)
        return scale_rows(np.where(bounds > 0, 0.0, 1.0), self.parabolas) + scale_rows(bounds, upstream)

    def face_flows(self, fluid: Fluid, pressure: FloatArray, film: FloatArray) -> tuple[Flow, Flow]:
        """Flows through the faces along y and along x, from fluid pressure and mean height (x, y)."""
        height, pressure = film.ravel(), pressure.ravel()
        density, reduced = fluid.density(pressure), fluid.reduced_pressure(pressure)
        upwind = self.upwind(height)
        couette_flow = Flow(
            upwind @ (density.value * height),
            scale_columns(upwind, density.slope * height),
            scale_columns(upwind, density.value),
        )
        poiseuille_y, poiseuille_x = (
            faces.conduct_flow(fluid.flow_number, reduced, height) for faces in (self.faces_y, self.faces_x)
        )
        flows_y = zip(couette_flow, poiseuille_y, strict=True)
        return Flow(*(couette + poiseuille for couette, poiseuille in flows_y)), poiseuille_x

    def cell_flows(
        self, fluid: Fluid, pressure: FloatArray, film: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Flows along x and y at the centres (x, y) per width, and those out of both end faces."""
        columns, cell_count = self.shape
        flows_y, flows_x = (flow.flow for flow in self.face_flows(fluid, pressure, film))
        flows_y, flows_x = flows_y.reshape(columns, -1), flows_x.reshape(-1, cell_count)
        end_flows = flows_x[[0, -1]] @ self.lengths * [-1.0, 1.0]
        return 0.5 * (flows_x[1:] + flows_x[:-1]), 0.5 * (flows_y[:, 1:] + flows_y[:, :-1]), end_flows

    def flow(self, fluid: Fluid, pressure: FloatArray, film: Law) -> Flow:
        """Net outflow of each cell, eq. (401), from fluid pressure and mean height (x, y) by the surfaces' distance."""
        outflow, pressure_jacobian, film_jacobian = (
            self.faces_y.outflow @ flow_y + self.faces_x.outflow @ flow_x
            for flow_y, flow_x in zip(*self.face_flows(fluid, pressure, film.value), strict=True)
        )
        return Flow(outflow, pressure_jacobian, scale_columns(film_jacobian, film.slope.ravel()))


@dataclass(frozen=True, eq=False)
class Faces:
    """Faces along one axis: matrices (face, cell)."""

    upstream: sparse.csr_array  # selection of the cells upstream
    downstream: sparse.csr_array  # and downstream: the same cell at the outermost faces
    gradient: sparse.csr_array  # beyond the outermost faces the pressure is ambient
    outflow: sparse.csr_array  # (cell, face): net outflow of the cells per flow through the faces

    def conduct_flow(self, flow_number: float, reduced_pressure: Law, height: FloatArray) -> Flow:
        """Flow that the reduced pressure's gradient drives, eq. (402); it rises with the pressure difference."""
        # The flow is constant between two centres, and the film linear: the thinner film determines the flow.
        upstream, downstream = self.upstream @ height, self.downstream @ height
        factor = -2 * (upstream * downstream) ** 2 / (upstream + downstream) / flow_number
        slopes = self.gradient @ reduced_pressure.value
        pressure_jacobian = scale_columns(scale_rows(factor, self.gradient), reduced_pressure.slope)
        upstream_jacobian, downstream_jacobian = (
            scale_rows(factor * slopes * (2 / film - 1 / (upstream + downstream)), selection)
            for film, selection in ((upstream, self.upstream), (downstream, self.downstream))
        )
        return Flow(factor * slopes, pressure_jacobian, upstream_jacobian + downstream_jacobian)


def _difference_matrices(edges: FloatArray, centres: FloatArray, *, closed: bool) -> tuple[sparse.sparray, ...]:
    """Matrices of `Faces` for a row of cells; outermost gradients lead to a value of zero or, if `closed`, are zero."""
    count = centres.size
    identity = sparse.eye_array(count, format="csr")
    upstream, downstream = sparse.vstack([identity[:1], identity]), sparse.vstack([identity, identity[-1:]])
    differences = sparse.diags_array([-1.0, 1.0], offsets=[-1, 0], shape=(count + 1, count))
    inverse_steps = 1 / np.diff(np.concatenate([edges[:1], centres, edges[-1:]]))
    if closed:
        inverse_steps[[0, -1]] = 0.0
    return upstream, downstream, sparse.diags_array(inverse_steps) @ differences, -differences.T
