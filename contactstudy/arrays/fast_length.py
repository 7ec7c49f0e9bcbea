"""Numbers of cells of which Fourier transforms are fast, without SciPy: a plan, or a page, of a study needs no more."""

from __future__ import annotations

from functools import lru_cache

REAL, COMPLEX = (2, 3, 5), (2, 3, 5, 7, 11)
"""Factors of the lengths of which transforms of real and of complex values are fast, as `scipy.fft` has them."""


@lru_cache(maxsize=4096)
def fast_length(least: int, *, real: bool = False) -> int:
    """Smallest number of cells, not below `least`, of which Fourier transforms are fast.

    Parameters
    ----------
    least : int
        Positive.
    real : bool
        Whether the values are real.

    Returns
    -------
    int

    Examples
    --------
    >>> fast_length(121), fast_length(121, real=True)
    (121, 125)
    """
    return _smallest(least, REAL if real else COMPLEX)


def _smallest(least: int, factors: tuple[int, ...]) -> int:
    """Smallest product of these factors that is not below `least`."""
    *others, last = factors
    if not others:
        return int(last ** (least - 1).bit_length())
    best, power = 0, 1
    while not best or power < best:
        product = power * _smallest(-(-least // power), tuple(others))
        best = min(best, product) if best else product
        power *= last
    return best
