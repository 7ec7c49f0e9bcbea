"""Contact of a rigid roller on the finite-element body, as a complementarity problem.

The pressure is a product of hat functions: along x on nodes graded to where the roller or the body ends, along y on
uniform nodes. For each wavenumber along y the finite elements give the flexibility of the top between the hats along
x; the integral over the wavenumber is the flexibility between any two hats. The contact is then the convex
problem

    minimise  p A p / 2 + g p   for  p >= 0,  w p = load,

with `g` and `w` the integrals of gap and of 1 times each hat (a Galerkin form of the conditions of contact), solved
by Lawson and Hanson's active sets (`scipy.optimize.nnls`). Roller and body are even about mid-length and in y, so one
quarter of the pressure is unknown.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy import linalg, optimize

from benchmarks.finite_elements.harmonics import HarmonicBody, Line
from benchmarks.finite_elements.superpose import Resolution
from contactstudy.verification.problems import ContactCase

Array = NDArray[np.float64]
STEPS = (0.01, 0.025, 0.05, 0.085, 0.13, 0.19, 0.27, 0.38, 0.52, 0.7, 1.0)
"""Distances of nodes from an end, in half-widths."""
MAX_STEP = 0.3
"""Largest distance between nodes."""


def make_graded_nodes(start: float, stop: float) -> Array:
    """Nodes from `start` to `stop`, graded to both."""
    end_steps = np.array(STEPS)
    end_steps = end_steps[end_steps < 0.4 * (stop - start)]
    mid_length = stop - start - 2 * end_steps[-1]
    inner = np.linspace(start + end_steps[-1], stop - end_steps[-1], 2 * int(np.ceil(0.5 * mid_length / MAX_STEP)) + 1)
    return np.concatenate([[start], start + end_steps[:-1], inner, stop - end_steps[-2::-1], [stop]])


def make_mirrored_hats(nodes: Array) -> list[Callable[[Array], Array]]:
    """Hats on the first half of the nodes, each with its mirror image about mid-length."""

    def mirrored_hat(index: int) -> Callable[[Array], Array]:
        heights = np.zeros(nodes.size)
        heights[[index, nodes.size - 1 - index]] = 1.0
        return lambda x: np.interp(x, nodes, heights, left=0.0, right=0.0)

    return [mirrored_hat(index) for index in range((nodes.size + 1) // 2)]


@dataclass(frozen=True, kw_only=True)
class Flexibility:
    """Flexibility `[k, i, j]` between hats along x, in units where `2 G` is 1, and the integrals of the hats."""

    k: Array
    values: Array
    weights: Array
    nodes: Array
    resolution: Resolution


def compute_flexibility(case: ContactCase, resolution: Resolution) -> Flexibility:
    """Solve for every wavenumber; the body is cut where the load of the panel's smallest one has decayed."""
    nodes = make_graded_nodes(case.start, case.stop)
    margin = make_graded_nodes(0.0, case.start)[:-1] if case.start > 0 else np.zeros(0)
    edges = np.concatenate([margin, nodes, (case.length - margin)[::-1]])
    x = Line(edges=edges, order=resolution.order)
    hats = make_mirrored_hats(nodes)
    loads = np.array([x.load(hat) for hat in hats])
    depth = resolution.make_mesh_z()
    gauss_nodes = legendre.leggauss(resolution.nodes)[0]
    wavenumbers, matrices = [], []
    for low, high in zip(resolution.panels[:-1], resolution.panels[1:], strict=True):
        depth_count = int(np.searchsorted(depth, 40 / low)) + 1 if low else depth.size
        body = HarmonicBody(x, Line(edges=depth[:depth_count], order=resolution.order), case.poisson)
        for k in low + 0.5 * (high - low) * (gauss_nodes + 1):
            amplitudes = body.solve(float(k), [(hat, "z") for hat in hats])
            top = 2 * np.stack([u[2] @ body.top for u in amplitudes])
            flexibility_of_k = loads @ top.T
            wavenumbers.append(float(k))
            matrices.append(0.5 * (flexibility_of_k + flexibility_of_k.T))
    return Flexibility(
        k=np.array(wavenumbers),
        values=np.array(matrices),
        weights=_moments(np.ones_like, nodes),
        nodes=nodes,
        resolution=resolution,
    )


