"""Normal displacement of the top of a body under pressure and traction: the operator of every contact solution."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.cells import labelled_cells
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.units import in_si
from contactstudy.arrays.variables import named
from contactstudy.bodies.models import Body
from contactstudy.cache import kept
from contactstudy.checks import FloatArray
from contactstudy.fields.columns import ColumnsOperator
from contactstudy.fields.loads import sliding
from contactstudy.fields.part import PartOperator
from contactstudy.kernels.load import Load
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.threads import one_blas_thread


class OperatorRequest(NamedTuple):
    """What decides a surface operator.

    Attributes
    ----------
    body : Body
        The body.
    grid : Grid
        Cells; on a body with ends they begin at ``x = 0`` and span it.
    loads : tuple of Load
        Directions of the loads that it takes, the pressure first.
    resolution : Resolution
        Quadrature settings of the free ends' part.
    """

    body: Body
    grid: Grid
    loads: tuple[Load, ...] = (Load.NORMAL,)
    resolution: Resolution = Resolution()


class SurfaceOperator:
    """Displacement of the top from pressure and traction, for one body and one grid.

    Parameters
    ----------
    body : Body
        The body.
    parts : sequence of (float, operator)
        Operators whose weighted sum is the body's.
    """

    def __init__(self, body: Body, parts: Sequence[tuple[float, PartOperator | ColumnsOperator]]) -> None:
        self.body, self._parts = body, parts

    @classmethod
    def of(cls, request: OperatorRequest) -> SurfaceOperator:
        """Build the operator.

        Raises
        ------
        InvalidInputError
            If the grid does not fit the body.
        """
        body, grid, loads, resolution = request
        body.check_span(grid)
        kind = PartOperator if grid.uniform else ColumnsOperator
        parts = [(part.weight, kind.of(body.material, part, grid, loads, resolution)) for part in body.parts]
        return cls(body, parts)

    def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
        """Displacement (m) of the cell centres under `loads` (Pa): array (x, y)."""
        weight, first = self._parts[0]
        displacement = weight * first(loads)
        for weight, part in self._parts[1:]:
            displacement += weight * part(loads)
        return displacement

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Roughly the pressure that sinks the cells by `gap`."""
        return self._parts[0][1].precondition(gap)

    @cached_property
    def coarse(self) -> SurfaceOperator:
        """The operator on cells of twice the size, roughly: what a first guess is solved with."""
        parts = [(weight, part.coarsened(self.body.material)) for weight, part in self._parts]
        return SurfaceOperator(self.body, parts)

    @property
    def grid(self) -> Grid:
        """Cells."""
        return self._parts[0][1].grid

    @property
    def reference(self) -> float:
        """Distance along y at which the displacement is zero, metres; infinite unless the body has two ends."""
        return self._parts[0][1].reference

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        return sum(part.nbytes for _, part in self._parts)


@kept("surface operators", lambda operator: operator.nbytes)
def surface_operator(request: OperatorRequest) -> SurfaceOperator:
    """Return the operator for a request; all cases with the same one share it."""
    return SurfaceOperator.of(request)


def surface_displacement(body: Body, pressure: xr.DataArray, friction: float = 0.0) -> xr.DataArray:
    """Compute how a prescribed pressure, and the friction that goes with it, sink the top of a body.

    Parameters
    ----------
    body : Body
        The elastic body.
    pressure : DataArray (x, y)
        Pressure in Pa, uniform in each cell; coordinates are cell centres in metres. On a body with free ends the
        cells begin at ``x = 0``, and on a finite-length space they end at its length.
    friction : float
        Coefficient ``f``; the traction on the body is ``f`` times the pressure along +y.

    Returns
    -------
    DataArray (x, y)
        `displacement_z` in metres, positive into the body. A finite-length space has no absolute displacement: its
        value is relative to the top far away, at the distance along y stated in the attribute ``reference_distance``.

    Raises
    ------
    InvalidInputError
        If the pressure is not a DataArray of finite numbers on a uniform grid that fits the body.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from contactstudy import HalfSpace, Material
    >>> centres = np.linspace(-0.95, 0.95, 20)
    >>> pressure = xr.DataArray(np.ones((20, 20)), coords={"x": centres, "y": centres}, dims=("x", "y"))
    >>> sunk = surface_displacement(HalfSpace(material=Material(1.0, 0.0)), pressure)
    >>> round(float(sunk.max()), 2)
    2.24
    """
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    pressure = in_si("pressure", pressure, "Pa")
    values, grid = labelled_cells("pressure", pressure, extent=body.extent)
    loads = sliding(values, checks.finite("friction", friction))
    operator = surface_operator(OperatorRequest(body, grid, tuple(loads)))
    with one_blas_thread():
        displacement = operator({load: top.values for load, top in loads.items()})
    sunk = xr.DataArray(displacement, coords={"x": pressure["x"], "y": pressure["y"]}, dims=("x", "y"))
    return named("displacement_z", sunk).assign_attrs(displacement_reference(operator.reference))


def displacement_reference(reference: float) -> dict[str, str | float]:
    """Attributes that say relative to what a displacement of the top is stated; none if it is absolute."""
    if not np.isfinite(reference):
        return {}
    return {"reference_distance": reference, "reference": "zero at |y| = reference_distance (m) on the top"}
