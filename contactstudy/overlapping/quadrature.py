"""Quadratures over wavenumbers: Gauss-Legendre's on panels, and the trapezoidal rule over their logarithm.

Integrands along axial and depth wavenumbers are smooth over their logarithm ``u``: the nearest poles lie at the angle
`Resolution.angle` from the path. The trapezoidal rule of step h over u has the error ``exp(-2 pi angle / h)``, with
half the nodes of Gauss's rule on growing panels (L. N. Trefethen and J. A. C. Weideman, SIAM Review 56 (2014) 385).
Displacements of the free ends vary on the scale of the distance from the end: panels double away from the end.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from contactstudy import checks
from contactstudy.arrays.peaks import lagrange_weights
from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.kernels.load import Load


@lru_cache(maxsize=32)
def _gauss_nodes(order: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights on [-1, 1], read-only: all threads share them."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    nodes.flags.writeable = weights.flags.writeable = False
    return nodes, weights


def panel_nodes(edges: FloatArray, order: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights of composite Gauss-Legendre quadrature on the panels between `edges`."""
    nodes, weights = _gauss_nodes(order)
    half_widths = 0.5 * np.diff(edges)[:, None]
    midpoints = 0.5 * (edges[1:] + edges[:-1])[:, None]
    return (midpoints + half_widths * nodes).ravel(), (half_widths * weights).ravel()


AXIAL_STEP, AXIAL_REACH = 0.16, 1000.0
"""Largest step and least reach under loads along x. Accuracy: where such loads bend the body, H and V grow and cancel;
on a corner the normal stress of these loads on the end is singular."""

START_FACTOR, MIN_LOGARITHM = 0.3, -2.8
"""Wavenumber about which the nodes begin to thin out towards 0, over the smallest scale, and the least ``u``.
Accuracy: below it lies 1e-7 of that scale."""


@dataclass(frozen=True, kw_only=True)
class Resolution:
    """Settings of the quadratures behind the equivalent loads; the defaults leave errors below 2e-5 of a load.

    Reaches refer to the smallest distance of a position from a loaded corner.

    Parameters
    ----------
    step : float
        Step of axial and depth wavenumbers over their logarithm.
    angle : float
        Angle of the rays to the real axis, radians. Axial and depth wavenumbers are turned by the same angle; twice
        the angle must stay well below pi/2, where ``k_x**2 + k_y**2 + k_z**2`` would vanish.
    reach : float
        Largest axial and depth wavenumber, times the smallest distance from a loaded corner.
    ray_reach : float
        As `reach`, on the ray of depth wavenumbers, where the loads are evaluated.
    modes : int
        Axial modes that are summed one by one.
    lateral_nodes : int
        Equation sets per panel of wavenumbers along y.
    lateral_ratio : float
        Growth of these panels, whose nodes are Gauss's over the logarithm.
    lateral_order : int
        Gauss nodes per panel of the finer wavenumbers along y, which follow the load's phase.
    lateral_reach : float
        Largest wavenumber along y, times the smallest distance from a loaded corner.

    Raises
    ------
    InvalidInputError
        If a setting is out of range.
    """

    step: float = 0.22
    angle: float = np.pi / 6
    reach: float = 200.0
    ray_reach: float = 50.0
    modes: int = 8
    lateral_nodes: int = 7
    lateral_ratio: float = 5.5
    lateral_order: int = 16
    lateral_reach: float = 10.0

    def __post_init__(self) -> None:
        for name in ("modes", "lateral_nodes", "lateral_order"):
            checks.count(name, getattr(self, name), minimum=2)
        for name in ("reach", "ray_reach", "lateral_reach"):
            checks.positive(name, getattr(self, name))
        if not 0 < self.step <= 1:
            raise InvalidInputError("step", self.step, "more than 0 and at most 1")
        if not self.lateral_ratio > 1:
            raise InvalidInputError("lateral_ratio", self.lateral_ratio, "more than 1: the panels grow")
        if not 0 < self.angle < np.pi / 4:
            raise InvalidInputError("angle", self.angle, "between 0 and pi/4, where k_x^2 + k_y^2 + k_z^2 vanishes")

    def for_loads(self, loads: Iterable[Load]) -> Resolution:
        """Return settings that resolve loads in some directions as well as the present settings resolve a pressure."""
        if Load.ALONG_X not in loads:
            return self
        return replace(self, step=min(self.step, AXIAL_STEP), reach=max(self.reach, AXIAL_REACH))


