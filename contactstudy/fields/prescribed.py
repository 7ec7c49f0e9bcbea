"""Prescribed loads on the top of a body, from labelled pressure and tractions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.cells import labelled_cells
from contactstudy.arrays.grid import SPACING_TOLERANCE, Grid
from contactstudy.arrays.units import in_si
from contactstudy.bodies.models import Body
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.fields.loads import Loads, TopLoad, sliding
from contactstudy.fields.positions import Labels
from contactstudy.kernels.load import Load


class PrescribedLoads(NamedTuple):
    """Checked loads.

    Attributes
    ----------
    grid : Grid
        Cells.
    loads : mapping of Load to TopLoad
        Pressure and tractions on the cells.
    labels : tuple of array
        Coordinates of the cell centres as they were given.
    """

    grid: Grid
    loads: Loads
    labels: Labels

    @property
    def pressure(self) -> FloatArray:
        """Pressure on the cells, Pa."""
        return self.loads[Load.NORMAL].values


def prescribed_loads(
    body: Body,
    pressure: xr.DataArray,
    friction: float = 0.0,
    traction_x: xr.DataArray | None = None,
    traction_y: xr.DataArray | None = None,
) -> PrescribedLoads:
    """Check loads on a body, DataArrays (x, y) in Pa that all lie on the cells of the pressure.

    Raises
    ------
    InvalidInputError
        If an argument is of the wrong kind, the cells differ, or `friction` and `traction_y` are both given.
    """
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    pressure = in_si("pressure", pressure, "Pa")
    values, grid = labelled_cells("pressure", pressure, extent=body.extent)
    friction = checks.finite("friction", friction)
    if friction and traction_y is not None:
        raise InvalidInputError("friction", friction, "0 with traction_y, which is the whole traction along y")
    loads = dict(sliding(values, friction))
    for name, load, traction in (
        ("traction_x", Load.ALONG_X, traction_x),
        ("traction_y", Load.ALONG_Y, traction_y),
    ):
        if traction is not None:
            loads[load] = TopLoad(_on_cells(name, traction, grid, body))
    return PrescribedLoads(grid, loads, (pressure["x"].values, pressure["y"].values))


def _on_cells(name: str, traction: xr.DataArray, grid: Grid, body: Body) -> FloatArray:
    """Values of a traction that lies on the cells of the pressure."""
    values, own = labelled_cells(name, in_si(name, traction, "Pa"), extent=body.extent)
    apart = SPACING_TOLERANCE * min(float(grid.widths.min()), grid.dy)
    if own.shape != grid.shape or max(np.abs(own.x_edges - grid.x_edges).max(), np.abs(own.y - grid.y).max()) > apart:
        raise InvalidInputError(f"{name}.coords", f"{own.shape} cells from x = {own.x[0]:g} m", "those of the pressure")
    return values
