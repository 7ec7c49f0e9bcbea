"""Strain energy of a contact over approach and tilt as one smooth function: load, moment and stiffness derive from it.

The energy without tilt follows powers of the approach: its logarithm is a spline in the logarithm of the approach. The
energy added by a tilt is a tensor product of splines, fitted to energy, load and moment together by least squares.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.interpolate import BSpline
from scipy.ndimage import maximum_filter

from contactstudy.checks import FloatArray

# Degree of the splines whose difference from the fit estimates the error; factor on the estimate; steps between nodes
# at which splines are compared. Accuracy: the estimate covers the error of springs of power 3/2 on 5 to 9 nodes
ERROR_DEGREE, ERROR_FACTOR, SUBDIVISIONS = 3, 3.0, 4


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
    inner_knots = [nodes[start : start + degree - 1].mean() for start in range(1, nodes.size - degree + 1)]
    first_knots, last_knots = (np.repeat(end, degree + 1) for end in nodes[[0, -1]])
    return BSpline(np.concatenate([first_knots, inner_knots, last_knots]), np.eye(nodes.size + 1), degree)


@dataclass(frozen=True, kw_only=True, eq=False)
class EnergySpline:
    """Strain energy: without tilt the exponential of a spline; a tensor product of splines adds the tilt's energy."""

    approach_splines: BSpline  # values (point, spline), in the logarithm of the approach
    tilt_splines: BSpline  # the same in the tilt over the largest tilt
    tilt_scale: float  # rad
    untilted_coefficients: FloatArray  # coefficients of the logarithm of the energy without tilt
    tilt_coefficients: FloatArray  # coefficients of the energy added by a tilt, per pair, J

    @classmethod
    def fit(cls, nodes: Nodes, degree: int = 4) -> EnergySpline:
        """Fit energy, load and moment at once."""
        log_approaches, scale = np.log(nodes.approaches), float(np.abs(nodes.tilts).max())
        scaled_tilts = nodes.tilts / scale
        approach_splines, tilt_splines = create_basis(log_approaches, degree), create_basis(scaled_tilts, degree)
        # dU / d ln delta = delta Q, and dU / d(theta / scale) = scale M.
        load, moment = nodes.approaches[:, None] * nodes.normal_load, scale * nodes.moment
        untilted_column = int(np.abs(scaled_tilts).argmin())
        energy, untilted_load = nodes.energy[:, untilted_column], load[:, untilted_column]
        values, slopes = (approach_splines(log_approaches, order) for order in (0, 1))
        untilted = _solve_least_squares([(values, np.log(energy)), (slopes, untilted_load / energy)])
        untilted_energy = np.exp(values @ untilted)
        # All loads have equal weights, and so have the moments at each approach.
        max_moment = np.abs(moment).max(axis=1, keepdims=True) + np.zeros_like(moment)
        # The energies have a low weight: load and moment nearly determine the energy.
        equations = (
            (values, 0, nodes.energy - untilted_energy[:, None], nodes.energy / 0.1),
            (slopes, 0, load - (untilted_energy * (slopes @ untilted))[:, None], load),
            (values, 1, moment, np.where(max_moment > 0, max_moment, scale * load)),
        )
        blocks = [
            (np.kron(factor, tilt_splines(scaled_tilts, order)) / weight.reshape(-1, 1), (target / weight).ravel())
            for factor, order, target, weight in equations
        ]
        return cls(
            approach_splines=approach_splines,
            tilt_splines=tilt_splines,
            tilt_scale=scale,
            untilted_coefficients=untilted,
            tilt_coefficients=_solve_least_squares(blocks).reshape(values.shape[1], -1),
        )

    def __call__(self, approach: FloatArray, tilt: FloatArray) -> ContactResponse:
        """Load, moment and stiffness at pairs of approach and tilt, of one shape."""
        scale = self.tilt_scale
        approach_basis = [self.approach_splines(np.log(approach), order) for order in range(3)]
        tilt_basis = [self.tilt_splines(tilt / scale, order) for order in range(3)]

        def differentiate_tilt_energy(i: int, j: int) -> FloatArray:
            return np.asarray(np.einsum("...i,ij,...j->...", approach_basis[i], self.tilt_coefficients, tilt_basis[j]))

        log_energy, slope, curvature = (basis @ self.untilted_coefficients for basis in approach_basis)
        energy = np.exp(log_energy)
        first_derivative = energy * slope + differentiate_tilt_energy(1, 0)
        second_derivative = energy * (curvature + slope**2) + differentiate_tilt_energy(2, 0)
        return ContactResponse(
            normal_load=first_derivative / approach,
            moment=differentiate_tilt_energy(0, 1) / scale,
            normal_stiffness=(second_derivative - first_derivative) / approach**2,
            coupling_stiffness=differentiate_tilt_energy(1, 1) / (approach * scale),
            tilting_stiffness=differentiate_tilt_energy(0, 2) / scale**2,
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
    width = 2 * SUBDIVISIONS + 1
    degree_error = maximum_filter(degree_error, (1, width, width), mode="nearest")[:, ::SUBDIVISIONS, ::SUBDIVISIONS]
    rows, names = range(1, nodes.approaches.size - 1), ("approaches", "energy", "normal_load", "moment")
    omission_errors = []
    for row in rows:
        other_nodes = nodes._replace(**{name: np.delete(getattr(nodes, name), row, axis=0) for name in names})
        omission_errors.append(_differences(EnergySpline.fit(other_nodes)(*pairs), nodes, length)[:, row])
    omission_error = np.stack([omission_errors[0], *omission_errors, omission_errors[-1]], axis=1)
    return np.asarray(np.maximum(residual, ERROR_FACTOR * (degree_error + omission_error)))


def _subdivide(nodes: FloatArray) -> FloatArray:
    """Return the nodes with further points between the nodes."""
    count = nodes.size
    return np.asarray(np.interp(np.arange(SUBDIVISIONS * (count - 1) + 1) / SUBDIVISIONS, np.arange(count), nodes))


def _differences(response: ContactResponse, expected: Nodes | ContactResponse, length: float) -> FloatArray:
    """Errors of a response: load difference over load, and moment difference over load times length."""
    moment_error = np.abs(response.moment - expected.moment) / (expected.normal_load * length)
    return np.array([np.abs(response.normal_load / expected.normal_load - 1), moment_error])
