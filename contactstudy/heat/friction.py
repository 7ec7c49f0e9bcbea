"""Heat that friction makes in a solved contact, in full sliding or in rolling."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.cells import labelled_cells
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.units import required_in_si
from contactstudy.case.case import Case
from contactstudy.case.motion import Rolling, Shift, Sliding
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError


class FrictionalHeat(NamedTuple):
    """Frictional heat on the cells, and how the surfaces move against the contact."""

    density: FloatArray
    power: float
    body_speed: float
    roller_speed: float


def frictional_heat(
    case: Case,
    one: xr.Dataset,
    grid: Grid,
    body_speed: object,
    roller_speed: object,
    rolling_speed: object,
) -> FrictionalHeat:
    """Heat per area and speeds of a solved case.

    Parameters
    ----------
    case : Case
        In full sliding or in rolling.
    one : Dataset
        Its result.
    grid : Grid
        The result's cells.
    body_speed, roller_speed, rolling_speed : float
        As of :func:`contactstudy.flash_temperature`.

    Raises
    ------
    InvalidInputError
        If the speeds contradict the motion or the friction, or the result lacks tractions.
    """
    motion = case.motion
    assert not isinstance(motion, Shift)
    area = grid.weights * grid.cell_area
    if isinstance(motion, Sliding):
        one = required_in_si(one, "traction_y", argument="result")
        if rolling_speed is not None:
            raise InvalidInputError(
                "rolling_speed", rolling_speed, "None in full sliding", "give both surfaces' speeds"
            )
        own, others = (
            checks.finite(name, value, "m/s, of full sliding")
            for name, value in (("body_speed", body_speed), ("roller_speed", roller_speed))
        )
        traction = labelled_cells("result.traction_y", one["traction_y"], extent=case.body.extent)[0]
        density = traction * (others - own)
        if (density < 0).any():
            raise InvalidInputError(
                "roller_speed",
                others,
                f"{_side(traction)} body_speed, {own:g}, for the friction to drag the body the way the roller slides",
                "speeds are along +y",
            )
        return FrictionalHeat(density, float((area * traction).sum() * (others - own)), own, others)
    for name, value in (("body_speed", body_speed), ("roller_speed", roller_speed)):
        if value is not None:
            raise InvalidInputError(name, value, "None in rolling", "give rolling_speed: the creepage says the rest")
    speed = checks.positive("rolling_speed", rolling_speed, "m/s, of rolling")
    return _rolling_heat(case, motion, one, speed, area)


def _side(traction: FloatArray) -> str:
    """Say on which side of the body's speed the roller's lies."""
    if (traction < 0).any() and (traction > 0).any():
        return "equal to, as the friction changes its sign along the axis,"
    return "not below" if traction.max() > 0 else "not above"


def _rolling_heat(case: Case, motion: Rolling, one: xr.Dataset, speed: float, area: FloatArray) -> FrictionalHeat:
    """Heat of a rolling contact: traction times slip per distance, times distance per time.

    Cells of which a part slips say roughly how much work each does; the work of the whole contact is known better.
    """
    names = ("traction_x", "slip_x", "traction_y", "slip_y")
    one = required_in_si(one, *names, "friction_work", argument="result")
    q_x, s_x, q_y, s_y = (labelled_cells(f"result.{name}", one[name], extent=case.body.extent)[0] for name in names)
    # The contact moves along +y over both surfaces, so these move backwards below it.
    creepage = float(one["longitudinal_creepage"]) if "longitudinal_creepage" in one else motion.longitudinal_creepage
    half = 0.5 * float(creepage or 0.0)
    density = np.maximum(q_x * s_x + q_y * s_y, 0.0)
    work, summed = float(one["friction_work"]), float((area * density).sum())
    return FrictionalHeat(
        speed * density * (work / summed if summed else 0.0),
        speed * (work if summed else 0.0),
        -speed * (1 + half),
        -speed * (1 - half),
    )
