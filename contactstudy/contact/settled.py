"""Contact of a case on columns that settle its peak and end pressures."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe, without_error
from contactstudy.bodies.models import EndedBody
from contactstudy.cache import ArrayKey, kept
from contactstudy.case.case import Case
from contactstudy.case.doubts import changed
from contactstudy.case.gridding import columns_of
from contactstudy.case.motion import Rolling, Sliding
from contactstudy.checks import FloatArray
from contactstudy.contact.axial_shape import AxialShape
from contactstudy.contact.contact import Contact, Settings, Shape, check_window, contact_of, contact_operator
from contactstudy.contact.end_law import elastic_exponent
from contactstudy.contact.prescribed import Prescribed
from contactstudy.contact.problem import ContactProblem, solve_normal
from contactstudy.contact.refinement import Pressed, Refined, read_again, refined_contact, rough_contact
from contactstudy.errors import WindowError
from contactstudy.kernels.load import Load
from contactstudy.threads import one_blas_thread

WINDOWS = (2.0, 3.0, 5.0, 8.0, 12.0)
"""Half-widths of the window over that of the Hertz contact, tried in turn. Speed."""

ROOM, COUPLED_ROOM, MOVED_ROOM = 1.1, 1.4, 1.5
"""Least window over the extent of the contact along y. Speed; what lies outside is not pressed, but with stick and slip
the contact is solved on half of the cells too, and the slip of rolling is taken from two cells ahead."""

WINDOW_STEP = 2 ** (1 / 6)
"""Ratio of the windows that are taken, from the Hertz half-width on: cases of a study share them, and with them the
kernels of the ends. Speed."""

CELLS_Y, ROUGH_CELLS_Y = (32, 64, 128, 256), 16
"""Numbers of cells along y, of which the first that suffices is taken, and that of the first contact. Accuracy."""

BETWEEN_CELLS, SHARE_OF_Y = 0.7, 0.25
"""Part of the peak that lies between its cells along y, times the square of their number across the contact, and the
part of the accuracy that it may take. Accuracy."""


@dataclass(frozen=True, eq=False)
class SettledContact:
    """A contact and what is known of its accuracy."""

    contact: Contact
    refined: Refined

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        shape = self.contact.shape
        arrays = (self.contact.pressure, self.contact.displacement, self.refined.pressure, shape.gap.values)
        return sum(array.nbytes for array in arrays)


def settled_contact(case: Case, accuracy: float, tolerance: float) -> SettledContact:
    """Contact of a case, its columns refined until its peak and end pressures are settled.

    Raises
    ------
    WindowError
        If the contact is wider than the widest window.
    """
    if not isinstance(case.motion, Sliding):
        # No creepage or shift changes the columns.
        case = changed(case, friction=0.0, motion=Rolling())
    request = _Request(case if case.coupled else changed(case, friction=0.0), accuracy, tolerance)
    return _kept(request) if _is_value(case) else _settled(request)


class _Request(NamedTuple):
    """What decides a settled contact: friction does not, unless it is coupled."""

    case: Case
    accuracy: float
    tolerance: float


def _is_value(part: object) -> bool:
    """Whether something is compared by its values, which cannot change: a profile of the user's own may not be."""
    if is_dataclass(part):
        frozen = bool(getattr(type(part), "__dataclass_params__").frozen)  # noqa: B009 - mypy does not know it
        return frozen and all(_is_value(getattr(part, each.name)) for each in fields(part))
    if isinstance(part, tuple):
        return all(_is_value(each) for each in part)
    return part is None or isinstance(part, (str, int, float, np.number, np.bool_))


def _settled(request: _Request) -> SettledContact:
    """Solve for a settled contact."""
    case, accuracy, tolerance = request
    *narrower, widest = WINDOWS
    for window in narrower:
        with contextlib.suppress(WindowError):
            return _within(case, window * case.hertz_half_width, accuracy, tolerance)
    return _within(case, widest * case.hertz_half_width, accuracy, tolerance)


_kept = kept("settled contacts", lambda settled: settled.nbytes)(_settled)


