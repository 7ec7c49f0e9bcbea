"""Passes of a line contact over an elastic-plastic half-plane in increments of its position, in plane strain.

The half-plane is a strip periodic along y: one contact circulates, and the mean strain along y is zero. The bottom is
fixed.

Elements are quadrilaterals with eight nodes and two by two points of integration, without locking under plastic
flow at constant volume. The stress is the sum of the closed form of the elastic contact and the residual stress of the
plastic strain; the radial return with its consistent tangent integrates the plastic strain (J. C. Simo,
R. L. Taylor, Comput. Methods Appl. Mech. Engng 48 (1985) 101). The plastic strain may vary along y.

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
TENSOR_COMPONENTS = ("xx", "yy", "zz", "yz")
"""Order of the components along the first axis of tensors."""

SLOW_CONVERGENCE = 0.7
"""Ratio of successive residual forces above which the stiffness is factorised again. Speed."""

COMPONENT_WEIGHTS = np.array([1.0, 1.0, 1.0, 2.0])[:, None]
YOUNG = 1000.0
"""Young's modulus: plastic strains are in proportion to its inverse."""


@dataclass(frozen=True, kw_only=True)
class Strip:
    """Mesh and steps.

    Attributes
    ----------
    length, depth : float
        Length and depth of the strip.
    width : float
        Width of the elements along y.
    height : float
        Height of the elements down to `fine`; below, it grows by the factor `growth`.
    step : float
        Distance of the contact between successive increments.
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
    """Repeated passes of a line contact over an elastic-plastic half-plane.

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
        """Elements; the first row lies on the top."""
        strip = self.strip
        y = np.linspace(0, strip.length, round(strip.length / strip.width) + 1)
        mesh = skfem.MeshQuad.init_tensor(y, strip.depths)
        return skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuadS2()), intorder=3)

    @cached_property
    def unknowns(self) -> NDArray[np.int64]:
        """Number of each displacement among the unknowns; -1 at the bottom. Both ends of the strip share unknowns."""
        basis, strip = self.basis, self.strip
        y, z = np.round(basis.doflocs, 9)
        y[np.isclose(y, strip.length)] = 0.0
        is_depth_component = np.zeros(basis.N)
        is_depth_component[basis.split_indices()[1]] = 1.0
        node_numbers = np.unique(np.stack([y, z, is_depth_component]), axis=1, return_inverse=True)[1].ravel()
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
        """Element and point numbers in rows of equal depth: two arrays (depth, along y)."""
        y, z = np.round(np.asarray(self.basis.global_coordinates()), 9)
        sorted_points = np.lexsort((y.ravel(), z.ravel())).reshape(np.unique(z).size, -1)
        elements, points = np.unravel_index(sorted_points, y.shape)
        return elements, points

    @cached_property
    def z(self) -> Array:
        """Depths of the points of integration."""
        elements, points = self.order
        return np.asarray(np.asarray(self.basis.global_coordinates())[1][elements[:, 0], points[:, 0]])

    def compute_elastic_stress(self, position: float) -> Array:
        """Stress (4, element, point) of the elastic contact at a position along y."""
        y, z = np.asarray(self.basis.global_coordinates())
        distance = (y - position + 0.5 * self.strip.length) % self.strip.length - 0.5 * self.strip.length
        values = hertz_strip(distance, z, 1.0, 1.0, self.case.poisson, friction=self.case.friction)
        return np.stack([values["sigma_xx"], values["sigma_yy"], values["sigma_zz"], values["tau_yz"]])

    def compute_hooke_stress(self, strain: Array) -> Array:
        """Stress of an elastic strain, tensors (4, ...)."""
        lame = 2 * self.shear_modulus * self.case.poisson / (1 - 2 * self.case.poisson)
        stress = 2 * self.shear_modulus * strain
        stress[:3] += lame * strain[:3].sum(axis=0)
        return np.asarray(stress)

    def return_stress(self, total_strain: Array, plastic: Array, elastic: Array) -> tuple[Array, Array, Array]:
        """Residual stress, plastic strain and tangent for total strains, from the previous plastic strain.

        The tangent is (4, 4, point) with the strain 2 yz; `total` and `plastic` are tensors (4, point).
        """
        shear, hardening = self.shear_modulus, 2 / 3 * YOUNG * self.case.kinematic_hardening
        stress = self.compute_hooke_stress(total_strain - plastic) + elastic
        relative_stress = stress - hardening * plastic
        relative_stress[:3] -= relative_stress[:3].mean(axis=0)
        norm = np.sqrt((COMPONENT_WEIGHTS * relative_stress**2).sum(axis=0))
        radius = np.sqrt(2.0) * self.case.shear_yield_stress
        flows = norm > radius
        norm = np.maximum(norm, radius)
        multiplier = (norm - radius) / (2 * shear + hardening)
        normal = relative_stress / norm * flows
        new_plastic = plastic + multiplier * normal
        # Simo and Taylor, eq. (3.19), with hardening.
        factors = 1 - 2 * shear * multiplier / norm
        rotation = 2 * shear / (2 * shear + hardening) - (1 - factors)
        deviatoric_projection = np.diag([1.0, 1.0, 1.0, 0.5])
        deviatoric_projection[:3, :3] -= 1 / 3
        bulk = YOUNG / (3 * (1 - 2 * self.case.poisson))
        volumetric_stiffness = np.zeros((4, 4))
        volumetric_stiffness[:3, :3] = bulk
        normal_product = normal[:, None] * normal[None]
        tangent = volumetric_stiffness[..., None] + 2 * shear * (
            factors * deviatoric_projection[..., None] - rotation * normal_product
        )
        return stress - elastic - 2 * shear * multiplier * normal, new_plastic, tangent

    def force(self, stress: Array) -> Array:
        """Nodal forces of stresses (4, element, point), by unknown."""
        nodal_forces = np.einsum("aiep,iep,ep->ae", self.strains, stress, self.basis.dx)
        is_free = self.unknowns >= 0
        return np.asarray(np.bincount(self.unknowns[is_free], nodal_forces[is_free]), dtype=np.float64)

    def stiffness(self, tangent: Array) -> sparse.csc_matrix:
        """Stiffness matrix of the unknowns for tangents (4, 4, element, point)."""
        stress_change = np.einsum("ijep,bjep,ep->biep", tangent, self.strains, self.basis.dx, optimize=True)
        element_stiffness = np.einsum("aiep,biep->abe", self.strains, stress_change, optimize=True)
        i = np.broadcast_to(self.unknowns[:, None], element_stiffness.shape)
        j = np.broadcast_to(self.unknowns[None], element_stiffness.shape)
        is_free = (i >= 0) & (j >= 0)
        count = self.unknowns.max() + 1
        return sparse.csc_matrix((element_stiffness[is_free], (i[is_free], j[is_free])), shape=(count, count))

    def increment(
        self, displacement: Array, plastic: Array, elastic: Array, accuracy: float = 1e-5
    ) -> tuple[Array, ...]:
        """Displacements, plastic strain and residual stress in equilibrium with the contact's elastic stress."""
        shape = plastic.shape
        tolerance = accuracy * self.strip.width * self.case.shear_yield_stress
        previous_residual = np.inf
        for _ in range(100):
            nodal_displacement = np.append(displacement, 0.0)[self.unknowns]  # the bottom is held
            total_strain = np.einsum("aiep,ae->iep", self.strains, nodal_displacement)
            total_strain[3] *= 0.5
            flat_arrays = (array.reshape(4, -1) for array in (total_strain, plastic, elastic))
            stress, new_plastic, tangent = self.return_stress(*flat_arrays)
            out_of_balance = self.force(stress.reshape(shape))
            residual = np.abs(out_of_balance).max()
            if residual <= tolerance:
                return displacement, new_plastic.reshape(shape), stress.reshape(shape)
            # The previous stiffness is used while the iteration converges.
            if self.factors is None or residual > SLOW_CONVERGENCE * previous_residual:
                matrix = self.stiffness(tangent.reshape(4, 4, *shape[1:]))
                options = {"SymmetricMode": True}
                self.factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", options=options, diag_pivot_thresh=0.1)
            previous_residual = residual
            displacement = displacement - self.factors.solve(out_of_balance)
        raise RuntimeError(f"no equilibrium: the residual force is {residual:.2g}, the tolerance {tolerance:.2g}")

    def rows(self, field: Array) -> Array:
        """A field (..., element, point) as rows of equal depth (..., depth, along y)."""
        elements, points = self.order
        return np.asarray(field[..., elements, points])

    def roll_over(self) -> tuple[Array, Array, Array]:
        """Roll all passes.

        Returns
        -------
        strain : array (pass, 4, depth)
            Plastic strain after each pass, far from the contact.
        stress : array (4, depth)
            Residual stress after the last pass, without the contact, averaged along y.
        spread : array (4, depth)
            Half the range of the plastic strain along y in the same range of y.
        """
        plastic = np.zeros((4, *self.basis.dx.shape))
        displacement = np.zeros(self.unknowns.max() + 1)
        steps_per_pass = round(self.strip.length / self.strip.step)
        elastic_stresses = [self.compute_elastic_stress(index * self.strip.step) for index in range(steps_per_pass)]
        for fraction in (0.25, 0.5, 0.75):
            displacement, plastic, _ = self.increment(displacement, plastic, fraction * elastic_stresses[0])
        pass_strains = []
        y_points = np.linspace(0, self.strip.length, self.order[0].shape[1], endpoint=False)
        is_far = np.abs(y_points - 0.5 * self.strip.length) < 2.0
        for _ in range(self.case.passes):
            for elastic in [*elastic_stresses[1:], elastic_stresses[0]]:
                displacement, plastic, _ = self.increment(displacement, plastic, elastic)
            pass_strains.append(self.rows(plastic)[..., is_far].mean(axis=-1))
        spread = 0.5 * np.ptp(self.rows(plastic)[..., is_far], axis=-1)
        for fraction in (0.75, 0.5, 0.25, 0.0):
            displacement, plastic, stress = self.increment(displacement, plastic, fraction * elastic_stresses[0])
        return np.array(pass_strains), self.rows(stress).mean(axis=-1), spread
