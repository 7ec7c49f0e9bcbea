"""Strain energy of a contact over approach and tilt as one smooth function: load, moment and stiffness derive from it.

The energy without tilt follows powers of the approach: its logarithm is a spline in the logarithm of the approach. The
energy added by a tilt is a tensor product of splines in that logarithm and in the tilt, fitted to energy, load and
moment together by least squares.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.interpolate import BSpline
from scipy.ndimage import maximum_filter

from contactstudy.checks import FloatArray

# Degree of the other splines, whose difference estimates the error; factor on the estimate; steps between nodes at
# which splines are compared. Accuracy: the estimate covers the error of springs of power 3/2 on 5 to 9 nodes
ERROR_DEGREE, FACTOR, STEPS = 3, 3.0, 4


class Nodes(NamedTuple):
    """Energy, load and moment of a contact at pairs of approach and tilt."""

    approaches: FloatArray  # m, positive, increasing
    tilts: FloatArray  # rad, increasing
    energy: FloatArray  # (approach, tilt), J
    normal_load: FloatArray  # N
    moment: FloatArray  # N m


class ContactResponse(NamedTuple):
    """Load, moment and stiffness matrix at an approach and a tilt; arrays of one shape."""

    normal_load: FloatArray  # N
    moment: FloatArray  # N m
    normal_stiffness: FloatArray  # dQ/d delta, N/m
    coupling_stiffness: FloatArray  # dQ/d theta = dM/d delta, N/rad
    tilting_stiffness: FloatArray  # dM/d theta, N m/rad


STIFFNESSES = ContactResponse._fields[2:]


def create_basis(nodes: FloatArray, degree: int) -> BSpline:
    """Create a basis of one more B-spline than nodes, with knots at de Boor's means of the nodes."""
    degree = min(degree, nodes.size - 1)
    inner = [nodes[first : first + degree - 1].mean() for first in range(1, nodes.size - degree + 1)]
    first, last = (np.repeat(end, degree + 1) for end in nodes[[0, -1]])
    return BSpline(np.concatenate([first, inner, last]), np.eye(nodes.size + 1), degree)


@dataclass(frozen=True, kw_only=True, eq=False)
class EnergySpline:
    """Strain energy: without tilt the exponential of a spline; a tensor product of splines adds the tilt's energy."""

    approach_splines: BSpline  # values (point, spline), in the logarithm of the approach
    tilt_splines: BSpline  # the same in the tilt over the largest tilt
    tilt_scale: float  # rad
    untilted: FloatArray  # coefficients of the logarithm of the energy without tilt
    added: FloatArray  # coefficients of the energy added by a tilt, per pair, J

    @classmethod
    def fit(cls, nodes: Nodes, degree: int = 4) -> EnergySpline:
        """Fit energy, load and moment at once."""
        u, scale = np.log(nodes.approaches), float(np.abs(nodes.tilts).max())
        t = nodes.tilts / scale
        u_splines, t_splines = create_basis(u, degree), create_basis(t, degree)
        # dU / d ln delta = delta Q, and dU / d(theta / scale) = scale M.
        load, moment = nodes.approaches[:, None] * nodes.normal_load, scale * nodes.moment
        untilted_column = int(np.abs(t).argmin())
        energy, untilted_load = nodes.energy[:, untilted_column], load[:, untilted_column]
        weights = _solve_least_squares([(u_splines(u), np.log(energy)), (u_splines(u, 1), untilted_load / energy)])
        untilted_energy = np.exp(u_splines(u) @ weights)
        # All loads have equal weights, and so have the moments at each approach.
        max_moment = np.abs(moment).max(axis=1, keepdims=True) + np.zeros_like(moment)
        # The energies have a low weight: load and moment nearly determine the energy.
        equations = (
            ((0, 0), nodes.energy - untilted_energy[:, None], nodes.energy / 0.1),
            ((1, 0), load - (untilted_energy * (u_splines(u, 1) @ weights))[:, None], load),
            ((0, 1), moment, np.where(max_moment > 0, max_moment, scale * load)),
        )
        blocks = [
            (np.kron(u_splines(u, i), t_splines(t, j)) / weight.reshape(-1, 1), (right_hand_side / weight).ravel())
            for (i, j), right_hand_side, weight in equations
        ]
        added = _solve_least_squares(blocks).reshape(u_splines(u).shape[1], -1)
        return cls(approach_splines=u_splines, tilt_splines=t_splines, tilt_scale=scale, untilted=weights, added=added)

    def __call__(self, approach: FloatArray, tilt: FloatArray) -> ContactResponse:
        """Load, moment and stiffness at pairs of approach and tilt, of one shape."""
        scale = self.tilt_scale
        b_u = [self.approach_splines(np.log(approach), order) for order in range(3)]
        b_t = [self.tilt_splines(tilt / scale, order) for order in range(3)]

        def tilt_derivative(i: int, j: int) -> FloatArray:
            return np.asarray(np.einsum("...i,ij,...j->...", b_u[i], self.added, b_t[j]))

        energy, slope, curvature = np.exp(b_u[0] @ self.untilted), b_u[1] @ self.untilted, b_u[2] @ self.untilted
        by_u = energy * slope + tilt_derivative(1, 0)
        by_uu = energy * (curvature + slope**2) + tilt_derivative(2, 0)
        return ContactResponse(
            normal_load=by_u / approach,
            moment=tilt_derivative(0, 1) / scale,
            normal_stiffness=(by_uu - by_u) / approach**2,
            coupling_stiffness=tilt_derivative(1, 1) / (approach * scale),
            tilting_stiffness=tilt_derivative(0, 2) / scale**2,
        )


