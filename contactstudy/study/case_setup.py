"""Case, cells and settings of the solver from the parameters of a study."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.bodies.lubricant import Lubricant
from contactstudy.bodies.material import Material, contact_modulus
from contactstudy.bodies.models import MODELS, Body, FiniteLengthSpace, HalfSpace, QuarterSpace
from contactstudy.case.case import Case
from contactstudy.case.gridding import check_accuracy, choose_grid, create_widening_grids
from contactstudy.case.motion import Motion, Rolling, Shift, Sliding
from contactstudy.case.roller import Roller
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.film.asperities import Asperities
from contactstudy.study.parameters import (
    PARAMETERS,
    REQUIRED,
    UNIFORM_CELL_PARAMETERS,
    check_parameters,
    keywords_of,
    with_defaults,
    without_defaults,
)
from contactstudy.study.profile_tables import Dimensions, build_profile

SCALED_POSITIONS = ("field_x_over_a", "field_y_over_a", "field_z_over_a")  # positions over the half-width
LUBRICANT_PAIRS = {"lubricant": "temperature", "viscosity": "pressure_viscosity"}  # parameters given in pairs
FILM_PARAMETERS = ("entrainment_speed", "slide_roll_ratio", "roughness_rms")  # Further parameters of a film
MOTION_PARAMETERS = {  # arguments of each motion's class, with the prefix `shift_` for a shift
    "sliding": ("entrainment_speed", "slide_roll_ratio"),
    "shift": ("shift_x", "shift_y", "force_x", "force_y"),
    "rolling": ("longitudinal_creepage", "lateral_creepage", "spin", "force_x", "force_y", "moment_z"),
}


class Setup(NamedTuple):
    """A case ready to solve."""

    case: Case
    grid: Grid | None  # uniform cells, on the narrowest of the windows to try; None: columns that the solver refines
    options: dict[str, Any]  # all other arguments of the solver
    # cells per half-width, where the window may grow with the contact; empty where `grid` is the only grid
    cells: dict[str, float]
    e_over_a: float  # NaN where the half-width follows from the solution
    gamma: float  # length of the body over the roller's radius

    @property
    def grids(self) -> Iterator[Grid | None]:
        """Grids of increasing windows: the solver uses the first that contains the contact."""
        return create_widening_grids(self.case, **self.cells) if self.cells else iter((self.grid,))

    @property
    def shape(self) -> tuple[int, int]:
        """Number of cells along x and y; typical numbers if the solver refines columns."""
        return (120, 32) if self.grid is None else self.grid.shape

    @property
    def points(self) -> int:
        """Number of points with stresses; assumes a typical number of depths where the solver chooses the depths."""
        if not self.options.get("stresses"):
            return 0
        x, y, z = (
            default if (axis := self.options[name]) is None else axis.size
            for name, default in zip("xyz", (*self.shape, 32), strict=True)
        )
        return int(x * y * z)


def _check_choices(values: Mapping[str, Any]) -> None:
    """Raise unless a case has exactly one parameter of each group of :data:`REQUIRED`."""
    for names in REQUIRED:
        stated_names = [name for name in names if name in values]
        if not stated_names and len(names) == 1:
            raise InvalidInputError(names[0], None, "given")
        if len(stated_names) != 1:
            *first, last = names
            allowed = f"given as one of the {'two' if len(names) == 2 else 'three'}, {', '.join(first)} or {last}"
            stated_values = tuple(values[name] for name in stated_names) if stated_names else "none"
            raise InvalidInputError(", ".join(stated_names or names), stated_values, allowed)


def _reject(values: Mapping[str, Any], names: Iterable[str], allowed: str, hint: str = "") -> None:
    """Raise if a case has one of the named parameters."""
    for name in names:
        if name in values:
            raise InvalidInputError(name, values[name], allowed, hint)


def _check_approach(parameters: Mapping[str, Any]) -> None:
    """Raise if a case at an approach has a parameter in half-widths: the half-width follows from the solution."""
    if "approach" in parameters:
        allowed = "left out where the approach is prescribed"
        _reject(parameters, UNIFORM_CELL_PARAMETERS, allowed, "leave it out: columns are refined, to `accuracy`")
        hint = "leave it out: the solver chooses the points, after the half-width"
        _reject(parameters, SCALED_POSITIONS, allowed, hint)
        _reject(parameters, ["e_over_a"], allowed, "give end_distance (metres)")
        _reject(parameters, ["load_offset"], allowed, "prescribe the load instead")


def _build_body(values: Mapping[str, Any], material: Material, length: float) -> Body:
    """Body of a case with a `length` between its free ends."""
    kind, model, depth = values["body"], values["model"], values.get("reference_depth")
    if kind == "finite-length":
        return FiniteLengthSpace(length=length, material=material, model=model, reference_depth=depth)
    if kind == "quarter-space":
        return QuarterSpace(material=material, model=model, reference_depth=depth)
    if model != MODELS[0]:
        raise InvalidInputError("model", model, f"{MODELS[0]!r} for a half-space, which has no free end")
    return HalfSpace(material=material, reference_depth=depth)


def _roller_material(values: Mapping[str, Any]) -> Material | None:
    """Material of an elastic roller, by default the body's; None for a rigid roller."""
    if values["roller_body"] == "rigid":
        _reject(values, ("roller_young", "roller_poisson"), "left out for a rigid roller", "or give roller_body")
        return None
    return Material(
        young=values.get("roller_young", values["young"]), poisson=values.get("roller_poisson", values["poisson"])
    )


