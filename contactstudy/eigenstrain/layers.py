"""Residual stress of eigenstrains in layers of a half-space that change along y, and not along x.

For one wave along y the complementary energy (`stress_function`) of Airy's function ``f(z) exp(i k y)`` is least where

    (1 - nu**2) / E  int f'' h'' + 2 k**2 f' h' + k**4 f h
        =  -int (e_yy + nu e_xx) h'' - k**2 (e_zz + nu e_xx) h + 2 i k e_yz h'

for all h. The stresses ``t_xy = g'``, ``t_xz = -i k g`` across the plane follow from the same principle. With e_yz and
e_xz over i all terms are real.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contactstudy.bodies.material import Material
from contactstudy.checks import FloatArray
from contactstudy.eigenstrain.body import DEGREE, FAR_DISTANCE, XX, XY, XZ, YY, YZ, ZZ, grade_to_face, grow_edges
from contactstudy.eigenstrain.stress_function import Splines


def layer_stresses(material: Material, eigenstrain: FloatArray) -> FloatArray:
    """Residual stresses (6, layer) from eigenstrains (6, layer) in endless layers, without strains along x and y."""
    e, nu, modulus = eigenstrain, material.poisson, material.plane_strain_modulus
    stress = np.zeros_like(e)
    stress[XX], stress[YY] = -modulus * (e[XX] + nu * e[YY]), -modulus * (e[YY] + nu * e[XX])
    stress[XY] = -2 * material.shear_modulus * e[XY]
    return stress


@dataclass(frozen=True, eq=False)
class PeriodicLayers:
    """Layers whose eigenstrain is given at equal distances along y, on a closed path."""

    material: Material
    z_edges: FloatArray  # edges of the layers, metres
    positions: int  # number of positions along y
    step: float  # distance from one position to the next, metres; negative where y falls

    def _matrices(self, degree: int, order: int) -> FloatArray:
        """Stresses (or their part over i) in the layers per eigenstrain, over minus the modulus, for every wave."""
        waves, z = 2 * np.pi * np.fft.rfftfreq(self.positions, abs(self.step)), self.z_edges
        # The elements over depth: the layers, and elements above and below.
        above = grade_to_face(z[0], 0.0, z[1] - z[0])[::-1]
        elements = np.concatenate([above, z, grow_edges(z[-1], FAR_DISTANCE * z[-1], z[-1] - z[-2])])
        splines = Splines(elements, degree, continuity=order - 1, vanishing_orders=order)
        products = [splines.products(derivative).toarray() for derivative in range(order + 1)]
        overlaps = [splines.integrals(z, derivative) for derivative in range(order + 1)]
        heights = np.tile(np.diff(z), order + 1)
        matrices = np.zeros((waves.size, heights.size, heights.size))
        # Without a change along y only strains in the plane of the layers are suppressed.
        layer_indices = np.arange(z.size - 1)
        matrices[0, layer_indices, layer_indices] = 1.0 if order == 2 else 2.0
        for wave_index, k in enumerate(waves[1:], 1):
            if order == 2:  # yy, zz, yz
                energy = products[2] + 2 * k**2 * products[1] + k**4 * products[0]  # eq. (504)
                integrals = np.concatenate([overlaps[2], -(k**2) * overlaps[0], -k * overlaps[1]], axis=1)
                multiplicities = np.repeat([1.0, 1.0, 2.0], heights.size // 3)
            else:  # xy, xz
                energy = products[1] + k**2 * products[0]
                integrals = np.concatenate([overlaps[1], k * overlaps[0]], axis=1)
                multiplicities = np.full(heights.size, 2.0)
            scale = 1 / np.sqrt(np.diag(energy))[:, None]
            coefficients = scale * np.linalg.solve(scale * energy * scale.T, scale * integrals)
            matrices[wave_index] = integrals.T @ coefficients * multiplicities / heights[:, None]
        return matrices

    @cached_property
    def _airy_matrices(self) -> FloatArray:
        return -self.material.plane_strain_modulus * self._matrices(DEGREE, 2)

    @cached_property
    def _antiplane_matrices(self) -> FloatArray:
        return -self.material.shear_modulus * self._matrices(DEGREE - 1, 1)

    def stresses(self, eigenstrain: FloatArray) -> FloatArray:
        """Residual stresses (6, position, column, layer) from eigenstrains of this shape; columns are independent."""
        e, nu = eigenstrain, self.material.poisson
        stress = np.zeros_like(e)
        in_plane = np.stack([e[YY] + nu * e[XX], e[ZZ] + nu * e[XX], e[YZ]])
        stress[[YY, ZZ, YZ]] = self._apply(self._airy_matrices, in_plane)
        stress[XX] = nu * (stress[YY] + stress[ZZ]) - self.material.young * e[XX]
        if e[[XY, XZ]].any():
            stress[[XY, XZ]] = self._apply(self._antiplane_matrices, e[[XY, XZ]])
        return stress

    def _apply(self, matrices: FloatArray, strains: FloatArray) -> FloatArray:
        """Stresses (component, position, column, layer) of strains of this shape; the last component is over i."""
        components, positions, columns, layers = strains.shape
        waves = np.fft.rfft(strains, axis=1)
        waves[-1] *= -1j * np.sign(self.step)
        waves = waves.transpose(1, 0, 3, 2).reshape(-1, components * layers, columns)
        products = matrices @ np.concatenate([waves.real, waves.imag], axis=2)
        waves = (products[..., :columns] + 1j * products[..., columns:]).reshape(-1, components, layers, columns)
        waves[:, -1] *= 1j * np.sign(self.step)
        return np.fft.irfft(waves.transpose(1, 0, 3, 2), n=positions, axis=1)
