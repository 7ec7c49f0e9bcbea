"""What is prescribed of a contact: its load, perhaps where that acts, or its approach."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray
from contactstudy.contact.conjugate_gradients import Resultants
from contactstudy.errors import InvalidInputError


class Prescribed(NamedTuple):
    """Either the load, at a given position or with a given inclination, or the approach.

    Attributes
    ----------
    load : float or None
        Normal load, N.
    load_position : float or None
        Position x on which the load acts, metres; None: the shape keeps its inclination.
    approach : float or None
        How far the shape is pressed down from first touch, metres.
    """

    load: float | None = None
    load_position: float | None = None
    approach: float | None = None

    def checked(self, gap: FloatArray, grid: Grid) -> Prescribed:
        """Return the same as floats, or raise if the values do not go together or with the initial gap (x, y)."""
        load, position, approach = self
        if (load is None) == (approach is None):
            raise InvalidInputError("load, approach", (load, approach), "exactly one of the two, the other None")
        if approach is not None:
            lowered = checks.finite("approach", approach, "metres")
            if position is not None:
                raise InvalidInputError(
                    "load_position", position, "None where the approach is prescribed", "prescribe the load instead"
                )
            if lowered <= gap.min():
                raise InvalidInputError("approach", lowered, f"more than the least gap, {gap.min():g} m")
            return Prescribed(approach=lowered)
        total = checks.positive("load", load, "N")
        if position is None:
            return Prescribed(total)
        at = checks.finite("load_position", position, "metres")
        columns = grid.x[np.isfinite(gap).any(axis=1)]
        if not columns[0] < at < columns[-1]:
            raise InvalidInputError(
                "load_position",
                at,
                f"under the shape, between {columns[0]:g} and {columns[-1]:g} m, for it to balance there",
            )
        return Prescribed(total, at)

    @property
    def lowered(self) -> float:
        """How far the shape is lowered before the iteration, metres."""
        return 0.0 if self.approach is None else self.approach

    def resultants(self, grid: Grid) -> Resultants:
        """Return what the pressure on the cells has to sum up to."""
        if self.load is None:
            return Resultants(None)
        lever = None if self.load_position is None else (grid.x[:, None] - self.load_position) / self.largest_arm(grid)
        return Resultants(self.load / grid.cell_area, lever)

    def largest_arm(self, grid: Grid) -> float:
        """Return the largest distance of a cell from where the load acts, metres."""
        assert self.load_position is not None
        return float(np.abs(grid.x - self.load_position).max())
