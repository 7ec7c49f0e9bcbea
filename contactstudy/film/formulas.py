"""Formulas for the film of line and point contacts, against which solutions are compared."""

from __future__ import annotations

import numpy as np

from contactstudy.checks import FloatArray


def moes_line(load: FloatArray | float, lubricant: FloatArray | float) -> FloatArray:
    """Central film of a line contact, ``H = h / R (2 U)**-1/2``, by Moes' formula, eq. (410).

    Moes' numbers are ``M = w / (E' R) (2 U)**-1/2`` and ``L = alpha E' (2 U)**1/4``, with ``E' = 2 E*``.
    """
    h_ri, h_ei = 3.0 / np.asarray(load), 2.621 * np.asarray(load) ** -0.2
    h_rp = 1.287 * np.asarray(lubricant) ** (2 / 3)
    h_ep = 1.311 * np.asarray(load) ** -0.125 * np.asarray(lubricant) ** 0.75
    s = (7 + 8 * np.exp(-2 * h_ei / h_ri)) / 5
    piezoviscous = (h_rp**-3.5 + h_ep**-3.5) ** (-2 * s / 7)
    return np.asarray(((h_ri ** (7 / 3) + h_ei ** (7 / 3)) ** (3 * s / 7) + piezoviscous) ** (1 / s))


def nijenbanning(load: float, lubricant: float, ratio: float = 1.0) -> float:
    """Central film of an elliptic contact by Nijenbanning, Venner and Moes (1994), eq. (411); `ratio` at most 1.

    Of ``M = F / (E' Rx**2) (2 U)**-3/4``, ``L``, and ``Rx / Ry`` with the radius Rx along rolling.
    """
    h_ri = 145 * (1 + 0.796 * ratio ** (14 / 15)) ** (-15 / 7) * load**-2 / ratio
    h_ei = 3.18 * (1 + 0.006 * np.log(ratio) + 0.63 * ratio ** (4 / 7)) ** (-14 / 25) * ratio ** (-1 / 15)
    h_ei *= load ** (-2 / 15)
    h_rp = 1.29 * (1 + 0.691 * ratio) ** (-2 / 3) * lubricant ** (2 / 3)
    h_ep = 1.48 * (1 + 0.006 * np.log(ratio) + 0.63 * ratio ** (4 / 7)) ** (-7 / 20) * ratio ** (-1 / 24)
    h_ep *= load ** (-1 / 12) * lubricant**0.75
    s = 1.5 * (1 + np.exp(-1.2 * h_ei / h_ri))
    isoviscous = (h_ri**1.5 + (h_ei**-4 + (1.8 / ratio) ** -4) ** (-3 / 8)) ** (2 * s / 3)
    return float((isoviscous + (h_rp**-8 + h_ep**-8) ** (-s / 8)) ** (1 / s))


def thermal_reduction(pressure_ratio: float, loading: float, slide_roll_ratio: float) -> float:
    """Film with the heat of shear in the inlet over the isothermal film (Gupta, Cheng, Zhu 1992), eq. (414).

    From the largest pressure over E' and the `loading` ``eta0 beta um**2 / k``.
    """
    inlet_heating = 1 + 0.213 * (1 + 2.23 * abs(slide_roll_ratio) ** 0.83) * loading**0.64
    return float((1 - 13.2 * pressure_ratio * loading**0.42) / inlet_heating)
