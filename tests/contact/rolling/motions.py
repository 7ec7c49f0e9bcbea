"""Motions of a loaded ball: rolling and shifts with every kind of prescribed value."""

from __future__ import annotations

from contactstudy import Rolling, Shift

FRICTION, LOAD = 0.3, 0.06
MOTIONS = {
    "longitudinal": Rolling(longitudinal_creepage=0.01),
    "lateral": Rolling(lateral_creepage=0.01),
    "spin": Rolling(spin=0.02),
    "all": Rolling(longitudinal_creepage=0.005, lateral_creepage=-0.007, spin=0.01),
    "forces": Rolling(force_y=0.5 * FRICTION * LOAD, force_x=-0.3 * FRICTION * LOAD),
    "moment": Rolling(longitudinal_creepage=0.005, moment_z=0.03 * FRICTION * LOAD),
    "shift": Shift(y=0.012, x=0.005),
    "shifting force": Shift(force_x=0.7 * FRICTION * LOAD),
}
