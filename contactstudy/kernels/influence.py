"""What a unit load on one cell does around it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.kernels.images import CornerFunction, cell_kernel, mirrored_kernel
from contactstudy.kernels.load import Load


@dataclass(frozen=True)
class Influence:
    """What a unit load on one cell does around it: the components of a field.

    Two influences that compare equal are the same, so they can be part of a cache's request.

    Attributes
    ----------
    corner : callable
        Corner functions (component, ...) of broadcastable offsets ``X, Y`` and depths, and Poisson's ratio.
    poisson : float
        Poisson's ratio.
    load : Load
        Direction of the load.
    sign_along_x, sign_along_y : tuple of int
        Per component, 1 or -1 if it is even or odd in the offset along x and along y.
    image_level : tuple of float
        Per component, the constant that the images of a unit load per area add to the kernel, see `mirrored_kernel`; it
        fixes the reference of a quantity that grows with distance.
    """

    corner: Callable[[FloatArray, FloatArray, FloatArray | float, float], FloatArray]
    poisson: float
    load: Load
    sign_along_x: tuple[int, ...]
    sign_along_y: tuple[int, ...]
    image_level: tuple[float, ...]

    @classmethod
    def of(
        cls,
        corner: Callable[[FloatArray, FloatArray, FloatArray | float, float], FloatArray],
        poisson: float,
        load: Load,
        under_pressure: tuple[tuple[int, ...], tuple[int, ...]],
        image_level: tuple[float, ...] | None = None,
    ) -> Influence:
        """Influence of a load in any direction, from the parities along x and y of the components under a pressure."""
        along_x, along_y = under_pressure
        return cls(
            corner,
            poisson,
            load,
            tuple(load.sign_x * sign for sign in along_x),
            tuple(load.sign_y * sign for sign in along_y),
            (0.0,) * len(along_x) if image_level is None else image_level,
        )

    @property
    def components(self) -> int:
        """Number of components."""
        return len(self.sign_along_x)

    def corner_at(self, depth: float) -> CornerFunction:
        """Corner functions at one depth."""
        return lambda x, y: self.corner(x, y, depth, self.poisson)

    def kernel(self, x: FloatArray, y: FloatArray, dx: float, dy: float, length: float, depth: float) -> FloatArray:
        """Influence at uniform offsets `x` and `y`, with all images where `length` is finite: (component, x, y)."""
        if np.isinf(length):
            return cell_kernel(self.corner_at(depth), x, y, dx, dy)
        kernel = mirrored_kernel(self.corner_at(depth), x, y, dx, dy, length)
        return np.asarray(kernel + dx * dy * np.array(self.image_level)[:, None, None])
