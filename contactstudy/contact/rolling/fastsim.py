"""FASTSIM: Kalker's strips, the simplified method of vehicle dynamics, for comparison.

Each strip along the rolling direction is displaced by ``u = L q`` under the local traction alone. Three flexibilities
L, of both creepages and of the spin, make the forces of vanishing creepages on an ellipse equal to the exact theory
(J. J. Kalker, Vehicle System Dynamics 11 (1982) 1), through his coefficients (Three-Dimensional Elastic Bodies in
Rolling Contact (1990), table E.3).
"""

from __future__ import annotations

import numpy as np

from contactstudy.case.motion import Rolling
from contactstudy.checks import FloatArray
from contactstudy.contact.rolling.surfaces import Surfaces, Tractions

POISSONS = (0.0, 0.25, 0.5)  # Poisson's ratios of the table. Physics.

TABLE = (  # half-width along rolling over that across; c11, c22, c23 at three Poisson's ratios. Physics.
    (0.1, (2.51, 3.31, 4.85), (2.51, 2.52, 2.53), (0.334, 0.473, 0.731)),
    (0.2, (2.59, 3.37, 4.81), (2.59, 2.63, 2.66), (0.483, 0.603, 0.809)),
    (0.3, (2.68, 3.44, 4.80), (2.68, 2.75, 2.81), (0.607, 0.715, 0.889)),
    (0.4, (2.78, 3.53, 4.82), (2.78, 2.88, 2.98), (0.720, 0.823, 0.977)),
    (0.5, (2.88, 3.62, 4.83), (2.88, 3.01, 3.14), (0.827, 0.929, 1.07)),
    (0.6, (2.98, 3.72, 4.91), (2.98, 3.14, 3.31), (0.930, 1.03, 1.18)),
    (0.7, (3.09, 3.81, 4.97), (3.09, 3.28, 3.48), (1.03, 1.14, 1.29)),
    (0.8, (3.19, 3.91, 5.05), (3.19, 3.41, 3.65), (1.13, 1.25, 1.40)),
    (0.9, (3.29, 4.01, 5.12), (3.29, 3.54, 3.82), (1.23, 1.36, 1.51)),
    (1.0, (3.40, 4.12, 5.20), (3.40, 3.67, 3.98), (1.33, 1.47, 1.63)),
    (1 / 0.8, (3.65, 4.36, 5.42), (3.65, 3.99, 4.39), (1.58, 1.75, 1.94)),
    (1 / 0.6, (4.06, 4.78, 5.80), (4.06, 4.50, 5.04), (2.01, 2.23, 2.50)),
    (1 / 0.4, (4.84, 5.57, 6.57), (4.84, 5.48, 6.31), (2.88, 3.24, 3.70)),
    (1 / 0.2, (6.96, 7.78, 8.82), (6.96, 8.14, 9.79), (5.72, 6.63, 7.89)),
    (1 / 0.1, (10.7, 11.7, 12.9), (10.7, 12.8, 16.0), (12.2, 14.6, 18.0)),
)


def creep_coefficients(ratio: float, poisson: float) -> FloatArray:
    """Kalker's c11, c22 and c23 of an ellipse: above the table's range the last values, below it the asymptotes."""
    from scipy.interpolate import PchipInterpolator

    if ratio < TABLE[0][0]:
        spin_coefficient = np.pi * np.sqrt(ratio) / (3 * (1 - poisson)) * (1 + poisson * (np.log(16 / ratio) - 5))
        return np.array([np.pi**2 / (4 * (1 - poisson)), np.pi**2 / 4, spin_coefficient])
    ratios = np.log([row[0] for row in TABLE])
    logarithm = float(np.clip(np.log(ratio), ratios[0], ratios[-1]))
    values = PchipInterpolator(ratios, np.array([row[1:] for row in TABLE]))(logarithm)
    coefficients = np.polynomial.polynomial.polyfit(POISSONS, values.T, 2)
    return np.asarray(np.polynomial.polynomial.polyval(poisson, coefficients))


