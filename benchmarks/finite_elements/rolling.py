"""Steady rolling of two like bodies between free ends, on the flexibility of the finite elements.

Traction and pressure are uniform on columns along x and on strips along y. For each wavenumber along y the finite
elements give the mean displacement of each column under each; its integral over the wavenumber is the displacement of
strips. Bodies and motion are even about mid-length: pressure and the traction along y are even, the traction along x is
odd, so the tractions of one half of the columns are unknown.

Rolling begins at rest and advances strip by strip. In every step the material of a strip comes from the strip ahead,
and the tractions q minimise

    q A q - 2 q A q_before    for    |q| <= f p    in every cell and a prescribed sum of the q along y,

with the flexibility A of one body and the tractions one strip ahead and one step earlier: a convex program over cones.
Its multiplier of the sum is the rigid slip of the step, the creepage. The program shares no code with the solver. The
slip is a difference between neighbouring strips, so the error of the creepage is of first order in their width.
"""

from __future__ import annotations

from dataclasses import dataclass

import clarabel
import numpy as np
import scipy.sparse as sp
from numpy.polynomial import legendre
from numpy.typing import NDArray

from benchmarks.finite_elements.contact import complementarity
from benchmarks.finite_elements.harmonics import HarmonicBody, Line
from benchmarks.finite_elements.superpose import Resolution

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class ColumnFlexibility:
    """Mean displacement of columns with their mirror images, in units where `2 G` is 1: `[k, displaced, loaded]`.

    `x` is odd about mid-length, `y` and `z` are even, as their tractions; `cross` is the displacement along x under
    tractions along y, the factor of `sin`.
    """

    edges: Array
    z: Array
    x: Array
    y: Array
    cross: Array
    k: Array
    poisson: float
    resolution: Resolution


def compute_flexibility(length: float, columns: int, poisson: float, resolution: Resolution) -> ColumnFlexibility:
    """Solve for every wavenumber on an even number of columns; the body is cut where a panel's load has decayed."""
    edges = np.linspace(0.0, length, columns + 1)
    nodes_x = resolution.make_mesh_x(length)
    nodes_x = nodes_x[nodes_x < 0.9 * edges[1]]
    x = Line(edges=np.unique(np.concatenate([edges, nodes_x, length - nodes_x])), order=resolution.order)
    step, half_columns = edges[1], columns // 2

    def mirror_columns(start: float, mirror_sign: float) -> Array:
        """Force 1 on a column, and 1 or -1 on its mirror image."""
        unit_load, mirrored_load = (
            x.load(lambda x, column_start=column_start: 1.0 * (x > column_start) * (x < column_start + step))
            for column_start in (start, length - start - step)
        )
        return unit_load + mirror_sign * mirrored_load

    even, odd = (np.array([mirror_columns(edges[i], sign) for i in range(half_columns)]) for sign in (1.0, -1.0))
    depth, gauss_nodes = resolution.make_mesh_z(), legendre.leggauss(resolution.nodes)[0]
    flexibilities: dict[str, list[Array]] = {"z": [], "x": [], "y": [], "cross": []}
    wavenumbers = []
    for low, high in zip(resolution.panels[:-1], resolution.panels[1:], strict=True):
        depth_count = int(np.searchsorted(depth, 40 / low)) + 1 if low else depth.size
        body = HarmonicBody(x, Line(edges=depth[:depth_count], order=resolution.order), poisson)
        for k in low + 0.5 * (high - low) * (gauss_nodes + 1):
            loads = np.zeros((3, half_columns, 3, x.basis.N, body.z.basis.N))
            for component_load, component, forces, sign in zip(
                loads, (2, 0, 1), (even, odd, even), (1, 1, -1), strict=True
            ):
                component_load[:, component] = sign * forces[:, :, None] * body.top
            amplitudes = body.displacements(loads.reshape(-1, *loads.shape[2:]), float(k))
            top = 2 * (amplitudes @ body.top).reshape(3, half_columns, 3, -1)
            # The mean over a column is half the functional of the column and its mirror image.
            mean_factor = 0.5 / step
            flexibilities["z"].append(mean_factor * even @ top[0, :, 2].T)
            flexibilities["x"].append(mean_factor * odd @ top[1, :, 0].T)
            flexibilities["y"].append(-mean_factor * even @ top[2, :, 1].T)
            flexibilities["cross"].append(mean_factor * odd @ top[2, :, 0].T)
            wavenumbers.append(float(k))
    return ColumnFlexibility(
        edges=edges,
        **{name: np.array(flexibility) for name, flexibility in flexibilities.items()},
        k=np.array(wavenumbers),
        poisson=poisson,
        resolution=resolution,
    )


