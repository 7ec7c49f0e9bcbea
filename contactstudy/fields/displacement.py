"""Displacements in a body under a prescribed pressure on its top."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy.arrays.grid import Grid, Points
from contactstudy.arrays.variables import describe
from contactstudy.bodies.models import Body
from contactstudy.cache import ArrayKey
from contactstudy.checks import FloatArray
from contactstudy.fields.loads import UNIFORM, Loads, end_problem, prescribed_loads, superpose, unit_problem
from contactstudy.fields.positions import Positions, field_positions
from contactstudy.fields.surface import kernel_factor, reference_distance
from contactstudy.kernels.field import displacement_influence, half_space_field, half_space_influence
from contactstudy.kernels.load import Load
from contactstudy.overlapping.field import DISPLACEMENT, end_fields, unit_fields

COMPONENTS = ("u_x", "u_y", "u_z")


def displacement_field(
    body: Body,
    pressure: xr.DataArray,
    *,
    friction: float = 0.0,
    x: Positions | None = None,
    y: Positions | None = None,
    z: Positions = (0.0,),
    traction_x: xr.DataArray | None = None,
    traction_y: xr.DataArray | None = None,
    inside_cells: str | xr.DataArray = UNIFORM,
) -> xr.Dataset:
    """Displacements at the tensor product of any x, y and z.

    Parameters
    ----------
    body, pressure, friction, x, y, z, traction_x, traction_y, inside_cells
        As for :func:`contactstudy.stress_field`.

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
        As `stress_field`.

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
    prescribed = prescribed_loads(body, pressure, friction, traction_x, traction_y, inside_cells=inside_cells)
    positions = field_positions(body, prescribed.grid, x, y, z, labels=prescribed.labels)
    displacement = displacement_under(body, prescribed.loads, prescribed.grid, positions.points, prescribed.shape)
    fields = positions.dataset({name: displacement[i] for i, name in enumerate(COMPONENTS)})
    # Far from an infinite row of images the displacement grows like a logarithm, without an absolute value.
    reference = min(reference_distance(term.extent) for term in body.terms)
    if np.isfinite(reference):
        for name in COMPONENTS:
            fields[name].attrs["reference_distance"] = reference
            fields[name].attrs["reference"] = "rigid motion zero at |y| = reference_distance (m) on the top"
    return describe(fields, "displacements under a prescribed pressure")


def displacement_under(
    body: Body, loads: Loads, grid: Grid, points: Points, shape: FloatArray | None = None
) -> FloatArray:
    """Displacements (3, x, y, z), metres; `shape` as in `stresses_at`."""
    material, shape_key = body.material, None if shape is None else ArrayKey(shape)

    def unit_fields(directions: tuple[Load, ...], cell_loads: ArrayKey) -> dict[Load, list[FloatArray]]:
        fields = {load: np.zeros((3, *(axis.size for axis in points))) for load in directions}
        for term in body.terms:
            length, reference = term.extent[1] - term.extent[0], reference_distance(term.extent)
            end_displacements: dict[Load, FloatArray] = {}
            if term.free_ends and cell_loads.values.any():
                problem = end_problem(term.free_ends, material.poisson, cell_loads, shape_key, grid, loads=directions)
                (end_displacements,) = end_fields(problem, DISPLACEMENT, [points], reference)
            for load, total in fields.items():
                influence = displacement_influence(load, material.poisson, length, reference)
                field = half_space_field(cell_loads.values, influence, grid, points, extent=term.extent, shape=shape)
                field = kernel_factor(material) * field
                if load in end_displacements:
                    field += end_displacements[load] / (2 * material.shear_modulus)
                total += term.weight * field
        return {load: [field] for load, field in fields.items()}

    (displacement,) = superpose(loads, unit_fields)
    return displacement


POSITIONS_PER_BATCH = 32  # positions along x per evaluation, for bounded memory. Speed.


def normal_influence(body: Body, grid: Grid, load: Load, x: FloatArray, z: float) -> FloatArray:
    """Return the normal displacement at y = 0 and a depth under a unit load on each cell: array (x, cell_x, cell_y)."""
    material, normal = body.material, COMPONENTS.index("u_z")
    total = np.zeros((x.size, *grid.shape))
    for term in body.terms:
        length, reference = term.extent[1] - term.extent[0], reference_distance(term.extent)
        influence = displacement_influence(load, material.poisson, length, reference)
        for start in range(0, x.size, POSITIONS_PER_BATCH):
            batch = slice(start, start + POSITIONS_PER_BATCH)
            points = Points(x[batch], -grid.y, np.array([z]))
            field = half_space_influence(influence, grid, points, extent=term.extent)[normal, ..., 0]
            total[batch] += term.weight * kernel_factor(material) * field
        if term.free_ends:
            problem = unit_problem(term.free_ends, material.poisson, grid, load)
            line_points = Points(x, np.zeros(1), np.array([z]))
            for amplitudes, filters in unit_fields(problem, DISPLACEMENT, line_points, reference):
                field = np.einsum("xniz,njy->xij", amplitudes[normal], filters[normal], optimize=True)
                total += term.weight / (2 * material.shear_modulus) * field
    return total
