"""Case: a roller, a body, a load and a friction."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.engineering import format_quantity
from contactstudy.arrays.grid import Grid
from contactstudy.bodies import hertz
from contactstudy.bodies.lubricant import Lubricant
from contactstudy.bodies.material import contact_modulus
from contactstudy.bodies.models import Body, Counterbody
from contactstudy.case.motion import (
    MOTIONS_TEXT,
    AxialFriction,
    Friction,
    Motion,
    Sliding,
    check_friction,
    evaluate_friction,
)
from contactstudy.case.roller import Roller, snap_to_ends
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import SlopeJumps, as_shape, find_slope_jumps
from contactstudy.profiles.geometric import Chamfer, Cylinder

GAP_NODES = 6  # Gauss points over the width of a cell for the mean gap. Accuracy.
MAX_TILT = 0.1  # Largest tilt of the linear theory, radians. Limit.
INCLINATION_POINT_COUNT = 41  # Points along the axis for the mean inclination of the roller. Accuracy.
# Range of the Hertz half-width over the roller's radius; the minimum corresponds to 10 kPa on steel. Limit.
MIN_HALF_WIDTH, MAX_HALF_WIDTH = 1e-7, 0.5
MIN_DEPTH = 1e-12  # Minimum depth beyond first touch over the roller's radius. Rounding.
TOUCH_POINTS = 2001  # Points along the axis in the search for first touch. Accuracy.
MIN_LENGTH_RATIO, MAX_LENGTH_RATIO = 1e-4, 1e7  # Range of contact and body length over the half-width. Limit.


@dataclass(frozen=True, kw_only=True)
class Case:
    """A roller in contact with a body, rolling and sliding along y.

    Exactly one of `max_pressure`, `load` and `approach` is given. Pressure and load follow from one another by the
    Hertz line contact of the same load per length of contact; under an approach both follow from the solution.

    Parameters
    ----------
    body : Body
        The elastic body.
    roller : Roller
        The roller.
    max_pressure : float, optional
        Peak pressure ``p0`` of the Hertz line contact, Pa.
    load : float, optional
        Normal load ``W``, N.
    approach : float, optional
        Displacement of the roller towards the body at mid-length, metres, from the contact of the undeformed top with a
        profile drop of 0; see `reference` of `approach` in results.
    friction : float or DataArray (x)
        Coefficient ``f``, a number or values at positions along x interpolated linearly: in full sliding the shear
        traction on the body is ``q = f p`` along +y; in any other motion ``f p`` bounds the shear traction.
    end_distance : float, optional
        Distance ``e`` from the body's end I to the roller's nearer end, metres; negative if the roller
        overhangs. Default: the roller is centred on a finite-length space, and begins at ``x = 0`` otherwise.
    coupled : bool
        Whether the friction also displaces the surface normally, which changes the pressure.
    tilt : float
        Prescribed misalignment about the roller's mid-length against the undeformed top, radians, positive if the end
        at larger x is deeper.
    load_position : float, optional
        Position x of the load, metres; the roller tilts until the pressure balances it. Default: prescribed `tilt`.
    motion : Sliding, Shift or Rolling
        Motion and speed of the roller against the body. Default: full sliding.
    body_edge : Cylinder or Chamfer
        Edge radius or chamfer of the body's top at its free ends, for the gap; default: sharp. An overhanging roller
        loads this edge.
    lubricant : Lubricant, optional
        Lubricant between the surfaces, for `solve_film`; the dry contact does not depend on it.

    Raises
    ------
    InvalidInputError
        If a value is out of range, not exactly one of pressure, load and approach is given, or the roller misses the
        body. Functions that require the load raise it for a case with a prescribed approach.

    Examples
    --------
    >>> from contactstudy import FiniteLengthSpace, Material
    >>> body = FiniteLengthSpace(length=10.2e-3, material=Material(210e9, 0.3))
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=10e-3), max_pressure=1.5e9)
    >>> round(1e6 * case.hertz_half_width, 2), round(case.normal_load, 1), round(1e3 * case.roller_start, 3)
    (65.0, 1531.5, 0.1)
    """

    body: Body
    roller: Roller
    max_pressure: float | None = None
    load: float | None = None
    friction: Friction | xr.DataArray = 0.0
    end_distance: float | None = None
    coupled: bool = False
    tilt: float = 0.0
    load_position: float | None = None
    motion: Motion = field(default=Sliding())
    approach: float | None = None
    lubricant: Lubricant | None = None
    body_edge: Cylinder | Chamfer = field(default=Cylinder())

    def __post_init__(self) -> None:
        allowed = "elastic, a HalfSpace, QuarterSpace or FiniteLengthSpace: two rigid bodies have no contact pressure"
        checks.instance("body", self.body, Body, allowed)
        checks.instance("roller", self.roller, Roller, "a Roller")
        checks.instance("motion", self.motion, Motion, MOTIONS_TEXT)
        checks.instance("lubricant", self.lubricant, Lubricant | None, "a Lubricant(...), or None")
        allowed = "profiles.Cylinder(fillet_radius), sharp by default, or profiles.Chamfer(...)"
        checks.instance("body_edge", self.body_edge, Cylinder | Chamfer, allowed)
        checks.instance("coupled", self.coupled, (bool, np.bool_), "True or False")
        friction = check_friction(self.friction, self.motion, coupled=self.coupled)
        checks.store(self, friction=friction, tilt=small_tilt(self.tilt))
        self._check_position()
        self._check_load()

    def __repr__(self) -> str:
        if self.approach is not None:
            load_sizes = {"approach": (self.approach, "m")}
        else:
            p0, a = self.hertz_max_pressure, self.hertz_half_width
            load_sizes = {"W": (self.normal_load, "N"), "p0": (p0, "Pa"), "a": (a, "m")}
        load_text = ", ".join(f"{name} = {format_quantity(*size)}" for name, size in load_sizes.items())
        motion = "full sliding along +y" if isinstance(self.motion, Sliding) else repr(self.motion)
        if isinstance(self.friction, AxialFriction):
            friction = f"friction from {min(self.friction.values):g} to {max(self.friction.values):g}"
        else:
            friction = f"friction {self.friction:g}"
        details = [f"{friction}{', coupled' if self.coupled else ''}, {motion}"]
        if self.tilt:
            details.append(f"tilt {format_quantity(self.tilt, 'rad')}")
        if self.load_position is not None:
            details.append(f"load at x = {format_quantity(self.load_position, 'm')}")
        heading = f"Case: {load_text}, e = {format_quantity(self.roller_start, 'm')}"
        return "\n  ".join([heading, repr(self.roller), repr(self.body), "; ".join(details)])

    def _check_position(self) -> None:
        """Raise unless roller and body overlap and the load acts on both."""
        if self.end_distance is not None:
            checks.store(self, end_distance=checks.finite("end_distance", self.end_distance, "metres"))
        elif self.roller.length > (extent := self.body.extent[1] - self.body.extent[0]):
            allowed = f"at most the body's length, {extent:g} m"
            hint = "give end_distance (negative) if the roller is to overhang"
            raise InvalidInputError("roller.length", self.roller.length, allowed, hint)
        start, stop = self.contact_range
        if not start < stop:
            hint = f"the body spans x = {self.body.extent}"
            raise InvalidInputError("end_distance", self.roller_start, "such that the roller lies over the body", hint)
        with checks.name_argument("body_edge"):
            self.body_edge.drop(np.zeros(1), self._body_top[1])  # raises if the edge does not fit the body
        if self.load_position is not None:
            position = checks.finite("load_position", self.load_position, "metres")
            if not start < position < stop:
                allowed = f"in the overlap of roller and body, {start:g} to {stop:g} m"
                raise InvalidInputError("load_position", position, allowed)
            checks.store(self, load_position=position)
            if self.tilt:
                hint = "the roller tilts until the pressure balances the load"
                raise InvalidInputError("tilt", self.tilt, "left out with load_position", hint)
            self._check_inclination(start, stop)

    def _check_inclination(self, start: float, stop: float) -> None:
        """Raise if a roller that is free to tilt needs more than a small angle to lie on the body."""
        x = np.linspace(start, stop, INCLINATION_POINT_COUNT)[1:-1]
        gap = self._clearance(x - self.roller_middle, np.zeros(1))[:, 0]
        slope = float(np.polynomial.polynomial.polyfit((x - start) / (stop - start), gap, 1)[1]) / (stop - start)
        if abs(slope) > MAX_TILT:
            allowed = (
                f"None, because the roller over the body is inclined by {slope:.3g} rad: a balanced roller would tilt "
                f"by more than a small angle, {MAX_TILT} rad"
            )
            hint = "let the roller overhang less, or hold its tilt"
            raise InvalidInputError("load_position", self.load_position, allowed, hint)

    def _check_load(self) -> None:
        """Raise unless one of pressure, load and approach is given, with a possible magnitude."""
        loads = (self.max_pressure, self.load, self.approach)
        if sum(value is not None for value in loads) != 1:
            raise InvalidInputError("max_pressure, load, approach", loads, "exactly one of the three, the others None")
        if self.approach is not None:
            self._check_approach()
            return
        name, unit = ("load", "N") if self.max_pressure is None else ("max_pressure", "Pa")
        value = checks.positive(name, getattr(self, name), unit)
        checks.store(self, **{name: value})
        half_width, radius = self.hertz_half_width, self.roller.radius
        if not MIN_HALF_WIDTH <= half_width / radius <= MAX_HALF_WIDTH:
            raise InvalidInputError(
                name,
                value,
                f"such that the Hertz half-width, {half_width:.3g} m, is at most {MAX_HALF_WIDTH:g} and at least "
                f"{MIN_HALF_WIDTH:g} of the roller's radius, {radius:g} m",
                f"pressures and moduli are in Pa ({self.modulus:.3g} Pa here; 1500 MPa is 1.5e9 Pa), loads in N, "
                "lengths in metres",
            )
        low, high = self.body.extent
        allowed = f"between {MIN_LENGTH_RATIO:g} and {MAX_LENGTH_RATIO:g} Hertz half-widths, {half_width:.3g} m"
        for parameter, length in {"roller.length": self.contact_length, "body.length": high - low}.items():
            if np.isfinite(length) and not MIN_LENGTH_RATIO <= length / half_width <= MAX_LENGTH_RATIO:
                hint = "lengths are in metres, pressures and moduli in Pa, loads in N"
                raise InvalidInputError(parameter, length, allowed, hint)

    def _check_approach(self) -> None:
        """Raise unless the approach is one number, beyond first touch by at most the roller's radius."""
        value: object = self.approach
        if isinstance(value, (list, tuple)) or (isinstance(value, (np.ndarray, xr.DataArray)) and value.ndim):
            allowed = "one number (metres), because each approach has separate cells"
            hint = "sweep a list in a Study, or tabulate loads by contactstudy.bearing.contact_law"
            raise InvalidInputError("approach", self.approach, allowed, hint)
        approach = checks.finite("approach", self.approach, "metres")
        checks.store(self, approach=approach)
        if self.load_position is not None:
            allowed = "None where the approach is prescribed"
            raise InvalidInputError("load_position", self.load_position, allowed, "prescribe the load")
        radius, first_touch = self.roller.radius, self.first_touch
        if not MIN_DEPTH * radius < approach - first_touch <= radius:
            limits = f"{first_touch:.3g} m, and beyond it no more than the roller's radius, {radius:g} m"
            hint = "approaches are in metres, relative to the contact at a profile drop of 0"
            raise InvalidInputError("approach", approach, f"more than that of first touch, {limits}", hint)

    @property
    def first_touch(self) -> float:
        """Approach of first touch, metres: the minimum gap before deformation along the roller's axis."""
        return float(self.gap_on_axis(np.linspace(*self.contact_range, TOUCH_POINTS)).min())

    def gap_on_axis(self, x: FloatArray) -> FloatArray:
        """Return the gap before deformation along the roller's axis, metres, at `x`; constant beyond its ends."""
        half_length = 0.5 * self.roller.length
        return self._clearance(np.clip(x - self.roller_middle, -half_length, half_length), np.zeros(1))[:, 0]

    @property
    def slope_jumps(self) -> SlopeJumps:
        """Corners of the gap along the axis, unresolved ones included: positions x, metres, and jumps of the slope."""
        start, stop = self.contact_range
        middle = 0.5 * (start + stop)
        corners = find_slope_jumps(lambda x: self.gap_on_axis(middle + x), stop - start)
        nodes = as_shape(self.roller.profile).nodes(self.roller.length)
        x = np.append(middle + corners.positions, self.roller_middle + nodes.positions)
        jumps = np.append(corners.jumps, nodes.jumps)
        is_inside = (x > start) & (x < stop) & (jumps != 0)
        return SlopeJumps(x[is_inside], jumps[is_inside])

    @property
    def nodes(self) -> FloatArray:
        """Positions x, metres, between which the generatrix over the body is smooth."""
        x = self.roller_middle + as_shape(self.roller.profile).nodes(self.roller.length).positions
        midpoint, length = self._body_top
        x = np.union1d(x, midpoint + self.body_edge.nodes(length).positions)
        start, stop = self.contact_range
        return np.asarray(x[(x > start) & (x < stop)])

    def friction_on(self, x: FloatArray) -> float | FloatArray:
        """Return the coefficient of friction on columns of cells at `x`: a number or an array (x, 1)."""
        assert not isinstance(self.friction, xr.DataArray)
        return evaluate_friction(self.friction, x)

    @property
    def coupled_friction(self) -> float:
        """Coefficient of friction in coupled full sliding; 0 in any other contact."""
        is_coupled = self.coupled and isinstance(self.motion, Sliding)
        return float(self.friction) if is_coupled and isinstance(self.friction, float) else 0.0

    @property
    def roller_start(self) -> float:
        """Position x of the roller's end nearer to end I, metres."""
        if self.end_distance is not None:
            return self.end_distance
        low, high = self.body.extent
        return 0.5 * (high - low - self.roller.length) if np.isfinite(high) else 0.0

    @property
    def roller_middle(self) -> float:
        """Position x of the roller's mid-length, metres: the centre of tilt, spin and moment."""
        return self.roller_start + 0.5 * self.roller.length

    @property
    def contact_range(self) -> tuple[float, float]:
        """First and last x of the overlap of roller and body, metres."""
        low, high = self.body.extent
        return max(low, self.roller_start), min(high, self.roller_start + self.roller.length)

    @property
    def contact_length(self) -> float:
        """Length of the overlap of roller and body, metres."""
        start, stop = self.contact_range
        return stop - start

    @property
    def modulus(self) -> float:
        """Contact modulus ``E*``, Pa: ``1 / E* = (1 - nu1**2) / E1 + (1 - nu2**2) / E2``; E2 infinite if rigid."""
        return contact_modulus(self.body.material, self.roller.material)

    @property
    def counterbody(self) -> Counterbody | None:
        """Elastic roller as the second body; None for a rigid roller."""
        body = self.roller.body
        return None if body is None else Counterbody(body, self.roller_start)

    @property
    def hertz_max_pressure(self) -> float:
        """Peak pressure ``p0`` of the Hertz line contact of the same load per length, Pa."""
        if self.max_pressure is not None:
            return self.max_pressure
        return hertz.line_max_pressure(self.normal_load / self.contact_length, self.roller.radius, self.modulus)

    @property
    def hertz_half_width(self) -> float:
        """Half-width ``a`` of the Hertz line contact of the same load per length, metres."""
        return hertz.line_half_width(self.hertz_max_pressure, self.roller.radius, self.modulus)

    @property
    def normal_load(self) -> float:
        """Normal load ``W``, N."""
        if self.load is not None:
            return self.load
        if self.approach is not None:
            allowed = "None for functions that require the load before the solution"
            hint = "solve the case, and give load = normal_load of its result instead"
            raise InvalidInputError("approach", self.approach, allowed, hint)
        return self.contact_length * hertz.line_load(self.hertz_max_pressure, self.roller.radius, self.modulus)

    def gap(self, grid: Grid) -> FloatArray:
        """Return the gap before deformation, metres: at centres of uniform cells, else means along x."""
        x, middle_line = grid.x - self.roller_middle, np.zeros(1)
        if not grid.observes_means:
            return self._clearance(snap_to_ends(x, 0.5 * self.roller.length, grid.dx), grid.y)
        nodes, weights = np.polynomial.legendre.leggauss(GAP_NODES)
        points = x[:, None] + 0.5 * grid.widths[:, None] * nodes
        axial = self._clearance(points.ravel(), middle_line).reshape(points.shape)
        is_finite = np.isfinite(axial)
        finite_weights = np.maximum(is_finite @ weights, weights.min())
        mean = np.where(is_finite, axial, 0.0) @ weights / finite_weights
        central_gap = self._clearance(x, middle_line)[:, 0]
        correction = np.subtract(mean, central_gap, out=np.zeros_like(mean), where=np.isfinite(central_gap))
        return np.asarray(self._clearance(x, grid.y) + correction[:, None])

    @property
    def _body_top(self) -> tuple[float, float]:
        """Midpoint and length of the body's top, metres; the far end of a quarter-space lies beyond the roller."""
        low, high = self.body.extent
        if np.isinf(low):
            return self.roller_middle, np.inf
        high = high if np.isfinite(high) else 3 * (self.roller_start + self.roller.length)
        return 0.5 * (low + high), high - low

    def _clearance(self, axial_distance: FloatArray, y: FloatArray) -> FloatArray:
        """Height (x, y) of the roller over the body's top at distances from the roller's mid-length."""
        clearance = self.roller.clearance(axial_distance, y)
        midpoint, length = self._body_top
        x = np.clip(self.roller_middle + axial_distance - midpoint, -0.5 * length, 0.5 * length)
        clearance = clearance + self.body_edge.drop(x, length)[:, None]
        return clearance - self.tilt * axial_distance[:, None] if self.tilt else clearance


def small_tilt(value: object) -> float:
    """Return a tilt in radians, or raise if it is not a small angle."""
    tilt = checks.finite("tilt", value, "radians")
    if abs(tilt) > MAX_TILT:
        hint = "1 mrad is 0.001, and degrees need numpy.radians"
        raise InvalidInputError("tilt", tilt, f"a small angle, at most {MAX_TILT} radians", hint)
    return tilt
