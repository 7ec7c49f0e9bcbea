"""The Gaussian filter of measured profiles: waves shorter than a cut-off are left out."""

from __future__ import annotations

import numpy as np

from contactstudy.checks import FloatArray

ALPHA = np.sqrt(np.log(2) / np.pi)
"""Makes the transmission one half at the cut-off (ISO 16610-21)."""

REACH = 2.2
"""Half the width of the weight over ``ALPHA`` times the cut-off; beyond it is less than 3e-7 of its peak. Accuracy."""

CHUNK = 256
"""Points that are filtered at once. Speed."""


def gaussian_filtered(x: FloatArray, values: FloatArray, cutoff: float) -> FloatArray:
    """Return values without the waves that are shorter than a cut-off.

    Parameters
    ----------
    x : array
        Increasing positions, metres, evenly spaced or not.
    values : array
        One for each.
    cutoff : float
        Wavelength of which one half is transmitted, metres; of a wavelength `l` it is ``2**-(cutoff / l)**2``.

    Notes
    -----
    The weight is that of ISO 16610-21, ``exp(-pi (s / (alpha cutoff))**2)``. At each point the straight line that fits
    the values best by this weight is taken: away from the ends, where the weight is even, that is the standard's
    weighted mean; within a cut-off of the ends the weight is cut off, and the line keeps the zeroth and first moments
    that the mean would lose there (moment criterion, ISO 16610-28; linear regression of first order, S. Brinkmann,
    H. Bodschwinna, H.-W. Lemke, International Journal of Machine Tools and Manufacture 41 (2001) 2153-2161). A straight
    line stays as it is, up to its ends.

    Examples
    --------
    >>> x = np.linspace(0.0, 10e-3, 1001)
    >>> wave = np.sin(2 * np.pi * x / 0.8e-3)
    >>> bool(np.allclose(gaussian_filtered(x, wave, 0.8e-3)[200:-200], 0.5 * wave[200:-200], atol=1e-5))
    True
    """
    width = ALPHA * cutoff
    shares = np.gradient(x)  # of the axis that each point stands for
    found = np.empty_like(values)
    for begin in range(0, x.size, CHUNK):
        at = x[begin : begin + CHUNK]
        low, high = np.searchsorted(x, (at[0] - REACH * width, at[-1] + REACH * width), side="left")
        near = slice(low, min(high + 1, x.size))
        s = (x[near] - at[:, None]) / width
        weight = np.where(np.abs(s) <= REACH, shares[near] * np.exp(-np.pi * s**2), 0.0)
        zeroth, first, second = (np.sum(weight * s**power, axis=1) for power in range(3))
        mean, moment = weight @ values[near], (weight * s) @ values[near]
        found[begin : begin + CHUNK] = (second * mean - first * moment) / (zeroth * second - first**2)
    return found
