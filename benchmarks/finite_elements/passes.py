"""Passes of a line contact over an elastic-plastic half-plane, step by step along the way, in plane strain.

The half-plane is a strip along y that closes on itself: one contact circulates without beginning and end, and the mean
strain along y is zero. The bottom is fixed.

Elements are quadrilaterals with eight nodes and two by two points of integration, which plastic flow without change of
volume does not lock. The stress is the sum of the closed form of the elastic contact and the residual stress of the
plastic strain; the plastic strain is integrated by the radial return with the tangent consistent with it (J. C. Simo,
R. L. Taylor, Comput. Methods Appl. Mech. Engng 48 (1985) 101). The plastic strain may vary along y in any way.

Lengths are over the half-width, stresses over the peak pressure.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import skfem  # type: ignore[import-untyped]
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from contactstudy.verification.closed_forms import hertz_strip
from contactstudy.verification.problems import PassesCase

Array = NDArray[np.float64]
PAIRS = ("xx", "yy", "zz", "yz")
"""Components of tensors, here in this order along the first axis."""

SLOW = 0.7
"""Part of the forces out of balance above which a step towards equilibrium is too short. Speed."""

TWICE = np.array([1.0, 1.0, 1.0, 2.0])[:, None]
YOUNG = 1000.0
"""Young's modulus: plastic strains are in proportion to its inverse."""


@dataclass(frozen=True, kw_only=True)
class Strip:
    """Mesh and steps.

    Attributes
    ----------
    length, depth : float
        Of the strip.
    width : float
        Of the elements along y.
    height : float
        Of the elements down to `fine`; below they grow by `growth`.
    step : float
        Way of the contact from one increment to the next.
    """

    length: float = 16.0
    depth: float = 8.0
    width: float = 0.25
    height: float = 0.125
    fine: float = 2.0
    growth: float = 1.5
    step: float = 0.125

    @property
    def depths(self) -> Array:
        """Edges of the elements along z."""
        edges = list(np.linspace(0, self.fine, round(self.fine / self.height) + 1))
        while edges[-1] < self.depth:
            edges.append(min(edges[-1] + self.growth * (edges[-1] - edges[-2]), self.depth))
        return np.array(edges)


