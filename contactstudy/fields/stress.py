"""Stresses in a body under a prescribed pressure on its top."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.invariants import von_mises
from contactstudy.arrays.variables import STRESSES, describe
from contactstudy.bodies.models import Body, Part
from contactstudy.cache import ArrayKey, kept
from contactstudy.checks import FloatArray
from contactstudy.fields.largest import Largest, largest_stress
from contactstudy.fields.loads import Loads, superposed
from contactstudy.fields.near_top import seen_by_ends
from contactstudy.fields.part import reference_of
from contactstudy.fields.positions import FieldPositions, Positions, field_positions
from contactstudy.fields.prescribed import prescribed_loads
from contactstudy.fields.search import search_under
from contactstudy.interrupts import BriefInterrupt
from contactstudy.kernels.load import Load
from contactstudy.kernels.stress import half_space_stress
from contactstudy.overlapping.field import Place
from contactstudy.overlapping.problem import CORNER_OFFSET, EndProblem, finest_cell
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.overlapping.stress import end_stress


def stress_field(
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
    """Stresses at the tensor product of any x, y and z.

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
        Whether the load is smooth near to a point, as `solve` takes it. False: it is uniform in each cell. Only then is
        the stress of a sum of loads the sum of their stresses near the top.

    Returns
    -------
    Dataset
        `sigma_xx`, `sigma_yy`, `sigma_zz`, `tau_xy`, `tau_xz`, `tau_yz` and `von_mises` (x, y, z) in Pa, positive in
        tension. On the free ends they hold the traction that the quadratures leave there, but for the
        edge at the top, which carries none. A net force along x bends a finite-length space by an amount that grows
        like the logarithm of the distance: the curvature along y is zero on the top at ten lengths, as in
        `surface_displacement`.

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
    grid, loads, own = prescribed_loads(body, pressure, friction, traction_x, traction_y)
    positions = field_positions(body, grid, x, y, z, own)
    checks.instance("smooth", smooth, (bool, np.bool_), "True or False")
    with BriefInterrupt():
        return stress_dataset(body, loads, grid, positions, smooth=bool(smooth))


def stress_dataset(
    body: Body, loads: Loads, grid: Grid, positions: FieldPositions, *, smooth: bool = True
) -> xr.Dataset:
    """Stresses under `loads` on the cells of `grid`, labelled."""
    (stresses,) = stresses_at(body, loads, grid, [Place(*positions.axes)], smooth=smooth)
    return _labelled(body, grid, stresses, positions)


def _labelled(body: Body, grid: Grid, stresses: FloatArray, positions: FieldPositions) -> xr.Dataset:
    """Label stresses (6, x, y, z)."""
    _free_edge(body, grid, stresses, positions)
    fields = positions.dataset({name: stresses[i] for i, name in enumerate(STRESSES)})
    fields["von_mises"] = von_mises(fields)
    return describe(fields, "stresses under a prescribed pressure")


def _free_edge(body: Body, grid: Grid, stresses: FloatArray, positions: FieldPositions) -> None:
    """Leave no traction on the edges between top and ends: both auxiliary bodies have a logarithm there.

    Points on an edge are evaluated a little below it. A comparison model that does not free its ends keeps what it has.
    """
    if all(part.freed for part in body.parts):
        on_end, on_top = np.isin(positions.x, body.extent), positions.z < CORNER_OFFSET * grid.dy
        for component in (0, 3, 4):
            stresses[component][np.ix_(on_end, np.ones(positions.y.size, bool), on_top)] = 0.0


