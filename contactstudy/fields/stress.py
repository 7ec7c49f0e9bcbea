"""Stresses in a body under a prescribed pressure on its top."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.sparse.linalg import LinearOperator

from contactstudy.arrays.grid import Grid, Points
from contactstudy.arrays.variables import STRESSES, describe
from contactstudy.bodies.models import Body
from contactstudy.cache import ArrayKey, recall, retain
from contactstudy.checks import FloatArray
from contactstudy.fields.loads import UNIFORM, Loads, end_problem, prescribed_loads, superpose, unit_problem
from contactstudy.fields.positions import FieldPositions, Positions, field_positions
from contactstudy.fields.stress_maximum import Search, StressMaximum, find_stress_maximum, include_points
from contactstudy.fields.surface import reference_distance
from contactstudy.kernels.field import half_space_field, stress_influence
from contactstudy.kernels.load import Load
from contactstudy.overlapping.field import STRESS, UnitFields, end_fields, unit_fields
from contactstudy.overlapping.problem import CORNER_OFFSET
from contactstudy.stress import von_mises


def stress_field(
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
    """Stresses at the tensor product of any x, y and z.

    Parameters
    ----------
    body : Body
        The elastic body.
    pressure : DataArray (x, y)
        Mean pressure in each cell, Pa; coordinates are cell centres in metres. On a body with free ends the
        cells begin at ``x = 0``, and on a finite-length space they end at its length.
    friction : float
        Coefficient ``f``; the traction on the body is ``f`` times the pressure along +y.
    x, y : sequence of float, optional
        Positions in metres, inside the body and in any order; default: the pressure's positions.
    z : sequence of float
        Depths in metres, not negative.
    traction_x, traction_y : DataArray (x, y), optional
        Tractions on the body along +x and +y, Pa, on the cells of the pressure; `traction_y` instead of `friction`.
    inside_cells : "uniform" or DataArray (x, y)
        Distribution of the loads inside the cells: uniform, or the shape of a given pressure on the same cells, usually
        the contact pressure of `solve`. Its smooth form is continuous and falls to zero inside the last cells; a load
        is this form times a ratio, linear between centres and faces, and the cells keep the sum of their forces. For a
        given argument the field is linear in the loads. The error under a Hertz pressure at a third of a cell below
        the top is 7e-2 of the largest pressure with uniform cells, 1.5e-3 with the shape. At the corners of uniform
        cells on the top `tau_xy` is unbounded: a position there yields an arbitrary finite value, a centre does not.

    Returns
    -------
    Dataset
        `sigma_xx`, `sigma_yy`, `sigma_zz`, `tau_xy`, `tau_xz`, `tau_yz` and `von_mises` (x, y, z) in Pa, positive in
        tension. On the free ends they contain the residual traction of the quadratures, except on the edge at the top.
        A net force along x bends a finite-length space by an amount that grows like the logarithm of the distance: the
        curvature along y is zero on the top at ten lengths, as in `surface_displacement`.

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
    >>> abs(float(stress.sigma_xx[0, 0, 0])) < 1e-5, round(float(stress.sigma_zz[1, 0, 0]), 3)
    (True, -0.954)
    """
    prescribed = prescribed_loads(body, pressure, friction, traction_x, traction_y, inside_cells=inside_cells)
    positions = field_positions(body, prescribed.grid, x, y, z, labels=prescribed.labels)
    return stress_dataset(body, prescribed.loads, prescribed.grid, positions, prescribed.shape)


def stress_dataset(
    body: Body, loads: Loads, grid: Grid, positions: FieldPositions, shape: FloatArray | None
) -> xr.Dataset:
    """Stresses under `loads` on the cells of `grid`, labelled."""
    (stresses,) = stresses_at(body, loads, grid, [positions.points], shape)
    return _label_stresses(body, grid, stresses, positions)


def _label_stresses(body: Body, grid: Grid, stresses: FloatArray, positions: FieldPositions) -> xr.Dataset:
    """Label stresses (6, x, y, z)."""
    _clear_edge_traction(body, grid, stresses, positions.points)
    fields = positions.dataset({name: stresses[i] for i, name in enumerate(STRESSES)})
    fields["von_mises"] = von_mises(fields)
    return describe(fields, "stresses under a prescribed pressure")


def _clear_edge_traction(body: Body, grid: Grid, stresses: FloatArray, points: Points) -> None:
    """Set the traction on the edges between top and free ends to zero, where both auxiliary bodies have a logarithm."""
    if all(term.free_ends for term in body.terms):
        is_on_end, is_on_top = np.isin(points.x, body.extent), points.z < CORNER_OFFSET * grid.dy
        for component in (0, 3, 4):
            stresses[component][np.ix_(is_on_end, np.ones(points.y.size, bool), is_on_top)] = 0.0


def stresses_at(
    body: Body, loads: Loads, grid: Grid, point_sets: Sequence[Points], shape: FloatArray | None
) -> list[FloatArray]:
    """Stresses (6, x, y, z) at each set of points, from one solution for the equivalent loads."""
    # The pressure `shape` determines the distribution inside the cells; None: uniform. All frictions of a sweep share
    # the cached fields of each direction.
    point_keys = tuple(ArrayKey(axis) for points in point_sets for axis in points)
    shape_key = None if shape is None else ArrayKey(shape)

    def unit_fields(directions: tuple[Load, ...], cell_loads: ArrayKey) -> dict[Load, list[FloatArray]]:
        keys = {load: (body, grid, load, cell_loads, point_keys, shape_key) for load in directions}
        fields: dict[Load, list[FloatArray]] = {load: recall("stress fields", key) or [] for load, key in keys.items()}
        missing_loads = tuple(load for load, field in fields.items() if not field)
        missing_fields = _unit_stress(body, grid, missing_loads, cell_loads, point_sets=point_sets, shape=shape_key)
        for load, field in missing_fields.items():
            fields[load] = retain("stress fields", keys[load], field)
        return fields

    return superpose(loads, unit_fields)


def _unit_stress(
    body: Body,
    grid: Grid,
    loads: tuple[Load, ...],
    cell_loads: ArrayKey,
    *,
    point_sets: Sequence[Points],
    shape: ArrayKey | None,
) -> dict[Load, list[FloatArray]]:
    """Stresses (6, x, y, z) at each set of points under a distribution in each direction."""
    poisson, shape_values = body.material.poisson, None if shape is None else shape.values
    fields: dict[Load, list[FloatArray]] = {}
    for term in body.terms:
        end_stresses: list[dict[Load, FloatArray]] = [{} for _ in point_sets]
        if term.free_ends and cell_loads.values.any() and loads:
            problem = end_problem(term.free_ends, poisson, cell_loads, shape, grid, loads=loads)
            end_stresses = end_fields(problem, STRESS, point_sets, reference_distance(term.extent))
        for load in loads:
            term_fields, influence = [], stress_influence(load, poisson)
            for points, end_stress in zip(point_sets, end_stresses, strict=True):
                field = half_space_field(
                    cell_loads.values, influence, grid, points, extent=term.extent, shape=shape_values
                )
                if load in end_stress:
                    # The two auxiliary bodies leave no traction on the top, by construction.
                    for component in (2, 4, 5):  # eq. (1)
                        end_stress[load][component][..., points.z == 0] = 0.0
                    field = np.add(end_stress[load], field, out=end_stress[load])
                term_fields.append(field if term.weight == 1 else term.weight * field)
            fields[load] = (
                [a + b for a, b in zip(fields[load], term_fields, strict=True)] if load in fields else term_fields
            )
    return fields


class ContactStresses(NamedTuple):
    """Stresses of a contact."""

    field: xr.Dataset  # at positions
    end_residual: float  # residual on the free ends
    maximum: StressMaximum  # largest stress in the body
    further_stresses: list[FloatArray]  # at further sets of points: arrays (6, x, y, z)


def contact_stresses(
    body: Body,
    loads: Loads,
    search: Search,
    positions: FieldPositions,
    *,
    end_yz: tuple[FloatArray, FloatArray],
    further_points: Sequence[Points] = (),
) -> ContactStresses:
    """Return stresses at positions and further points, the residual on the ends, and the largest stress in the body."""
    end_positions, pressure = _end_positions(body), loads[Load.NORMAL].values

    def stress_at(points: Points) -> FloatArray:
        return stresses_at(body, loads, search.grid, [points], pressure)[0]

    # All sets share one solution for the equivalent loads.
    end_points = [Points(end_positions, *end_yz)] if end_positions.size else []
    point_sets = [positions.points, *end_points, *search.samples, *further_points]
    field, *stresses = stresses_at(body, loads, search.grid, point_sets, pressure)
    residual = _traction_residual(loads, stresses.pop(0)) if end_points else 0.0
    sample_count = len(search.samples)
    maximum = find_stress_maximum(search, stresses[:sample_count], stress_at)
    maximum = include_points(maximum, positions.points, field, search, stress_at)
    labelled_field = _label_stresses(body, search.grid, field, positions)
    return ContactStresses(labelled_field, residual, maximum, stresses[sample_count:])


def end_traction_residual(body: Body, loads: Loads, grid: Grid, y: FloatArray, z: FloatArray) -> float:
    """Largest traction on the free ends at `y` and `z` over the peak pressure; 0 for a body without ends."""
    ends = _end_positions(body)
    if not ends.size:
        return 0.0
    (stresses,) = stresses_at(body, loads, grid, [Points(ends, y, z)], loads[Load.NORMAL].values)
    return _traction_residual(loads, stresses)


def _end_positions(body: Body) -> FloatArray:
    """Positions of the free ends, metres."""
    return np.array([end for end in body.extent if np.isfinite(end)])


def _traction_residual(loads: Loads, stresses: FloatArray) -> float:
    """Largest traction among stresses (6, ...) on the ends, over the peak pressure."""
    peak = float(loads[Load.NORMAL].values.max())
    return float(np.sqrt((stresses[[0, 3, 4]] ** 2).sum(axis=0)).max() / peak) if peak else 0.0  # eq. (2)


class StressOperator(LinearOperator):  # type: ignore[misc]
    """Stresses (component, x, y, z) from a load in one direction on cells, uniform in each cell."""

    # The mirrored half-space is a matrix per cell along x and per distance along y; the free ends are amplitudes times
    # filters along y.

    def __init__(self, body: Body, grid: Grid, points: Points, load: Load) -> None:
        self._grid, self._shape = grid, (6, *(axis.size for axis in points))
        distances = points.y[:, None] - grid.y[None, :] + grid.y[0]
        unique_distances, distance_indices = np.unique(np.round(distances / grid.dy, 9), return_inverse=True)
        self._distance_indices = distance_indices.reshape(distances.shape)
        self._half_space = np.zeros((grid.cells_x, 6, points.x.size, unique_distances.size, points.z.size))
        self._end_fields: list[UnitFields] = []
        poisson = body.material.poisson
        for term in body.terms:
            for cell in range(grid.cells_x):
                unit_load = np.zeros(grid.shape)
                unit_load[cell, 0] = term.weight
                distance_points = points._replace(y=unique_distances * grid.dy)
                self._half_space[cell] += half_space_field(
                    unit_load, stress_influence(load, poisson), grid, distance_points, extent=term.extent
                )
            if term.free_ends:
                problem = unit_problem(term.free_ends, poisson, grid, load)
                for amplitudes, filters in unit_fields(problem, STRESS, points, reference_distance(term.extent)):
                    amplitudes[[2, 4, 5]] *= (points.z != 0) * term.weight
                    amplitudes[[0, 1, 3]] *= term.weight
                    self._end_fields.append(UnitFields(amplitudes, filters))
        self._mask = np.ones(self._shape)
        _clear_edge_traction(body, grid, self._mask, points)
        super().__init__(np.float64, (int(np.prod(self._shape)), grid.cells_x * grid.cells_y))

    def _matvec(self, vector: FloatArray) -> FloatArray:
        cell_loads = vector.reshape(self._grid.shape)
        stresses = np.zeros(self._shape)
        for index, distance_indices in enumerate(self._distance_indices):
            stresses[:, :, index] = np.tensordot(
                cell_loads, self._half_space[:, :, :, distance_indices], ([0, 1], [0, 3])
            )
        for amplitudes, filters in self._end_fields:
            filtered = np.einsum("ij,cnjy->cniy", cell_loads, filters, optimize=True)
            stresses += np.einsum("cxniz,cniy->cxyz", amplitudes, filtered, optimize=True)
        return (self._mask * stresses).ravel()

    def _rmatvec(self, vector: FloatArray) -> FloatArray:
        stresses = self._mask * vector.reshape(self._shape)
        cell_loads = np.zeros(self._grid.shape)
        for index, distance_indices in enumerate(self._distance_indices):
            kernel = self._half_space[:, :, :, distance_indices]
            cell_loads += np.tensordot(kernel, stresses[:, :, index], ([1, 2, 4], [0, 1, 2]))
        for amplitudes, filters in self._end_fields:
            filtered = np.einsum("cxniz,cxyz->cniy", amplitudes, stresses, optimize=True)
            cell_loads += np.einsum("cniy,cnjy->ij", filtered, filters, optimize=True)
        return cell_loads.ravel()
