"""Stresses in an elastic roller, from the contact with the body."""

from __future__ import annotations

import xarray as xr

from contactstudy import checks
from contactstudy.case.case import Case
from contactstudy.case.motion import Sliding
from contactstudy.errors import InvalidInputError
from contactstudy.fields.loads import TopLoad, prescribed_loads, sliding
from contactstudy.fields.positions import Positions, field_positions
from contactstudy.fields.stress import stress_dataset
from contactstudy.kernels.load import Load


def roller_stress(
    case: Case,
    pressure: xr.DataArray,
    x: Positions | None = None,
    y: Positions | None = None,
    z: Positions = (0.0,),
    *,
    traction_x: xr.DataArray | None = None,
    traction_y: xr.DataArray | None = None,
) -> xr.Dataset:
    """Stresses in an elastic roller.

    Parameters
    ----------
    case : Case
        The case; its roller has a material.
    pressure : DataArray (x, y)
        Contact pressure on the body's cells, Pa, as in the result of `solve`.
    x, y : sequence of float, optional
        Positions, metres: x from end I of the roller, y as on the body; default: the roller's cell centres.
    z : sequence of float
        Depths into the roller, metres, not negative.
    traction_x, traction_y : DataArray (x, y), optional
        Tractions on the body, as in the result, if the roller does not slide fully.

    Returns
    -------
    Dataset
        As from `stress_field`. The traction on the roller is opposite to that on the body.

    Raises
    ------
    InvalidInputError
        If the roller is rigid, or an argument is of the wrong kind or outside the roller.

    Examples
    --------
    >>> import numpy as np
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller, solve
    >>> steel = Material(210e9, 0.3)
    >>> body = FiniteLengthSpace(length=0.3e-3, material=steel)
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.3e-3, material=steel), max_pressure=1.5e9)
    >>> result = solve(case, x=[1e-4, 2e-4], y=[0.0], z=[5e-5], accuracy=0.1)
    >>> inside = roller_stress(case, result.pressure, result.x_field, [0.0], [5e-5])  # equal bodies, equal stresses
    >>> bool(np.allclose(inside.von_mises.values, result.von_mises.values, rtol=1e-4))
    True
    """
    checks.instance("case", case, Case, "a Case")
    if case.counterbody is None:
        raise InvalidInputError("case.roller.material", None, "a Material: a rigid roller has no stresses")
    slides_fully = isinstance(case.motion, Sliding)
    if not slides_fully and (traction_x is None or traction_y is None):
        allowed = "those of the result: they do not follow from the pressure"
        raise InvalidInputError("traction_x, traction_y", None, allowed)
    grid, body_loads, *_ = prescribed_loads(case.body, pressure, 0.0, traction_x, traction_y)
    if slides_fully and traction_y is None:
        body_loads = {**body_loads, **sliding(body_loads[Load.NORMAL].cell_loads, case.friction_on(grid.x))}
    counterbody = case.counterbody
    roller_grid, loads = counterbody.grid_on_body(grid), {}
    for load, top in body_loads.items():
        factor = top.factor if load is Load.NORMAL else -top.factor
        loads[load] = TopLoad(counterbody.transfer_load(grid, top.cell_loads), factor)
    positions = field_positions(counterbody.body, roller_grid, x, y, z)
    return stress_dataset(counterbody.body, loads, roller_grid, positions, loads[Load.NORMAL].values)
