"""Stress functions of (x, z) from piecewise polynomials: equilibrium, free faces, least energy.

In the plane Airy's function gives ``s_xx = f,zz``, ``s_zz = f,xx``, ``s_xz = -f,xz``; across the plane
``t_xy = g,z``, ``t_yz = -g,x``. Faces are free where f and its slope, and g, vanish. The stress of the eigenstrain e
makes the complementary energy least (K. Washizu, Variational Methods in Elasticity and Plasticity, 2nd ed. 1975):

    (1 - nu**2) / E  int lap f lap h  =  -int (e_xx + nu e_yy) h,zz + (e_zz + nu e_yy) h,xx - 2 e_xz h,xz
    (1 / G)  int grad g . grad h  =  -int 2 e_xy h,z - 2 e_yz h,x

for all functions h. ``lap f lap h`` may be written ``f,xx h,xx + f,zz h,zz + 2 f,xz h,xz``, since h vanishes with its
slope on all sides.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.interpolate import BSpline
from scipy.sparse.linalg import splu

from contactstudy.checks import FloatArray

Factors = tuple[list[FloatArray], list[FloatArray]]  # Values, slopes, ... of functions along x, and along z


@dataclass(frozen=True, eq=False)
class Splines:
    """Basis of piecewise polynomials."""

    edges: FloatArray  # edges of the elements, metres, increasing
    degree: int  # degree of the polynomials
    continuity: int  # number of derivatives that are continuous between elements
    vanishing_orders: int  # how many of value, slope, ... vanish on both sides.

    @property
    def count(self) -> int:
        """Number of functions."""
        return self._knots.size - self.degree - 1 - 2 * self.vanishing_orders

    @cached_property
    def _knots(self) -> FloatArray:
        repeats = np.full(self.edges.size, self.degree - self.continuity)
        repeats[[0, -1]] = self.degree + 1
        return np.repeat(self.edges, repeats)

    def values(self, points: FloatArray, derivative: int = 0) -> FloatArray:
        """Functions, or a derivative of them, at points: array (point, function); on an edge of the right element."""
        spline_count = self._knots.size - self.degree - 1
        function_values = BSpline(self._knots, np.eye(spline_count), self.degree)(points, nu=derivative)
        return np.asarray(function_values[:, self.vanishing_orders : spline_count - self.vanishing_orders])

    @cached_property
    def _gauss(self) -> tuple[FloatArray, FloatArray]:
        """Points and weights that integrate products of two functions exactly: arrays (element, point)."""
        node, weight = np.polynomial.legendre.leggauss(self.degree + 1)
        half_widths = 0.5 * np.diff(self.edges)[:, None]
        return self.edges[:-1, None] + half_widths * (1 + node), half_widths * weight

    def products(self, derivative: int) -> sparse.csr_array:
        """Integrals of products of two functions' derivatives: array (function, function)."""
        points, weights = self._gauss
        derivatives = sparse.csr_array(self.values(points.ravel(), derivative))
        return sparse.csr_array(derivatives.T @ sparse.diags_array(weights.ravel()) @ derivatives)

    def integrals(self, cell_edges: FloatArray, derivative: int) -> FloatArray:
        """Integrals of functions or their derivatives over cells with edges of elements: array (function, cell)."""
        points, weights = self._gauss
        weighted_values = self.values(points.ravel(), derivative) * weights.reshape(-1, 1)
        element_integrals = weighted_values.reshape(*points.shape, -1).sum(axis=1)
        sums = np.concatenate([np.zeros((1, self.count)), np.cumsum(element_integrals, axis=0)])
        elements = np.abs(self.edges[:, None] - cell_edges).argmin(axis=0)
        return np.asarray(np.diff(sums[elements], axis=0).T)


# Weights of the squares of derivatives (along x, along z) in the energy, by the number of vanishing orders
ENERGY_WEIGHTS = {2: {(2, 0): 1.0, (0, 2): 1.0, (1, 1): 2.0}, 1: {(1, 0): 1.0, (0, 1): 1.0}}


@dataclass(frozen=True, eq=False)
class StressFunction:
    """Products of splines along x and z, and their energy."""

    x: Splines  # splines that vanish on the faces, for Airy's function with their slopes
    z: Splines

    @cached_property
    def _factorisation(self) -> tuple[sparse.linalg.SuperLU, FloatArray]:
        """Factors of the energy's matrix, and the scale of each function with which the function's energy is 1."""
        weights = ENERGY_WEIGHTS[self.x.vanishing_orders]
        energy = sum(weight * sparse.kron(self.x.products(i), self.z.products(j)) for (i, j), weight in weights.items())
        scale = 1 / np.sqrt(energy.diagonal())
        scaled = sparse.csc_array(sparse.diags_array(scale) @ energy @ sparse.diags_array(scale))
        factor = splu(scaled, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        return factor, scale

    def values(self, x: FloatArray, z: FloatArray) -> Factors:
        """Functions and their derivatives at positions: arrays (point, function)."""
        orders = range(self.x.vanishing_orders + 1)
        return [self.x.values(x, order) for order in orders], [self.z.values(z, order) for order in orders]

    def integrals(self, x_edges: FloatArray, z_edges: FloatArray) -> Factors:
        """Integrals of the functions and their derivatives over cells: arrays (function, cell)."""
        orders = range(self.x.vanishing_orders + 1)
        return [self.x.integrals(x_edges, order) for order in orders], [
            self.z.integrals(z_edges, order) for order in orders
        ]

    def solve(self, right_hand_sides: FloatArray) -> FloatArray:
        """Coefficients of least energy for right-hand sides: array (function, column)."""
        factor, scale = self._factorisation
        return np.asarray(scale[:, None] * factor.solve(scale[:, None] * right_hand_sides))
