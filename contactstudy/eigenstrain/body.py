"""Residual stress of eigenstrains on cells, in a body with two free ends, one or none, and in endless layers.

Stress functions of (x, z) from piecewise polynomials: in the plane Airy's function gives ``s_xx = f,zz``,
``s_zz = f,xx``, ``s_xz = -f,xz``; across the plane ``t_xy = g,z``, ``t_yz = -g,x``. Faces are free where f and its
slope, and g, vanish. The stress of the eigenstrain e minimises the complementary energy (K. Washizu, Variational
Methods in Elasticity and Plasticity, 2nd ed. 1975):

    (1 - nu**2) / E  int lap f lap h  =  -int (e_xx + nu e_yy) h,zz + (e_zz + nu e_yy) h,xx - 2 e_xz h,xz
    (1 / G)  int grad g . grad h  =  -int 2 e_xy h,z - 2 e_yz h,x

for all functions h. ``lap f lap h`` may be written ``f,xx h,xx + f,zz h,zz + 2 f,xz h,xz``, since h vanishes with its
slope on all sides. Elements are the cells or equal parts of them, and beyond the cells elements that grow: to the ends,
to a depth of negligible stress, and without an end to a distance of little stress.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.interpolate import BSpline
from scipy.sparse.linalg import splu

from contactstudy.bodies.material import Material
from contactstudy.checks import FloatArray, IntArray

Factors = tuple[list[FloatArray], list[FloatArray]]  # Values, slopes, ... of functions along x, and along z


@dataclass(frozen=True, eq=False)
class Splines:
    """Basis of piecewise polynomials."""

    edges: FloatArray  # edges of the elements, metres, increasing
    degree: int  # degree of the polynomials
    continuity: int  # number of derivatives that are continuous between elements
    vanishing_orders: int  # number of derivatives, from the value on, that vanish on both sides

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
        """Functions, or their derivatives, at points: array (point, function); at edges those of the right element."""
        spline_count = self._knots.size - self.degree - 1
        function_values = BSpline(self._knots, np.eye(spline_count), self.degree)(points, nu=derivative)
        return np.asarray(function_values[:, self.vanishing_orders : spline_count - self.vanishing_orders])

    @cached_property
    def _gauss(self) -> tuple[FloatArray, FloatArray]:
        """Points and weights that integrate products of two functions exactly: arrays (element, point)."""
        nodes, weights = np.polynomial.legendre.leggauss(self.degree + 1)
        half_widths = 0.5 * np.diff(self.edges)[:, None]
        return self.edges[:-1, None] + half_widths * (1 + nodes), half_widths * weights

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
        scaled_energy = sparse.csc_array(sparse.diags_array(scale) @ energy @ sparse.diags_array(scale))
        factor = splu(scaled_energy, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
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


DEGREE = 4  # degree of the polynomials of Airy's function. Accuracy.
MAX_ELEMENT_SIZE = 0.2  # largest element near the cells, over the distance of two ends. Accuracy.
GROWTH = 1.5  # ratio of neighbouring elements beyond the cells. Accuracy.

FAR_DISTANCE = 1000.0
"""Without an end: distance of the last element, over the extent of the cells. Accuracy: the error of the stress falls
with the square of this distance, the error of the top's displacement with the distance."""

DEEP_LENGTHS = 8.0
"""Between two ends: depth below the cells at which the elements end, over the length. Accuracy: stress without
resultant decays like exp(-4.2 z / L) between the ends."""

XX, YY, ZZ, XY, XZ, YZ = range(6)  # components in the order of every array of stresses


def grow_edges(start: float, stop: float, first_width: float) -> FloatArray:
    """Edges from `start` (excluded) to `stop`; the widths of the elements grow from about `first_width`."""
    count = max(1, int(np.ceil(np.log1p(abs(stop - start) * (GROWTH - 1) / first_width) / np.log(GROWTH))))
    # The widths are shrunk a little, such that the last element ends at `stop`.
    edges = start + (stop - start) * np.cumsum(GROWTH ** np.arange(count)) / (GROWTH ** np.arange(count)).sum()
    edges[-1] = stop
    return np.asarray(edges)


def grade_to_face(start: float, face: float, first_width: float) -> FloatArray:
    """Edges from `start` (excluded) to a free face, with fine elements at `start` and at the face."""
    midpoint = 0.5 * (start + face)
    if start == face:
        return np.zeros(0)
    near_edges = grow_edges(start, midpoint, first_width)
    return np.concatenate([near_edges, start + face - np.append(start, near_edges[:-1])[::-1]])


