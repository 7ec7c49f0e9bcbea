"""Rollers that would leave their length and stand on an end: what their contact could not balance is refused."""

from __future__ import annotations

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.case.case import Case
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

LEAST_CONTACT = 1.0
"""Length over the Hertz half-width that a tilted roller has to touch on, if it touches at its end."""

LEAST_ARM = 0.25
"""Distance of the load from the roller's end, over the Hertz half-width, below which no such contact balances it."""


def inclination(case: Case) -> str:
    """Name what inclines the roller of a case, for messages."""
    if case.load_position is not None:
        return f"load_position = {case.load_position:g} m"
    return f"tilt = {case.tilt:g} rad"


def check_balanced(case: Case) -> None:
    """Raise if the load acts so near to the roller's end that the contact could not reach far from it."""
    if case.load_position is None:
        return
    start, stop = case.contact_range
    distance = min(case.load_position - start, stop - case.load_position)
    if distance < LEAST_ARM * case.hertz_half_width < LEAST_ARM * case.contact_length:
        raise _stands_on_its_end(case, f"where a load at {distance:.3g} m from the end is not balanced")


def check_on_its_length(case: Case, grid: Grid, gap: FloatArray, pressure: FloatArray) -> None:
    """Raise if a tilted roller left its length under a pressure (x, y); its gap is finite where it faces the body."""
    if not case.tilt and case.load_position is None:
        return
    facing = np.flatnonzero(np.isfinite(gap).any(axis=1))
    touching = np.flatnonzero(pressure.any(axis=1))
    at_end = touching[0] == facing[0] or touching[-1] == facing[-1]
    length = float(grid.widths[touching].sum())
    if at_end and length < LEAST_CONTACT * case.hertz_half_width < case.contact_length:
        raise _stands_on_its_end(case, f"not {length:.3g} m")


def _stands_on_its_end(case: Case, found: str) -> InvalidInputError:
    """Error of a roller that has left its length and stands on its end."""
    name = "tilt" if case.load_position is None else "load_position"
    return InvalidInputError(
        name,
        getattr(case, name),
        f"such that the contact reaches further from the roller's end than {LEAST_CONTACT:g} half-width a, "
        f"{case.hertz_half_width:.3g} m, {found}",
        "tilt the roller less or load it nearer to its middle",
    )