def build_motion(values: Mapping[str, Any]) -> Motion:
    """Motion of a case, from checked parameters with their defaults."""
    kind = values["motion"]
    parameters = MOTION_PARAMETERS[kind]
    for name in chain(*MOTION_PARAMETERS.values()):
        if name in values and name not in parameters:
            motions = " or ".join(repr(motion) for motion, names in MOTION_PARAMETERS.items() if name in names)
            raise InvalidInputError(name, values[name], f"left out for motion = {kind!r}", f"it belongs to {motions}")
    if kind != "rolling" and values["rolling_model"] != "exact":
        raise InvalidInputError("rolling_model", values["rolling_model"], f"left out for motion = {kind!r}")
    arguments = {name.removeprefix("shift_"): values[name] for name in parameters if name in values}
    if kind == "rolling":
        return Rolling(**arguments, model=values["rolling_model"])
    if kind == "shift":
        return Shift(**arguments)
    if "entrainment_speed" not in values:
        return Sliding()
    speed, half_slip = values["entrainment_speed"], 0.5 * values.get("slide_roll_ratio", 0.0)
    return Sliding(body_speed=(1 - half_slip) * speed, roller_speed=(1 + half_slip) * speed)


def _build_lubricant(values: Mapping[str, Any]) -> Lubricant | None:
    """Lubricant of a case; None for a dry case."""
    given = [name for name in LUBRICANT_PAIRS if name in values]
    if len(given) > 1:
        raise InvalidInputError(", ".join(given), tuple(values[name] for name in given), "one of the two")
    if not given:
        _reject(values, (*LUBRICANT_PAIRS.values(), *FILM_PARAMETERS), "left out without a film")
        return None
    excluded = {*LUBRICANT_PAIRS.values(), *UNIFORM_CELL_PARAMETERS, *SCALED_POSITIONS} - {LUBRICANT_PAIRS[given[0]]}
    _reject(without_defaults(values), sorted(excluded), "left out for a film")
    for name in (LUBRICANT_PAIRS[given[0]], "entrainment_speed"):
        if name not in values:
            raise InvalidInputError(name, None, f"given with {given[0]}")
    if "lubricant" in given:
        return Lubricant.preset(values["lubricant"], values["temperature"])
    return Lubricant(viscosity=values["viscosity"], pressure_viscosity=values["pressure_viscosity"])


def _stress_points(
    values: Mapping[str, Any], half_width: float, extent: tuple[float, float]
) -> dict[str, FloatArray | None]:
    """Stress points in metres; None along an axis where the solver chooses the points."""
    x, y, z = (half_width * np.array(values[name]) if name in values else None for name in SCALED_POSITIONS)
    if z is not None and z.min() < 0:
        raise InvalidInputError("field_z_over_a", float(z.min() / half_width), "not below zero")
    low, high = extent
    if x is not None and not (low <= x.min() and x.max() <= high * (1 + 1e-12)):
        outside = float((x.min() if x.min() < low else x.max()) / half_width)
        raise InvalidInputError("field_x_over_a", outside, f"inside the body, 0 to {high / half_width:g}")
    return {"x": x, "y": y, "z": z}


def build_setup(parameters: Mapping[str, Any]) -> Setup:
    """Case, cells and stress points of a study's case.

    With ``a = 2 p0 R / E*`` and ``e = e_over_a a``: a `gamma` fixes the body, of length ``gamma R``, and the roller is
    shorter by ``2 e``; a `roller_length` fixes the roller, and the body is longer by ``2 e``.
    """
    parameters = check_parameters(parameters)
    values = with_defaults(parameters)
    _check_approach(parameters)
    _check_choices(values)
    material, roller_material = Material(values["young"], values["poisson"]), _roller_material(values)
    sizes = Dimensions.of(values, contact_modulus(material, roller_material))
    mid_length = sizes.end_distance + 0.5 * sizes.roller_length
    case = Case(
        body=_build_body(values, material, sizes.body_length),
        roller=Roller(
            radius=sizes.radius,
            length=sizes.roller_length,
            profile=build_profile("profile", values["profile"], sizes),
            material=roller_material,
            ends="none" if values["roller_body"] == "half-space" else "free",
            reference_depth=values.get("roller_reference_depth") if roller_material else None,
        ),
        end_distance=sizes.end_distance,
        load_position=mid_length + values["load_offset"] if "load_offset" in values else None,
        motion=build_motion(values),
        lubricant=_build_lubricant(values),
        **keywords_of(Case, values | {"body_edge": build_profile("body_edge", values["body_edge"], sizes)}),
    )
    options: dict[str, Any] = {
        **_stress_points(values, sizes.half_width, case.body.extent),
        "stresses": values["stresses"],
        "tolerance": checks.positive("tolerance", values["tolerance"]),
    }
    stated_cells = {name: parameters[name] for name in ("accuracy", *UNIFORM_CELL_PARAMETERS) if name in parameters}
    if "accuracy" in stated_cells and len(stated_cells) > 1:
        allowed = "given as one of the two, accuracy or uniform cells"
        raise InvalidInputError(", ".join(stated_cells), tuple(stated_cells.values()), allowed)
    grid: Grid | None = None
    cells: dict[str, float] = {}
    if "accuracy" in values:
        options["accuracy"] = check_accuracy(values["accuracy"])
    else:
        gridding = keywords_of(choose_grid, values)
        if all(gridding[name] == PARAMETERS[name].default for name in ("window", "margin")):
            cells = {name: gridding[name] for name in ("cells_x", "cells_y")}
        grid = choose_grid(case, **gridding)
    if case.lubricant is not None:
        rms = values.get("roughness_rms")
        options = {"accuracy": options["accuracy"], "asperities": None if rms is None else Asperities(rms=rms)}
    e_over_a, gamma = sizes.end_distance / sizes.half_width, sizes.body_length / sizes.radius
    return Setup(case, grid, options, cells, e_over_a=e_over_a, gamma=gamma)