@dataclass(frozen=True, kw_only=True, eq=False)
class EigenstrainBody:
    """A body, and cells of (x, z) with uniform eigenstrains."""

    material: Material
    extent: tuple[float, float]  # ends of the body along x, metres; infinite for none
    x_edges: FloatArray  # edges of the cells, metres
    z_edges: FloatArray
    splits: int = 1  # elements per cell along either axis
    degree: int = DEGREE  # degree of the polynomials of Airy's function

    @cached_property
    def elements(self) -> tuple[FloatArray, FloatArray]:
        """Edges of the elements along x and z, metres."""
        length = self.extent[1] - self.extent[0]
        x, z = (_split_cells(edges, self.splits, MAX_ELEMENT_SIZE * length) for edges in (self.x_edges, self.z_edges))
        far_distance = FAR_DISTANCE * max(np.ptp(x), z[-1])
        side_edges = []
        for end, edge, width, sign in zip(self.extent, x[[0, -1]], np.diff(x)[[0, -1]], (-1, 1), strict=True):
            is_free = np.isfinite(end)
            side_edges.append(
                grade_to_face(edge, end, width) if is_free else grow_edges(edge, edge + sign * far_distance, width)
            )
        edges_above = grade_to_face(z[0], 0.0, z[1] - z[0])[::-1]
        edges_below = grow_edges(z[-1], z[-1] + min(DEEP_LENGTHS * length, far_distance), z[-1] - z[-2])
        return np.concatenate([side_edges[0][::-1], x, side_edges[1]]), np.concatenate([edges_above, z, edges_below])

    @cached_property
    def functions(self) -> tuple[StressFunction, StressFunction]:
        """Airy's function, of the stresses xx, zz and xz, and the antiplane function, of the stresses xy and yz."""
        airy = (Splines(edges, self.degree, continuity=1, vanishing_orders=2) for edges in self.elements)
        antiplane = (Splines(edges, self.degree - 1, continuity=0, vanishing_orders=1) for edges in self.elements)
        return StressFunction(*airy), StressFunction(*antiplane)

    @cached_property
    def integrals(self) -> tuple[Factors, Factors]:
        """Integrals of both functions and of their derivatives over the cells."""
        airy, antiplane = (function.integrals(self.x_edges, self.z_edges) for function in self.functions)
        return airy, antiplane

    def solve(self, eigenstrain: FloatArray) -> EigenstrainSolution:
        """Solve for the stress functions of eigenstrains (6, cell x, cell z): tensor components xx, ..., yz."""
        e, nu = eigenstrain, self.material.poisson
        (airy_function, antiplane_function), ((x, z), (antiplane_x, antiplane_z)) = self.functions, self.integrals
        loads = x[0] @ (e[XX] + nu * e[YY]) @ z[2].T + x[2] @ (e[ZZ] + nu * e[YY]) @ z[0].T  # eq. (503)
        loads -= 2 * x[1] @ e[XZ] @ z[1].T
        airy = airy_function.solve(-self.material.plane_strain_modulus * loads.reshape(-1, 1)).reshape(loads.shape)
        loads = 2 * (antiplane_x[0] @ e[XY] @ antiplane_z[1].T - antiplane_x[1] @ e[YZ] @ antiplane_z[0].T)
        antiplane = np.zeros_like(loads)
        if e[[XY, YZ]].any():
            antiplane = antiplane_function.solve(-self.material.shear_modulus * loads.reshape(-1, 1))
        return EigenstrainSolution(self, e, airy, antiplane.reshape(loads.shape))


