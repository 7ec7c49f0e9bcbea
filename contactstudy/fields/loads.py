"""Loads on the top of a body by direction, and the superposition of their fields."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.grid import SPACING_TOLERANCE, Grid
from contactstudy.arrays.variables import in_si, labelled_cells
from contactstudy.bodies.models import Body, FreeEnds
from contactstudy.cache import ArrayKey, cached
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.fields.positions import Labels
from contactstudy.kernels.fine_cells import share_fine_cells
from contactstudy.kernels.load import Load
from contactstudy.overlapping.problem import EndProblem, finest_cell
from contactstudy.overlapping.quadrature import Resolution


class TopLoad(NamedTuple):
    """A load in one direction: a factor times a distribution over the cells."""

    cell_loads: FloatArray  # (x, y): load per area on each cell, Pa
    factor: float = 1.0  # on `cell_loads`; loads that differ by a factor share the fields of `cell_loads`

    @property
    def values(self) -> FloatArray:
        """Load per area on each cell, with the factor, Pa."""
        return self.factor * self.cell_loads


Loads = Mapping[Load, TopLoad]  # loads on the top by direction


def sliding(pressure: FloatArray, friction: float | FloatArray) -> Loads:
    """Return the pressure and, in full sliding, the traction ``q = f p`` on the body along +y."""
    loads = {Load.NORMAL: TopLoad(pressure)}
    if isinstance(friction, np.ndarray):
        return loads | {Load.ALONG_Y: TopLoad(friction * pressure)}
    return loads | {Load.ALONG_Y: TopLoad(pressure, friction)} if friction else loads


def superpose(
    loads: Loads, unit_fields: Callable[[tuple[Load, ...], ArrayKey], Mapping[Load, Sequence[FloatArray]]]
) -> list[FloatArray]:
    """Sum the fields of all loads; one call of `unit_fields` serves all loads with the same distribution."""
    groups: dict[ArrayKey, list[Load]] = {}
    for load, (cell_loads, _) in loads.items():
        groups.setdefault(ArrayKey(cell_loads), []).append(load)
    fields: dict[Load, Sequence[FloatArray]] = {}
    for distribution, directions in groups.items():
        fields |= unit_fields(tuple(directions), distribution)
    first_load, *other_loads = loads
    totals = [np.multiply(loads[first_load].factor, field, order="K") for field in fields[first_load]]
    for load in other_loads:
        for total, field in zip(totals, fields[load], strict=True):
            total += loads[load].factor * field
    return totals


@cached("end problems")
def end_problem(
    free_ends: FreeEnds, poisson: float, load: ArrayKey, shape: ArrayKey | None, grid: Grid, loads: tuple[Load, ...]
) -> EndProblem:
    """Problem of the free ends under a load on cells, on the fine cells of a `shape` inside the cells."""
    finest, cell_loads = finest_cell(grid), load.values
    if shape is not None:
        cell_loads, grid = share_fine_cells(load, shape, grid, (0.0, free_ends.length)).end_load()
    return EndProblem(
        length=free_ends.length,
        poisson=poisson,
        cell_loads=cell_loads,
        loads=loads,
        grid=grid,
        resolution=Resolution(),
        mirrored_once=free_ends.mirrored_once,
        finest=finest,
    )


def unit_problem(free_ends: FreeEnds, poisson: float, grid: Grid, load: Load) -> EndProblem:
    """Problem of the ends for unit loads on the cells along x."""
    return end_problem(free_ends, poisson, ArrayKey(np.zeros(grid.shape)), None, grid, loads=(load,)).by_mirror_sign[0]


UNIFORM = "uniform"  # value of `inside_cells` for loads that are uniform in each cell


class PrescribedLoads(NamedTuple):
    """Checked loads."""

    grid: Grid
    loads: Loads  # pressure and tractions on the cells
    labels: Labels  # coordinates of the cell centres
    shape: FloatArray | None  # (x, y): pressure that distributes the loads inside the cells; None: uniform


def prescribed_loads(
    body: Body,
    pressure: xr.DataArray,
    friction: float = 0.0,
    traction_x: xr.DataArray | None = None,
    traction_y: xr.DataArray | None = None,
    inside_cells: str | xr.DataArray = UNIFORM,
) -> PrescribedLoads:
    """Check loads on a body, DataArrays (x, y) in Pa that all lie on the cells of the pressure."""
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    pressure = in_si("pressure", pressure, "Pa")
    pressure_cells, grid = labelled_cells("pressure", pressure, extent=body.extent)
    friction = checks.finite("friction", friction)
    if friction and traction_y is not None:
        raise InvalidInputError("friction", friction, "0 with traction_y, which is the whole traction along y")
    loads = dict(sliding(pressure_cells, friction))
    for name, load, traction in (("traction_x", Load.ALONG_X, traction_x), ("traction_y", Load.ALONG_Y, traction_y)):
        if traction is not None:
            loads[load] = TopLoad(_values_on_cells(name, traction, grid, body))
    shape = None
    if not isinstance(inside_cells, str):
        shape = _values_on_cells("inside_cells", inside_cells, grid, body)
        if not shape.any():
            raise InvalidInputError(
                "inside_cells", "zero everywhere", f"a pressure with a nonzero value, or {UNIFORM!r}"
            )
    elif inside_cells != UNIFORM:
        raise InvalidInputError("inside_cells", inside_cells, f"{UNIFORM!r} or a pressure, a DataArray (x, y)")
    return PrescribedLoads(grid, loads, (pressure["x"].values, pressure["y"].values), shape)


def _values_on_cells(name: str, traction: xr.DataArray, grid: Grid, body: Body) -> FloatArray:
    """Values of a load that lies on the cells of the pressure."""
    load_cells, load_grid = labelled_cells(name, in_si(name, traction, "Pa"), extent=body.extent)
    tolerance = SPACING_TOLERANCE * min(float(grid.widths.min()), grid.dy)
    if (
        load_grid.shape != grid.shape
        or max(np.abs(load_grid.x_edges - grid.x_edges).max(), np.abs(load_grid.y - grid.y).max()) > tolerance
    ):
        raise InvalidInputError(
            f"{name}.coords", f"{load_grid.shape} cells from x = {load_grid.x[0]:g} m", "those of the pressure"
        )
    return load_cells
