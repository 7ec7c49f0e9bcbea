"""Stresses as a dictionary of components, and their equivalent stress.

Names and formula also stand in :mod:`contactstudy.arrays`; they are written here a second time on purpose, as all
closed forms, so that a mistake there shows.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contactstudy.checks import FloatArray

Stress = dict[str, FloatArray]

COMPONENTS = ("sigma_xx", "sigma_yy", "sigma_zz", "tau_xy", "tau_xz", "tau_yz")
"""Keys of a stress."""


def von_mises(stress: Mapping[str, FloatArray]) -> FloatArray:
    """Equivalent stress of von Mises."""
    xx, yy, zz, xy, xz, yz = (np.asarray(stress[name]) for name in COMPONENTS)
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(0.5 * normal + 3 * (xy**2 + xz**2 + yz**2)))
