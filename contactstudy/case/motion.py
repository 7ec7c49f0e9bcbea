"""Motion of the roller against the body: full sliding, a shift from rest, or steady rolling."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar, NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.variables import in_si
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError


class SurfaceSpeeds(NamedTuple):
    """Speeds of both surfaces along +y relative to the contact, m/s."""

    body: float
    roller: float

    @property
    def entrainment(self) -> float:
        """Mean of both speeds, m/s: positive if the lubricant enters at negative y."""
        return 0.5 * (self.body + self.roller)

    @property
    def slide_roll_ratio(self) -> float:
        """Difference of the speeds over their mean."""
        return (self.roller - self.body) / self.entrainment


@dataclass(frozen=True, kw_only=True)
class Sliding:
    """Full sliding: the traction is the friction times the pressure, along +y.

    Parameters
    ----------
    body_speed, roller_speed : float, optional
        Speeds of the surfaces along +y relative to the contact, m/s: both or neither. Heat and film depend on them, the
        contact does not. A roller that slides over a body which rolls past at V has ``body_speed = -V``.

    Raises
    ------
    InvalidInputError
        If a speed is not a finite number, or one is missing.

    Examples
    --------
    >>> Sliding(body_speed=2.0, roller_speed=3.0).speeds.slide_roll_ratio
    0.4
    """

    body_speed: float | None = None
    roller_speed: float | None = None

    def __post_init__(self) -> None:
        speeds = {name: getattr(self, name) for name in ("body_speed", "roller_speed")}
        if all(value is None for value in speeds.values()):
            return
        checks.store(self, **{name: checks.finite(name, value, "m/s") for name, value in speeds.items()})

    @property
    def speeds(self) -> SurfaceSpeeds | None:
        """Speeds of the surfaces."""
        if self.body_speed is None or self.roller_speed is None:
            return None
        return SurfaceSpeeds(self.body_speed, self.roller_speed)


RESULTANTS = {"x": "force_x", "y": "force_y", "spin": "moment_z"}  # conjugate to the rigid motions
LENGTH, FORCE = checks.number(checks.finite, "metres"), checks.number(checks.finite, "N")


class StickSlip:
    """Base of the motions with stick and slip: a prescribed rigid motion, force or moment per direction."""

    AMPLITUDES: ClassVar[Mapping[str, str]]  # parameter of each rigid motion

    def __post_init__(self) -> None:
        """Check the values, at most one of a motion and its force; the motion is 0 without either."""
        for mode, name in self.AMPLITUDES.items():
            force = RESULTANTS[mode]
            amplitude, resultant = getattr(self, name), getattr(self, force)
            if amplitude is not None and resultant is not None:
                values, allowed = (amplitude, resultant), "at most one of the two"
                raise InvalidInputError(f"{name}, {force}", values, allowed, "the other value follows")
            if amplitude is None and resultant is None:
                checks.store(self, **{name: 0.0})
        checks.store_numbers(self)

    @property
    def modes(self) -> tuple[str, ...]:
        """Rigid motions with a prescribed force or moment: "x", "y" or "spin"."""
        return tuple(mode for mode in self.AMPLITUDES if getattr(self, RESULTANTS[mode]) is not None)

    @property
    def amplitudes(self) -> dict[str, float]:
        """Prescribed amplitudes of the rigid motions; 0 where a force is prescribed."""
        return {mode: getattr(self, name) or 0.0 for mode, name in self.AMPLITUDES.items()}

    @property
    def resultants(self) -> dict[str, float]:
        """Prescribed forces and moment of the modes."""
        return {mode: getattr(self, RESULTANTS[mode]) for mode in self.modes}


@dataclass(frozen=True, kw_only=True)
class Shift(StickSlip):
    """One shift of the roller against the body, from rest, with Coulomb friction.

    Along each axis either the shift or its force is prescribed. `solve_contact` can start from the last step's result.

    Parameters
    ----------
    x, y : float, optional
        Rigid shift of the roller against the body, metres; default: 0 without a force.
    force_x, force_y : float, optional
        Force on the body, N, instead of the shift.

    Raises
    ------
    InvalidInputError
        If a value is not a finite number, or both are given along one axis.

    Examples
    --------
    >>> Shift(force_y=10.0).modes
    ('y',)
    """

    x: float | None = field(default=None, metadata=LENGTH)
    y: float | None = field(default=None, metadata=LENGTH)
    force_x: float | None = field(default=None, metadata=FORCE)
    force_y: float | None = field(default=None, metadata=FORCE)

    AMPLITUDES: ClassVar[Mapping[str, str]] = {"x": "x", "y": "y"}

    @property
    def speeds(self) -> None:
        """None: a shift has no speeds."""


MODELS = ("exact", "fastsim")


@dataclass(frozen=True, kw_only=True)
class Rolling(StickSlip):
    """Steady rolling: the contact moves along +y over both surfaces, with Coulomb friction.

    A creepage is the velocity of the roller's surface relative to the body's, over the rolling speed; the spin turns
    x to y, about the roller's mid-length. Each of them, or its force or moment, is prescribed.

    Parameters
    ----------
    longitudinal_creepage, lateral_creepage : float, optional
        Creepage along y and along x; default: 0 without a force.
    spin : float, optional
        Angular velocity about z over the rolling speed, rad/m; default: 0 without a moment.
    force_y, force_x : float, optional
        Force on the body, N, instead of the creepage along that axis.
    moment_z : float, optional
        Moment on the body about the roller's mid-length, N m, instead of the spin.
    speed : float, optional
        Speed with which the contact moves over both surfaces, m/s; for heat and film only.
    model : {"exact", "fastsim"}
        "fastsim", for a comparison: strips without an influence of neighbours and free ends, under creepages only.

    Raises
    ------
    InvalidInputError
        If a value is not a finite number, a creepage is given together with its force, or the model is unknown.

    Examples
    --------
    >>> Rolling(longitudinal_creepage=1e-3, force_x=0.0).modes
    ('x',)
    """

    longitudinal_creepage: float | None = field(default=None, metadata=checks.number(checks.finite))
    lateral_creepage: float | None = field(default=None, metadata=checks.number(checks.finite))
    spin: float | None = field(default=None, metadata=checks.number(checks.finite, "rad/m"))
    force_x: float | None = field(default=None, metadata=FORCE)
    force_y: float | None = field(default=None, metadata=FORCE)
    moment_z: float | None = field(default=None, metadata=checks.number(checks.finite, "N m"))
    speed: float | None = field(default=None, metadata=checks.number(checks.positive, "m/s"))
    model: str = "exact"

    AMPLITUDES: ClassVar[Mapping[str, str]] = {"x": "lateral_creepage", "y": "longitudinal_creepage", "spin": "spin"}

    def __post_init__(self) -> None:
        checks.known_name("model", self.model, MODELS)
        super().__post_init__()
        if self.modes and self.model == "fastsim":
            raise InvalidInputError("model", self.model, 'a model that takes forces: "exact"', "or give the creepages")

    @property
    def speeds(self) -> SurfaceSpeeds | None:
        """Speeds of the surfaces, opposite to the contact's speed; an unknown creepage counts as 0."""
        return None if self.speed is None else self.speeds_at(self.longitudinal_creepage or 0.0)

    def speeds_at(self, creepage: float) -> SurfaceSpeeds:
        """Speeds of the surfaces at a longitudinal creepage."""
        speed = checks.positive("motion.speed", self.speed, "m/s")
        return SurfaceSpeeds(-speed * (1 + 0.5 * creepage), -speed * (1 - 0.5 * creepage))


