"""Stresses in a body under a prescribed pressure on its top."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.invariants import von_mises
from contactstudy.arrays.variables import STRESSES, describe
from contactstudy.bodies.models import Body, Part
from contactstudy.cache import BoundedCache, digest
from contactstudy.checks import FloatArray
from contactstudy.fields.positions import Positions, field_positions
from contactstudy.kernels.stress import half_space_stress
from contactstudy.overlapping.problem import EndProblem
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.overlapping.stress import end_stress


def stress_field(
    body: Body,
    pressure: xr.DataArray,
    friction: float = 0.0,
    x: Positions | None = None,
    y: Positions | None = None,
    z: Positions = (0.0,),
) -> xr.Dataset:
    """Stresses at the tensor product of any x, y and z.

    Parameters
    ----------
    body : Body
        The elastic body.
    pressure : DataArray (x, y)
        Pressure in Pa, uniform in each cell; coordinates are cell centres in metres. On a body with free ends the
        cells begin at ``x = 0``, and on a finite-length space they end at its length.
    friction : float
        Coefficient ``f``; the traction on the body is ``f`` times the pressure along +y.
    x, y : sequence of float, optional
        Positions in metres, inside the body and in any order; default: the pressure's own.
    z : sequence of float
        Depths in metres, not negative.

    Returns
    -------
    Dataset
        `sigma_xx`, `sigma_yy`, `sigma_zz`, `tau_xy`, `tau_xz`, `tau_yz` and `von_mises` (x, y, z) in Pa, positive in
        tension. What is known exactly is returned exactly: free ends carry no traction, the top carries the load.

    Raises
    ------
    InvalidInputError
        If an argument is of the wrong kind, a position lies outside the body, or the grid does not fit it.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from contactstudy import FiniteLengthSpace, Material
    >>> centres = 0.125 + 0.25 * np.arange(8)
    >>> pressure = xr.DataArray(np.ones((8, 8)), coords={"x": centres, "y": centres - 1.0}, dims=("x", "y"))
    >>> body = FiniteLengthSpace(length=2.0, material=Material(1.0, 0.3))
    >>> stress = stress_field(body, pressure, x=[0.0, 1.0], y=[0.0], z=[0.5])
    >>> float(stress.sigma_xx[0, 0, 0]), round(float(stress.sigma_zz[1, 0, 0]), 3)
    (0.0, -0.954)
    """
    grid, values, positions = field_positions(body, pressure, x, y, z)
    friction = checks.finite("friction", friction)
    stresses = raw_stress(body, values, friction, grid, *positions.axes)
    _impose_free_ends(body, stresses, positions.x)
    fields = positions.dataset({name: stresses[i] for i, name in enumerate(STRESSES)})
    fields["von_mises"] = von_mises(fields)
    return describe(fields, "stresses under a prescribed pressure")


_FIELDS: BoundedCache[FloatArray] = BoundedCache(2**28, lambda fields: fields.nbytes)


def raw_stress(
    body: Body, pressure: FloatArray, friction: float, grid: Grid, x: FloatArray, y: FloatArray, z: FloatArray
) -> FloatArray:
    """Stresses (6, x, y, z) as computed: nothing is imposed on the free ends.

    Stresses are linear in the friction, so the fields under the pressure and under an equal traction are kept: a
    sweep over the friction computes them once.
    """
    key = (body, grid, friction != 0, digest(pressure, x, y, z))
    fields = _FIELDS.get(key, lambda: _unit_fields(body, pressure, grid, x, y, z, tangential=friction != 0))
    return np.asarray(fields[0] + friction * fields[1] if friction else fields[0].copy(order="K"))


def _unit_fields(
    body: Body, pressure: FloatArray, grid: Grid, x: FloatArray, y: FloatArray, z: FloatArray, *, tangential: bool
) -> FloatArray:
    """Stresses (load, 6, x, y, z) under the pressure and, if wanted, under an equal traction along +y."""
    points = (x, y, z)
    fields, *others = (
        _part_fields(part, body.material.poisson, pressure, grid, points, tangential=tangential) for part in body.parts
    )
    for other in others:
        fields += other
    return fields


def _part_fields(
    part: Part,
    poisson: float,
    pressure: FloatArray,
    grid: Grid,
    points: tuple[FloatArray, FloatArray, FloatArray],
    *,
    tangential: bool,
) -> FloatArray:
    """Stresses of one part of a body, times its weight."""
    fields = half_space_stress(pressure, poisson, grid, *points, extent=part.extent, tangential=tangential)
    if part.freed and pressure.any():
        length, mirrored_once = part.freed
        problem = EndProblem(length, poisson, pressure, grid, tangential, Resolution(), mirrored_once)
        from_ends = end_stress(problem, *points)
        # The two auxiliary bodies leave no traction on the top, by construction.
        for component in (2, 4, 5):
            from_ends[:, component][..., points[2] == 0] = 0.0
        fields += from_ends
    if part.weight != 1:
        fields *= part.weight
    return fields


def end_traction_residual(
    body: Body, pressure: FloatArray, friction: float, grid: Grid, y: FloatArray, z: FloatArray
) -> float:
    """Largest traction that the solution leaves on the free ends, over the peak pressure.

    Parameters
    ----------
    body : Body
        The elastic body.
    pressure : array (x, y)
        Pressure on the cells of `grid`, Pa.
    friction : float
        Coefficient of the traction along +y.
    grid : Grid
        Cells.
    y, z : array
        Where to look on the end faces, metres.

    Returns
    -------
    float
        0 for a body without ends.
    """
    ends = np.array([end for end in body.extent if np.isfinite(end)])
    if not ends.size or not pressure.any():
        return 0.0
    traction = raw_stress(body, pressure, friction, grid, ends, y, z)[[0, 3, 4]]
    return float(np.sqrt((traction**2).sum(axis=0)).max() / pressure.max())


def _impose_free_ends(body: Body, stresses: FloatArray, x: FloatArray) -> None:
    """Set what is known exactly on the end faces, unless the body is a comparison model that does not free them."""
    if not all(part.freed for part in body.parts):
        return
    for component in (0, 3, 4):
        stresses[component][np.isin(x, body.extent)] = 0.0