def _solve_least_squares(equation_blocks: list[tuple[FloatArray, FloatArray]]) -> FloatArray:
    """Solve several blocks of equations by least squares, scaled by columns."""
    matrix, right_hand_side = (np.concatenate(blocks) for blocks in zip(*equation_blocks, strict=True))
    norms = np.linalg.norm(matrix, axis=0)
    return np.asarray(np.linalg.lstsq(matrix / norms, right_hand_side, rcond=None)[0] / norms)


def estimate_fit_errors(nodes: Nodes, length: float) -> FloatArray:
    """Errors (2, approach, tilt) up to the nearest nodes: load error over load, moment error over load times length."""
    # Estimates: residuals, and differences from splines of another degree and on fewer nodes.
    spline, lower_degree_spline = EnergySpline.fit(nodes), EnergySpline.fit(nodes, ERROR_DEGREE)
    pairs = np.meshgrid(nodes.approaches, nodes.tilts, indexing="ij")
    residual = _differences(spline(*pairs), nodes, length)
    fine_pairs = np.meshgrid(np.exp(_subdivide(np.log(nodes.approaches))), _subdivide(nodes.tilts), indexing="ij")
    degree_error = _differences(spline(*fine_pairs), lower_degree_spline(*fine_pairs), length)
    # Largest difference between each node and its neighbours.
    nearby = maximum_filter(degree_error, (1, 2 * STEPS + 1, 2 * STEPS + 1), mode="nearest")[:, ::STEPS, ::STEPS]
    rows, names = range(1, nodes.approaches.size - 1), ("approaches", "energy", "normal_load", "moment")
    gaps = []
    for row in rows:
        other_nodes = nodes._replace(**{name: np.delete(getattr(nodes, name), row, axis=0) for name in names})
        gaps.append(_differences(EnergySpline.fit(other_nodes)(*pairs), nodes, length)[:, row])
    return np.asarray(np.maximum(residual, FACTOR * (nearby + np.stack([gaps[0], *gaps, gaps[-1]], axis=1))))


def _subdivide(nodes: FloatArray) -> FloatArray:
    """Return the nodes with further points between the nodes."""
    count = nodes.size
    return np.asarray(np.interp(np.arange(STEPS * (count - 1) + 1) / STEPS, np.arange(count), nodes))


def _differences(response: ContactResponse, expected: Nodes | ContactResponse, length: float) -> FloatArray:
    """Errors of a response: load difference over load, and moment difference over load times length."""
    moment_error = np.abs(response.moment - expected.moment) / (expected.normal_load * length)
    return np.array([np.abs(response.normal_load / expected.normal_load - 1), moment_error])
