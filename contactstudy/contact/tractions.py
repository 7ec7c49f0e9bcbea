"""Tractions and slip of a contact with a motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from contactstudy.case.motion import Rolling, Shift
from contactstudy.checks import BoolArray, FloatArray
from contactstudy.contact.fastsim import Pair, flexibilities, strip_tractions
from contactstudy.contact.rubbed import Surfaces, amplitude, motions_of


@dataclass(frozen=True, eq=False)
class Tractions:
    """Tractions on the body, and the slip of the roller against it.

    Attributes
    ----------
    traction : array (2, x, y)
        Along x and y, Pa.
    slip : array (2, x, y)
        Along x and y: per distance rolled, or metres in a shift; 0 outside the contact.
    sticks : bool array (x, y)
        Cells of the contact that stick.
    rigid : mapping of str to float
        Amplitudes of the rigid slip: "x", "y" and, in rolling, "spin".
    force_x, force_y, moment_z : float
        Resultants on the body, N and N m.
    work : float
        Frictional work: per distance rolled, J/m, or of the shift, J.
    bound_error, slip_error, force_error : float
        Certificate, recomputed: traction above the bound, over the largest bound; slip where cells stick, and slip
        across or against the traction elsewhere, over the rigid slip; error of prescribed resultants, over the largest.
    steps, applications : int
        Steps of Newton's method and applications of the operator.
    converged : bool
        Whether the tolerance was reached.
    """

    traction: FloatArray
    slip: FloatArray
    sticks: BoolArray
    rigid: Mapping[str, float]
    force_x: float
    force_y: float
    moment_z: float
    work: float
    bound_error: float = 0.0
    slip_error: float = 0.0
    force_error: float = 0.0
    steps: int = 0
    applications: int = 0
    converged: bool = True


def tractions_of_strips(motion: Rolling, surfaces: Surfaces, bound: FloatArray) -> Tractions:
    """Tractions of FASTSIM's strips."""
    grid, weights = surfaces.grid, surfaces.weights
    rows, columns = np.flatnonzero(bound.any(axis=1)), np.flatnonzero(bound.any(axis=0))
    widths = 0.5 * float(grid.widths[rows].sum()), 0.5 * columns.size * grid.dy
    rigid = {name: amplitude(motion, name) for name in motions_of(motion)}
    soft = flexibilities(widths, Pair.of(surfaces.materials))
    turning = rigid["spin"] / soft["spin"]
    growth = np.zeros((2, *grid.shape))
    growth[0] = rigid["x"] / soft["x"] - turning * grid.y
    growth[1] = rigid["y"] / soft["y"] + turning * (grid.x - surfaces.middle)[:, None]
    traction, lost = strip_tractions(bound, growth, grid.dy)
    slip = np.array([soft["x"], soft["y"]])[:, None, None] * lost
    force_x, force_y, moment = (weights * traction).sum(axis=(1, 2, 3)).tolist()
    return Tractions(
        traction=traction,
        slip=slip,
        sticks=(bound > 0) & ~lost.any(axis=0),
        rigid=rigid,
        force_x=force_x,
        force_y=force_y,
        moment_z=moment,
        work=float((traction * slip * surfaces.areas).sum()),
    )


def no_tractions(motion: Shift | Rolling, surfaces: Surfaces) -> Tractions:
    """Tractions where the friction is 0 everywhere: none, and the slip of rigid surfaces is of no interest."""
    none = np.zeros((2, *surfaces.grid.shape))
    rigid = {name: amplitude(motion, name) for name in motions_of(motion)}
    return Tractions(none, none.copy(), np.zeros(surfaces.grid.shape, bool), rigid, 0.0, 0.0, 0.0, 0.0)
