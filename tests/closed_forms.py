"""Closed forms for tests: surface stresses of a Hertz circle, and sliding line contacts."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contactstudy.bodies.material import Material
from contactstudy.checks import FloatArray
from contactstudy.verification.closed_forms import Stress


class SlidingLine(NamedTuple):
    """Line contact with friction coupled into its geometry."""

    half_width: float
    centre: float
    exponent: float
    peak_scale: float

    def pressure(self, y: ArrayLike) -> NDArray[np.float64]:
        """Pressure at `y`, Pa."""
        scaled_y = np.clip((np.asarray(y, dtype=float) - self.centre) / self.half_width, -1.0, 1.0)
        shape = (1 + scaled_y) ** (0.5 + self.exponent) * (1 - scaled_y) ** (0.5 - self.exponent)
        return np.asarray(self.peak_scale * self.half_width * shape)


def solve_sliding_line_contact(
    load_per_length: float,
    radius: float,
    friction: float,
    body_material: Material,
    roller_material: Material | None = None,
) -> SlidingLine:
    """Cylinder that slides on a plane, in plane strain, with coupled friction (Bufler 1959; Johnson 7.2).

    Where the bodies touch their slopes add up to

        (2 / (pi E*)) PV int p(s) / (s - y) ds + (2 / E*) f beta p(y) = -y / R,

    with Dundurs' ``beta = [(1 - 2 nu1) / G1 - (1 - 2 nu2) / G2] / 2 / [(1 - nu1) / G1 + (1 - nu2) / G2]``. The
    function ``(c + t)**(1/2 + gamma) (c - t)**(1/2 - gamma)`` of ``t = y - centre`` solves it for
    ``tan(pi gamma) = -f beta`` and ``centre = 2 gamma c``; the load is ``pi E* c**2 (1/4 - gamma**2) / R``.
    """
    bodies = [body_material] if roller_material is None else [body_material, roller_material]
    shear_terms = [(1 - 2 * material.poisson) / material.shear_modulus for material in bodies]
    normal_term = sum((1 - material.poisson) / material.shear_modulus for material in bodies)
    beta = (shear_terms[0] - (shear_terms[1] if roller_material is not None else 0.0)) / (2 * normal_term)
    modulus = 2 / normal_term
    gamma = float(-np.arctan(friction * beta) / np.pi)
    half_width = float(np.sqrt(load_per_length * radius / (np.pi * modulus * (0.25 - gamma**2))))
    return SlidingLine(half_width, 2 * gamma * half_width, gamma, float(modulus * np.cos(np.pi * gamma) / (2 * radius)))


def compute_hertz_surface_stress(
    r: ArrayLike, radius: float, max_pressure: float, poisson: float
) -> tuple[FloatArray, FloatArray]:
    """`sigma_rr` and `sigma_tt` on the surface around a frictionless Hertz circle (Johnson 3.42, 3.43)."""
    radius_ratio = np.asarray(r, dtype=float) / radius
    height = np.sqrt(np.clip(1 - radius_ratio**2, 0, None))
    with np.errstate(divide="ignore", invalid="ignore"):
        term = np.where(radius_ratio > 1e-4, (1 - height**3) / radius_ratio**2, 1.5) * (1 - 2 * poisson) / 3
    return max_pressure * (term - height), max_pressure * (-term - 2 * poisson * height)


def compute_sliding_surface_stress(
    x: ArrayLike, y: ArrayLike, radius: float, max_traction: float, poisson: float
) -> Stress:
    """In-plane stresses on the surface inside the circle, from the traction `q` alone (Johnson section 7.1)."""
    traction_scale = -np.pi * max_traction / (8 * radius)
    x_grid, y_grid = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
    return {
        "sigma_yy": traction_scale * (4 + poisson) * y_grid,
        "sigma_xx": traction_scale * 3 * poisson * y_grid,
        "tau_xy": traction_scale * (2 - poisson) * x_grid,
    }


def compute_elliptic_line_stresses(y: FloatArray, z: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Stresses (yy, zz, yz) under the pressure, and under the traction along +y, ``sqrt(1 - y**2)``.

    K. L. Johnson, Contact Mechanics (1985), 4.49 and 7.8.
    """
    difference = 1 - y**2 + z**2
    root = np.sqrt(difference**2 + 4 * y**2 * z**2)
    m = np.sqrt(np.maximum(root + difference, 0) / 2)
    n = np.sign(y) * np.sqrt(np.maximum(root - difference, 0) / 2)
    squares = np.maximum(m**2 + n**2, 1e-300)
    yy, zz = 2 * z - m * (1 + (z**2 + n**2) / squares), -m * (1 - (z**2 + n**2) / squares)
    yz = -n * (m**2 - z**2) / squares
    return np.array([yy, zz, yz]), np.array([n * (2 - (z**2 - m**2) / squares) - 2 * y, yz, yy])


def compute_largest_von_mises_under_carter(friction: float, stick_ratio: float, poisson: float) -> float:
    """Largest von Mises stress under Carter's traction over the largest pressure, in plane strain."""
    y = np.append(np.linspace(-1.1, 1.1, 441), 1 - 2 * stick_ratio)
    y, z = (axis.ravel() for axis in np.meshgrid(y, np.linspace(0.0, 1.0, 51)))
    pressure_stress, sliding_stress = compute_elliptic_line_stresses(y, z)
    sticking_stress = compute_elliptic_line_stresses((y - 1 + stick_ratio) / stick_ratio, z / stick_ratio)[1]
    yy, zz, yz = pressure_stress + friction * (sliding_stress - stick_ratio * sticking_stress)
    xx = poisson * (yy + zz)
    squares = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * yz**2
    return float(np.sqrt(squares.max()))
