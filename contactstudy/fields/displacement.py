"""Displacements in a body under a prescribed pressure on its top."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe
from contactstudy.bodies.models import Body, Part
from contactstudy.checks import FloatArray
from contactstudy.fields.loads import Loads, superposed
from contactstudy.fields.near_top import seen_by_ends
from contactstudy.fields.part import REFERENCE_LENGTHS
from contactstudy.fields.positions import Positions, field_positions
from contactstudy.fields.prescribed import prescribed_loads
from contactstudy.kernels.displacement import half_space_displacement
from contactstudy.kernels.load import Load
from contactstudy.overlapping.displacement import end_displacement
from contactstudy.overlapping.problem import EndProblem, finest_cell
from contactstudy.overlapping.quadrature import Resolution

COMPONENTS = ("u_x", "u_y", "u_z")


def displacement_field(
    body: Body,
    pressure: xr.DataArray,
    friction: float = 0.0,
    x: Positions | None = None,
    y: Positions | None = None,
    z: Positions = (0.0,),
    *,
    traction_x: xr.DataArray | None = None,
    traction_y: xr.DataArray | None = None,
    smooth: bool = True,
) -> xr.Dataset:
    """Displacements at the tensor product of any x, y and z.

    Parameters
    ----------
    body : Body
        The elastic body.
    pressure : DataArray (x, y)
        Mean pressure in each cell, Pa; coordinates are cell centres in metres. On a body with free ends the
        cells begin at ``x = 0``, and on a finite-length space they end at its length. Between the centres the pressure
        is taken as smooth, each cell keeping its force; a load that does not fall towards its end, such as a uniform
        one, ends in a step.
    friction : float
        Coefficient ``f``; the traction on the body is ``f`` times the pressure along +y.
    x, y : sequence of float, optional
        Positions in metres, inside the body and in any order; default: the pressure's own.
    z : sequence of float
        Depths in metres, not negative.
    traction_x, traction_y : DataArray (x, y), optional
        Tractions on the body along +x and +y, Pa, on the cells of the pressure; `traction_y` instead of `friction`.
    smooth : bool
        Whether the load is smooth near to a point. False: it is uniform in each cell, as for `surface_displacement`.
        Only then is the displacement under a sum of loads the sum of their displacements near the top.

    Returns
    -------
    Dataset
        `u_x`, `u_y`, `u_z` (x, y, z) in metres. A half-space and a quarter space are at rest far away. A finite-length
        space is not, for the displacement along its load grows like a logarithm: its rigid motion, and with an
        eccentric load its tilt and with a force along x its bending, is zero on the top far away, at the distance along
        y stated in the attribute ``reference_distance``, as in `surface_displacement`.

    Raises
    ------
    InvalidInputError
        If an argument is of the wrong kind, a position lies outside the body, or the grid does not fit it.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from contactstudy import HalfSpace, Material, surface_displacement
    >>> centres = np.linspace(-0.95, 0.95, 20)
    >>> pressure = xr.DataArray(np.ones((20, 20)), coords={"x": centres, "y": centres}, dims=("x", "y"))
    >>> body = HalfSpace(material=Material(1.0, 0.0))
    >>> displacement = displacement_field(body, pressure, z=[0.0, 1.0])
    >>> bool(np.allclose(displacement.u_z.sel(z=0.0), surface_displacement(body, pressure)))
    True
    """
    grid, loads, own = prescribed_loads(body, pressure, friction, traction_x, traction_y)
    positions = field_positions(body, grid, x, y, z, own)
    checks.instance("smooth", smooth, (bool, np.bool_), "True or False")
    displacement = displacement_under(body, loads, grid, *positions.axes, smooth=bool(smooth))
    fields = positions.dataset({name: displacement[i] for i, name in enumerate(COMPONENTS)})
    reference = REFERENCE_LENGTHS * body.unbounded_row
    if np.isfinite(reference):
        for name in COMPONENTS:
            fields[name].attrs["reference_distance"] = reference
            fields[name].attrs["reference"] = "rigid motion zero at |y| = reference_distance (m) on the top"
    return describe(fields, "displacements under a prescribed pressure")


def displacement_under(
    body: Body, loads: Loads, grid: Grid, x: FloatArray, y: FloatArray, z: FloatArray, *, smooth: bool = True
) -> FloatArray:
    """Displacements (3, x, y, z), metres."""

    def unit_fields(directions: tuple[Load, ...], cells: FloatArray) -> dict[Load, list[FloatArray]]:
        fields: dict[Load, FloatArray] = {load: np.zeros((3, x.size, y.size, z.size)) for load in directions}
        for part in body.parts:
            for load, field in _part_displacement(body, part, directions, cells, grid, x, y, z, smooth).items():
                fields[load] += part.weight * field
        return {load: [field] for load, field in fields.items()}

    (displacement,) = superposed(loads, unit_fields)
    return displacement


def _part_displacement(
    body: Body,
    part: Part,
    loads: tuple[Load, ...],
    cells: FloatArray,
    grid: Grid,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    smooth: bool,
) -> dict[Load, FloatArray]:
    """Displacements (3, x, y, z) of one part of a body, before its weight."""
    material, extent = body.material, part.extent
    reference = REFERENCE_LENGTHS * (extent[1] - extent[0])
    fields = {
        load: half_space_displacement(
            load, cells, material, grid, x, y, z, extent=extent, reference=reference, smooth=smooth
        )
        for load in loads
    }
    if part.freed and cells.any():
        length, mirrored_once = part.freed
        seen, seen_on = seen_by_ends(cells, grid, length, smooth=smooth)
        problem = EndProblem(
            length, material.poisson, seen, loads, seen_on, Resolution(), mirrored_once, finest_cell(grid)
        )
        for load, from_ends in end_displacement(problem, x, y, z, reference=reference).items():
            fields[load] = fields[load] + from_ends / (2 * material.shear_modulus)
    return fields
