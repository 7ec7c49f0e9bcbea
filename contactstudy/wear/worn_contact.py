"""Contact of a roller whose profile wears while it is pressed: the wear of a step is one more compliance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from contactstudy.cache import ArrayKey
from contactstudy.case.case import Case
from contactstudy.case.motion import Rolling
from contactstudy.checks import FloatArray
from contactstudy.contact.contact import Settings, Shape, check_window, contact_operator
from contactstudy.contact.frictional import frictional_contact
from contactstudy.contact.problem import ContactOperator, ContactProblem, solve_coupled, solve_normal
from contactstudy.kernels.load import Load
from contactstudy.threads import one_blas_thread


@dataclass(frozen=True, eq=False)
class WearingOperator:
    """Displacement under a pressure, with what it wears off the profile within a step.

    Attributes
    ----------
    elastic : ContactOperator
        Of the bodies.
    compliance : array (x, 1)
        Worn depth per load per length of each column, m2/N.
    step : float
        Cell size along y, metres.
    """

    elastic: ContactOperator
    compliance: FloatArray
    step: float

    def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
        """Displacement (m) of the cell centres under `loads` (Pa): traction along y wears nothing by itself."""
        displaced = self.elastic(loads)
        if Load.NORMAL not in loads:
            return displaced
        return np.asarray(displaced + self.compliance * (self.step * loads[Load.NORMAL].sum(axis=1, keepdims=True)))

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Roughly the pressure that sinks the cells by `gap`."""
        return self.elastic.precondition(gap)

    @property
    def coarse(self) -> ContactOperator:
        """The bodies' operator on cells of twice the size: a first guess without wear."""
        return self.elastic.coarse


class Pressed(NamedTuple):
    """A pressure (x, y), its load per length (x), and whether the iteration converged."""

    pressure: FloatArray
    line_load: FloatArray
    converged: bool


@dataclass(frozen=True, eq=False)
class WornContact:
    """The contact of a case on given cells, its profile worn by some depth.

    Attributes
    ----------
    case : Case
        The case.
    shape : Shape
        What is pressed on what while nothing is worn.
    settings : Settings
        When the iterations stop.
    """

    case: Case
    shape: Shape
    settings: Settings

    def pressed(self, depth: FloatArray, compliance: FloatArray, start: FloatArray | None) -> Pressed:
        """Press the roller on while it wears.

        Parameters
        ----------
        depth : array (x)
            Worn depth at the beginning, metres.
        compliance : array (x)
            Further depth per load per length, m2/N.
        start : array (x, y), optional
            Pressure to begin the iteration with.

        Raises
        ------
        WindowError
            If the contact reaches an edge of the grid where the body goes on.
        """
        shape, grid = self.shape, self.shape.grid
        problem = ContactProblem(
            grid,
            shape.gap.values + depth[:, None],
            shape.prescribed.resultants(grid),
            shape.coupled_friction,
            *self.settings,
        )
        with one_blas_thread():
            operator = WearingOperator(contact_operator(shape), compliance[:, None], grid.dy)
            if shape.coupled_friction:
                found = solve_coupled(operator, problem)
            else:
                found = solve_normal(operator, problem, start)
        check_window(shape.body, found.pressure)
        return Pressed(found.pressure, grid.dy * found.pressure.sum(axis=1), found.converged)

    def slip(self, depth: FloatArray, law: str) -> FloatArray:
        """Return what the load per length is multiplied with to give wear: array (x).

        That is the slip per distance, or the frictional work, averaged over the cross-section with the pressure.
        """
        case, grid = self.case, self.shape.grid
        friction = np.broadcast_to(case.friction_on(grid.x), (grid.cells_x, 1))[:, 0]
        if not isinstance(case.motion, Rolling):
            return np.ones(grid.cells_x) if law == "slip" else np.abs(friction)
        middle = case.roller_middle
        shape = self.shape._replace(gap=ArrayKey(self.shape.gap.values + depth[:, None]))
        found = frictional_contact(shape, self.settings, case.motion, friction[:, None], middle, coupled=False)
        found.warn_unless_converged()
        slip, traction = found.tractions.slip, found.tractions.traction
        pressure = found.contact.pressure
        if law == "slip":
            worn = pressure * np.hypot(slip[0], slip[1])
        else:
            worn = np.maximum(traction[0] * slip[0] + traction[1] * slip[1], 0.0)
            # The work of the whole contact is known better than that of cells of which a part slips.
            summed = float((worn * grid.weights).sum() * grid.cell_area)
            worn *= found.tractions.work / summed if summed else 0.0
        load = pressure.sum(axis=1)
        return np.asarray(np.divide(worn.sum(axis=1), load, out=np.zeros_like(load), where=load > 0))
