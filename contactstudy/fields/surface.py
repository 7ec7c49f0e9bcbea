"""Displacements of the top of a body under pressure and traction: the operator of every contact solution."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import overload

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe, name_array
from contactstudy.bodies.models import Body
from contactstudy.cache import cached
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.fields.body_operators import ColumnsOperator, UniformOperator, end_kernel_of, reference_distance
from contactstudy.fields.loads import prescribed_loads
from contactstudy.kernels.load import Load, Response
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.threads import one_blas_thread

NORMAL = (Load.NORMAL,)  # directions of a contact without friction
RESOLUTION = Resolution()  # quadrature settings of the free ends' part


class SurfaceOperator:
    """Displacements of the top from pressure and traction, for one body and one grid."""

    def __init__(self, body: Body, operators: Sequence[tuple[float, UniformOperator | ColumnsOperator]]) -> None:
        self.body, self._operators = body, operators

    @classmethod
    def of(
        cls,
        body: Body,
        grid: Grid,
        loads: tuple[Load, ...] = NORMAL,
        directions: tuple[Load, ...] = NORMAL,
        resolution: Resolution = RESOLUTION,
    ) -> SurfaceOperator:
        """Build the operator from loads, the pressure first, to displacements in some directions."""
        # Between ends the cells begin at ``x = 0`` and span the body.
        body.check_span(grid)
        operator_class = ColumnsOperator if grid.observes_means else UniformOperator
        responses = tuple(Response(direction, load) for direction in directions for load in loads)
        operators = []
        with one_blas_thread():
            for term in body.terms:
                ends_kernel = end_kernel_of(term, body.material, grid, responses, resolution)
                operators.append(
                    (term.weight, operator_class.of(body.material, term.extent, grid, responses, ends_kernel))
                )
        return cls(body, operators)

    def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
        """Displacement (m) of the cells along z under `loads` (Pa): array (x, y)."""
        return self.compute_displacements(loads, (Load.NORMAL,))[Load.NORMAL]

    def compute_displacements(
        self, loads: Mapping[Load, FloatArray], directions: Sequence[Load]
    ) -> dict[Load, FloatArray]:
        """Displacements (m) of the cells in some `directions` under `loads` (Pa): arrays (x, y)."""
        weight, first_operator = self._operators[0]
        displacements = first_operator(loads, directions)
        if weight != 1:
            displacements = {direction: weight * displacement for direction, displacement in displacements.items()}
        for weight, operator in self._operators[1:]:
            for direction, displacement in operator(loads, directions).items():
                displacements[direction] += weight * displacement
        return displacements

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Approximate pressure for a normal displacement `gap`."""
        return self._operators[0][1].precondition(gap)

    @cached_property
    def coarse(self) -> SurfaceOperator:
        """Approximate operator on cells of twice the size, for an initial guess."""
        operators = [(weight, operator.coarsen(self.body.material)) for weight, operator in self._operators]
        return SurfaceOperator(self.body, operators)

    @property
    def grid(self) -> Grid:
        """Grid of the cells."""
        return self._operators[0][1].grid

    @property
    def reference(self) -> float:
        """Distance along y at which the displacement is zero, metres; infinite unless the body has two ends."""
        return reference_distance(self.body.terms[0].extent)


def surface_operator(
    body: Body, grid: Grid, loads: tuple[Load, ...] = NORMAL, directions: tuple[Load, ...] = NORMAL
) -> SurfaceOperator:
    """Return the operator of a body, shared by all cases of the body at any reference depth."""
    return _cached_operator(replace(body, reference_depth=None), grid, loads, directions)


_cached_operator = cached("surface operators")(SurfaceOperator.of)


@overload
def surface_displacement(
    body: Body,
    pressure: xr.DataArray,
    friction: float = ...,
    *,
    traction_x: xr.DataArray | None = ...,
    traction_y: xr.DataArray | None = ...,
    components: None = ...,
) -> xr.DataArray: ...


@overload
def surface_displacement(
    body: Body,
    pressure: xr.DataArray,
    friction: float = ...,
    *,
    traction_x: xr.DataArray | None = ...,
    traction_y: xr.DataArray | None = ...,
    components: Sequence[str],
) -> xr.Dataset: ...


def surface_displacement(
    body: Body,
    pressure: xr.DataArray,
    friction: float = 0.0,
    *,
    traction_x: xr.DataArray | None = None,
    traction_y: xr.DataArray | None = None,
    components: Sequence[str] | None = None,
) -> xr.DataArray | xr.Dataset:
    """Compute the displacement of the top of a body under a prescribed pressure and tractions.

    Parameters
    ----------
    body, pressure, friction, traction_x, traction_y
        As for :func:`contactstudy.stress_field`; the loads are uniform in each cell.
    components : sequence of str, optional
        Some of "x", "y" and "z"; default: the normal displacement alone, as a DataArray.

    Returns
    -------
    DataArray (x, y) or Dataset
        `displacement_z`, positive into the body, in metres; of several components a Dataset of `displacement_x`,
        `displacement_y` and `displacement_z`. The displacement of a finite-length space is relative
        to the top far away, at the distance along y stated in the attribute ``reference_distance``. A net force along
        x bends it, by an amount that depends on the distance: its curvature along y is zero far away, too.

    Raises
    ------
    InvalidInputError
        If a load is not a DataArray of finite numbers on a grid that fits the body, the loads' cells differ, or
        `friction` and `traction_y` are both given.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from contactstudy import HalfSpace, Material
    >>> centres = np.linspace(-0.95, 0.95, 20)
    >>> pressure = xr.DataArray(np.ones((20, 20)), coords={"x": centres, "y": centres}, dims=("x", "y"))
    >>> body = HalfSpace(material=Material(1.0, 0.0))
    >>> round(float(surface_displacement(body, pressure).max()), 2)
    2.24
    """
    prescribed = prescribed_loads(body, pressure, friction, traction_x, traction_y)
    axes = {name[-1]: direction for name, direction in DISPLACEMENTS.items()}
    selected = "z" if components is None else components
    directions = tuple(dict.fromkeys(axes[checks.known_name("components", axis, axes)] for axis in selected))
    if not directions:
        raise InvalidInputError("components", components, "at least one of x, y and z, or None")
    grid, loads = prescribed.grid, prescribed.loads
    operator = surface_operator(body, grid, tuple(loads), directions=directions)
    with one_blas_thread():
        displacements = operator.compute_displacements({load: top.values for load, top in loads.items()}, directions)
    attributes: dict[str, str | float] = {}
    if np.isfinite(operator.reference):
        reference = "zero at |y| = reference_distance (m) on the top"
        attributes = {"reference_distance": operator.reference, "reference": reference}
    coords = {"x": pressure["x"], "y": pressure["y"]}
    fields = {
        name: name_array(name, xr.DataArray(displacements[direction], coords, dims=("x", "y"))).assign_attrs(attributes)
        for name, direction in DISPLACEMENTS.items()
        if direction in displacements
    }
    if components is None:
        return fields["displacement_z"]
    return describe(xr.Dataset(fields), "displacements of the top under a prescribed load")


DISPLACEMENTS = {"displacement_x": Load.ALONG_X, "displacement_y": Load.ALONG_Y, "displacement_z": Load.NORMAL}
"""Variables of the surface displacement."""
