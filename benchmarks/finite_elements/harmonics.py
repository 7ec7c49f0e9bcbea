"""Finite elements for the finite-length space: Fourier in y, high-order elements in x and z (scikit-fem).

For a load `cos(k y)` the displacement is `(U_x cos, U_y sin, U_z cos)(k y)`, and the amplitudes solve a real
two-dimensional problem on `0 <= x <= L`, `0 <= z <= depth`: free at `x = 0`, `x = L` and (except for the load)
`z = 0`, held at `z = depth`; a traction along x is a load of this form. A traction `q cos(k y)` along y is the same
problem shifted by a quarter period: `(U_x sin, -U_y cos, U_z sin)`.

The mesh is a tensor product of two line meshes, so the matrices are sums of Kronecker products of
one-dimensional ones, which scikit-fem assembles. Unit of stiffness is the shear modulus: stresses do not
depend on it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementLinePp, LinearForm, MeshLine  # type: ignore[import-untyped]

Array = NDArray[np.float64]
COMPONENTS = ("sigma_xx", "sigma_yy", "sigma_zz", "tau_xy", "tau_xz", "tau_yz")


@BilinearForm  # type: ignore[untyped-decorator]
def _compute_mass(u: Any, v: Any, _: Any) -> Any:
    return u * v


@BilinearForm  # type: ignore[untyped-decorator]
def _compute_stiffness(u: Any, v: Any, _: Any) -> Any:
    return u.grad[0] * v.grad[0]


@BilinearForm  # type: ignore[untyped-decorator]
def _compute_mixed(u: Any, v: Any, _: Any) -> Any:
    return u * v.grad[0]


@dataclass(kw_only=True)
class Line:
    """One-dimensional elements of one order on given element edges; `mixed` differentiates the rows."""

    edges: Array
    order: int
    basis: Basis = field(init=False)
    mass: sp.csr_matrix = field(init=False)
    stiffness: sp.csr_matrix = field(init=False)
    mixed: sp.csr_matrix = field(init=False)

    def __post_init__(self) -> None:
        mesh = MeshLine(np.asarray(self.edges, dtype=float))
        self.basis = Basis(mesh, ElementLinePp(self.order), intorder=2 * self.order + 8)
        self.mass, self.stiffness, self.mixed = (
            f.assemble(self.basis) for f in (_compute_mass, _compute_stiffness, _compute_mixed)
        )

    def load(self, g: Callable[[Array], Array]) -> Array:
        """Integrals of `g` times each shape function."""
        return np.asarray(LinearForm(lambda v, w: g(w.x[0]) * v).assemble(self.basis))

    def evaluate(self, points: Sequence[float]) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """Matrices of the values and of the derivatives at points; on an edge the mean of both elements."""
        edges, rows = np.asarray(self.edges), []
        for i, point in enumerate(points):
            is_on_edge = np.abs(edges - point) < 1e-12 * edges[-1]
            cell_end = int(np.searchsorted(edges, point - 1e-12 * edges[-1]))
            cells = {max(cell_end - 1, 0), min(cell_end, len(edges) - 2)} if is_on_edge.any() else {cell_end - 1}
            rows += [(i, cell, 1 / len(cells)) for cell in cells]
        value, slope = (sp.lil_matrix((len(points), self.basis.N)) for _ in range(2))
        for i, cell, weight in rows:
            local_point = np.array([[(points[i] - edges[cell]) / (edges[cell + 1] - edges[cell])]])
            element = ElementLinePp(self.order)  # an evaluated element caches the values of its last points
            for j in range(self.basis.Nbfun):
                shape = element.gbasis(self.basis.mapping, local_point, j, tind=np.array([cell]))[0]
                dof = self.basis.element_dofs[j, cell]
                value[i, dof] += weight * float(np.asarray(shape).ravel()[0])
                slope[i, dof] += weight * float(shape.grad.ravel()[0])
        return value.tocsr(), slope.tocsr()


class HarmonicBody:
    """Body on one mesh; each solution is for one wavenumber and any number of axial load shapes."""

    def __init__(self, x: Line, z: Line, poisson: float) -> None:
        self.x, self.z, self.poisson = x, z, poisson
        lam = 2 * poisson / (1 - 2 * poisson)
        top = z.basis.get_dofs(lambda c: np.isclose(c[0], z.edges[0])).all()
        fixed_dofs = z.basis.get_dofs(lambda c: np.isclose(c[0], z.edges[-1])).all()
        self.top = np.zeros(z.basis.N)
        self.top[top] = 1.0
        is_free = np.ones((3, x.basis.N, z.basis.N), dtype=bool)
        is_free[:, :, fixed_dofs] = False
        self._free = np.flatnonzero(is_free)
        mm, sm, ms = (sp.kron(*ab) for ab in ((x.mass, z.mass), (x.stiffness, z.mass), (x.mass, z.stiffness)))
        xm, mz = sp.kron(x.mixed, z.mass), sp.kron(x.mass, z.mixed)
        xz = lam * sp.kron(x.mixed, z.mixed.T) + sp.kron(x.mixed.T, z.mixed)
        xy, yz = lam * xm - xm.T, lam * mz.T - mz
        none = None
        blocks = (
            [[(lam + 2) * sm + ms, none, xz], [none, sm + ms, none], [xz.T, none, (lam + 2) * ms + sm]],
            [[none, xy, none], [xy.T, none, yz], [none, yz.T, none]],
            [[mm, none, none], [none, (lam + 2) * mm, none], [none, none, mm]],
        )
        self._matrices = [self._restrict_matrix(sp.bmat(p, format="csr")) for p in blocks]

    def _restrict_matrix(self, matrix: sp.csr_matrix) -> sp.csc_matrix:
        return matrix[self._free][:, self._free].tocsc()

    def solve(self, k: float, shapes: Sequence[tuple[Callable[[Array], Array], str]]) -> Array:
        """Amplitudes `[shape, component, x, z]` for unit loads `g(x) cos(k y)` in the direction "x", "y" or "z"."""
        loads = np.zeros((len(shapes), 3, self.x.basis.N, self.z.basis.N))
        for load, (g, direction) in zip(loads, shapes, strict=True):
            axial_load = np.outer(self.x.load(g), self.top)
            load["xyz".index(direction)] = -axial_load if direction == "y" else axial_load
        return self.displacements(loads, k)

    def displacements(self, loads: Array, k: float = 0.0) -> Array:
        """Amplitudes `[load, component, x, z]` for generalised forces on all shape functions, of the same shape."""
        constant, linear, square = self._matrices
        matrix = (constant + k * linear + k**2 * square).tocsc()
        factor = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        right_side = loads.reshape(len(loads), -1)[:, self._free].T
        solution = factor.solve(right_side)
        solution += factor.solve(right_side - matrix @ solution)
        amplitudes = np.zeros((len(loads), loads[0].size))
        amplitudes[:, self._free] = solution.T
        return amplitudes.reshape(loads.shape)

    def stresses(self, k: float, amplitudes: Array, x: Sequence[float], z: Sequence[float]) -> Array:
        """Stress amplitudes `[shape, component, x, z]` (order of `COMPONENTS`) at the tensor product of points.

        The factors in y are `cos` for the normal components and `tau_xz`, `sin` for `tau_xy` and `tau_yz`.
        """
        (x0, x1), (z0, z1) = self.x.evaluate(x), self.z.evaluate(z)

        def sample(matrix_x: sp.csr_matrix, amplitudes: Array, matrix_z: sp.csr_matrix) -> Array:
            return np.stack([(matrix_z @ (matrix_x @ amplitude).T).T for amplitude in amplitudes])

        ux, uy, uz = (amplitudes[:, i] for i in range(3))
        lam = 2 * self.poisson / (1 - 2 * self.poisson)
        xx, yy, zz = sample(x1, ux, z0), k * sample(x0, uy, z0), sample(x0, uz, z1)
        trace = lam * (xx + yy + zz)
        xy = sample(x1, uy, z0) - k * sample(x0, ux, z0)
        yz = sample(x0, uy, z1) - k * sample(x0, uz, z0)
        xz = sample(x0, ux, z1) + sample(x1, uz, z0)
        return np.stack([2 * xx + trace, 2 * yy + trace, 2 * zz + trace, xy, xz, yz], axis=1)

    def surface(self, amplitudes: Array, x: Sequence[float], component: int = 2) -> Array:
        """Amplitudes `[shape, x]` of `2 G` times one component of the top's displacement (`G` is the unit)."""
        return 2 * np.stack([self.x.evaluate(x)[0] @ (u[component] @ self.top) for u in amplitudes])
