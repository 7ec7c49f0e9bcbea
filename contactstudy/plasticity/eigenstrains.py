"""Residual stress of any plastic strain, or other eigenstrain, that does not depend on y."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.variables import STRESSES, describe, require
from contactstudy.bodies.models import Body
from contactstudy.checks import FloatArray
from contactstudy.eigenstrain.body import EigenstrainBody
from contactstudy.errors import InvalidInputError

STRAINS = tuple(f"plastic_strain_{pair}" for pair in ("xx", "yy", "zz", "xy", "xz", "yz"))  # tensor components

# Elements per cell along either axis, and degree of their polynomials. Accuracy: 1e-4 of the largest stress at a
# cell's distance from corners of the eigenstrain, if the neighbouring cells are as small
SPLITS, DEGREE = 2, 5


def eigenstrain_stress(
    body: Body,
    eigenstrain: xr.Dataset,
    x: object = None,
    z: object = None,
    *,
    x_edges: object = None,
    z_edges: object = None,
) -> xr.Dataset:
    """Residual stress of eigenstrains over the cross-section (x, z) of a body with fields uniform along y.

    Parameters
    ----------
    body : Body
        Half-space, quarter-space or body between two free ends.
    eigenstrain : Dataset
        ``plastic_strain_xx``, ``_yy``, ``_zz``, ``_xy``, ``_xz``, ``_yz`` (components of the tensor; missing
        components are zero) along `x` and `z`, metres: uniform in cells around these positions, zero beyond. It may
        stem from plastic flow, heat or a transformation.
    x, z : sequence of float, optional
        Positions of the stresses, metres; default: the positions of the eigenstrain.
    x_edges, z_edges : sequence of float, optional
        Edges of the cells, metres; default: half-way between the positions, and on the top or a free end that is as
        near to the outer position as the next position.

    Returns
    -------
    Dataset
        The six residual stresses ``sigma_xx`` ... ``tau_yz`` (x, z), Pa, in equilibrium, with top and ends free to
        rounding; between two cells the side at larger x and z. `residual_displacement_z` (into the body) and
        `residual_displacement_y` (x) of the top, metres, relative to the depth.

    Raises
    ------
    InvalidInputError
        If the eigenstrain is missing or not finite, or cells and body do not fit.

    Examples
    --------
    Strain along y causes stress along y alone.

    >>> from contactstudy import FiniteLengthSpace, Material
    >>> body = FiniteLengthSpace(length=1.0, material=Material(2.0, 0.3))
    >>> midpoints = {"x": [0.25, 0.75], "z": [1.0, 3.0, 5.0]}
    >>> stretched = xr.Dataset({"plastic_strain_yy": (("x", "z"), np.ones((2, 3)))}, midpoints)
    >>> result = eigenstrain_stress(body, stretched, x=[0.5], z=[0.1])
    >>> round(float(result.sigma_yy.squeeze()), 3), abs(float(result.sigma_xx.squeeze())) < 1e-3
    (-2.0, True)
    """
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    require(eigenstrain, argument="eigenstrain")
    names = [name for name in STRAINS if name in eigenstrain]
    if not names:
        raise InvalidInputError("eigenstrain", sorted(map(str, eigenstrain)), f"with one of {', '.join(STRAINS)}")
    axes, edges = {}, {}
    for axis, points, given_edges, (low, high) in (("x", x, x_edges, body.extent), ("z", z, z_edges, (0.0, np.inf))):
        if axis not in eigenstrain.coords:
            raise InvalidInputError("eigenstrain.coords", list(eigenstrain.coords), f"with {axis} (metres)")
        centres = checks.coordinates(f"eigenstrain.{axis}", eigenstrain[axis].values)
        if given_edges is not None:
            cell_edges = checks.coordinates(f"{axis}_edges", given_edges)
        elif centres.size < 2:
            raise InvalidInputError(f"{axis}_edges", None, "given for one cell", "its size is unknown")
        else:
            cell_edges = edges_between(centres, low, high)
        if cell_edges.size != centres.size + 1 or (np.diff(cell_edges) <= 0).any():
            raise InvalidInputError(f"{axis}_edges", cell_edges, f"{centres.size + 1} edges, increasing (metres)")
        if cell_edges[0] < low or cell_edges[-1] > high:
            raise InvalidInputError(f"{axis}_edges", cell_edges, f"inside the body, {low:g} to {high:g} m")
        if (centres < cell_edges[:-1]).any() or (centres > cell_edges[1:]).any():
            raise InvalidInputError(f"{axis}_edges", cell_edges, "such that each cell holds its position")
        edges[axis] = cell_edges
        axes[axis] = centres if points is None else checks.coordinates(axis, points)
        if (axes[axis] < low).any() or (axes[axis] > high).any():
            raise InvalidInputError(axis, "a position outside", f"inside the body, from {low:g} to {high:g} m")
    strain = np.zeros((6, edges["x"].size - 1, edges["z"].size - 1))
    for name in names:
        values = np.asarray(eigenstrain[name].transpose("x", "z").values, dtype=np.float64)
        if not np.isfinite(values).all():
            raise InvalidInputError(f"eigenstrain.{name}", "values that are not finite", "finite strains")
        strain[STRAINS.index(name)] = values
    cells = EigenstrainBody(
        material=body.material, extent=body.extent, x_edges=edges["x"], z_edges=edges["z"], splits=SPLITS, degree=DEGREE
    )
    solution = cells.solve(strain)
    normal_displacement, axial_displacement = solution.top_displacement(axes["x"])
    result = xr.Dataset(
        {name: (("x", "z"), field) for name, field in zip(STRESSES, solution.stresses(**axes), strict=True)}
        | {"residual_displacement_z": ("x", normal_displacement), "residual_displacement_y": ("x", axial_displacement)},
        coords=axes,
    )
    return describe(result, "residual stress")


def edges_between(positions: FloatArray, low: float, high: float) -> FloatArray:
    """Edges half-way between positions; an outer cell ends at `low` or `high` if as near as the next position."""
    midpoints = 0.5 * (positions[1:] + positions[:-1])
    first_edge = low if positions[0] - low <= positions[1] - positions[0] else 2 * positions[0] - midpoints[0]
    last_edge = high if high - positions[-1] <= positions[-1] - positions[-2] else 2 * positions[-1] - midpoints[-1]
    return np.concatenate([[first_edge], midpoints, [last_edge]])
