"""From the parameters of a study to the case that is solved."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import astuple, dataclass
from typing import Any

import numpy as np

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.bodies import hertz
from contactstudy.bodies.material import Material, contact_modulus
from contactstudy.bodies.models import MODELS, Body, FiniteLengthSpace, HalfSpace, QuarterSpace
from contactstudy.case.case import Case
from contactstudy.case.doubts import unquestioned
from contactstudy.case.gridding import choose_grid, widening_grids
from contactstudy.case.roller import Roller
from contactstudy.case.settings import check_accuracy, solver_settings
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.study.motion_kinds import motion_of
from contactstudy.study.parameters import PARAMETERS, REQUIRED, ROLLER_BODIES, UNIFORM, checked, taken_by, with_defaults
from contactstudy.study.profile_kinds import Surroundings, build_profile
from contactstudy.study.profile_words import profile_label

USUAL_COLUMNS, USUAL_ROWS, USUAL_DEPTHS = 120, 32, 32
"""Cells along x and y of a refined contact, and depths that the solver chooses, roughly; for forecasts only."""

OVER_HALF_WIDTH = ("field_x_over_a", "field_y_over_a", "field_z_over_a")
"""Parameters that are positions over the half-width."""

Described = dict[str, float | str]


@dataclass(frozen=True)
class Dimensions:
    """Lengths of a case that follow from one another, metres, and the contact modulus, Pa."""

    radius: float
    body_length: float
    roller_length: float
    end_distance: float
    half_width: float
    modulus: float

    @classmethod
    def of(cls, values: Mapping[str, Any], modulus: float) -> Dimensions:
        """Dimensions of a case; with a load, ``a`` depends on the contact's length, which may depend on ``a``.

        With an approach ``a`` is NaN, because it follows from the solution.

        Raises
        ------
        InvalidInputError
            If a value that they are calculated from is out of range, or a length would not be positive.
        """
        radius = checks.positive("radius", values["radius"], "metres")
        if "max_pressure" in values:
            pressure = checks.positive("max_pressure", values["max_pressure"], "Pa")
            found = cls._for(values, radius, modulus, hertz.line_half_width(pressure, radius, modulus))
            found._check()
            return found
        if "approach" in values:
            found = cls._for(values, radius, modulus, np.nan)
            found._check()
            return found
        load, half_width = checks.positive("load", values["load"], "N"), 0.0
        for _ in range(500):
            found = cls._for(values, radius, modulus, half_width)
            length = min(found.body_length, found.roller_length)
            if length <= 0:
                if not half_width:  # whatever the load is
                    found._check()
                break
            pressure = hertz.line_max_pressure(load / length, radius, modulus)
            previous, half_width = half_width, hertz.line_half_width(pressure, radius, modulus)
            if abs(half_width - previous) <= 1e-14 * half_width:
                found = cls._for(values, radius, modulus, half_width)
                found._check()
                return found
        raise InvalidInputError("load", load, "small enough for a roller of positive length at this e_over_a")

    @classmethod
    def _for(cls, values: Mapping[str, Any], radius: float, modulus: float, half_width: float) -> Dimensions:
        """Dimensions for a given half-width."""
        distance = values["end_distance"] if "end_distance" in values else values["e_over_a"] * half_width
        if "gamma" in values:
            body = checks.positive("gamma", values["gamma"]) * radius
            return cls(radius, body, body - 2 * distance, distance, half_width, modulus)
        roller = values["roller_length"]
        return cls(radius, roller + 2 * distance, roller, distance, half_width, modulus)

    def _check(self) -> None:
        """Raise if a length is not positive."""
        for name, length in (("roller length", self.roller_length), ("body length", self.body_length)):
            if length <= 0:
                hint = f"e = {self.end_distance:g} m" + (f", a = {self.half_width:g} m" if self.half_width > 0 else "")
                raise InvalidInputError(name, length, "positive (metres)", hint)


@dataclass(frozen=True, eq=False)
class Setup:
    """A case ready to solve.

    Parameters
    ----------
    case : Case
        The case.
    grid : Grid or None
        Its uniform cells, or the first of those that are tried; None: columns that the solver refines.
    options : dict
        All other arguments of the solver, by name.
    described : dict
        End distance over the half-width, friction, length of the body over the roller's radius, and profile.
    cells : dict
        Cells per half-width, where the window may grow with the contact; empty where `grid` is the only one.
    """

    case: Case
    grid: Grid | None
    options: dict[str, Any]
    described: Described
    cells: dict[str, float]

    @property
    def grids(self) -> Iterator[Grid | None]:
        """Grids to try in turn until one holds the contact."""
        return widening_grids(self.case, **self.cells) if self.cells else iter((self.grid,))

    @property
    def operator(self) -> str:
        """What the solver's expensive preparation depends on: equal for cases that can share it."""
        case = self.case
        cells = (case.approach or case.hertz_half_width) if self.grid is None else self.grid
        bodies = [body and (type(body).__name__, astuple(body)) for body in (case.body, case.roller.body)]
        return repr((*bodies, cells, case.coupled, type(case.motion).__name__))

    @property
    def shape(self) -> tuple[int, int]:
        """Number of cells along x and y, as far as it is known before solving."""
        return (USUAL_COLUMNS, USUAL_ROWS) if self.grid is None else self.grid.shape

    @property
    def points(self) -> int:
        """Number of points with stresses, as far as it is known before solving."""
        if not self.options["stresses"]:
            return 0
        x, y, z = (
            default if (axis := self.options[name]) is None else axis.size
            for name, default in zip("xyz", (*self.shape, USUAL_DEPTHS), strict=True)
        )
        return int(x * y * z)


