"""A contact with stick and slip: the pressure, then the tractions, and again where these change the pressure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from contactstudy.arrays.variables import describe
from contactstudy.cache import ArrayKey
from contactstudy.caller import warn
from contactstudy.case.motion import Rolling, Shift
from contactstudy.checks import FloatArray
from contactstudy.contact.contact import Contact, Settings, Shape, contact_of
from contactstudy.contact.friction import TANGENTIAL, tractions_of
from contactstudy.contact.nested import Coarser
from contactstudy.contact.pair import PairOperator
from contactstudy.contact.rubbed import Surfaces
from contactstudy.contact.tractions import Tractions
from contactstudy.errors import ConvergenceWarning, InvalidInputError, WindowError
from contactstudy.fields.loads import Loads, TopLoad
from contactstudy.fields.surface import OperatorRequest, SurfaceOperator, surface_operator
from contactstudy.kernels.load import Load
from contactstudy.threads import one_blas_thread

ALL = (Load.NORMAL, *TANGENTIAL)

ROUNDS = 30
"""Rounds of pressure and tractions after which a coupled contact counts as not converged. Speed."""

LEAST_ACCURACY = 1e-5
"""Part of the pressure to which coupled rounds settle at least, however coarse the tolerance. Accuracy."""


AMPLITUDES = {
    True: {"x": "lateral_creepage", "y": "longitudinal_creepage", "spin": "spin"},
    False: {"x": "shift_x", "y": "shift_y"},
}
"""Names in results of the rigid motions, in rolling and in a shift."""


@dataclass(frozen=True, eq=False)
class FrictionalContact:
    """A contact with the tractions of a motion.

    Attributes
    ----------
    contact : Contact
        Pressure and what belongs to it.
    tractions : Tractions
        Tractions and slip.
    settled : bool
        Whether pressure and tractions no longer change each other.
    """

    contact: Contact
    tractions: Tractions
    settled: bool

    @property
    def loads(self) -> Loads:
        """What acts on the body."""
        along_x, along_y = self.tractions.traction
        return {
            Load.NORMAL: TopLoad(self.contact.pressure),
            Load.ALONG_X: TopLoad(along_x),
            Load.ALONG_Y: TopLoad(along_y),
        }

    @property
    def converged(self) -> bool:
        """Whether every iteration reached its tolerance."""
        return self.settled and self.tractions.converged and self.contact.converged

    def warn_unless_converged(self) -> None:
        """Say by how much the result misses its conditions, if it did not converge."""
        self.contact.warn_unless_converged()
        found = self.tractions
        if self.settled and found.converged:
            return
        reason = (
            f"Newton's method stopped after {found.steps} steps (bound_error = {found.bound_error:.2g}, "
            f"slip_error = {found.slip_error:.2g}, force_error = {found.force_error:.2g})"
            if not found.converged
            else f"pressure and tractions still change each other after {ROUNDS} rounds"
        )
        warn(
            f"stick and slip did not converge: {reason}; raise max_iterations or change the grid",
            ConvergenceWarning,
        )

    def dataset(self) -> xr.Dataset:
        """Label tractions, slip, resultants and the certificate, on x and y without coordinates."""
        found, shape = self.tractions, self.contact.shape
        fields = {
            "traction_x": found.traction[0],
            "traction_y": found.traction[1],
            "slip_x": found.slip[0],
            "slip_y": found.slip[1],
            "stick": found.sticks,
        }
        rolls = "spin" in found.rigid
        names, unit = AMPLITUDES[rolls], "1" if rolls else "m"
        scalars: dict[str, object] = {names[name]: amount for name, amount in found.rigid.items()}
        for name in ("force_x", "force_y", "moment_z", "bound_error", "slip_error", "force_error"):
            scalars[name] = getattr(found, name)
        areas, pressed = shape.grid.weights, self.contact.pressure > 0
        scalars["sticking_part"] = float((areas * found.sticks).sum() / (areas * pressed).sum())
        scalars["friction_work"] = found.work
        scalars["friction_steps"] = found.steps
        result = xr.Dataset({name: (("x", "y"), values) for name, values in fields.items()} | scalars)
        for name in ("slip_x", "slip_y"):
            result[name].attrs["units"] = unit
        result["friction_work"].attrs["units"] = "J/m" if rolls else "J"
        assert shape.grid.shape == found.sticks.shape
        return result


def relative_operator(shape: Shape, directions: tuple[Load, ...]) -> PairOperator | SurfaceOperator:
    """Operator from pressure and tractions to displacements of the surfaces relative to each other."""
    if shape.counterbody is None:
        return surface_operator(OperatorRequest(shape.body, shape.grid, ALL, directions=directions))
    return PairOperator.of(shape.body, shape.counterbody, shape.grid, ALL, directions)


def frictional_contact(
    shape: Shape,
    settings: Settings,
    motion: Shift | Rolling,
    friction: float | FloatArray,
    middle: float,
    *,
    coupled: bool,
    before: Mapping[Load, FloatArray] | None = None,
    coarser: Coarser | None = None,
) -> FrictionalContact:
    """Solve a contact whose parts are checked, with the tractions of a motion.

    Parameters
    ----------
    shape : Shape
        What is pressed on what, without friction of its own.
    settings : Settings
        When the iterations stop.
    motion : Shift or Rolling
        How the shape moves against the body.
    friction : float or array (x, 1)
        Coefficient of friction, not below zero.
    middle : float
        Position x about which spin and moment are taken, metres.
    coupled : bool
        Whether the tractions also displace the surfaces normally and so change the pressure.
    before : mapping of Load to array (x, y), optional
        Pressure and tractions from which a shift begins; default: none.
    coarser : Coarser, optional
        Tractions on coarser cells, to begin from.

    Raises
    ------
    InvalidInputError
        If the friction is below zero, or a prescribed force exceeds that of full sliding.
    WindowError
        If the contact comes too close to an edge of the grid.
    """
    on_cells = np.broadcast_to(np.asarray(friction, dtype=np.float64), shape.grid.shape)
    if (on_cells < 0).any():
        raise InvalidInputError(
            "friction", float(on_cells.min()), "not below zero with stick and slip", "the slip turns the traction round"
        )
    with one_blas_thread():
        operator = relative_operator(shape, ALL if coupled else TANGENTIAL)
    materials = [shape.body.material]
    if shape.counterbody is not None:
        materials.append(shape.counterbody.body.material)
    surfaces = Surfaces(operator, shape.grid, materials, middle)

    def rubbed(pressure: FloatArray, last: Tractions | None = None) -> Tractions:
        if isinstance(motion, Rolling) and pressure[:, -2:].any():
            raise WindowError(
                "the contact reaches the last two cells along +y, and rolling takes the slip from the two cells ahead: "
                "widen the window along y"
            )
        with one_blas_thread():
            return tractions_of(
                motion,
                surfaces,
                pressure,
                on_cells,
                tolerance=settings.tolerance,
                max_steps=settings.max_iterations,
                before=before,
                coarser=coarser,
                last=last,
            )

    contact = contact_of(shape, settings)
    tractions, settled = rubbed(contact.pressure), True
    if coupled:
        settled = False
        wanted = max(settings.tolerance, LEAST_ACCURACY)
        for number in range(ROUNDS):
            bent = operator.displaced(dict(zip(TANGENTIAL, tractions.traction, strict=True)), (Load.NORMAL,))
            last = contact.pressure
            contact = contact_of(shape._replace(gap=ArrayKey(shape.gap.values + bent[Load.NORMAL])), settings)
            # Which columns slide is told anew by the first coupled pressure and then kept: it must not go to and fro.
            tractions = rubbed(contact.pressure, tractions if number else None)
            change = float(np.abs(contact.pressure - last).sum() / contact.pressure.sum())
            if change <= wanted:
                settled = True
                break
        body = surface_operator(OperatorRequest(shape.body, shape.grid, ALL, directions=ALL))
        on_body = dict(zip(ALL, (contact.pressure, *tractions.traction), strict=True))
        with one_blas_thread():
            contact = replace(contact, shape=shape, displacement=body(on_body))
    return FrictionalContact(contact, tractions, settled)


def labelled(result: xr.Dataset, found: FrictionalContact) -> xr.Dataset:
    """Add tractions and slip to the labelled contact, whose full sliding they replace."""
    complete = result.assign(found.dataset().data_vars)
    complete["converged"] = found.converged
    return describe(complete)
