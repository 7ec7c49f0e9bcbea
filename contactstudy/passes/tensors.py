"""Tensors as arrays (6, ...): xx, yy, zz, xy, xz, yz."""

from __future__ import annotations

import numpy as np

from contactstudy.checks import FloatArray

DOUBLED = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
"""How often each component stands in a tensor."""


def deviator(tensor: FloatArray) -> FloatArray:
    """Deviator of tensors."""
    found = tensor.copy()
    found[:3] -= tensor[:3].mean(axis=0)
    return found


def length(tensor: FloatArray) -> FloatArray:
    """Euclidean length of tensors.

    Examples
    --------
    >>> float(length(np.array([3.0, 0.0, 0.0, 0.0, 0.0, np.sqrt(8.0)])))
    5.0
    """
    return np.asarray(np.sqrt(np.tensordot(DOUBLED, tensor**2, axes=1)))