def scale_nodes(first: float, last: float, step: float) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights from 0 to about `last`, for integrands smooth over the logarithm from `first` on."""
    # The trapezoidal rule runs over ``u`` with ``k = start exp(u - exp(-u))``: k falls to 0 doubly exponentially.
    start = START_FACTOR * first
    lowest, highest = int(np.floor(MIN_LOGARITHM / step)), int(np.ceil(np.log(last / start) / step))
    u = step * np.arange(lowest, highest + 1.0)
    nodes = start * np.exp(u - np.exp(-u))
    return nodes, step * nodes * (1 + np.exp(-u))


def ray_nodes(first: float, last: float, resolution: Resolution) -> tuple[ComplexArray, ComplexArray]:
    """Nodes and weights along the ray from 0 at the resolution's angle, of scales from `first` to `last`."""
    nodes, weights = scale_nodes(first, last, resolution.step)
    rotation = np.exp(1j * resolution.angle)
    return nodes * rotation, weights * rotation


POSITIONS_PER_PANEL = 8  # Gauss positions per panel along x. Accuracy.


def graded_positions(stop: float, finest: float) -> tuple[FloatArray, FloatArray]:
    """Edges of panels from 0 to `stop` that double from `finest`, and the Gauss positions in them."""
    panels = max(1, int(np.ceil(np.log2(stop / finest) - 1e-9)))
    edges = np.append(0.0, stop / 2.0**panels * 2.0 ** np.arange(panels + 1))
    return edges, panel_nodes(edges, POSITIONS_PER_PANEL)[0]


def cell_moments(edges: FloatArray, positions: FloatArray, cell_edges: FloatArray) -> FloatArray:
    """Integrals over each cell of the Lagrange polynomials on each panel's positions: array (position, cell)."""
    order = positions.size // (edges.size - 1)
    moments = np.zeros((positions.size, cell_edges.size - 1))
    break_points = np.union1d(edges, np.clip(cell_edges, edges[0], edges[-1]))
    points, weights = panel_nodes(break_points, order)
    midpoints = np.repeat(0.5 * (break_points[1:] + break_points[:-1]), order)
    panel = np.clip(np.searchsorted(edges, midpoints) - 1, 0, edges.size - 2)
    cell = np.searchsorted(cell_edges, midpoints) - 1
    for index in range(edges.size - 1):
        is_inside = (panel == index) & (cell >= 0) & (cell < moments.shape[1])
        nodes = slice(index * order, (index + 1) * order)
        point_moments = weights[is_inside, None] * lagrange_weights(positions[nodes], points[is_inside])
        np.add.at(moments[nodes].T, cell[is_inside], point_moments)
    return moments


def graded_interpolation(x: FloatArray, length: float) -> tuple[FloatArray, FloatArray] | None:
    """Few positions graded towards the ends, and the matrix that interpolates from them to many positions `x`."""
    order, half_length = POSITIONS_PER_PANEL, 0.5 * length if np.isfinite(length) else float(x.max())
    is_near_first = x <= half_length
    end_distances = np.where(is_near_first, x, length - x)
    is_off_end = end_distances > 0
    if not is_off_end.any():
        return None
    finest = float(end_distances[is_off_end].min())
    if not half_length > finest:
        return None
    panels = max(1, int(np.ceil(np.log2(half_length / finest))))
    edges = finest * (half_length / finest) ** (np.arange(panels + 1) / panels)
    positions = panel_nodes(edges, order)[0]
    count = positions.size
    end_count = 2 if np.isfinite(length) else 1
    end_indices = np.flatnonzero(~is_off_end)
    if end_count * count + end_indices.size >= x.size:
        return None
    matrix = np.zeros((x.size, end_count * count + end_indices.size))
    panel = np.clip(np.searchsorted(edges, end_distances) - 1, 0, panels - 1)
    for index in range(panels):
        nodes = slice(index * order, (index + 1) * order)
        for end, is_near_end in enumerate((is_near_first, ~is_near_first)[:end_count]):
            points = np.flatnonzero(is_off_end & is_near_end & (panel == index))
            matrix[points, end * count + nodes.start : end * count + nodes.stop] = lagrange_weights(
                positions[nodes], end_distances[points]
            )
    matrix[end_indices, end_count * count + np.arange(end_indices.size)] = 1.0
    all_positions = [positions, length - positions] if end_count == 2 else [positions]
    return np.concatenate([*all_positions, x[end_indices]]), matrix
