"""Slope of a body's reference line, from displacements inside the body."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import FiniteLengthSpace, displacement_field


def compute_line_slope(body: FiniteLengthSpace, pressure: xr.DataArray, depth: float) -> float:
    """Least-squares slope of the line y = 0 at a depth: a fit at Gauss nodes with their weights."""
    nodes, weights = np.polynomial.legendre.leggauss(16)
    x = 0.5 * body.length * (nodes + 1)
    displacement = displacement_field(body, pressure, x=x, y=[0.0], z=[depth]).u_z.values.ravel()
    return float(np.polynomial.polynomial.polyfit(x, displacement, 1, w=np.sqrt(weights))[1])
