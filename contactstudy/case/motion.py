"""How the roller moves against the body: full sliding, a shift from rest, or steady rolling."""

from __future__ import annotations

from dataclasses import dataclass

from contactstudy import checks
from contactstudy.errors import InvalidInputError


@dataclass(frozen=True, kw_only=True)
class Sliding:
    """Full sliding: the traction is the friction times the pressure, along +y.

    Examples
    --------
    >>> Sliding()
    Sliding()
    """


@dataclass(frozen=True, kw_only=True)
class Shift:
    """One shift of the roller against the body, from rest, with Coulomb friction.

    Along each axis either the shift or the force that it needs is prescribed. `solve_contact` goes on from the result
    of a step before instead, if it is given.

    Parameters
    ----------
    x, y : float, optional
        Rigid shift of the roller against the body, metres; 0 if neither it nor the force is given.
    force_x, force_y : float, optional
        Force on the body, N, instead.

    Raises
    ------
    InvalidInputError
        If a value is not a finite number, or both are given along one axis.

    Examples
    --------
    >>> Shift(force_y=10.0).modes
    ('y',)
    """

    x: float | None = None
    y: float | None = None
    force_x: float | None = None
    force_y: float | None = None

    def __post_init__(self) -> None:
        """Check the values."""
        for name in ("x", "y"):
            _check_either(self, name, f"force_{name}", "metres", "N")

    @property
    def modes(self) -> tuple[str, ...]:
        """Axes along which the force is prescribed."""
        return tuple(name for name in ("x", "y") if getattr(self, f"force_{name}") is not None)


MODELS = ("exact", "fastsim")


@dataclass(frozen=True, kw_only=True)
class Rolling:
    """Steady rolling along y, in which the contact moves along +y over both surfaces, with Coulomb friction.

    A creepage is the velocity of the roller's surface relative to the body's, over the rolling speed; the spin turns
    x to y, about the roller's middle. Each is prescribed, or the force or moment that it makes.

    Parameters
    ----------
    longitudinal_creepage, lateral_creepage : float, optional
        Along y and along x; 0 if neither it nor the force is given.
    spin : float, optional
        Angular velocity about z over the rolling speed, rad/m; 0 if neither it nor the moment is given.
    force_y, force_x : float, optional
        Force on the body, N, instead of the creepage along that axis.
    moment_z : float, optional
        Moment on the body about the roller's middle, N m, instead of the spin.
    model : str
        "exact", or "fastsim" for a comparison: strips without an influence of neighbours and free ends. It takes
        creepages only.

    Raises
    ------
    InvalidInputError
        If a value is not a finite number, a creepage is given together with its force, or the model is unknown.

    Examples
    --------
    >>> Rolling(longitudinal_creepage=1e-3, force_x=0.0).modes
    ('x',)
    """

    longitudinal_creepage: float | None = None
    lateral_creepage: float | None = None
    spin: float | None = None
    force_x: float | None = None
    force_y: float | None = None
    moment_z: float | None = None
    model: str = "exact"

    def __post_init__(self) -> None:
        """Check the values."""
        checks.instance("model", self.model, str, "a name")
        checks.known_name("model", self.model, MODELS)
        _check_either(self, "longitudinal_creepage", "force_y", "", "N")
        _check_either(self, "lateral_creepage", "force_x", "", "N")
        _check_either(self, "spin", "moment_z", "rad/m", "N m")
        if self.modes and self.model == "fastsim":
            raise InvalidInputError("model", self.model, 'a model that takes forces: "exact"', "or give the creepages")

    @property
    def modes(self) -> tuple[str, ...]:
        """What is prescribed by its force: "x", "y" or "spin"."""
        given = {"x": self.force_x, "y": self.force_y, "spin": self.moment_z}
        return tuple(name for name, value in given.items() if value is not None)


Motion = Sliding | Shift | Rolling
"""Any of them."""

KINDS, MOTIONS = (Sliding, Shift, Rolling), "a Sliding(), a Shift(...) or a Rolling(...)"
"""What a motion can be, and how messages say it."""


def _check_either(motion: Shift | Rolling, moved: str, force: str, unit: str, force_unit: str) -> None:
    """Check a motion and its force, of which one is given at most; without either it does not move so."""
    amount, resultant = getattr(motion, moved), getattr(motion, force)
    if amount is not None and resultant is not None:
        raise InvalidInputError(
            f"{moved}, {force}", (amount, resultant), "at most one of the two", "the other one follows from it"
        )
    if resultant is not None:
        checks.store(motion, **{force: checks.finite(force, resultant, force_unit)})
    else:
        checks.store(motion, **{moved: checks.finite(moved, 0.0 if amount is None else amount, unit)})
