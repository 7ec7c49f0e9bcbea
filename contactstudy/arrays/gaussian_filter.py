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

EVEN = 1e-3
"""Part of a step by which points may be off even ones, which are filtered by Fourier transforms. Accuracy."""


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
    step = (x[-1] - x[0]) / (x.size - 1)
    even = np.abs(x - np.linspace(x[0], x[-1], x.size)).max() <= EVEN * step
    zeroth, first, second, mean, moment = _even(step / width, values) if even else _uneven(x / width, values)
    return np.asarray((second * mean - first * moment) / (zeroth * second - first**2))


def _even(step: float, values: FloatArray) -> tuple[FloatArray, ...]:
    """Return the sums of the weight times 1, ``s``, ``s**2``, the values and ``s`` times these at each even point."""
    from scipy.signal import oaconvolve

    reach = min(int(REACH / step), values.size - 1)
    s = step * np.arange(reach, -reach - 1, -1)  # a convolution turns it round
    weight = step * np.exp(-np.pi * s**2)
    ones = np.ones(values.size)
    ones[[0, -1]] = 0.5  # half a step belongs to each end
    pairs = [(weight * s**power, ones) for power in range(3)]
    pairs += [(weight * s**power, ones * values) for power in range(2)]
    return tuple(oaconvolve(along, kernel, mode="full")[reach : reach + values.size] for kernel, along in pairs)


def _uneven(x: FloatArray, values: FloatArray) -> tuple[FloatArray, ...]:
    """Return the same sums for points anywhere, in widths of the weight."""
    shares = np.gradient(x)  # of the axis that each point stands for
    shares[[0, -1]] *= 0.5
    found = np.empty((5, x.size))
    for begin in range(0, x.size, CHUNK):
        at = x[begin : begin + CHUNK]
        low, high = np.searchsorted(x, (at[0] - REACH, at[-1] + REACH))
        near = slice(low, high)
        s = x[near] - at[:, None]
        weight = np.where(np.abs(s) <= REACH, shares[near] * np.exp(-np.pi * s**2), 0.0)
        sums = [np.sum(weight * s**power, axis=1) for power in range(3)]
        found[:, begin : begin + CHUNK] = [*sums, weight @ values[near], (weight * s) @ values[near]]
    return tuple(found)