@dataclass
class PlasticStrip:
    """A line contact over and over an elastic-plastic half-plane.

    Attributes
    ----------
    case : PassesCase
        Contact and material.
    strip : Strip
        Mesh and steps.
    """

    case: PassesCase
    strip: Strip = Strip()
    factors: Any = field(default=None, init=False, repr=False)

    @property
    def shear_modulus(self) -> float:
        """Shear modulus."""
        return 0.5 * YOUNG / (1 + self.case.poisson)

    @cached_property
    def basis(self) -> skfem.Basis:
        """Elements; the first ones lie on the top, from one end of the strip to the other."""
        strip = self.strip
        y = np.linspace(0, strip.length, round(strip.length / strip.width) + 1)
        mesh = skfem.MeshQuad.init_tensor(y, strip.depths)
        return skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuadS2()), intorder=3)

    @cached_property
    def unknowns(self) -> NDArray[np.int64]:
        """Number of each displacement among the unknowns; -1 at the bottom. Both ends of the strip are the same."""
        basis, strip = self.basis, self.strip
        y, z = np.round(basis.doflocs, 9)
        y[np.isclose(y, strip.length)] = 0.0
        across = np.zeros(basis.N)
        across[basis.split_indices()[1]] = 1.0
        node_numbers = np.unique(np.stack([y, z, across]), axis=1, return_inverse=True)[1].ravel()
        is_free = np.zeros(node_numbers.max() + 1, dtype=bool)
        is_free[node_numbers[z < strip.depth - 1e-9]] = True
        indices = np.where(is_free, np.cumsum(is_free) - 1, -1)
        return np.asarray(indices[node_numbers][basis.element_dofs])

    @cached_property
    def strains(self) -> Array:
        """Strains xx, yy, zz, 2 yz at each point of integration per displacement: (function, 4, element, point)."""
        values = np.zeros((self.basis.Nbfun, 4, *self.basis.dx.shape))
        for index, (function,) in enumerate(self.basis.basis):
            (yy, yz), (zy, zz) = function.grad
            values[index, 1], values[index, 2], values[index, 3] = yy, zz, yz + zy
        return values

    @cached_property
    def order(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Elements and points sorted into rows of equal depth: arrays (depth, along y) of both numbers."""
        y, z = np.round(np.asarray(self.basis.global_coordinates()), 9)
        sorted_points = np.lexsort((y.ravel(), z.ravel())).reshape(np.unique(z).size, -1)
        elements, points = np.unravel_index(sorted_points, y.shape)
        return elements, points

    @cached_property
    def z(self) -> Array:
        """Depths of the points of integration."""
        elements, points = self.order
        return np.asarray(np.asarray(self.basis.global_coordinates())[1][elements[:, 0], points[:, 0]])

    def elastic_stress(self, position: float) -> Array:
        """Stress (4, element, point) of the elastic contact at this place along y."""
        y, z = np.asarray(self.basis.global_coordinates())
        distance = (y - position + 0.5 * self.strip.length) % self.strip.length - 0.5 * self.strip.length
        values = hertz_strip(distance, z, 1.0, 1.0, self.case.poisson, friction=self.case.friction)
        return np.stack([values["sigma_xx"], values["sigma_yy"], values["sigma_zz"], values["tau_yz"]])

    def hooke(self, strain: Array) -> Array:
        """Stress of an elastic strain, tensors (4, ...)."""
        lame = 2 * self.shear_modulus * self.case.poisson / (1 - 2 * self.case.poisson)
        stress = 2 * self.shear_modulus * strain
        stress[:3] += lame * strain[:3].sum(axis=0)
        return np.asarray(stress)

    def return_stress(self, total: Array, plastic: Array, elastic: Array) -> tuple[Array, Array, Array]:
        """Stress without the contact's, plastic strain and tangent for total strains, from the plastic strain before.

        The tangent is (4, 4, point) with the strain 2 yz; `total` and `plastic` are tensors (4, point).
        """
        shear, hardening = self.shear_modulus, 2 / 3 * YOUNG * self.case.kinematic_hardening
        stress = self.hooke(total - plastic) + elastic
        relative = stress - hardening * plastic
        relative[:3] -= relative[:3].mean(axis=0)
        size = np.sqrt((TWICE * relative**2).sum(axis=0))
        radius = np.sqrt(2.0) * self.case.shear_yield_stress
        flows = size > radius
        size = np.maximum(size, radius)
        multiplier = (size - radius) / (2 * shear + hardening)
        normal = relative / size * flows
        values = plastic + multiplier * normal
        # Simo and Taylor, eq. (3.19), with hardening.
        factors = 1 - 2 * shear * multiplier / size
        rotation = 2 * shear / (2 * shear + hardening) - (1 - factors)
        unit = np.diag([1.0, 1.0, 1.0, 0.5])
        unit[:3, :3] -= 1 / 3
        bulk = YOUNG / (3 * (1 - 2 * self.case.poisson))
        volume = np.zeros((4, 4))
        volume[:3, :3] = bulk
        outer = normal[:, None] * normal[None]
        tangent = volume[..., None] + 2 * shear * (factors * unit[..., None] - rotation * outer)
        return stress - elastic - 2 * shear * multiplier * normal, values, tangent

    def force(self, stress: Array) -> Array:
        """Forces on the unknowns of stresses (4, element, point)."""
        nodal_forces = np.einsum("aiep,iep,ep->ae", self.strains, stress, self.basis.dx)
        is_free = self.unknowns >= 0
        return np.asarray(np.bincount(self.unknowns[is_free], nodal_forces[is_free]), dtype=np.float64)

    def stiffness(self, tangent: Array) -> sparse.csc_matrix:
        """Matrix of the unknowns, of tangents (4, 4, element, point)."""
        stress_change = np.einsum("ijep,bjep,ep->biep", tangent, self.strains, self.basis.dx, optimize=True)
        values = np.einsum("aiep,biep->abe", self.strains, stress_change, optimize=True)
        i = np.broadcast_to(self.unknowns[:, None], values.shape)
        j = np.broadcast_to(self.unknowns[None], values.shape)
        is_free = (i >= 0) & (j >= 0)
        count = self.unknowns.max() + 1
        return sparse.csc_matrix((values[is_free], (i[is_free], j[is_free])), shape=(count, count))

    def increment(
        self, displacement: Array, plastic: Array, elastic: Array, accuracy: float = 1e-5
    ) -> tuple[Array, ...]:
        """Displacements, plastic strain and residual stress in equilibrium with the contact's elastic stress."""
        shape = plastic.shape
        tolerance = accuracy * self.strip.width * self.case.shear_yield_stress
        previous_force = np.inf
        for _ in range(100):
            nodal_displacement = np.append(displacement, 0.0)[self.unknowns]  # the bottom is held
            total = np.einsum("aiep,ae->iep", self.strains, nodal_displacement)
            total[3] *= 0.5
            flat = (array.reshape(4, -1) for array in (total, plastic, elastic))
            stress, values, tangent = self.return_stress(*flat)
            out_of_balance = self.force(stress.reshape(shape))
            size = np.abs(out_of_balance).max()
            if size <= tolerance:
                return displacement, values.reshape(shape), stress.reshape(shape)
            # The previous stiffness is used while the iteration converges.
            if self.factors is None or size > SLOW * previous_force:
                matrix = self.stiffness(tangent.reshape(4, 4, *shape[1:]))
                options = {"SymmetricMode": True}
                self.factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", options=options, diag_pivot_thresh=0.1)
            previous_force = size
            displacement = displacement - self.factors.solve(out_of_balance)
        raise RuntimeError(f"no equilibrium: {size:.2g} is left, {tolerance:.2g} is allowed")

    def rows(self, field: Array) -> Array:
        """A field (..., element, point) as rows of equal depth (..., depth, along y)."""
        elements, points = self.order
        return np.asarray(field[..., elements, points])

    def roll(self) -> tuple[Array, Array, Array]:
        """Roll.

        Returns
        -------
        strain : array (pass, 4, depth)
            Plastic strain after each pass, far from the contact.
        stress : array (4, depth)
            Residual stress after the last pass, with the contact taken away, averaged along y.
        spread : array (4, depth)
            Half the range of the plastic strain along y in the same places.
        """
        plastic = np.zeros((4, *self.basis.dx.shape))
        displacement = np.zeros(self.unknowns.max() + 1)
        per_pass = round(self.strip.length / self.strip.step)
        fields = [self.elastic_stress(index * self.strip.step) for index in range(per_pass)]
        for fraction in (0.25, 0.5, 0.75):
            displacement, plastic, _ = self.increment(displacement, plastic, fraction * fields[0])
        factors = []
        y = np.linspace(0, self.strip.length, self.order[0].shape[1], endpoint=False)
        opposite = np.abs(y - 0.5 * self.strip.length) < 2.0
        for _ in range(self.case.passes):
            for elastic in [*fields[1:], fields[0]]:
                displacement, plastic, _ = self.increment(displacement, plastic, elastic)
            factors.append(self.rows(plastic)[..., opposite].mean(axis=-1))
        spread = 0.5 * np.ptp(self.rows(plastic)[..., opposite], axis=-1)
        for fraction in (0.75, 0.5, 0.25, 0.0):
            displacement, plastic, stress = self.increment(displacement, plastic, fraction * fields[0])
        return np.array(factors), self.rows(stress).mean(axis=-1), spread