def _within(case: Case, half_window: float, accuracy: float, tolerance: float) -> SettledContact:
    """Contact in a window that is first fitted to it."""
    shape = _axial_shape(case)
    with one_blas_thread():
        # How wide the contact is depends on what frees the ends by little, and that is what takes longest to prepare.
        body = case.body
        mirrored = replace(body, model="mirror") if isinstance(body, EndedBody) and body.model == "exact" else body
        first = _Solver(changed(case, body=mirrored), half_window, ROUGH_CELLS_Y)
        rough = rough_contact(first, shape)
        touched = np.flatnonzero(rough.pressure.any(axis=0))
        cells = first.grid(rough.edges)
        reach = float(np.abs(cells.y[touched]).max()) + 0.5 * cells.dy
        # Coupled friction moves the contact along y.
        window = min(_shared_window(case, reach), half_window)
        at_peak = rough.pressure[int(rough.pressure.max(axis=1).argmax())] > 0
        solver = _Solver(case, window, _cells_across(float(at_peak.sum()) * cells.dy / (2 * window), accuracy))
        # The law of an end shows in how its outermost columns are split, one by one.
        refined = refined_contact(solver, shape, accuracy, None if rough.singular(shape) else rough.edges)
    whole = solver.shape(refined.edges)
    contact = contact_of(whole, Settings(tolerance))
    if whole.coupled_friction:
        refined = read_again(refined, contact.pressure[_under(whole.grid, refined.edges)], shape)
    return SettledContact(contact, refined)


def _shared_window(case: Case, reach: float) -> float:
    """Half-width of a window that holds a contact up to `reach`, metres, and that similar cases have as well."""
    room = COUPLED_ROOM if case.coupled else ROOM
    if not isinstance(case.motion, Sliding):
        room = MOVED_ROOM
    least = room * reach / case.hertz_half_width
    return float(case.hertz_half_width * WINDOW_STEP ** np.ceil(np.log(least) / np.log(WINDOW_STEP)))


def _cells_across(part: float, accuracy: float) -> int:
    """Return how many cells along y resolve a peak where the contact takes this `part` of the window."""
    needed = np.sqrt(BETWEEN_CELLS / (SHARE_OF_Y * accuracy)) / part
    return next((cells for cells in CELLS_Y if cells >= needed), CELLS_Y[-1])


def settled_values(settled: SettledContact) -> xr.Dataset:
    """Label what is settled, each value with its error; the law of a singular end instead of its pressure."""
    refined = settled.refined
    values: dict[str, float] = {"peak_pressure": refined.peak, "peak_pressure_error": refined.peak_error}
    dy = settled.contact.shape.grid.dy
    for name, side in (("first", 0), ("last", 1)):
        law = refined.laws[side]
        values |= {
            f"peak_pressure_{name}": refined.peaks[side],
            f"peak_pressure_{name}_error": refined.peak_errors[side],
            f"end_pressure_{name}": refined.ends[side],
            f"end_pressure_{name}_error": refined.end_errors[side],
            f"end_load_{name}": dy * refined.loads[side],
            f"end_load_{name}_error": dy * refined.load_errors[side],
        }
        if law is not None:
            values |= {
                f"end_exponent_{name}": law.exponent,
                f"end_intensity_{name}": law.intensity,
                f"end_intensity_{name}_error": law.intensity_error,
            }
    sharper = max((law for law in refined.laws if law), key=lambda law: np.nan_to_num(law.intensity), default=None)
    if sharper is not None:
        values |= {
            "end_exponent": sharper.exponent,
            "end_intensity": sharper.intensity,
            "end_intensity_error": sharper.intensity_error,
        }
    result = xr.Dataset(values)
    if any(law and law.fitted for law in refined.laws):
        result = without_error(result, *(str(name) for name in result if str(name).startswith("end_exponent")))
    for key, intensity in result.items():
        if str(key).startswith("end_intensity"):
            exponent = float(result[str(key).replace("intensity", "exponent").removesuffix("_error")])
            intensity.attrs["units"] = f"Pa m{exponent:.3g}"
    if not refined.settled:
        result["peak_pressure_error"].attrs["comment"] = "more than the accuracy: the most columns were reached"
    return describe(result)