def integrate_wavenumbers(flexibility: ColumnFlexibility, name: str, width: float, count: int) -> Array:
    """Displacement `[offset, displaced, loaded]` in the middle of strips, `offset` strips from the loaded strip.

    Under a resultant it grows like a constant over k at small wavenumbers, the same for all columns: this part is
    integrated with `cos(k y) - 1`, which omits a displacement of the whole body.
    """
    values, is_odd, has_resultant = getattr(flexibility, name), name == "cross", name in "yz"
    resolution, n = flexibility.resolution, flexibility.resolution.nodes
    inverse_legendre = np.linalg.inv(legendre.legvander(legendre.leggauss(n)[0], n - 1))
    offsets = width * np.arange(count)
    common_response = values[:, -1, -1] if has_resultant else np.zeros(flexibility.k.size)
    total = np.zeros((count, *values.shape[1:]))
    for i, (low, high) in enumerate(zip(resolution.panels[:-1], resolution.panels[1:], strict=True)):
        nodes = slice(i * n, (i + 1) * n)
        node, weight = legendre.leggauss(24 + int(0.6 * (high - low) * offsets[-1]))
        k = low + 0.5 * (high - low) * (node + 1)
        factor = 0.5 * (high - low) * weight * width * np.sinc(k * width / (2 * np.pi)) / np.pi
        interpolate = legendre.legvander(node, n - 1) @ inverse_legendre
        waves = (np.sin if is_odd else np.cos)(np.outer(offsets, k))
        total += np.tensordot(waves * factor @ interpolate, values[nodes] - common_response[nodes, None, None], axes=1)
        if has_resultant:
            total += ((waves - 1) / k * factor @ interpolate @ (flexibility.k[nodes] * common_response[nodes]))[
                :, None, None
            ]
    return total


@dataclass(frozen=True, kw_only=True)
class RollingSolution:
    """Steady tractions `[column, strip]` on the first half of the columns, and the largest change in the last step."""

    creepage: float
    pressure: Array
    along_x: Array
    along_y: Array
    change: float


def _make_blocks(strips: Array, count: int, *, odd: bool = False) -> Array:
    """Matrix between cells (column-major) from the offsets of strips; an odd matrix changes sign for negative
    offsets."""
    offset = np.arange(count)[:, None] - np.arange(count)
    blocks = strips[np.abs(offset)]
    if odd:
        blocks = blocks * np.sign(offset)[..., None, None]
    columns = strips.shape[1]
    return blocks.transpose(2, 0, 3, 1).reshape(columns * count, columns * count)


def solve_rolling(
    flexibility: ColumnFlexibility,
    strips: int,
    window: float,
    load: float,
    friction: float,
    force_fraction: float,
    steps: int,
) -> RollingSolution:
    """Two like bodies of plane-strain modulus 1 each, the gap y**2 / 2, rolling along +y from rest.

    The force along y is `force_fraction` times that of full sliding.
    """
    half_columns, width = flexibility.edges.size // 2, 2 * window / strips
    # 2 G = (1 - nu) E', of one body.
    flexibilities = {
        name: integrate_wavenumbers(flexibility, name, width, strips) / (1 - flexibility.poisson)
        for name in ("z", "x", "y")
    }
    normal = 2 * _make_blocks(flexibilities["z"], strips)
    y = (np.arange(strips) + 0.5) * width - window
    areas = np.full(half_columns * strips, 2 * width * flexibility.edges[1])
    pressure = complementarity(0.5 * (normal + normal.T), np.tile(0.5 * y**2, half_columns), areas, load)
    cross_flexibility = integrate_wavenumbers(flexibility, "cross", width, strips) / (1 - flexibility.poisson)
    matrix_y = _make_blocks(flexibilities["y"], strips)
    # A constant between all tractions along y displaces the whole body and makes the program convex.
    matrix_y = matrix_y - 1.01 * min(float(np.linalg.eigvalsh(matrix_y + matrix_y.T)[0]) / 2, 0.0) / areas.size
    cross_blocks = _make_blocks(cross_flexibility, strips, odd=True)
    matrix = np.block([[_make_blocks(flexibilities["x"], strips), cross_blocks], [cross_blocks.T, matrix_y]])
    matrix = 0.5 * (matrix + matrix.T)
    loaded_cells = np.flatnonzero(pressure > 0)
    count, unknown_indices = loaded_cells.size, np.concatenate([loaded_cells, areas.size + loaded_cells])
    force = force_fraction * friction * pressure.sum()
    # The sum of the q along y, then (f p, q_x, q_y) cell by cell in a cone.
    indices = np.arange(count)
    rows = np.concatenate([np.zeros(count, int), 3 * indices + 2, 3 * indices + 3])
    columns = np.concatenate([count + indices, indices, count + indices])
    values = np.concatenate([np.ones(count), -np.ones(2 * count)])
    constraints = sp.csc_matrix((values, (rows, columns)), (1 + 3 * count, 2 * count))
    limits = np.zeros(1 + 3 * count)
    limits[0], limits[1::3] = force, friction * pressure[loaded_cells]
    cones = [clarabel.ZeroConeT(1), *[clarabel.SecondOrderConeT(3)] * count]
    upper_triangle = sp.csc_matrix(np.triu(2 * matrix[np.ix_(unknown_indices, unknown_indices)]))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    traction, change, creepage = np.zeros((2, half_columns, strips)), np.inf, np.nan
    for _ in range(steps):
        traction_ahead = np.zeros_like(traction)
        traction_ahead[:, :, :-1] = traction[:, :, 1:]
        surface_shift = 2 * matrix @ traction_ahead.ravel()
        solution = clarabel.DefaultSolver(
            upper_triangle, -surface_shift[unknown_indices], constraints, limits, cones, settings=settings
        ).solve()
        forces = np.zeros(2 * areas.size)
        forces[unknown_indices] = solution.x
        change = float(np.abs(forces - traction.ravel()).max() / (friction * pressure.max()))
        traction, creepage = forces.reshape(traction.shape), -solution.z[0] / width
    return RollingSolution(
        creepage=creepage,
        pressure=pressure.reshape(half_columns, -1),
        along_x=traction[0],
        along_y=traction[1],
        change=change,
    )