@dataclass(frozen=True, eq=False)
class EigenstrainSolution:
    """Stress functions of some eigenstrains."""

    body: EigenstrainBody  # body and cells
    eigenstrain: FloatArray  # (6, cell x, cell z): the eigenstrains
    airy: FloatArray  # (function x, function z): coefficients of the stress functions
    antiplane: FloatArray

    def stresses(self, x: FloatArray, z: FloatArray) -> FloatArray:
        """Residual stresses at the tensor product of positions: array (6, x, z), xx, yy, zz, xy, xz, yz in Pa."""
        airy, antiplane = (function.values(x, z) for function in self.body.functions)
        return self._assemble_stresses(airy, antiplane, self.eigenstrain_at(x, z))

    def cell_averages(self) -> FloatArray:
        """Residual stresses averaged over the cells: array (6, cell x, cell z), Pa."""
        body = self.body
        widths, heights = np.diff(body.x_edges)[:, None], np.diff(body.z_edges)[:, None]
        airy, antiplane = (
            ([matrix.T / widths for matrix in along_x], [matrix.T / heights for matrix in along_z])
            for along_x, along_z in body.integrals
        )
        return self._assemble_stresses(airy, antiplane, self.eigenstrain)

    def _assemble_stresses(self, airy: Factors, antiplane: Factors, eigenstrain: FloatArray) -> FloatArray:
        """Stresses from the functions' derivatives along x and z."""
        (x, z), material = airy, self.body.material
        stress = np.zeros((6, x[0].shape[0], z[0].shape[0]))
        stress[XX] = x[0] @ self.airy @ z[2].T
        stress[ZZ] = x[2] @ self.airy @ z[0].T
        stress[XZ] = -x[1] @ self.airy @ z[1].T
        # No strain along y: s_yy = nu (s_xx + s_zz) - E e_yy.
        stress[YY] = material.poisson * (stress[XX] + stress[ZZ]) - material.young * eigenstrain[YY]
        x, z = antiplane
        stress[XY] = x[0] @ self.antiplane @ z[1].T
        stress[YZ] = -x[1] @ self.antiplane @ z[0].T
        return stress

    def eigenstrain_at(self, x: FloatArray, z: FloatArray) -> FloatArray:
        """Eigenstrains at the tensor product of positions: array (6, x, z); zero beyond the cells."""
        body = self.body
        indices, is_inside = [], []
        for points, edges in ((x, body.x_edges), (z, body.z_edges)):
            index = np.searchsorted(edges, points, side="right") - 1
            index[points == edges[-1]] = edges.size - 2
            is_inside.append((index >= 0) & (index < edges.size - 1))
            indices.append(np.clip(index, 0, edges.size - 2))
        strain = self.eigenstrain[:, indices[0][:, None], indices[1]]
        return np.where(is_inside[0][:, None] & is_inside[1], strain, 0.0)

    def top_displacement(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Displacements z (into the body) and y of the top at positions x, metres, relative to the lowest elements."""
        # The displacements are integrals of the strains zz and yz, eigenstrains included, over the depth.
        body, material = self.body, self.body.material
        nu, young = material.poisson, material.young
        z_elements = body.elements[1]
        depth_range = z_elements[[0, -1]]
        airy, antiplane = body.functions
        airy_z = [airy.z.integrals(depth_range, d)[:, 0] for d in (0, 2)]
        s_xx, s_zz = airy.x.values(x) @ self.airy @ airy_z[1], airy.x.values(x, 2) @ self.airy @ airy_z[0]
        heights = np.diff(body.z_edges)
        centres = 0.5 * (body.z_edges[1:] + body.z_edges[:-1])
        e = self.eigenstrain_at(x, centres) @ heights
        # e_zz = (1 + nu) / E ((1 - nu) s_zz - nu s_xx) + eigenstrain zz + nu eigenstrain yy
        strain_zz = (1 + nu) / young * ((1 - nu) * s_zz - nu * s_xx) + e[ZZ] + nu * e[YY]
        s_yz = -antiplane.x.values(x, 1) @ self.antiplane @ antiplane.z.integrals(depth_range, 0)[:, 0]
        return -strain_zz, -(s_yz / material.shear_modulus + 2 * e[YZ])


def _split_cells(edges: FloatArray, splits: int, max_width: float) -> FloatArray:
    """Edges of cells and of equal parts of them, none wider than `max_width`."""
    widths = np.diff(edges)
    counts = np.maximum(splits, np.ceil(widths / max_width - 1e-9)).astype(int)
    starts = [
        edge + width * np.arange(count) / count for edge, width, count in zip(edges, widths, counts, strict=False)
    ]
    return np.append(np.concatenate(starts), edges[-1])


COLUMNS_PER_SOLUTION = 256  # Right-hand sides of one solution. Speed.


def cell_influence(body: EigenstrainBody, along_x: IntArray, along_z: IntArray) -> Callable[[FloatArray], FloatArray]:
    """Residual stresses (6, cell) of eigenstrains (6, cell), in the cells with these indices along x and along z."""
    areas = np.diff(body.x_edges)[along_x] * np.diff(body.z_edges)[along_z]

    def integrals_of(integrals: Factors, i: int, j: int) -> sparse.csc_array:
        """Integrals of the functions' derivatives over each of the cells: array (function, cell)."""
        x, z = (sparse.csc_array(matrix) for matrix in (integrals[0][i][:, along_x], integrals[1][j][:, along_z]))
        products = [sparse.kron(x[:, [cell]], z[:, [cell]], format="csc") for cell in range(along_x.size)]
        return sparse.csc_array(sparse.hstack(products))

    def influence_matrix(function: StressFunction, blocks: list[sparse.csc_array], factors: FloatArray) -> FloatArray:
        """Cell averages of the stresses per eigenstrain times `factors`, over minus the modulus."""
        right_sides = sparse.csc_array(sparse.hstack(blocks))
        averages = sparse.csr_array(right_sides.T)
        influence = np.empty((right_sides.shape[1],) * 2)
        for start in range(0, influence.shape[1], COLUMNS_PER_SOLUTION):
            columns = right_sides[:, start : start + COLUMNS_PER_SOLUTION].toarray()
            influence[:, start : start + COLUMNS_PER_SOLUTION] = averages @ function.solve(columns)
        return influence / np.tile(areas, len(blocks))[:, None] * np.repeat(factors, areas.size)

    (airy_function, antiplane_function), (integrals, antiplane_integrals) = body.functions, body.integrals
    airy = [integrals_of(integrals, 0, 2), integrals_of(integrals, 2, 0), -integrals_of(integrals, 1, 1)]
    antiplane = [integrals_of(antiplane_integrals, 0, 1), -integrals_of(antiplane_integrals, 1, 0)]
    nu, young = body.material.poisson, body.material.young
    # Stresses xx, zz, xz per eigenstrains xx + nu yy, zz + nu yy, xz; stresses xy, yz per eigenstrains xy, yz
    airy_matrix = influence_matrix(airy_function, airy, np.array([1.0, 1.0, 2.0]))
    airy_matrix *= -body.material.plane_strain_modulus
    antiplane_matrix = influence_matrix(antiplane_function, antiplane, np.array([2.0, 2.0]))
    antiplane_matrix *= -body.material.shear_modulus

    def stresses(e: FloatArray) -> FloatArray:
        stress = np.empty_like(e)
        strain = np.concatenate([e[XX] + nu * e[YY], e[ZZ] + nu * e[YY], e[XZ]])
        stress[[XX, ZZ, XZ]] = (airy_matrix @ strain).reshape(3, -1)
        stress[[XY, YZ]] = (antiplane_matrix @ np.concatenate([e[XY], e[YZ]])).reshape(2, -1)
        stress[YY] = nu * (stress[XX] + stress[ZZ]) - young * e[YY]
        return stress

    return stresses


def layer_stresses(material: Material, eigenstrain: FloatArray) -> FloatArray:
    """Residual stresses (6, layer) from eigenstrains (6, layer) in endless layers, without strains along x and y."""
    e, nu, modulus = eigenstrain, material.poisson, material.plane_strain_modulus
    stress = np.zeros_like(e)
    stress[XX], stress[YY] = -modulus * (e[XX] + nu * e[YY]), -modulus * (e[YY] + nu * e[XX])
    stress[XY] = -2 * material.shear_modulus * e[XY]
    return stress


@dataclass(frozen=True, eq=False)
class PeriodicLayers:
    """Layers, endless along x, whose eigenstrain is given at equal distances along y, on a closed path."""

    # For one wave along y the complementary energy of Airy's function ``f(z) exp(i k y)`` is least where, for all h,
    #     (1 - nu**2) / E  int f'' h'' + 2 k**2 f' h' + k**4 f h
    #         =  -int (e_yy + nu e_xx) h'' - k**2 (e_zz + nu e_xx) h + 2 i k e_yz h'.
    # The stresses ``t_xy = g'``, ``t_xz = -i k g`` across the plane follow from the same principle. With e_yz and e_xz
    # over i all terms are real.

    material: Material
    z_edges: FloatArray  # edges of the layers, metres
    positions: int  # number of positions along y
    step: float  # distance from one position to the next, metres; negative where y falls

    def _matrices(self, degree: int, order: int) -> FloatArray:
        """Stresses (over i if imaginary) in the layers per eigenstrain, over minus the modulus, for every wave."""
        waves, z = 2 * np.pi * np.fft.rfftfreq(self.positions, abs(self.step)), self.z_edges
        # The elements over depth: the layers, and elements above and below.
        edges_above = grade_to_face(z[0], 0.0, z[1] - z[0])[::-1]
        elements = np.concatenate([edges_above, z, grow_edges(z[-1], FAR_DISTANCE * z[-1], z[-1] - z[-2])])
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
        plane_strains = np.stack([e[YY] + nu * e[XX], e[ZZ] + nu * e[XX], e[YZ]])
        stress[[YY, ZZ, YZ]] = self._apply(self._airy_matrices, plane_strains)
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