def _one_of(values: Mapping[str, Any], *names: str) -> None:
    """Raise unless exactly one of some parameters is given."""
    given = [name for name in names if name in values]
    if not given and len(names) == 1:
        raise InvalidInputError(names[0], None, "given")
    if len(given) != 1:
        *others, last = names
        count = "two" if len(names) == 2 else "three"
        shown = tuple(values[name] for name in given) if given else "none"
        raise InvalidInputError(
            ", ".join(given or names), shown, f"given as one of the {count}, {', '.join(others)} or {last}"
        )


def check_cells(parameters: Mapping[str, Any]) -> None:
    """Raise if a case says both how far its columns are refined and how wide uniform cells are."""
    said = {name: parameters[name] for name in ("accuracy", *UNIFORM) if name in parameters}
    if "accuracy" in said and len(said) > 1:
        raise InvalidInputError(
            ", ".join(said), tuple(said.values()), "given as one of the two, accuracy or uniform cells"
        )


def _check_approach(values: Mapping[str, Any], given: Mapping[str, Any]) -> None:
    """Raise if a case at an approach says anything over the half-width, which follows from the solution."""
    if "approach" not in values:
        return
    instead = dict.fromkeys(UNIFORM, "leave it out: columns are refined, to `accuracy`") | dict.fromkeys(
        OVER_HALF_WIDTH, "leave it out: the solver chooses the points when it knows a"
    )
    instead |= {"e_over_a": "give end_distance (metres)", "load_offset": "prescribe the load instead"}
    for name, hint in instead.items():
        if name in given:
            raise InvalidInputError(name, given[name], "left out where the approach is prescribed", hint)


def _body(values: Mapping[str, Any], material: Material, length: float) -> Body:
    """Body of a case, of this `length` between its free ends."""
    kind, model = values["body"], values["model"]
    if kind == "finite-length":
        return FiniteLengthSpace(length=length, material=material, model=model)
    if kind == "quarter-space":
        return QuarterSpace(material=material, model=model)
    if model != MODELS[0]:
        raise InvalidInputError("model", model, f"{MODELS[0]!r} for a half-space, which has no free end")
    return HalfSpace(material=material)


def _roller_material(values: Mapping[str, Any]) -> Material | None:
    """Material of an elastic roller: its own constants, or the body's."""
    if values["roller_body"] == "rigid":
        for name in ("roller_young", "roller_poisson"):
            if name in values:
                raise InvalidInputError(name, values[name], "left out for a rigid roller", "or give roller_body")
        return None
    return Material(
        young=values.get("roller_young", values["young"]), poisson=values.get("roller_poisson", values["poisson"])
    )


