"""Equivalent loads as labelled data."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.variables import describe
from contactstudy.bodies.models import Body
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.fields.loads import grouped
from contactstudy.fields.part import REFERENCE_LENGTHS
from contactstudy.fields.positions import Positions
from contactstudy.fields.prescribed import prescribed_loads
from contactstudy.kernels.load import Load
from contactstudy.overlapping.equivalent import EquivalentLoads, equivalent_loads_of
from contactstudy.overlapping.problem import EndProblem
from contactstudy.overlapping.quadrature import Resolution


def equivalent_loads(
    body: Body,
    pressure: xr.DataArray,
    friction: float = 0.0,
    z: Positions = (0.0,),
    *,
    traction_x: xr.DataArray | None = None,
    traction_y: xr.DataArray | None = None,
) -> xr.Dataset:
    """Compute the loads on the auxiliary bodies whose stresses together are those of a body with free ends.

    Parameters
    ----------
    body : Body
        A quarter space or a finite-length space.
    pressure : DataArray (x, y)
        Pressure in Pa on cells that begin at ``x = 0``, as for `stress_field`.
    friction : float
        Coefficient ``f`` of the traction along +y.
    z : sequence of float
        Depths on the end faces, metres, not negative.
    traction_x, traction_y : DataArray (x, y), optional
        Tractions on the body along +x and +y, Pa, on the cells of the pressure; `traction_y` instead of `friction`.

    Returns
    -------
    Dataset
        `P_h1` (x, y) on the top, `P_v1` and, with a second end, `P_v2` (y, z) on the end planes, in Pa, positive in
        compression. They grow like a logarithm towards a corner that carries load, where only the stresses that they
        make together are finite. On a finite-length space those of an eccentric load have a part that makes no
        stress and grows like the logarithm of the distance along y at which it is zero: see the attribute
        ``reference_distance``.

    Raises
    ------
    InvalidInputError
        If the body has no end, or an argument is of the wrong kind or out of range.

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
    freed = next((part.freed for part in body.parts if part.freed), None)
    if freed is None:
        raise InvalidInputError("body", body, "a body with a free end: a half-space needs no equivalent loads")
    prescribed = prescribed_loads(body, pressure, friction, traction_x, traction_y)
    grid, loads, (label_x, label_y) = prescribed
    body.check_span(grid)
    depths = checks.coordinates("z", z)
    if (depths < 0).any():
        raise InvalidInputError("z", float(depths.min()), "not negative (metres below the top)")
    length, mirrored_once = freed
    relative = np.isfinite(length) and not mirrored_once
    reference = REFERENCE_LENGTHS * length if relative else None
    poisson, resolution = body.material.poisson, Resolution()

    def unit_loads(directions: tuple[Load, ...], cells: FloatArray) -> dict[Load, EquivalentLoads]:
        problem = EndProblem(length, poisson, cells, directions, grid, resolution, mirrored_once)
        return equivalent_loads_of(problem, grid.x, grid.y, depths, reference=reference)

    unit = grouped(loads, unit_loads)
    added, first, second = (
        np.asarray(sum(top.factor * unit[load][i] for load, top in loads.items())) for i in range(3)
    )
    attributes: dict[str, str | float] = {}
    if reference is not None:
        attributes = {
            "reference_distance": reference,
            "reference": "the part of an eccentric load that makes no stress is zero at |y| = reference_distance (m)",
        }
    fields = {
        "P_h1": (("x", "y"), prescribed.pressure + added, attributes),
        "P_v1": (("y", "z"), first, attributes),
    }
    if np.isfinite(length):
        fields["P_v2"] = (("y", "z"), second, attributes)
    return describe(xr.Dataset(fields, coords={"x": label_x, "y": label_y, "z": depths}))