def stress_under(body: Body, loads: Loads, grid: Grid, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    """Stresses (6, x, y, z)."""
    (stresses,) = stresses_at(body, loads, grid, [Place(x, y, z)])
    return stresses


def stresses_at(
    body: Body, loads: Loads, grid: Grid, places: Sequence[Place], *, smooth: bool = True
) -> list[FloatArray]:
    """Stresses (6, x, y, z) at each of some places; what frees the ends is solved for once.

    The fields under each load's distribution are kept, so that a sweep over the friction computes them once.
    """
    keys = tuple(tuple(ArrayKey(axis) for axis in place) for place in places)

    def unit_fields(directions: tuple[Load, ...], cells: FloatArray) -> dict[Load, list[FloatArray]]:
        return _unit_stress(_StressRequest(body, grid, directions, ArrayKey(cells), keys, smooth))

    return superposed(loads, unit_fields)


class _StressRequest(NamedTuple):
    """What decides the stresses under one distribution in some directions, at some places."""

    body: Body
    grid: Grid
    loads: tuple[Load, ...]
    cells: ArrayKey
    places: tuple[tuple[ArrayKey, ...], ...]
    smooth: bool


@kept("stress fields", lambda fields: sum(each.nbytes for field in fields.values() for each in field))
def _unit_stress(request: _StressRequest) -> dict[Load, list[FloatArray]]:
    """Stresses (6, x, y, z) at each place under a distribution in each direction."""
    fields: dict[Load, list[FloatArray]] = {}
    for part in request.body.parts:
        for load, own in _part_stress(part, request).items():
            fields[load] = [a + b for a, b in zip(fields[load], own, strict=True)] if load in fields else own
    return fields


class _MirroredRequest(NamedTuple):
    """What decides the stresses at one place in the half-space under a load and its mirror images."""

    load: Load
    poisson: float
    extent: tuple[float, float]
    grid: Grid
    cells: ArrayKey
    place: tuple[ArrayKey, ...]
    smooth: bool


@kept("half-space stresses", lambda field: field.nbytes)
def _mirrored_stress(request: _MirroredRequest) -> FloatArray:
    """Stresses (6, x, y, z) at a place: those under a pressure are also part of those with friction."""
    load, poisson, extent, grid, cells, place, smooth = request
    points = Place(*(axis.values for axis in place))
    return half_space_stress(load, cells.values, poisson, grid, *points, extent=extent, smooth=smooth)


def _part_stress(part: Part, request: _StressRequest) -> dict[Load, list[FloatArray]]:
    """Stresses of one part of a body, times its weight."""
    body, grid, loads, cells, keys, smooth = request
    places = [Place(*(axis.values for axis in key)) for key in keys]
    poisson = body.material.poisson
    mirrored = {
        load: [_mirrored_stress(_MirroredRequest(load, poisson, part.extent, grid, cells, key, smooth)) for key in keys]
        for load in loads
    }
    # What is kept must not be changed.
    fields: dict[Load, list[FloatArray]] = {load: [] for load in loads}
    if part.freed and cells.values.any():
        length, mirrored_once = part.freed
        seen, seen_on = seen_by_ends(cells.values, grid, length, smooth=smooth)
        problem = EndProblem(length, poisson, seen, loads, seen_on, Resolution(), mirrored_once, finest_cell(grid))
        reference = reference_of(part.extent)
        for number, (place, by_load) in enumerate(zip(places, end_stress(problem, places, reference), strict=True)):
            for load, from_ends in by_load.items():
                # The two auxiliary bodies leave no traction on the top, by construction.
                for component in (2, 4, 5):
                    from_ends[component][..., place.z == 0] = 0.0
                from_ends += mirrored[load][number]
                fields[load].append(from_ends)
    else:
        fields = {load: [field.copy("K") for field in own] for load, own in mirrored.items()}
    if part.weight != 1:
        for own in fields.values():
            for field in own:
                field *= part.weight
    return fields


class ContactStresses(NamedTuple):
    """Stresses under a contact.

    Attributes
    ----------
    field : Dataset
        Stresses where they were asked for, Pa.
    residual : float
        Largest traction that is left on the free ends, over the peak pressure.
    largest : Largest
        Largest von Mises stress in the body.
    """

    field: xr.Dataset
    residual: float
    largest: Largest


def contact_stresses(
    body: Body, loads: Loads, grid: Grid, positions: FieldPositions, y: FloatArray, z: FloatArray
) -> ContactStresses:
    """Stresses at some positions, the residual on the ends and the largest stress, for less than these cost alone.

    Parameters
    ----------
    body : Body
        The body.
    loads : mapping of Load to TopLoad
        Loads on the cells of `grid`, a pressure among them.
    grid : Grid
        Cells.
    positions : FieldPositions
        Where the stresses are wanted.
    y, z : array
        Where to look on the end faces, metres.
    """
    asked, ends, search = Place(*positions.axes), _ends(body), search_under(loads, grid, body.extent)
    places = [asked, *search.places, *([Place(ends, y, z)] if ends.size else [])]
    stresses = stresses_at(body, loads, grid, places)
    residual = _residual(loads, stresses[-1]) if ends.size else 0.0
    known = stresses[1 : 1 + len(search.places)]
    largest = largest_stress(search, known, (asked, stresses[0]), lambda place: stress_under(body, loads, grid, *place))
    return ContactStresses(_labelled(body, grid, stresses[0], positions), residual, largest)


def end_traction_residual(body: Body, loads: Loads, grid: Grid, y: FloatArray, z: FloatArray) -> float:
    """Largest traction that the solution leaves on the free ends, over the peak pressure.

    Parameters
    ----------
    body : Body
        The elastic body.
    loads : mapping of Load to TopLoad
        Loads on the cells of `grid`, a pressure among them.
    grid : Grid
        Cells.
    y, z : array
        Where to look on the end faces, metres.

    Returns
    -------
    float
        0 for a body without ends.
    """
    ends = _ends(body)
    return _residual(loads, stress_under(body, loads, grid, ends, y, z)) if ends.size else 0.0


def _ends(body: Body) -> FloatArray:
    """Positions of the free ends, metres."""
    return np.array([end for end in body.extent if np.isfinite(end)])


def _residual(loads: Loads, stresses: FloatArray) -> float:
    """Largest traction among stresses (6, ...) on the ends, over the peak pressure."""
    peak = float(loads[Load.NORMAL].values.max())
    return float(np.sqrt((stresses[[0, 3, 4]] ** 2).sum(axis=0)).max() / peak) if peak else 0.0
