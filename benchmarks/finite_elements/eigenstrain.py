"""Residual stress of eigenstrains on cells by finite elements: the harmonic body at wavenumber 0 along y."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from skfem import LinearForm  # type: ignore[import-untyped]

from benchmarks.finite_elements.harmonics import HarmonicBody, Line

Array = NDArray[np.float64]
ORDER, SMALLEST = 5, 0.02  # order of the elements, and width of the elements at the borders of the rectangle


def make_graded_nodes(points: Array, smallest: float, largest: float) -> Array:
    """Element edges that pass through the points, with small elements at each point."""
    edges = [points[:1]]
    for low, high in pairwise(points):
        half_length, steps, width = 0.5 * (high - low), [0.0], smallest
        while steps[-1] + width < half_length:
            steps.append(steps[-1] + width)
            width = min(2.0 * width, largest)
        inner = np.array(steps[1:])
        edges.append(np.concatenate([low + inner, [low + half_length], high - inner[::-1], [high]]))
    return np.concatenate(edges)


def _compute_slope(line: Line, g: Callable[[Array], Array]) -> Array:
    """Integrals of `g` times each shape function's derivative."""
    return np.asarray(LinearForm(lambda v, w: g(w.x[0]) * v.grad[0]).assemble(line.basis))


def compute_residual_stress(
    length: float,
    rectangle: tuple[tuple[float, float], tuple[float, float]],
    eigenstrain: Array,
    poisson: float,
    x: Array,
    z: Array,
) -> Array:
    """Stresses (6, x, z) over the shear modulus of eigenstrains (xx, yy, zz, xy, xz, yz) in one rectangle."""
    (x_low, x_high), (z_low, z_high) = rectangle
    across = Line(edges=make_graded_nodes(np.unique([0.0, x_low, x_high, length]), SMALLEST, 0.3 * length), order=ORDER)
    depth = make_graded_nodes(np.unique([0.0, z_low, z_high, 2 * length]), SMALLEST, 0.5 * length)
    depth_line = Line(edges=np.append(depth, 2 * length * np.array([1.5, 2, 3, 4, 6])), order=ORDER)
    body = HarmonicBody(across, depth_line, poisson)
    lam = 2 * poisson / (1 - 2 * poisson)
    e_xx, e_yy, e_zz, e_xy, e_xz, e_yz = eigenstrain
    trace = lam * (e_xx + e_yy + e_zz)
    eigenstress = np.array([2 * e_xx + trace, 2 * e_yy + trace, 2 * e_zz + trace, 2 * e_xy, 2 * e_xz, 2 * e_yz])

    def indicator(low: float, high: float) -> Callable[[Array], Array]:
        return lambda points: ((points > low) & (points < high)).astype(float)

    in_x, in_z = indicator(x_low, x_high), indicator(z_low, z_high)
    (value_x, slope_x), (value_z, slope_z) = (
        (line.load(g), _compute_slope(line, g)) for line, g in ((across, in_x), (depth_line, in_z))
    )
    generalised_force = np.stack(
        [
            eigenstress[0] * np.outer(slope_x, value_z) + eigenstress[4] * np.outer(value_x, slope_z),
            eigenstress[3] * np.outer(slope_x, value_z) + eigenstress[5] * np.outer(value_x, slope_z),
            eigenstress[2] * np.outer(value_x, slope_z) + eigenstress[4] * np.outer(slope_x, value_z),
        ]
    )
    displacement = body.displacements(generalised_force[None])
    in_rectangle = in_x(x)[:, None] * in_z(z)
    return body.stresses(0.0, displacement, x, z)[0] - eigenstress[:, None, None] * in_rectangle
