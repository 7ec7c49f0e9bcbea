"""Equivalent loads as labelled data."""

from __future__ import annotations

from dataclasses import replace
from itertools import zip_longest

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.grid import Grid, Points
from contactstudy.arrays.variables import describe
from contactstudy.bodies.models import Body
from contactstudy.cache import ArrayKey
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.fields.loads import end_problem, prescribed_loads
from contactstudy.fields.positions import Positions
from contactstudy.fields.surface import REFERENCE_LENGTHS
from contactstudy.kernels.load import Load
from contactstudy.overlapping.operators import OverlappingOperators


def equivalent_loads(
    body: Body,
    pressure: xr.DataArray,
    friction: float = 0.0,
    z: Positions = (0.0,),
    *,
    traction_x: xr.DataArray | None = None,
    traction_y: xr.DataArray | None = None,
) -> xr.Dataset:
    """Compute the loads on the auxiliary bodies; the sum of their stresses equals the stress of a body with free ends.

    Parameters
    ----------
    body, pressure, friction, traction_x, traction_y
        As for :func:`contactstudy.stress_field`; the loads are uniform in each cell.
    z : sequence of float
        Depths on the end faces, metres, not negative.

    Returns
    -------
    Dataset
        `P_h1` (x, y) on the top and, for each free end, `P_v1` and `P_v2` (y, z) on the end planes, in Pa, positive in
        compression; without a free end `P_h1` equals the pressure. Towards a corner that carries load they grow like a
        logarithm; the stresses that they make together are finite. On a finite-length space the equivalent loads of an
        eccentric load contain a part without stress, which grows like the logarithm of the distance along y from the
        attribute ``reference_distance``.

    Raises
    ------
    InvalidInputError
        If an argument is of the wrong kind or out of range.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from contactstudy import Material, QuarterSpace
    >>> centres = 0.125 + 0.25 * np.arange(8)
    >>> pressure = xr.DataArray(np.ones((8, 8)), coords={"x": centres, "y": centres - 1.0}, dims=("x", "y"))
    >>> loads = equivalent_loads(QuarterSpace(material=Material(1.0, 0.3)), pressure, z=[0.5, 1.0])
    >>> bool((loads.P_h1 > pressure).all()), bool((loads.P_v1 < 0).all())
    (True, True)
    """
    checks.instance("body", body, Body, "a QuarterSpace or a FiniteLengthSpace")
    prescribed = prescribed_loads(body, pressure, friction, traction_x, traction_y)
    grid, loads, (coordinates_x, coordinates_y), _ = prescribed
    depths = checks.coordinates("z", z)
    top_load = np.array(loads[Load.NORMAL].values)
    face_totals: list[FloatArray] = []
    attributes: dict[str, str | float] = {}
    for load, (cell_loads, factor) in loads.items():
        operators = overlapping_operators(body, grid, depths, load, cell_loads)
        if operators is None:
            coords = {"x": coordinates_x, "y": coordinates_y}
            return describe(xr.Dataset({"P_h1": (("x", "y"), top_load)}, coords=coords))
        top_operator, face_operators = operators.equivalent(load)
        top_load += factor * top_operator.matvec(cell_loads.ravel()).reshape(top_load.shape)
        face_loads = [
            factor * operator.matvec(cell_loads.ravel()).reshape(grid.cells_y, -1) for operator in face_operators
        ]
        face_totals = [np.asarray(sum(terms)) for terms in zip_longest(face_totals, face_loads, fillvalue=0.0)]
        if operators.reference is not None:
            subject = "the part of an eccentric load that makes no stress"
            attributes["reference_distance"] = operators.reference
            attributes["reference"] = f"{subject} is zero at |y| = reference_distance (m)"
    fields = {"P_h1": (("x", "y"), top_load, attributes)}
    fields |= {f"P_v{end}": (("y", "z"), face_total, attributes) for end, face_total in enumerate(face_totals, start=1)}
    return describe(xr.Dataset(fields, coords={"x": coordinates_x, "y": coordinates_y, "z": depths}))


def overlapping_operators(
    body: Body, grid: Grid, depths: FloatArray, load: Load, cell_loads: FloatArray | None = None
) -> OverlappingOperators | None:
    """Operators for a load in one direction, None without a free end; `cell_loads` determine the loaded width."""
    body.check_span(grid)
    if (depths < 0).any():
        raise InvalidInputError("z", float(depths.min()), "not negative (metres below the top)")
    free_ends = next((term.free_ends for term in body.terms if term.free_ends), None)
    if free_ends is None:
        return None
    cell_loads = np.zeros(grid.shape) if cell_loads is None else cell_loads
    problem = end_problem(free_ends, body.material.poisson, ArrayKey(cell_loads), None, grid, loads=(load,))
    problem = replace(problem, resolution=problem.resolution.for_loads((load,)))
    # Two exact ends leave a part of an eccentric load without stress.
    is_relative = np.isfinite(free_ends.length) and not free_ends.mirrored_once
    reference = REFERENCE_LENGTHS * free_ends.length if is_relative else None
    return OverlappingOperators.of(problem, Points(grid.x, grid.y, depths), reference)
