"""Melan's bound by equilibrium finite elements: linear stresses in triangles, tractions that match between them.

The elements follow S. W. Sloan, Lower bound limit analysis using finite elements and linear programming, Int. J.
Numer. Anal. Meth. Geomech. 12 (1988) 61: in each triangle the stress is linear and in equilibrium; across each side
the tractions are continuous, and on the faces zero.
"""

from __future__ import annotations

from collections import defaultdict

import clarabel
import numpy as np
from numpy.typing import NDArray
from scipy import sparse

Array = NDArray[np.float64]
OFFSETS = (0.2, 0.7), (0.25, 0.75)
"""Points per rectangle, over its sides: each triangle contains one at least, and its sides contain none."""


def list_point_positions(edges: Array, axis: int) -> Array:
    """Positions of the points along x (0) or z (1)."""
    offsets = np.array(OFFSETS[axis])
    return (edges[:-1, None] + np.diff(edges)[:, None] * offsets).ravel()


class Elements:
    """Triangles of a rectangle; unknowns are (xx, zz, xz) at the corners of each."""

    def __init__(self, x: Array, z: Array) -> None:
        self.x, self.z = x, z
        self.triangles: list[Array] = []
        for i in range(x.size - 1):
            for j in range(z.size - 1):
                a, b, c, d = ([x[i + k], z[j + n]] for k, n in ((0, 0), (1, 0), (1, 1), (0, 1)))
                self.triangles += [np.array([a, b, c]), np.array([a, c, d])]
        self.count = 9 * len(self.triangles)

    def equilibrium(self) -> sparse.csr_array:
        """Equations of equilibrium in the triangles, across their sides and on the faces."""
        rows: list[dict[int, float]] = []
        sides: dict[tuple[tuple[float, ...], ...], list[tuple[int, Array]]] = defaultdict(list)
        for index, corners in enumerate(self.triangles):
            slopes = np.linalg.inv(np.column_stack([np.ones(3), corners]))[1:]
            for row_component, shear_component in ((0, 2), (2, 1)):  # xx,x + xz,z and xz,x + zz,z
                row: dict[int, float] = defaultdict(float)
                for corner in range(3):
                    row[9 * index + 3 * corner + row_component] += slopes[0, corner]
                    row[9 * index + 3 * corner + shear_component] += slopes[1, corner]
                rows.append(row)
            for corner_index in range(3):
                next_index = (corner_index + 1) % 3
                ends = sorted((tuple(corners[corner_index]), tuple(corners[next_index])))
                tangent = np.subtract(ends[1], ends[0])
                normal = np.array([tangent[1], -tangent[0]]) / np.hypot(*tangent)
                for end in ends:
                    corner = corner_index if tuple(corners[corner_index]) == end else next_index
                    sides[(*ends, end)].append((9 * index + 3 * corner, normal))
        for elements in sides.values():
            for direction in range(2):
                row = defaultdict(float)
                for sign, (start, normal) in zip((1.0, -1.0), elements, strict=False):
                    components = (0, 2) if direction == 0 else (2, 1)
                    row[start + components[0]] += sign * normal[0]
                    row[start + components[1]] += sign * normal[1]
                rows.append(row)
        entries = [(i, j, value) for i, row in enumerate(rows) for j, value in row.items()]
        i, j, values = zip(*entries, strict=True)
        return sparse.csr_array((values, (i, j)), shape=(len(rows), self.count))

    def stress_matrices(self) -> list[sparse.csr_array]:
        """Matrices from the unknowns to the stresses xx, zz, xz at all points (x first)."""
        x, z = list_point_positions(self.x, 0), list_point_positions(self.z, 1)
        matrices = [sparse.lil_array((x.size * z.size, self.count)) for _ in range(3)]
        for i, point_x in enumerate(x):
            for j, point_z in enumerate(z):
                rectangle = (i // 2) * (self.z.size - 1) + j // 2
                upper = OFFSETS[1][j % 2] > OFFSETS[0][i % 2]
                element = 2 * rectangle + int(upper)
                corners = self.triangles[element]
                weights = np.linalg.solve(np.vstack([np.ones(3), corners.T]), [1.0, point_x, point_z])
                for component in range(3):
                    for corner in range(3):
                        matrices[component][i * z.size + j, 9 * element + 3 * corner + component] = weights[corner]
        return [matrix.tocsr() for matrix in matrices]


def minimize_shear_yield_stress(history: Array, x: Array, z: Array) -> float:
    """Least k for histories (point, instant, 6) at the points of a mesh with edges `x` and `z`."""
    elements = Elements(x, z)
    equations, (xx, zz, xz) = elements.equilibrium(), elements.stress_matrices()
    count, instants = history.shape[:2]
    root_3 = np.sqrt(3.0)
    sxx, syy, szz, sxy, sxz, syz = np.moveaxis(history, -1, 0)
    blocks = [
        np.zeros((count, instants)),
        syy - 0.5 * (sxx + szz),
        0.5 * root_3 * (sxx - szz),
        root_3 * sxz,
        root_3 * np.sqrt(sxy**2 + syz**2),
    ]
    rows = np.arange(count * instants)
    point = rows // instants

    # Unknowns: the bound on von Mises' stress, the free stress along y at each point, the stresses.
    def make_cone_rows(cone_row: int, matrix: sparse.sparray) -> sparse.csr_array:
        selection = sparse.csr_array(
            (np.full(rows.size, -1.0), (5 * rows + cone_row, rows)), shape=(5 * rows.size, rows.size)
        )
        return selection @ matrix

    bound = make_cone_rows(0, sparse.csr_array(np.ones((rows.size, 1))))
    free_stress = make_cone_rows(1, sparse.csr_array((np.ones(rows.size), (rows, point)), shape=(rows.size, count)))
    stress = make_cone_rows(2, 0.5 * root_3 * (xx - zz)[point]) + make_cone_rows(3, root_3 * xz[point])
    constraints = sparse.hstack([sparse.csr_array((equations.shape[0], 1 + count)), equations])
    matrix = sparse.vstack([constraints, sparse.hstack([bound, free_stress, stress])], format="csc")
    right_side = np.concatenate([np.zeros(equations.shape[0]), np.stack(blocks, axis=-1).ravel()])
    cost = np.zeros(1 + count + elements.count)
    cost[0] = 1.0
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    cones = [clarabel.ZeroConeT(equations.shape[0])] + [clarabel.SecondOrderConeT(5)] * rows.size
    zero_matrix = sparse.csc_array((cost.size, cost.size))
    solution = clarabel.DefaultSolver(zero_matrix, cost, matrix, right_side, cones, settings=settings).solve()
    return float(solution.obj_val) / root_3
