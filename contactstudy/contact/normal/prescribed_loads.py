"""Prescribed load or approach, and the material lines of the bodies to which approach and tilt refer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.peaks import lagrange_weights
from contactstudy.bodies.models import Body
from contactstudy.cache import cached
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.problem import Resultants
from contactstudy.errors import InvalidInputError
from contactstudy.fields.displacement import normal_influence
from contactstudy.kernels.images import polynomial_count
from contactstudy.kernels.load import Load
from contactstudy.overlapping.quadrature import cell_moments, panel_nodes


class PrescribedLoad(NamedTuple):
    """Either the load, at a given position or with a given inclination, or the approach."""

    load: float | None = None  # normal load, N
    load_position: float | None = None  # position x of the load, metres; None: the shape keeps its inclination
    approach: float | None = None  # displacement of the shape from first touch, metres

    def check(self, gap: FloatArray, grid: Grid) -> PrescribedLoad:
        """Return the values as floats, or raise if they contradict each other or the initial gap (x, y)."""
        load, position, approach = self
        if (load is None) == (approach is None):
            raise InvalidInputError("load, approach", (load, approach), "exactly one of the two, the other None")
        if approach is not None:
            approach_m = checks.finite("approach", approach, "metres")
            if position is not None:
                allowed = "None where the approach is prescribed"
                raise InvalidInputError("load_position", position, allowed, "prescribe the load instead")
            if approach_m <= gap.min():
                raise InvalidInputError("approach", approach_m, f"more than the least gap, {gap.min():g} m")
            return PrescribedLoad(approach=approach_m)
        load_n = checks.positive("load", load, "N")
        if position is None:
            return PrescribedLoad(load_n)
        position_m = checks.finite("load_position", position, "metres")
        columns = grid.x[np.isfinite(gap).any(axis=1)]
        if not columns[0] < position_m < columns[-1]:
            allowed = f"under the shape, between {columns[0]:g} and {columns[-1]:g} m, where it can balance"
            raise InvalidInputError("load_position", position_m, allowed)
        return PrescribedLoad(load_n, position_m)

    @property
    def approach_or_zero(self) -> float:
        """Prescribed displacement of the shape, metres; 0 under a prescribed load."""
        return 0.0 if self.approach is None else self.approach

    def resultants(self, grid: Grid) -> Resultants:
        """Return the prescribed resultants of the pressure on the cells."""
        if self.load is None:
            return Resultants(None)
        lever = None if self.load_position is None else (grid.x[:, None] - self.load_position) / self.max_arm(grid)
        return Resultants(self.load / grid.cell_area, lever)

    def max_arm(self, grid: Grid) -> float:
        """Return the largest distance of a cell from the load, metres."""
        assert self.load_position is not None
        return float(np.abs(grid.x - self.load_position).max())


class RigidMotion(NamedTuple):
    """Displacement ``level + tilt x`` of a line along x into its body: metres and radians."""

    level: float = 0.0
    tilt: float = 0.0

    def height(self, x: FloatArray) -> FloatArray:
        """Displacement (m) at positions x (m): array (x, 1)."""
        return np.asarray(self.level + self.tilt * x[:, None])


@cached("reference lines")
def reference_line(body: Body, columns: Grid, load: Load) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Positions and weights of a quadrature along a reference line, and its displacement (point, column, cell_y)."""
    # The displacement, in metres per Pa, is smooth at the line's depth.
    low, high = np.clip(body.extent, *columns.x_range)
    x, weights = panel_nodes(np.array([low, high]), polynomial_count(0.5 * (high - low), body.depth))
    return x, weights, normal_influence(body, columns, load, x, body.depth)


@cached("distant columns")
def distant_columns(grid: Grid, depth: float) -> tuple[Grid, FloatArray]:
    """Few columns that replace the cells for fields at a depth, and the matrix (column, cell) of equivalent loads."""
    # At the depth the field is a polynomial of x: equivalent loads on columns have the moments of the loads on cells.
    low, high = grid.x_range
    count = polynomial_count(0.5 * (high - low), depth)
    if count >= grid.cells_x:
        return grid, np.eye(grid.cells_x)
    edges = low + 0.5 * (high - low) * (1 - np.cos(np.pi * np.arange(count + 1) / count))
    edges[-1] = high
    x_range = np.array(grid.x_range)
    nodes, _ = panel_nodes(x_range, count)
    column_moments, moments = (cell_moments(x_range, nodes, edges_x) for edges_x in (edges, grid.x_edges))
    return Grid.between(edges, grid.y_range, grid.cells_y), np.asarray(np.linalg.solve(column_moments, moments))


def line_motion(body: Body, grid: Grid, loads: Mapping[Load, FloatArray], position: float) -> RigidMotion:
    """Motion of a body's reference line under loads (Pa): least-squares slope, and displacement below a position."""
    if not np.isfinite(body.depth):
        return RigidMotion()
    columns, column_matrix = distant_columns(grid, body.depth)
    displacement: FloatArray = np.zeros(1)
    for load, cell_loads in loads.items():
        x, weights, influence = reference_line(body, columns, load)
        displacement = displacement + np.tensordot(influence, column_matrix @ cell_loads, axes=2)
    arm = x - np.average(x, weights=weights)
    tilt = float((weights * arm) @ displacement / ((weights * arm) @ arm))
    position_on_line = np.clip([position], *np.clip(body.extent, *grid.x_range))
    return RigidMotion(float((lagrange_weights(x, position_on_line) @ displacement)[0]) - tilt * position, tilt)


class LineMotions(NamedTuple):
    """Motions of the reference lines, each into its body: `body` of the first body, `total` the sum over both."""

    body: RigidMotion
    total: RigidMotion
