"""From the parameters of a study to the case that is solved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.bodies import hertz
from contactstudy.bodies.material import Material
from contactstudy.case.case import Case
from contactstudy.case.gridding import choose_grid
from contactstudy.case.roller import Roller
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.study.kinds import BODIES, ROLLER_BODIES
from contactstudy.study.parameters import checked, with_defaults
from contactstudy.study.profile_kinds import Surroundings, build_profile


@dataclass(frozen=True, eq=False)
class Setup:
    """A case ready to solve: the arguments of the solver."""

    case: Case
    grid: Grid
    x: FloatArray | None
    y: FloatArray | None
    z: FloatArray | None
    stresses: bool
    tolerance: float
    error_estimate: bool

    @property
    def operator(self) -> str:
        """What the solver's expensive preparation depends on: equal for cases that can share it."""
        return repr((self.case.body, self.case.roller.body, self.grid, self.case.coupled))

    @property
    def points(self) -> int:
        """Number of points with stresses, as far as it is known before solving."""
        if not self.stresses:
            return 0
        sizes = [
            axis.size if axis is not None else default
            for axis, default in ((self.x, self.grid.cells_x), (self.y, self.grid.cells_y), (self.z, 32))
        ]
        return sizes[0] * sizes[1] * sizes[2]


def _one_of(values: Mapping[str, Any], first: str, second: str) -> None:
    if (first in values) == (second in values):
        given = (values.get(first), values.get(second))
        raise InvalidInputError(f"{first}, {second}", given, "exactly one of the two")


def _lengths(values: Mapping[str, Any], distance: float) -> tuple[float, float]:
    """Body and roller length for a distance from roller end to free end, metres."""
    if "gamma" in values:
        body = checks.positive("gamma", values["gamma"]) * values["radius"]
        return body, body - 2 * distance
    return values["roller_length"] + 2 * distance, values["roller_length"]


def _half_width(values: Mapping[str, Any], modulus: float) -> float:
    """Hertz half-width ``a``; with a load it depends on the contact's length, which may depend on ``a``."""
    radius = values["radius"]
    if "max_pressure" in values:
        return hertz.line_half_width(checks.positive("max_pressure", values["max_pressure"], "Pa"), radius, modulus)
    load = checks.positive("load", values["load"], "N")
    half_width = 0.0
    for _ in range(500):
        distance = values.get("end_distance", values.get("e_over_a", 0.0) * half_width)
        length = min(_lengths(values, distance))
        if length <= 0:
            break
        pressure = hertz.line_max_pressure(load / length, radius, modulus)
        previous, half_width = half_width, hertz.line_half_width(pressure, radius, modulus)
        if abs(half_width - previous) <= 1e-14 * half_width:
            return half_width
    raise InvalidInputError("load", load, "small enough for a roller of positive length at this e_over_a")


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


def build_setup(parameters: Mapping[str, Any]) -> Setup:
    """Case, grid and stress points of a study's case.

    With ``a = 2 p0 R / E*`` and ``e = e_over_a a``: a given `gamma` fixes the body, of length ``gamma R``, and the
    roller is shorter by ``2 e``; a given `roller_length` fixes the roller, and the body is longer by ``2 e``. A
    half-space keeps roller, distance and so the coordinates of the body that it is compared with.

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
    values = with_defaults(checked(parameters))
    for name in ("young", "poisson", "radius"):
        if name not in values:
            raise InvalidInputError(name, None, "given")
    _one_of(values, "gamma", "roller_length")
    _one_of(values, "e_over_a", "end_distance")
    _one_of(values, "max_pressure", "load")
    material = Material(young=values["young"], poisson=values["poisson"])
    radius = checks.positive("radius", values["radius"], "metres")
    roller_material = _roller_material(values)
    modulus = material.plane_strain_modulus
    if roller_material is not None:
        modulus = 1 / (1 / modulus + 1 / roller_material.plane_strain_modulus)
    half_width = _half_width(values, modulus)
    distance = values["end_distance"] if "end_distance" in values else values["e_over_a"] * half_width
    body_length, roller_length = _lengths(values, distance)
    for name, length in (("roller length", roller_length), ("body length", body_length)):
        if length <= 0:
            raise InvalidInputError(name, length, "positive (metres)", f"e = {distance:g} m, a = {half_width:g} m")
    around = Surroundings(radius, modulus, half_width * modulus / (2 * radius))
    case = Case(
        body=BODIES[values["body"]](material, body_length, values["model"]),
        roller=Roller(
            radius=radius,
            length=roller_length,
            profile=build_profile(values["profile"], around),
            material=roller_material,
            ends=ROLLER_BODIES[values["roller_body"]] or "free",
        ),
        max_pressure=values.get("max_pressure"),
        load=values.get("load"),
        friction=values["friction"],
        end_distance=distance,
        coupled=values["coupled"],
        tilt=values["tilt"],
        load_position=distance + 0.5 * roller_length + values["load_offset"] if "load_offset" in values else None,
    )
    grid = choose_grid(
        case, cells_x=values["cells_x"], cells_y=values["cells_y"], window=values["window"], margin=values["margin"]
    )
    x, y, z = (
        half_width * checks.coordinates(name, values[name]) if name in values else None
        for name in ("field_x_over_a", "field_y_over_a", "field_z_over_a")
    )
    if z is not None and z.min() < 0:
        raise InvalidInputError("field_z_over_a", float(z.min() / half_width), "not below zero")
    low, high = case.body.extent
    if x is not None and not (low <= x.min() and x.max() <= high * (1 + 1e-12)):
        raise InvalidInputError(
            "field_x_over_a",
            float((x.min() if x.min() < low else x.max()) / half_width),
            f"inside the body, 0 to {high / half_width:g}",
        )
    tolerance = checks.positive("tolerance", values["tolerance"])
    return Setup(case, grid, x, y, z, values["stresses"], tolerance, values["error_estimate"])
