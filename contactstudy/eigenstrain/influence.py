"""Stress in some cells per eigenstrain in the same cells: small dense matrices for many evaluations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contactstudy.checks import FloatArray, IntArray
from contactstudy.eigenstrain.body import XX, XY, XZ, YY, YZ, ZZ, CellAverages, EigenstrainBody
from contactstudy.eigenstrain.stress_function import StressFunction

COLUMNS = 256
"""Right-hand sides that are solved for at once. Speed."""


@dataclass(frozen=True, eq=False)
class Influence:
    """Residual stress averaged over cells, from eigenstrains that are uniform in the same cells.

    Attributes
    ----------
    poisson, young : float
        Elastic constants.
    in_plane : array (3 cells, 3 cells)
        Stresses xx, zz, xz per eigenstrains xx + nu yy, zz + nu yy, xz.
    across : array (2 cells, 2 cells)
        Stresses xy, yz per eigenstrains xy, yz.
    """

    poisson: float
    young: float
    in_plane: FloatArray
    across: FloatArray

    @classmethod
    def of(cls, body: EigenstrainBody, along_x: IntArray, along_z: IntArray) -> Influence:
        """Influence of the cells with these numbers along x and along z on each other."""
        areas = np.diff(body.x_edges)[along_x] * np.diff(body.z_edges)[along_z]

        def columns(of: CellAverages, i: int, j: int) -> sparse.csc_matrix:
            """Integrals of the functions' derivatives over each of the cells: array (function, cell)."""
            x, z = (sparse.csc_matrix(m) for m in (of.x[i][:, along_x], of.z[j][:, along_z]))
            return sparse.csc_matrix(
                sparse.hstack([sparse.kron(x[:, [n]], z[:, [n]], format="csc") for n in range(along_x.size)])
            )

        def matrix(function: StressFunction, parts: list[sparse.csc_matrix], counts: FloatArray) -> FloatArray:
            """Averages of the stresses per eigenstrains times `counts`, over minus the modulus."""
            together = sparse.csc_matrix(sparse.hstack(parts))
            taken = sparse.csr_matrix(together.T)
            found = np.empty((together.shape[1],) * 2)
            for start in range(0, found.shape[1], COLUMNS):
                right = together[:, start : start + COLUMNS].toarray()
                found[:, start : start + COLUMNS] = taken @ function.solve_columns(right)
            return found / np.tile(areas, len(parts))[:, None] * np.repeat(counts, areas.size)

        of = body.airy_integrals
        airy = [columns(of, 0, 2), columns(of, 2, 0), -columns(of, 1, 1)]
        in_plane = matrix(body.in_plane, airy, np.array([1.0, 1.0, 2.0]))
        of = body.across_integrals
        shear = [columns(of, 0, 1), -columns(of, 1, 0)]
        across = matrix(body.across, shear, np.array([2.0, 2.0]))
        material = body.material
        modulus = material.plane_strain_modulus
        return cls(material.poisson, material.young, -modulus * in_plane, -material.shear_modulus * across)

    def stresses(self, eigenstrain: FloatArray) -> FloatArray:
        """Residual stresses (6, cell) from eigenstrains (6, cell): xx, yy, zz, xy, xz, yz."""
        e, nu = eigenstrain, self.poisson
        found = np.empty_like(e)
        held = np.concatenate([e[XX] + nu * e[YY], e[ZZ] + nu * e[YY], e[XZ]])
        found[[XX, ZZ, XZ]] = (self.in_plane @ held).reshape(3, -1)
        found[[XY, YZ]] = (self.across @ np.concatenate([e[XY], e[YZ]])).reshape(2, -1)
        found[YY] = nu * (found[XX] + found[ZZ]) - self.young * e[YY]
        return found


@dataclass(frozen=True, eq=False)
class LayerInfluence:
    """The same for layers that do not end: every cell is a layer, alone at its depth.

    Strains along x and y are held, and the stresses zz, xz and yz have nothing to hold them.

    Attributes
    ----------
    poisson, young : float
        Elastic constants.
    """

    poisson: float
    young: float

    def stresses(self, eigenstrain: FloatArray) -> FloatArray:
        """Residual stresses (6, layer) from eigenstrains (6, layer).

        Examples
        --------
        >>> LayerInfluence(0.25, 1.5).stresses(np.array([[1.0], [0.0], [0.0], [0.0], [0.0], [0.0]]))[:2, 0].tolist()
        [-1.6, -0.4]
        """
        e, nu = eigenstrain, self.poisson
        found = np.zeros_like(e)
        modulus = self.young / (1 - nu**2)
        found[XX], found[YY] = -modulus * (e[XX] + nu * e[YY]), -modulus * (e[YY] + nu * e[XX])
        found[XY] = -self.young / (1 + nu) * e[XY]
        return found