def flexibilities(half_widths: tuple[float, float], shear_modulus: float, poisson: float) -> dict[str, float]:
    """Flexibilities L, m/Pa, of the creepages along x and y and of the spin."""
    half_width_x, half_width_y = half_widths
    c11, c22, c23 = creep_coefficients(half_width_y / half_width_x, poisson)
    return {
        "x": 8 * half_width_y / (3 * shear_modulus * c22),
        "y": 8 * half_width_y / (3 * shear_modulus * c11),
        "spin": np.pi * half_width_y * np.sqrt(half_width_y / half_width_x) / (4 * shear_modulus * c23),
    }


def solve_strips(motion: Rolling, surfaces: Surfaces, bound: FloatArray) -> Tractions:
    """Tractions of FASTSIM's strips under their bound (x, y)."""
    grid, rigid = surfaces.grid, motion.amplitudes
    rows, columns = np.flatnonzero(bound.any(axis=1)), np.flatnonzero(bound.any(axis=0))
    half_widths = 0.5 * float(grid.widths[rows].sum()), 0.5 * columns.size * grid.dy
    # Mean compliances of the bodies; a rigid body contributes 0.
    shear_compliance = 0.5 * sum(1 / material.shear_modulus for material in surfaces.materials)
    poisson_compliance = 0.5 * sum(material.poisson / material.shear_modulus for material in surfaces.materials)
    compliance = flexibilities(half_widths, 1 / shear_compliance, poisson_compliance / shear_compliance)
    spin_gradient = rigid["spin"] / compliance["spin"]
    gradient = np.zeros((2, *grid.shape))
    gradient[0] = rigid["x"] / compliance["x"] - spin_gradient * grid.y
    gradient[1] = rigid["y"] / compliance["y"] + spin_gradient * (grid.x - surfaces.reference_x)[:, None]
    traction, lost_gradient = strip_tractions(bound, gradient, grid.dy)
    slip = np.array([compliance["x"], compliance["y"]])[:, None, None] * lost_gradient
    sticks = (bound > 0) & ~lost_gradient.any(axis=0)
    return Tractions.of(surfaces, rigid, bound=bound, traction=traction, slip=slip, sticks=sticks)


def strip_tractions(bound: FloatArray, gradient: FloatArray, dy: float) -> tuple[FloatArray, FloatArray]:
    """Tractions and the part of their gradient lost to slip, both (2, x, y); material enters at the leading edge."""
    traction, lost_gradient = np.zeros_like(gradient), np.zeros_like(gradient)
    previous_traction, previous_gradient = np.zeros(gradient.shape[:2]), np.zeros(gradient.shape[:2])
    behind_edge = np.zeros(bound.shape[0], bool)
    for column in range(bound.shape[1] - 1, -1, -1):
        is_inside, cell_gradient = bound[:, column] > 0, gradient[:, :, column]
        # The first centre lies half a cell behind the edge; between two centres the gradient is the mean of both.
        traction_step = np.where(behind_edge, 0.5 * (cell_gradient + previous_gradient) * dy, 0.5 * cell_gradient * dy)
        sticking_traction = previous_traction + traction_step
        size = np.hypot(*sticking_traction)
        fraction = np.minimum(bound[:, column] / np.where(size > 0, size, 1.0), 1.0)
        limited_traction = np.where(is_inside, sticking_traction * fraction, 0.0)
        traction[:, :, column] = limited_traction
        distance = np.where(behind_edge, dy, 0.5 * dy)
        excess_gradient = (sticking_traction - limited_traction) / distance
        lost_gradient[:, :, column] = np.where(is_inside & (fraction < 1), excess_gradient, 0.0)
        previous_traction, previous_gradient, behind_edge = limited_traction, cell_gradient, is_inside
    return traction, lost_gradient
