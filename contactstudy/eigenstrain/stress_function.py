"""Stress functions of (x, z): stresses that are in equilibrium and leave all faces free, and their least energy.

In the plane Airy's function gives ``s_xx = f,zz``, ``s_zz = f,xx``, ``s_xz = -f,xz``; across the plane
``t_xy = g,z``, ``t_yz = -g,x`` (S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 3rd ed. 1970, sections 17 and
104). Faces are free where f and its slope, and g, vanish. With no strain along y the stress of the eigenstrain e makes
the complementary energy least (the principle of minimum complementary energy with initial strains; K. Washizu,
Variational Methods in Elasticity and Plasticity, 2nd ed. 1975, chapter 5):

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
from scipy.sparse.linalg import splu

from contactstudy.checks import FloatArray
from contactstudy.eigenstrain.splines import Splines


@dataclass(frozen=True, eq=False)
class StressFunction:
    """Products of splines along x and z, and their energy.

    Attributes
    ----------
    x, z : Splines
        With their slopes, they vanish on the faces for Airy's function; without, for that across the plane.
    """

    x: Splines
    z: Splines

    @cached_property
    def _factorised(self) -> tuple[sparse.linalg.SuperLU, FloatArray]:
        """Factors of the energy, and the scale of each function that makes its own energy 1."""
        parts = {(i, j): sparse.kron(self.x.products(i), self.z.products(j)) for i, j in self._derivatives}
        matrix = sum(weight * parts[pair] for pair, weight in self._derivatives.items())
        scale = 1 / np.sqrt(matrix.diagonal())
        scaled = sparse.csc_matrix(sparse.diags(scale) @ matrix @ sparse.diags(scale))
        factor = splu(scaled, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        return factor, scale

    @property
    def _derivatives(self) -> dict[tuple[int, int], float]:
        """Weight of the square of each derivative (along x, along z) in the energy."""
        if self.x.vanishing == 2:
            return {(2, 0): 1.0, (0, 2): 1.0, (1, 1): 2.0}
        return {(1, 0): 1.0, (0, 1): 1.0}

    def solve(self, right: FloatArray) -> FloatArray:
        """Coefficients of least energy: array (function x, function z), for a right-hand side of this shape."""
        return self.solve_columns(right.reshape(-1, 1)).reshape(right.shape)

    def solve_columns(self, right: FloatArray) -> FloatArray:
        """Coefficients of least energy for many right-hand sides: array (function, column)."""
        factor, scale = self._factorised
        return np.asarray(scale[:, None] * factor.solve(scale[:, None] * right))
