"""Solve a contact with stick and slip: pressure, then tractions, in rounds if the tractions change the pressure."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from contactstudy.arrays.variables import describe
from contactstudy.cache import ArrayKey
from contactstudy.case.motion import Rolling, Shift
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.contact import Contact, Settings, Shape, contact_of
from contactstudy.contact.normal.two_bodies import PairOperator
from contactstudy.contact.rolling.surfaces import TANGENTIAL, Surfaces, Tractions
from contactstudy.contact.rolling.tractions import FrictionRequest, solve_tractions
from contactstudy.errors import ConvergenceWarning, WindowError
from contactstudy.fields.loads import Loads, TopLoad
from contactstudy.fields.surface import SurfaceOperator, surface_operator
from contactstudy.kernels.load import Load
from contactstudy.threads import one_blas_thread

DIRECTIONS = (Load.NORMAL, *TANGENTIAL)

MAX_ROUNDS = 30  # largest number of rounds of pressure and tractions in a coupled contact. Speed.
MIN_ACCURACY = 1e-5  # least change of the pressure that ends coupled rounds. Accuracy.
AMPLITUDE_NAMES = {Rolling: Rolling.AMPLITUDES, Shift: {"x": "shift_x", "y": "shift_y"}}
"""Names in results of the rigid motions, by class of the motion."""


@dataclass(frozen=True, eq=False)
class FrictionalContact:
    """A contact with the tractions of a motion."""

    contact: Contact  # pressure, gap and rigid motion
    tractions: Tractions  # tractions and slip
    rounds_converged: bool  # whether the rounds of pressure and tractions converged

    @property
    def loads(self) -> Loads:
        """Loads on the body."""
        return dict(zip(DIRECTIONS, map(TopLoad, (self.contact.pressure, *self.tractions.traction)), strict=True))

    @property
    def converged(self) -> bool:
        """Whether every iteration reached its tolerance."""
        return self.rounds_converged and self.tractions.converged and self.contact.converged

    def warn_unless_converged(self) -> None:
        """Warn with the violations of the conditions, if an iteration did not converge."""
        self.contact.warn_unless_converged()
        tractions = self.tractions
        if self.rounds_converged and tractions.converged:
            return
        reason = (
            f"Newton's method stopped after {tractions.steps} steps (bound_error = {tractions.bound_error:.2g}, "
            f"slip_error = {tractions.slip_error:.2g}, force_error = {tractions.force_error:.2g})"
            if not tractions.converged
            else f"pressure and tractions still change each other after {MAX_ROUNDS} rounds"
        )
        warnings.warn(
            f"stick and slip did not converge: {reason}; raise max_iterations or change the grid",
            ConvergenceWarning,
            stacklevel=2,
        )

    @property
    def rigid_motions(self) -> dict[str, float]:
        """Rigid motions by their names in results."""
        amplitudes = self.tractions.amplitudes
        names = AMPLITUDE_NAMES[Rolling if "spin" in amplitudes else Shift]
        return {names[mode]: amplitude for mode, amplitude in amplitudes.items()}

    def with_tractions(self, result: xr.Dataset) -> xr.Dataset:
        """Labelled contact with tractions, slip, resultants and certificate in place of full sliding."""
        tractions, weights = self.tractions, self.contact.shape.grid.weights
        fields = {
            "traction_x": tractions.traction[0],
            "traction_y": tractions.traction[1],
            "slip_x": tractions.slip[0],
            "slip_y": tractions.slip[1],
            "stick": tractions.sticks,
        }
        scalars = {
            **self.rigid_motions,
            **tractions.resultants,
            "bound_error": tractions.bound_error,
            "slip_error": tractions.slip_error,
            "force_error": tractions.force_error,
            "sticking_part": float((weights * tractions.sticks).sum() / (weights * (self.contact.pressure > 0)).sum()),
            "friction_work": tractions.work,
            "friction_steps": tractions.steps,
            "converged": self.converged,
        }
        complete = result.assign({name: (("x", "y"), values) for name, values in fields.items()}).assign(scalars)
        slip_unit, work_unit = ("1", "J/m") if "spin" in tractions.amplitudes else ("m", "J")
        for name, unit in (("slip_x", slip_unit), ("slip_y", slip_unit), ("friction_work", work_unit)):
            complete[name].attrs["units"] = unit
        return describe(complete)


def frictional_contact(shape: Shape, settings: Settings, request: FrictionRequest) -> FrictionalContact:
    """Solve a contact for the pressure and the tractions of a motion."""
    motion = request.motion
    directions, materials = DIRECTIONS if request.coupled else TANGENTIAL, [shape.body.material]
    operator: PairOperator | SurfaceOperator
    with one_blas_thread():
        if shape.counterbody is None:
            operator = surface_operator(shape.body, shape.grid, DIRECTIONS, directions=directions)
        else:
            operator = PairOperator.of(shape.body, shape.counterbody, shape.grid, DIRECTIONS, directions)
            materials.append(shape.counterbody.body.material)
    surfaces = Surfaces(operator, shape.grid, materials, request.reference_x)

    def solve_for_pressure(pressure: FloatArray, guess: Tractions | None = None) -> Tractions:
        if isinstance(motion, Rolling) and pressure[:, -2:].any():
            raise WindowError(
                "the contact reaches the last two cells along +y, and the slip of rolling follows from the two cells "
                "ahead: widen the window along y"
            )
        with one_blas_thread():
            return solve_tractions(request, settings, surfaces, pressure, guess)

    contact = contact_of(shape, settings)
    tractions, converged = solve_for_pressure(contact.pressure), True
    if request.coupled:
        converged = False
        tolerance = max(settings.tolerance, MIN_ACCURACY)
        for round_index in range(MAX_ROUNDS):
            loads = dict(zip(TANGENTIAL, tractions.traction, strict=True))
            displacements = operator.compute_displacements(loads, (Load.NORMAL,))
            previous_pressure = contact.pressure
            contact = contact_of(shape._replace(gap=ArrayKey(shape.gap.values + displacements[Load.NORMAL])), settings)
            # The first coupled pressure fixes sliding columns and leading edges, which might alternate between rounds.
            tractions = solve_for_pressure(contact.pressure, tractions if round_index else None)
            change = float(np.abs(contact.pressure - previous_pressure).sum() / contact.pressure.sum())
            if change <= tolerance:
                converged = True
                break
        body = surface_operator(shape.body, shape.grid, DIRECTIONS, directions=DIRECTIONS)
        loads = dict(zip(DIRECTIONS, (contact.pressure, *tractions.traction), strict=True))
        with one_blas_thread():
            contact = replace(contact, shape=shape, displacement=body(loads))
    return FrictionalContact(contact, tractions, converged)
