"""What a unit load on one cell does around it."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.kernels.images import CornerFunction, cell_kernel, mirrored_kernel


@dataclass(frozen=True, eq=False)
class Influence:
    """What a unit load on one cell does around it: the components of one or more fields.

    Attributes
    ----------
    key : hashable
        Name of the field and the values it depends on: two influences with equal keys are the same.
    corner : callable
        Corner functions (component, ...) of broadcastable offsets ``X, Y`` and of the depth.
    sign_along_x, sign_along_y : array (component,)
        1 or -1 for components even or odd in the offset along x and along y.
    image_level : array (component,)
        Constant that the images of a unit load per area add to the kernel, see `mirrored_kernel`; it fixes the
        reference of a quantity that grows with distance.
    """

    key: Hashable
    corner: Callable[[FloatArray, FloatArray, float], FloatArray]
    sign_along_x: FloatArray
    sign_along_y: FloatArray
    image_level: FloatArray

    def corner_at(self, depth: float) -> CornerFunction:
        """Corner functions at one depth."""
        return lambda x, y: self.corner(x, y, depth)

    def kernel(self, x: FloatArray, y: FloatArray, dx: float, dy: float, length: float, depth: float) -> FloatArray:
        """Influence at uniform offsets `x` and `y`, with all images where `length` is finite: (component, x, y)."""
        if np.isinf(length):
            return cell_kernel(self.corner_at(depth), x, y, dx, dy)
        kernel = mirrored_kernel(self.corner_at(depth), x, y, dx, dy, length)
        return np.asarray(kernel + dx * dy * self.image_level[:, None, None])