Motion = Sliding | Shift | Rolling
MOTIONS_TEXT = "a Sliding(), a Shift(...) or a Rolling(...)"  # in messages


@dataclass(frozen=True)
class AxialFriction:
    """Friction that varies along the axis: linear between positions (m), constant beyond the first and the last."""

    x: tuple[float, ...]
    values: tuple[float, ...]


Friction = float | AxialFriction


def check_friction(friction: object, motion: Motion, *, coupled: bool) -> Friction:
    """Return a number or an `AxialFriction` that motion and coupling allow, from a number or a DataArray along x."""
    checked_friction = _axial_friction(friction) if isinstance(friction, xr.DataArray) and friction.dims else friction
    if not isinstance(checked_friction, AxialFriction):
        checked_friction = checks.finite("friction", checked_friction)
    min_friction = min(checked_friction.values) if isinstance(checked_friction, AxialFriction) else checked_friction
    if not isinstance(motion, Sliding) and min_friction < 0:
        allowed = "not below zero with stick and slip: the slip reverses the traction"
        raise InvalidInputError("friction", min_friction, allowed)
    if isinstance(motion, Sliding) and coupled and isinstance(checked_friction, AxialFriction):
        raise InvalidInputError("coupled", True, "False in full sliding with friction that varies along the axis")
    return checked_friction


def _axial_friction(friction: xr.DataArray) -> AxialFriction:
    """Friction along the axis from a DataArray along x."""
    if friction.dims != ("x",) or "x" not in friction.coords:
        raise InvalidInputError("friction.dims", friction.dims, "('x',) with the coordinate x, metres, or a number")
    friction_si = in_si("friction", friction, "1")
    x = checks.increasing("friction.x", friction_si["x"].values)
    return AxialFriction(tuple(x.tolist()), tuple(checks.coordinates("friction", friction_si.values, "1").tolist()))


def evaluate_friction(friction: Friction, x: FloatArray) -> float | FloatArray:
    """Coefficient on columns of cells at `x`: a number or an array (x, 1)."""
    if isinstance(friction, AxialFriction):
        return np.asarray(np.interp(x, friction.x, friction.values))[:, None]
    return friction