def _stress_points(
    values: Mapping[str, Any], half_width: float, extent: tuple[float, float]
) -> dict[str, FloatArray | None]:
    """Stress points in metres; None where the solver chooses."""
    x, y, z = (
        half_width * checks.coordinates(name, values[name]) if name in values else None for name in OVER_HALF_WIDTH
    )
    if z is not None and z.min() < 0:
        raise InvalidInputError("field_z_over_a", float(z.min() / half_width), "not below zero")
    low, high = extent
    if x is not None and not (low <= x.min() and x.max() <= high * (1 + 1e-12)):
        raise InvalidInputError(
            "field_x_over_a",
            float((x.min() if x.min() < low else x.max()) / half_width),
            f"inside the body, 0 to {high / half_width:g}",
        )
    return {"x": x, "y": y, "z": z}


def build_setup(parameters: Mapping[str, Any]) -> Setup:
    """Case, grid and stress points of a study's case.

    With ``a = 2 p0 R / E*`` and ``e = e_over_a a``: a given `gamma` fixes the body, of length ``gamma R``, and the
    roller is shorter by ``2 e``; a given `roller_length` fixes the roller, and the body is longer by ``2 e``. A
    half-space keeps roller, distance and so the coordinates of the body that it is compared with. With an `accuracy`
    the solver refines its columns; without one the cells are uniform.

    Parameters
    ----------
    parameters : mapping
        Parameters of the case, see :data:`contactstudy.study.parameters.PARAMETERS`.

    Returns
    -------
    Setup

    Raises
    ------
    InvalidInputError
        If the parameters contradict each other, or a value is missing or out of range.

    Examples
    --------
    >>> setup = build_setup({"young": 210e9, "poisson": 0.3, "radius": 5e-3, "roller_length": 10e-3,
    ...                      "e_over_a": 2, "max_pressure": 1.5e9})
    >>> round(1e3 * setup.case.body.length, 3), round(1e3 * setup.case.roller_start, 3)
    (10.26, 0.13)
    """
    known = checked(parameters)
    setup = setup_of(known)
    check_cells(known)
    return setup


def setup_of(parameters: Mapping[str, Any]) -> Setup:
    """Return what :func:`build_setup` does, for parameters that are checked already."""
    values = with_defaults(parameters)
    _check_approach(values, parameters)
    for names in REQUIRED:
        _one_of(values, *names)
    material, roller_material = Material(values["young"], values["poisson"]), _roller_material(values)
    sizes = Dimensions.of(values, contact_modulus(material, roller_material))
    around = Surroundings(sizes.radius, sizes.modulus, sizes.roller_length)
    middle = sizes.end_distance + 0.5 * sizes.roller_length
    with unquestioned():  # the plan asks, for all cases at once
        case = Case(
            body=_body(values, material, sizes.body_length),
            roller=Roller(
                radius=sizes.radius,
                length=sizes.roller_length,
                profile=build_profile(values["profile"], around),
                material=roller_material,
                ends=ROLLER_BODIES[values["roller_body"]] or "free",
            ),
            end_distance=sizes.end_distance,
            load_position=middle + values["load_offset"] if "load_offset" in values else None,
            motion=motion_of(values),
            **taken_by(Case, values),
        )
    tolerance = checks.positive("tolerance", values["tolerance"])
    options = _stress_points(values, sizes.half_width, case.body.extent) | taken_by(solver_settings, values)
    described: Described = {
        "e_over_a": sizes.end_distance / sizes.half_width,
        "friction": float(values["friction"]),
        "gamma": sizes.body_length / sizes.radius,
        "profile": profile_label(values["profile"]),
    }
    if "accuracy" in values:
        accuracy = check_accuracy(values["accuracy"])
        return Setup(case, None, options | {"tolerance": tolerance, "accuracy": accuracy}, described, {})
    gridding = taken_by(choose_grid, values)
    usual = all(gridding[name] == PARAMETERS[name].default for name in ("window", "margin"))
    cells = {name: gridding[name] for name in ("cells_x", "cells_y")} if usual else {}
    return Setup(case, choose_grid(case, **gridding), options | {"tolerance": tolerance}, described, cells)