def shape_on(case: Case, grid: Grid, prescribed: Prescribed | None = None) -> Shape:
    """Return what is pressed on what, on given cells; under the case's load unless something else is prescribed."""
    gap = case.gap(grid)
    prescribed = (prescribed or prescribed_by(case)).checked(gap, grid)
    return Shape(case.body, grid, ArrayKey(gap), prescribed, case.counterbody, case.coupled_friction)


def prescribed_by(case: Case) -> Prescribed:
    """Return what a case prescribes of its contact."""
    if case.approach is not None:
        return Prescribed(approach=case.approach)
    return Prescribed(case.normal_load, case.load_position)


def with_contact(settled: SettledContact, contact: Contact, case: Case) -> SettledContact:
    """Return another contact on the same columns, which friction or finer cells along y have changed a little."""
    refined = settled.refined
    pressure = contact.pressure[_under(contact.shape.grid, refined.edges)]
    return SettledContact(contact, read_again(refined, pressure, _axial_shape(case)))


@dataclass(frozen=True)
class _Solver:
    """Contact of a case on given columns."""

    case: Case
    half_window: float
    cells_y: int

    def grid(self, edges: FloatArray) -> Grid:
        """Cells of the whole body, with these columns under the roller."""
        return columns_of(self.case, edges, (-self.half_window, self.half_window), self.cells_y)

    def shape(self, edges: FloatArray) -> Shape:
        """Return what is pressed on what."""
        return shape_on(self.case, self.grid(edges))

    def __call__(self, edges: FloatArray, start: FloatArray | None, tolerance: float) -> Pressed:
        """Contact without the displacement from friction, which changes the pressure by a few percent."""
        # The pressure alone decides where columns are needed.
        shape = self.shape(edges)._replace(coupled_friction=0.0)
        grid, gap = shape.grid, shape.gap.values
        under = _under(grid, edges)
        guess = None
        if start is not None and start.any():
            guess = np.zeros(grid.shape)
            guess[under] = start
        problem = ContactProblem(grid, gap, shape.prescribed.resultants(grid), 0.0, tolerance, 500)
        operator = contact_operator(shape)
        found = solve_normal(operator, problem, guess)
        check_window(shape.body, found.pressure)

        def opening() -> FloatArray:
            opened = gap + operator({Load.NORMAL: found.pressure}) - problem.level(found.motion)
            return np.asarray(opened[under].min(axis=1))

        return Pressed(found.pressure[under], opening)


def _under(grid: Grid, edges: FloatArray) -> slice:
    """Cells of a grid that are the columns between `edges`."""
    first = int(np.abs(grid.x_edges - edges[0]).argmin())
    return slice(first, first + edges.size - 1)


def _room(distance: float, near: float) -> float:
    """Return how far the face goes on beyond an end; 0 where both end together, or where the roller overhangs."""
    return distance if distance > near else 0.0


def _exponent(case: Case, distance: float, near: float) -> float:
    """Exponent of the pressure at an end that is this far from that of the face; NaN where theory knows none."""
    body, roller = case.body, case.roller.body
    of_body = 1 / body.material.plane_strain_modulus
    of_roller = 0.0 if roller is None else 1 / roller.material.plane_strain_modulus
    has_ends = isinstance(roller, EndedBody)
    if distance > near:
        return elastic_exponent(of_roller if has_ends else 0.0, of_body)
    # The body's own edge is pressed where the roller overhangs, or is a half-space.
    pressed = of_roller > 0 and (distance < -near or not has_ends)
    return elastic_exponent(of_body, of_roller) if pressed and getattr(body, "model", "") == "exact" else np.nan


def _axial_shape(case: Case) -> AxialShape:
    """Return what the refinement knows of a case."""
    start, stop = case.contact_range
    low, high = case.body.extent
    half_width = case.hertz_half_width
    near = 1e-9 * (stop - start)
    distances = case.roller_start - low, high - (case.roller_start + case.roller.length)
    return AxialShape(
        start,
        stop,
        half_width,
        half_width**2 / (2 * case.roller.radius),
        case.lowest,
        (_room(distances[0], near), _room(distances[1], near)),
        exponents=(_exponent(case, distances[0], near), _exponent(case, distances[1], near)),
        # The factor of the body's image is not that of the roller's.
        fades=case.roller.body is not None and isinstance(case.body, EndedBody) and case.body.model == "mirror-factor",
    )