def integrate_wavenumbers(flexibility: Flexibility, step: float, count: int) -> Array:
    """Flexibility `[offset, i, j]` between hats `offset * step` apart along y, up to a constant times `w_i w_j`.

    The flexibility grows like `w_i w_j / k` at small wavenumbers: this term, taken from one pair of hats, is
    integrated with `cos(k y) - 1`, which changes the approach only.
    """
    resolution, weights = flexibility.resolution, flexibility.weights
    n = resolution.nodes
    inverse_legendre = np.linalg.inv(legendre.legvander(legendre.leggauss(n)[0], n - 1))
    offsets = step * np.arange(count)
    density = flexibility.values / np.multiply.outer(weights, weights)
    base = density[:, -1, -1]
    pressure_sum = np.zeros((count, *density.shape[1:]))
    for i, (low, high) in enumerate(zip(resolution.panels[:-1], resolution.panels[1:], strict=True)):
        nodes = slice(i * n, (i + 1) * n)
        node, weight = legendre.leggauss(24 + int(2 * (high - low)))
        k = low + 0.5 * (high - low) * (node + 1)
        hat = step * np.sinc(k * step / (2 * np.pi)) ** 2
        factor = 0.5 * (high - low) * weight * hat**2 / np.pi
        interpolate = legendre.legvander(node, n - 1) @ inverse_legendre
        waves = np.cos(np.outer(offsets, k))
        pressure_sum += np.tensordot(waves * factor @ interpolate, density[nodes] - base[nodes, None, None], axes=1)
        pressure_sum += ((waves - 1) / k * factor @ interpolate @ (flexibility.k[nodes] * base[nodes]))[:, None, None]
    return pressure_sum * np.multiply.outer(weights, weights)


@dataclass(frozen=True)
class SolvedContact:
    """Pressure at the nodes `x` (whole length) and `y >= 0`, over `p0`."""

    x: Array
    y: Array
    pressure: Array


def solve(case: ContactCase, flexibility: Flexibility, step: float, window: float, *, stride: int = 1) -> SolvedContact:
    """Contact with hats `step` apart along y up to `window`; `stride` 2 omits every other node along x."""
    y = step * np.arange(round(window / step) + 1)
    strips = integrate_wavenumbers(flexibility, step, 2 * y.size - 1)
    merge = _compute_coarse_hats(flexibility.nodes, stride)
    row = np.arange(y.size)
    multiplicity = np.where(row == 0, 1.0, 2.0)  # a hat away from the middle includes its mirror image
    # The unknown of a row is also that of its mirror image at -y: the flexibilities of both rows add up.
    row_difference, row_sum = np.abs(row[:, None] - row), row[:, None] + row
    folded_strips = strips[row_difference] + strips[row_sum]
    folded_strips *= (0.5 * np.multiply.outer(multiplicity, multiplicity))[..., None, None]
    matrix = np.einsum("ai,mnij,bj->manb", merge, folded_strips, merge, optimize=True)
    size = matrix.shape[0] * matrix.shape[1]
    matrix = matrix.reshape(size, size) / (1 - case.poisson)  # 2 G = E* (1 - nu), and E* is 1
    matrix = 0.5 * (matrix + matrix.T)
    weights = np.outer(multiplicity * step, merge @ flexibility.weights).ravel()
    gaps = np.outer(multiplicity * step, merge @ _moments(case.gap_x, flexibility.nodes))
    # Integral of y**2 times a hat: step (y**2 + step**2 / 6).
    gaps += np.outer(multiplicity * step * (y**2 + step**2 / 6), merge @ flexibility.weights)
    pressure = complementarity(matrix, gaps.ravel(), weights, case.load)
    half_pressure = merge.T @ pressure.reshape(y.size, -1).T
    pressure_both_sides = np.concatenate([half_pressure, half_pressure[: flexibility.nodes.size // 2][::-1]])
    return SolvedContact(flexibility.nodes, y, pressure_both_sides)


def _compute_coarse_hats(nodes: Array, stride: int) -> Array:
    """Hats on every `stride`-th node as sums of the hats on all nodes: array (coarse, fine)."""
    half_nodes = nodes[: (nodes.size + 1) // 2]
    coarse_nodes = np.unique(np.append(np.arange(0, half_nodes.size, stride), half_nodes.size - 1))
    return np.array([np.interp(half_nodes, half_nodes[coarse_nodes], row) for row in np.eye(coarse_nodes.size)])


def _moments(function: Callable[[Array], Array], nodes: Array) -> Array:
    """Integrals of a function times each hat pair."""
    node, weight = legendre.leggauss(8)
    widths = np.diff(nodes)
    x = nodes[:-1, None] + 0.5 * widths[:, None] * (node + 1)
    values = 0.5 * widths[:, None] * weight * function(x)
    return np.array([float((values * hat(x)).sum()) for hat in make_mirrored_hats(nodes)])


def complementarity(matrix: Array, gap: Array, weights: Array, load: float) -> Array:
    """Pressure `>= 0` of the given load that minimises the energy; the approach is found by bracketing."""
    # A constant between all hats only shifts the approach; a large constant makes the matrix positive definite.
    constant = 10 * np.abs(matrix).sum() / weights.sum() ** 2
    factor = linalg.cholesky(matrix + constant * np.multiply.outer(weights, weights))
    scaled_gap, scaled_weights = (linalg.solve_triangular(factor, vector, trans="T") for vector in (gap, weights))

    def pressure(approach: float) -> Array:
        return np.asarray(optimize.nnls(factor, approach * scaled_weights - scaled_gap, maxiter=50 * gap.size)[0])

    # With the constant c the approach is near c times the load.
    mid_approach = constant * load
    root = optimize.root_scalar(
        lambda approach: float(weights @ pressure(approach)) / load - 1,
        x0=mid_approach,
        x1=1.05 * mid_approach,
        rtol=1e-12,
    )
    return pressure(root.root)
