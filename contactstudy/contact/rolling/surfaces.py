"""The surfaces in contact, the rigid motions between them, and the tractions and slip of a contact."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.bodies.material import Material
from contactstudy.case.motion import RESULTANTS, Rolling, Shift
from contactstudy.checks import BoolArray, FloatArray
from contactstudy.contact.normal.two_bodies import PairOperator
from contactstudy.errors import InvalidInputError
from contactstudy.fields.surface import SurfaceOperator
from contactstudy.kernels.load import Load

TANGENTIAL = (Load.ALONG_X, Load.ALONG_Y)  # directions of tractions and slip, in the order of every array


class Surfaces(NamedTuple):
    """Operator, cells and materials of the surfaces in contact."""

    operator: PairOperator | SurfaceOperator  # relative displacements of the surfaces
    grid: Grid
    materials: list[Material]  # materials of the elastic bodies
    reference_x: float  # position x to which spin and moment refer, metres

    @property
    def areas(self) -> FloatArray:
        """Areas of the cells, square metres: array (x, y)."""
        return np.broadcast_to(self.grid.cell_area * self.grid.weights, self.grid.shape)

    @property
    def weights(self) -> FloatArray:
        """Weights (resultant, component, x, y) of the tractions in the forces along x and y and the moment about z."""
        return np.stack([self.rigid_slip(mode, self.grid.x[:, None], self.grid.y) for mode in RESULTANTS]) * self.areas

    def rigid_slip(self, name: str, x: FloatArray, y: FloatArray) -> FloatArray:
        """Slip (2, ...) of a rigid motion of unit amplitude at positions."""
        x, y = np.broadcast_arrays(x - self.reference_x, y)
        if name == "spin":
            return np.stack([-y, x])  # eq. (44)
        slip = np.zeros((2, *x.shape))
        slip["xy".index(name)] = 1.0
        return slip


class LeadingEdges(NamedTuple):
    """Slip and pressure that determine the positions of the slip in the cells of a rolling contact."""

    slips: BoolArray  # (x): columns whose leading cell slips
    pressure: FloatArray  # (x, y): pressure whose extrapolation to zero is the leading edge, Pa


@dataclass(frozen=True, eq=False, kw_only=True)
class Tractions:
    """Tractions on the body, and the slip of the roller against it."""

    traction: FloatArray  # (2, x, y): along x and y, Pa
    slip: FloatArray  # (2, x, y): per distance rolled, or metres in a shift; 0 where cells stick or bear no pressure
    sticks: BoolArray  # (x, y): sticking cells of the contact
    bound: FloatArray  # (x, y): bound on the traction, Pa
    amplitudes: Mapping[str, float]  # amplitudes of the rigid slip: "x", "y" and, in rolling, "spin"
    resultants: Mapping[str, float]  # forces and moment on the body, N and N m, by their names in results
    work: float  # frictional work: per distance rolled, J/m, or of the shift, J
    bound_error: float = 0.0  # certificate: traction above the bound, over the largest bound
    slip_error: float = 0.0  # certificate: slip that contradicts the law, over the rigid slip
    force_error: float = 0.0  # certificate: error of prescribed resultants, over the largest
    steps: int = 0  # Newton steps
    converged: bool = True  # whether the tolerance was reached
    leading: LeadingEdges | None = None  # determines the positions of the slip in rolling

    @classmethod
    def of(
        cls,
        surfaces: Surfaces,
        amplitudes: Mapping[str, float],
        *,
        bound: FloatArray,
        traction: FloatArray,
        slip: FloatArray,
        sticks: BoolArray,
    ) -> Tractions:
        """Tractions with their resultants and work."""
        resultants = (surfaces.weights * traction).sum(axis=(1, 2, 3)).tolist()
        return cls(
            traction=traction,
            slip=slip,
            sticks=sticks,
            bound=bound,
            amplitudes=amplitudes,
            resultants=dict(zip(RESULTANTS.values(), resultants, strict=True)),
            work=float((traction * slip * surfaces.areas).sum()),
        )


def check_forces(motion: Shift | Rolling, bound: FloatArray, weights: FloatArray) -> None:
    """Raise if no tractions within their bound (x, y) have the prescribed resultants, sums with these `weights`."""
    modes, resultants = motion.modes, np.array(list(motion.resultants.values()))
    if not modes or (bound.any() and not resultants.any()):
        return
    names = [RESULTANTS[mode] for mode in modes]
    max_multiple = _largest_multiple(resultants, bound, weights[[list(RESULTANTS).index(mode) for mode in modes]])
    # At the force of full sliding the rigid slip is undetermined.
    if max_multiple * (1 - 1e-9) > 1:
        return
    limits = ", ".join(
        f"{name} = {max_multiple * value:.6g} {'N m' if name == 'moment_z' else 'N'}"
        for name, value in zip(names, resultants, strict=True)
    )
    raise InvalidInputError(
        ", ".join(names),
        tuple(resultants.tolist()),
        f"less than full sliding's {limits}",
        "friction times the pressure carries no more; full sliding along y is the motion Sliding()",
    )


def _largest_multiple(resultants: FloatArray, bound: FloatArray, weights: FloatArray) -> float:
    """Largest multiple of the resultants of tractions within their bound (x, y)."""
    # Tractions along a slip ``d . weights`` have the largest resultant along d. The multiple is the least value of a
    # convex function of the direction d, which a descent approaches from above.
    from scipy.optimize import minimize

    is_loaded = bound > 0
    loaded_bound, weights = bound[is_loaded], weights[:, :, is_loaded]
    max_resultants = np.array([float((loaded_bound * np.hypot(*weight)).sum()) for weight in weights])
    has_resultant = max_resultants > 0
    if resultants[~has_resultant].any() or not has_resultant.any():
        return 0.0
    max_resultants = max_resultants[has_resultant]
    weights = weights[has_resultant] / max_resultants[:, None, None]
    target = resultants[has_resultant] / max_resultants
    # The square of very small resultants would underflow.
    scale = float(np.abs(target).max())
    target = target / scale
    direction = target / (target @ target)
    normal_directions = np.linalg.svd(direction[None, :])[2][1:]

    def evaluate_resultant(components: FloatArray) -> tuple[float, FloatArray]:
        slip = np.tensordot(direction + components @ normal_directions, weights, axes=1)
        size = np.hypot(*slip)
        gradient = (weights * (loaded_bound * slip / np.where(size > 0, size, 1.0))).sum(axis=(1, 2))
        return float((loaded_bound * size).sum()), normal_directions @ gradient

    start = np.zeros(len(target) - 1)
    if not start.size:
        return evaluate_resultant(start)[0] / scale
    return float(minimize(evaluate_resultant, start, jac=True, method="BFGS").fun) / scale
