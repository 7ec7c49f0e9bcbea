"""Residual stress of any plastic strain, or other eigenstrain, that does not depend on y."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.required import require
from contactstudy.arrays.variables import STRESSES, describe
from contactstudy.bodies.models import Body
from contactstudy.eigenstrain.body import EigenstrainBody
from contactstudy.errors import InvalidInputError
from contactstudy.passes.cells import edges_around
from contactstudy.passes.rolled_in import STRAINS

SPLITS, DEGREE = 2, 5
"""Elements per cell along either axis, and degree of their polynomials. Accuracy: 1e-4 of the largest stress a
cell away from the corners where eigenstrain ends in a step, if the cells around are as small."""


def residual_stress(
    body: Body,
    eigenstrain: xr.Dataset,
    x: object = None,
    z: object = None,
    *,
    x_edges: object = None,
    z_edges: object = None,
) -> xr.Dataset:
    """Residual stress of eigenstrains over the cross-section (x, z) of a body in which nothing depends on y.

    Parameters
    ----------
    body : Body
        Half-space, quarter-space or body between two free ends.
    eigenstrain : Dataset
        ``plastic_strain_xx``, ``_yy``, ``_zz``, ``_xy``, ``_xz``, ``_yz`` (components of the tensor, those that are
        missing are zero) along `x` and `z`, metres: uniform in cells around these positions, zero beyond. It may
        stem from plastic flow, heat or a transformation.
    x, z : sequence of float, optional
        Positions of the stresses, metres; default: those of the eigenstrain.
    x_edges, z_edges : sequence of float, optional
        Edges of the cells, metres; default: half-way between the positions, and on the top or a free end if that is as
        near to the outer position as the next one.

    Returns
    -------
    Dataset
        The six residual stresses ``sigma_xx`` ... ``tau_yz`` (x, z), Pa, in equilibrium and with free top and ends to
        rounding; between two cells the side at larger x and z. `residual_displacement_z` (into the body) and
        `residual_displacement_y` (x) of the top, metres, relative to the depth.

    Raises
    ------
    InvalidInputError
        If there is no eigenstrain, it is not finite, or cells and body do not fit.

    Examples
    --------
    Strain along y is held by stress along y alone.

    >>> from contactstudy import FiniteLengthSpace, Material
    >>> body = FiniteLengthSpace(length=1.0, material=Material(2.0, 0.3))
    >>> middles = {"x": [0.25, 0.75], "z": [1.0, 3.0, 5.0]}
    >>> stretched = xr.Dataset({"plastic_strain_yy": (("x", "z"), np.ones((2, 3)))}, middles)
    >>> found = residual_stress(body, stretched, x=[0.5], z=[0.1])
    >>> round(float(found.sigma_yy.squeeze()), 3), abs(float(found.sigma_xx.squeeze())) < 1e-3
    (-2.0, True)
    """
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    require(eigenstrain, argument="eigenstrain")
    known = [name for name in STRAINS if name in eigenstrain]
    if not known:
        raise InvalidInputError("eigenstrain", sorted(map(str, eigenstrain)), f"with one of {', '.join(STRAINS)}")
    own = {}
    for axis in ("x", "z"):
        if axis not in eigenstrain.coords:
            raise InvalidInputError("eigenstrain.coords", list(eigenstrain.coords), f"with {axis} (metres)")
        own[axis] = checks.coordinates(f"eigenstrain.{axis}", eigenstrain[axis].values)
    edges = {}
    for axis, given, (low, high) in (("x", x_edges, body.extent), ("z", z_edges, (0.0, np.inf))):
        if given is None and own[axis].size < 2:
            raise InvalidInputError(f"{axis}_edges", None, "given where there is one cell", "its size is not known")
        edges[axis] = (
            edges_around(own[axis], low, high) if given is None else checks.coordinates(f"{axis}_edges", given)
        )
        _check_edges(axis, edges[axis], own[axis], low, high)
    strain = np.zeros((6, own["x"].size, own["z"].size))
    for name in known:
        values = np.asarray(eigenstrain[name].transpose("x", "z").values, dtype=np.float64)
        if not np.isfinite(values).all():
            raise InvalidInputError(f"eigenstrain.{name}", "values that are not finite", "finite strains")
        strain[STRAINS.index(name)] = values
    wanted = {
        axis: own[axis] if given is None else checks.coordinates(axis, given) for axis, given in (("x", x), ("z", z))
    }
    low, high = body.extent
    if (wanted["x"] < low).any() or (wanted["x"] > high).any() or (wanted["z"] < 0).any():
        raise InvalidInputError("x, z", "a position outside", f"inside the body, x from {low:g} to {high:g} m")
    cells = EigenstrainBody(body.material, body.extent, edges["x"], edges["z"], SPLITS, DEGREE)
    solution = cells.solve(strain)
    sunk, dragged = solution.top_displacement(wanted["x"])
    found = xr.Dataset(
        {name: (("x", "z"), field) for name, field in zip(STRESSES, solution.stresses(**wanted), strict=True)}
        | {"residual_displacement_z": ("x", sunk), "residual_displacement_y": ("x", dragged)},
        coords=wanted,
    )
    return describe(found, "residual stress")


def _check_edges(axis: str, edges: np.ndarray, centres: np.ndarray, low: float, high: float) -> None:
    """Raise unless cells with these edges are inside the body, each around its position."""
    if edges.size != centres.size + 1 or (np.diff(edges) <= 0).any():
        raise InvalidInputError(f"{axis}_edges", edges, f"{centres.size + 1} edges, increasing (metres)")
    if edges[0] < low or edges[-1] > high:
        raise InvalidInputError(f"{axis}_edges", edges, f"inside the body, {low:g} to {high:g} m")
    if (centres < edges[:-1]).any() or (centres > edges[1:]).any():
        raise InvalidInputError(f"{axis}_edges", edges, "such that each cell holds its position")
