"""Piecewise polynomials along one axis that vanish with their first derivatives on both sides."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.interpolate import BSpline

from contactstudy.checks import FloatArray


@dataclass(frozen=True, eq=False)
class Splines:
    """Basis of piecewise polynomials.

    Attributes
    ----------
    edges : array
        Edges of the elements, metres, increasing.
    degree : int
        Of the polynomials.
    continuity : int
        Derivatives that are continuous between elements.
    vanishing : int
        How many of value, slope, ... vanish on both sides.

    Examples
    --------
    >>> splines = Splines(np.array([0.0, 1.0, 2.0, 4.0]), degree=3, continuity=1, vanishing=2)
    >>> splines.count, float(np.abs(splines.values(np.array([0.0, 4.0]), 1)).max())
    (4, 0.0)
    """

    edges: FloatArray
    degree: int
    continuity: int
    vanishing: int

    @property
    def count(self) -> int:
        """Number of functions."""
        return self._knots.size - self.degree - 1 - 2 * self.vanishing

    @cached_property
    def _knots(self) -> FloatArray:
        first, inner, last = self.edges[0], self.edges[1:-1], self.edges[-1]
        outer = np.ones(self.degree + 1)
        return np.concatenate([first * outer, np.repeat(inner, self.degree - self.continuity), last * outer])

    def values(self, points: FloatArray, derivative: int = 0) -> FloatArray:
        """Functions, or a derivative of them, at points: array (point, function). Between elements the right one's."""
        whole = self._knots.size - self.degree - 1
        found = BSpline(self._knots, np.eye(whole), self.degree)(points, nu=derivative)
        return np.asarray(found[:, self.vanishing : whole - self.vanishing])

    @cached_property
    def _gauss(self) -> tuple[FloatArray, FloatArray]:
        """Points and weights that integrate products of two functions exactly: arrays (element, point)."""
        node, weight = np.polynomial.legendre.leggauss(self.degree + 1)
        half = 0.5 * np.diff(self.edges)[:, None]
        return self.edges[:-1, None] + half * (1 + node), half * weight

    def products(self, derivative: int) -> sparse.csr_matrix:
        """Integrals of products of two functions' derivatives: array (function, function)."""
        points, weights = self._gauss
        values = sparse.csr_matrix(self.values(points.ravel(), derivative))
        return sparse.csr_matrix(values.T @ sparse.diags(weights.ravel()) @ values)

    def integrals(self, cell_edges: FloatArray, derivative: int) -> FloatArray:
        """Integrals of functions or their derivatives over cells: array (function, cell).

        The cells' edges have to be edges of elements.
        """
        points, weights = self._gauss
        by_point = self.values(points.ravel(), derivative) * weights.reshape(-1, 1)
        by_element = by_point.reshape(*points.shape, -1).sum(axis=1)
        sums = np.concatenate([np.zeros((1, self.count)), np.cumsum(by_element, axis=0)])
        at = np.abs(self.edges[:, None] - cell_edges).argmin(axis=0)
        return np.asarray(np.diff(sums[at], axis=0).T)
