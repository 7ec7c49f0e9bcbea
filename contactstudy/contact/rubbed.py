"""What is rubbed on what, and the rigid motions of one against the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from scipy.optimize import minimize

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.case.motion import Rolling, Shift
from contactstudy.checks import FloatArray
from contactstudy.contact.leading_edge import RollingCells
from contactstudy.errors import InvalidInputError
from contactstudy.kernels.load import Load

ALMOST_SLIDING = 1 - 1e-9
"""Part of the largest force up to which a force can be prescribed: at all of it the rigid slip has no value."""


@runtime_checkable
class RelativeOperator(Protocol):
    """Displacements of the surfaces relative to each other."""

    def displaced(self, loads: Mapping[Load, FloatArray], directions: Sequence[Load]) -> dict[Load, FloatArray]:
        """Displacements (m) in some directions under loads on the first body (Pa)."""
        ...

    @property
    def coarse(self) -> object:
        """The operator on cells of twice the size, roughly; it may be of another kind."""
        ...


class Surfaces(NamedTuple):
    """What is rubbed on what.

    Attributes
    ----------
    operator : RelativeOperator
        Displacements relative to each other.
    grid : Grid
        Cells.
    materials : list of Material
        Of the elastic bodies.
    middle : float
        Position x about which spin and moment are taken, metres.
    """

    operator: RelativeOperator
    grid: Grid
    materials: list[Material]
    middle: float

    @property
    def areas(self) -> FloatArray:
        """Areas of the cells, square metres: array (x, y)."""
        return np.broadcast_to(self.grid.cell_area * self.grid.weights, self.grid.shape)

    @property
    def weights(self) -> FloatArray:
        """Weights of force along x, force along y and moment about z: array (3, 2, x, y)."""
        grid = self.grid
        weights = np.zeros((3, 2, *grid.shape))
        weights[0, 0] = weights[1, 1] = 1.0
        weights[2, 0], weights[2, 1] = -grid.y, (grid.x - self.middle)[:, None]
        return weights * self.areas

    def rigid_slip(self, name: str, cells: RollingCells) -> FloatArray:
        """Slip (2, unknown) of a rigid motion of unit amplitude, where the slip is taken."""
        grid, (row, column) = self.grid, cells.unknown
        slip = np.zeros((2, row.size))
        if name == "spin":
            slip[0], slip[1] = -(grid.y[column] + cells.place * grid.dy), grid.x[row] - self.middle
        else:
            slip["xy".index(name)] = 1.0
        return slip


def motions_of(motion: Shift | Rolling) -> tuple[str, ...]:
    """Names of the rigid motions."""
    return ("x", "y", "spin") if isinstance(motion, Rolling) else ("x", "y")


def amplitude(motion: Shift | Rolling, name: str) -> float:
    """Prescribed amplitude of a rigid motion; 0 where its force is prescribed."""
    names = {"x": "x", "y": "y"}
    if isinstance(motion, Rolling):
        names = {"x": "lateral_creepage", "y": "longitudinal_creepage", "spin": "spin"}
    return getattr(motion, names[name]) or 0.0


def resultant(motion: Shift | Rolling, name: str) -> float:
    """Prescribed force or moment."""
    return float(getattr(motion, {"x": "force_x", "y": "force_y", "spin": "moment_z"}[name]))


def check_forces(motion: Shift | Rolling, bound: FloatArray, weights: FloatArray) -> None:
    """Raise if tractions within their bound (x, y) cannot make the forces and the moment that are prescribed.

    `weights` are those of the resultants, as in `Surfaces`.
    """
    modes = motion.modes
    wanted = np.array([resultant(motion, name) for name in modes])
    if not modes or (bound.any() and not wanted.any()):
        return
    names = [{"x": "force_x", "y": "force_y", "spin": "moment_z"}[name] for name in modes]
    works = weights[[("x", "y", "spin").index(name) for name in modes]]
    most = _largest_multiple(wanted, bound, works)
    if most * ALMOST_SLIDING > 1:
        return
    units = {"spin": "N m"}
    carried = ", ".join(
        f"{name} = {most * value:.6g} {units.get(mode, 'N')}"
        for name, mode, value in zip(names, modes, wanted, strict=True)
    )
    raise InvalidInputError(
        ", ".join(names),
        tuple(wanted.tolist()),
        f"less than full sliding's {carried}",
        "friction times the pressure carries no more; full sliding along y is the motion Sliding()",
    )


def _largest_multiple(wanted: FloatArray, bound: FloatArray, works: FloatArray) -> float:
    """Largest multiple of the resultants `wanted` that tractions within their bound (x, y) make.

    Tractions along a slip ``d . works`` make the largest resultant along d. The multiple is the least of these over
    ``d . wanted``: a convex function of the direction, which a descent finds from above.
    """
    pressed = bound > 0
    bounds, works = bound[pressed], works[:, :, pressed]
    sizes = np.array([float((bounds * np.hypot(*work)).sum()) for work in works])
    able = sizes > 0
    if wanted[~able].any() or not able.any():
        return 0.0
    works, target = works[able] / sizes[able, None, None], wanted[able] / sizes[able]
    along = target / (target @ target)
    across = np.linalg.svd(along[None, :])[2][1:]

    def most(turn: FloatArray) -> tuple[float, FloatArray]:
        slip = np.tensordot(along + turn @ across, works, axes=1)
        size = np.hypot(*slip)
        gradient = (works * (bounds * slip / np.where(size > 0, size, 1.0))).sum(axis=(1, 2))
        return float((bounds * size).sum()), across @ gradient

    start = np.zeros(len(target) - 1)
    if not start.size:
        return most(start)[0]
    return float(minimize(most, start, jac=True, method="BFGS").fun)
