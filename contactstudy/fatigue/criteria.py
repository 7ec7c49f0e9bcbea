"""Multiaxial fatigue criteria: Dang Van's, Crossland's and Findley's, and the endurance limits of a material.

Sources: K. Dang Van, G. Cailletaud, J. F. Flavenot, A. Le Douaron, H. P. Lieurade, Criterion for high cycle fatigue
failure under multiaxial loading, in: Biaxial and Multiaxial Fatigue, EGF 3 (1989) 459-478; B. Crossland, Effect of
large hydrostatic pressures on the torsional fatigue strength of an alloy steel, Proc. Int. Conf. on Fatigue of Metals,
IMechE (1956) 138-149; amplitude as the radius of the smallest hypersphere: I. V. Papadopoulos et al., A comparative
study of multiaxial high-cycle fatigue criteria for metals, International Journal of Fatigue 19 (1997) 219-235; W. N.
Findley, A theory for the effect of mean stress on fatigue of metals under combined torsion and axial load or bending,
Journal of Engineering for Industry 81 (1959) 301-306; Findley's constants from two fully reversed limits as in the
manuals of PragTic (Findley method) and COMSOL (Findley criterion).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from itertools import product

import numpy as np
import xarray as xr
from scipy.linalg import block_diag, helmert

from contactstudy import checks
from contactstudy.analysis import positions
from contactstudy.arrays.variables import AXES, VARIABLES, describe
from contactstudy.case.magnitudes import warn_of_values
from contactstudy.checks import Array
from contactstudy.errors import InvalidInputError
from contactstudy.fatigue.history import enclosing_balls, label_points, map_histories, stack_history


@dataclass(frozen=True, kw_only=True)
class FatigueLimits:
    """Endurance limits of the material under fully reversed loading.

    Parameters
    ----------
    bending : float
        Limit ``sigma_w`` of the normal stress in bending or push-pull, Pa.
    torsion : float
        Limit ``tau_w`` of the shear stress in torsion, Pa.

    Raises
    ------
    InvalidInputError
        If a limit is not positive, or their ratio is not between 1/2 and 1, the range of Dang Van's and Findley's
        criteria (Crossland's criterion requires at least 1/sqrt(3)).

    Warns
    -----
    MagnitudeWarning
        If a limit lies outside its usual range, which suggests a wrong unit.

    Examples
    --------
    >>> limits = FatigueLimits(bending=500e6, torsion=300e6)
    >>> round(limits.dang_van_slope, 6), round(limits.crossland_slope, 6), round(limits.findley_slope, 6)
    (0.3, 0.067949, 0.204124)
    """

    bending: float = field(metadata=checks.number(checks.positive, "Pa"))
    torsion: float = field(metadata=checks.number(checks.positive, "Pa"))

    def __post_init__(self) -> None:
        checks.store_numbers(self)
        if not 0.5 <= self.ratio < 1:
            allowed = f"between half of the limit in bending and that limit, {self.bending:g} Pa"
            raise InvalidInputError("torsion", self.torsion, allowed)
        warn_of_values(stacklevel=4, **vars(self))

    @property
    def ratio(self) -> float:
        """Limit in torsion over limit in bending."""
        return self.torsion / self.bending

    @property
    def dang_van_slope(self) -> float:
        """``alpha = 3 (tau_w / sigma_w - 1/2)``: bending (shear s/2, hydrostatic stress s/3) is at the limit."""
        return 3 * (self.ratio - 0.5)

    @property
    def crossland_slope(self) -> float:
        """``A = 3 tau_w / sigma_w - sqrt(3)``: bending (sqrt(J2) s/sqrt(3), hydrostatic s/3) is at the limit."""
        slope = 3 * self.ratio - np.sqrt(3)
        # A ratio of 1 / sqrt(3) gives zero up to rounding.
        if slope < -1e-9:
            allowed = f"at least the limit in bending over sqrt(3), {self.bending / np.sqrt(3):g} Pa, for Crossland"
            raise InvalidInputError("torsion", self.torsion, allowed)
        return float(max(slope, 0.0))

    @property
    def findley_slope(self) -> float:
        """``k`` with which bending and torsion are at the limit: ``k / sqrt(1 + k**2) = 2 tau_w/sigma_w - 1``."""
        ratio = 2 * self.ratio - 1
        return float(ratio / np.sqrt(1 - ratio**2))

    @property
    def findley_limit(self) -> float:
        """``f = tau_w sqrt(1 + k**2)``, Pa: Findley's sum in torsion at the limit."""
        return float(self.torsion * np.sqrt(1 + self.findley_slope**2))


# Ilyushin's axes (axis, component): the squared length of a deviator's five coordinates is s:s
DEVIATOR_AXES = block_diag(helmert(3), np.sqrt(2.0) * np.eye(3))
TENSOR_INDICES = np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])  # Indices of the six components in the tensor
PLANE_TERMS = ("damage", "shear", "normal", *AXES)  # terms of Findley's sum, and components of the plane's normal


def _label_criterion(name: str, damage: xr.DataArray, limit: float, **terms: xr.DataArray) -> xr.Dataset:
    """Label the sum of a criterion, its ratio to the limit, and its terms with names and units."""
    values = {name: damage, "utilisation": damage / limit} | {f"{name}_{term}": array for term, array in terms.items()}
    return xr.Dataset({key: label_points(key, array, VARIABLES[name]) for key, array in values.items()})


def dang_van(stress: xr.Dataset, limits: FatigueLimits) -> xr.Dataset:
    """Dang Van's criterion ``max over time of tau(t) + alpha sigma_h(t) <= tau_w`` for every material point.

    ``tau(t)`` is half of Tresca's stress of the deviator less the centre of the smallest hypersphere around its
    history (the grains shake down elastically to that centre), ``sigma_h`` the hydrostatic stress, positive in
    tension, ``alpha = 3 (tau_w / sigma_w - 1/2)``. The history is the field along y, and the unloaded state.

    Parameters
    ----------
    stress : Dataset
        The six components along y over the whole passage, see :func:`window_remainder`; residual stresses may be added.
    limits : FatigueLimits
        Limits of the material.

    Returns
    -------
    Dataset
        Without the rolling direction: `dang_van` (Pa), the largest sum; `utilisation`, the sum over ``tau_w``;
        `dang_van_shear` and `dang_van_hydrostatic` (Pa), both terms at the instant of the largest sum, and
        `dang_van_y` (m), its position (NaN for the unloaded state). Their errors are not estimated.

    Raises
    ------
    InvalidInputError
        If a component or the rolling direction is missing, or `limits` are no FatigueLimits.

    Examples
    --------
    For a cycle of pure shear the criterion is the amplitude.

    >>> from contactstudy.arrays.variables import STRESSES
    >>> wave = xr.DataArray([0.0, 1.0, 0.0, -1.0], dims="y", coords={"y": [0.0, 1.0, 2.0, 3.0]})
    >>> shear = xr.Dataset({name: 0 * wave for name in STRESSES} | {"tau_yz": wave})
    >>> result = dang_van(shear, FatigueLimits(bending=1.8, torsion=1.0))
    >>> round(float(result.dang_van), 9), round(float(result.utilisation), 9)
    (1.0, 1.0)
    """
    checks.instance("limits", limits, FatigueLimits, "a FatigueLimits")
    tensor, rolling_dim = stack_history(stress)

    def evaluate(history: Array) -> dict[str, Array]:
        centre, _ = enclosing_balls(history @ DEVIATOR_AXES.T)
        residual = centre @ np.linalg.pinv(DEVIATOR_AXES).T
        principal = np.linalg.eigvalsh((history - residual[:, None])[..., TENSOR_INDICES])
        shear, hydrostatic = 0.5 * (principal[..., 2] - principal[..., 0]), history[..., :3].mean(axis=-1)
        damage = shear + limits.dang_van_slope * hydrostatic
        instant_index = damage.argmax(axis=1)[:, None]
        values = {"damage": damage, "shear": shear, "hydrostatic": hydrostatic}
        terms = {name: np.take_along_axis(value, instant_index, axis=1)[:, 0] for name, value in values.items()}
        return terms | {"instant": instant_index[:, 0].astype(np.float64)}

    terms = map_histories(evaluate, stress, ("damage", "shear", "hydrostatic", "instant"))
    instant = terms.pop("instant").compute()
    is_loaded = instant < tensor.sizes[rolling_dim]
    index = instant.where(is_loaded, 0).astype(np.int64).reset_coords(drop=True)
    y = positions(tensor, "y").isel({rolling_dim: index}).where(is_loaded)
    return _label_criterion("dang_van", terms.pop("damage"), limits.torsion, **terms, y=y)


def crossland(stress: xr.Dataset, limits: FatigueLimits) -> xr.Dataset:
    """Crossland's criterion ``sqrt(J2,a) + A sigma_h,max <= tau_w`` for every material point.

    ``sqrt(J2,a)`` is the radius of the smallest hypersphere around the history of the deviator, over sqrt(2);
    ``sigma_h,max`` the largest hydrostatic stress of the history, positive in tension, and not below zero since the
    point is unloaded before and after; ``A = 3 tau_w / sigma_w - sqrt(3)``.

    Parameters
    ----------
    stress : Dataset
        As for :func:`dang_van`.
    limits : FatigueLimits
        Limits of the material, with a torsion limit of at least the bending limit over sqrt(3).

    Returns
    -------
    Dataset
        As of :func:`dang_van`: `crossland` (Pa), the sum; `utilisation`; `crossland_shear` and `crossland_hydrostatic`
        (Pa), the two terms without the factor.

    Raises
    ------
    InvalidInputError
        If a component or the rolling direction is missing, or the limits contradict the criterion.

    Examples
    --------
    A push-pull cycle at the limit in bending has a utilisation of 1.

    >>> from contactstudy.arrays.variables import STRESSES
    >>> wave = xr.DataArray([0.0, 1.0, 0.0, -1.0], dims="y", coords={"y": [0.0, 1.0, 2.0, 3.0]})
    >>> tension = xr.Dataset({name: 0 * wave for name in STRESSES} | {"sigma_xx": wave})
    >>> round(float(crossland(tension, FatigueLimits(bending=1.0, torsion=0.65)).utilisation), 9)
    1.0
    """
    checks.instance("limits", limits, FatigueLimits, "a FatigueLimits")
    slope = limits.crossland_slope

    def evaluate(history: Array) -> dict[str, Array]:
        _, radius = enclosing_balls(history @ DEVIATOR_AXES.T)
        return {"shear": radius / np.sqrt(2.0), "hydrostatic": history[..., :3].mean(axis=-1).max(axis=1)}

    terms = map_histories(evaluate, stress, ("shear", "hydrostatic"))
    return _label_criterion("crossland", terms["shear"] + slope * terms["hydrostatic"], limits.torsion, **terms)


# Number of planes of the first search, about 10 degrees apart on a hemisphere, and of shear directions per plane
NORMALS, DIRECTIONS = 200, 8
FRAMES = 4  # Number of refined frames
# Largest and smallest rotation of plane and direction in the refinement
MAX_ROTATION, MIN_ROTATION = np.radians(8.0), np.radians(1e-3)


@cache
def _create_frames() -> Array:
    """Frames (frame, 2, 3): a normal and a shear direction in its plane."""
    number = np.arange(NORMALS) + 0.5
    height = 1 - number / NORMALS
    azimuth = np.pi * (1 + np.sqrt(5)) * number
    radius = np.sqrt(1 - height**2)
    normal = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), height], axis=-1)
    first_axis = np.cross(normal, np.where(np.abs(normal[:, :1]) < 0.7, [[1.0, 0, 0]], [[0, 1.0, 0]]))
    first_axis /= np.linalg.norm(first_axis, axis=-1, keepdims=True)
    second_axis = np.cross(normal, first_axis)
    angle = np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    direction = (
        first_axis[:, None] * np.cos(angle)[None, :, None] + second_axis[:, None] * np.sin(angle)[None, :, None]
    ).reshape(-1, 3)
    return np.stack([np.repeat(normal, DIRECTIONS, axis=0), direction], axis=1)


def _resolution_vectors(frames: Array) -> tuple[Array, Array]:
    """Vectors (..., 6) whose products with the six components are ``n.sigma.m`` (shear) and ``n.sigma.n``."""
    normal, direction = frames[..., 0, :], frames[..., 1, :]
    # The components of a tensor product count once on the diagonal, and twice beside it.
    products = (normal[..., None] * vector[..., None, :] for vector in (direction, normal))
    shear, normal_product = (
        (product + product.swapaxes(-1, -2))[..., [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]] for product in products
    )
    counts = np.array([0.5, 0.5, 0.5, 1.0, 1.0, 1.0])
    return counts * shear, counts * normal_product


def _compute_damage(history: Array, frames: Array, slope: float) -> tuple[Array, Array, Array]:
    """Findley's sum, shear amplitude and largest normal stress on every frame: arrays (point, candidate)."""
    shear_vectors, normal_vectors = _resolution_vectors(frames)
    shear = np.einsum("ptc,pkc->pkt", history, shear_vectors)
    max_normal = np.einsum("ptc,pkc->pkt", history, normal_vectors).max(axis=-1)
    amplitude = 0.5 * (shear.max(axis=-1) - shear.min(axis=-1))
    return amplitude + slope * max_normal, amplitude, max_normal


def _rotate_frames(frames: Array, angle: Array) -> Array:
    """Candidates of each frame, (frame, candidate, 2, 3): the frame itself, and rotated by `angle` about 14 axes."""
    from scipy.spatial.transform import Rotation

    corners = np.array(list(product((-1.0, 1.0), repeat=3))) / np.sqrt(3)
    axes = np.concatenate([np.eye(3), -np.eye(3), corners])
    vectors = angle[:, None, None] * np.concatenate([np.zeros((1, 3)), axes])
    rotations = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_matrix().reshape(len(frames), -1, 3, 3)
    return np.asarray(np.einsum("fkij,fnj->fkni", rotations, frames))


def _find_worst_planes(history: Array, slope: float) -> dict[str, Array]:
    """Sum, shear amplitude, largest normal stress and components of the normal, on the worst plane of each history."""
    search_frames = _create_frames()
    shear_vectors, normal_vectors = _resolution_vectors(search_frames)
    best_frames = np.empty((len(history), FRAMES, 2, 3))
    block_size = max(1, 2**24 // (history.shape[1] * len(search_frames)))  # Bound on the memory of the first search
    for start in range(0, len(history), block_size):
        block_history = history[start : start + block_size]
        shear = block_history @ shear_vectors.T
        max_normal = np.repeat((block_history @ normal_vectors[::DIRECTIONS].T).max(axis=1), DIRECTIONS, axis=1)
        damage = 0.5 * (shear.max(axis=1) - shear.min(axis=1)) + slope * max_normal
        best_frames[start : start + block_size] = search_frames[np.argpartition(damage, -FRAMES, axis=1)[:, -FRAMES:]]
    frames = best_frames.reshape(-1, 2, 3)
    point_index = np.repeat(np.arange(len(history)), FRAMES)
    angle = np.full(len(frames), MAX_ROTATION)
    active = np.arange(len(frames))
    # The search ignores gains below rounding; otherwise equivalent planes prevent its end.
    min_gain = 1e-11 * np.abs(history).max(axis=(1, 2))  # Minimum gain of a rotation: rounding
    while active.size:
        candidates = _rotate_frames(frames[active], angle[active])
        damage, _, _ = _compute_damage(history[point_index[active]], candidates, slope)
        choice = np.where(damage.max(axis=1) > damage[:, 0] + min_gain[point_index[active]], damage.argmax(axis=1), 0)
        frames[active] = candidates[np.arange(active.size), choice]
        angle[active[choice == 0]] *= 0.5
        active = active[angle[active] > MIN_ROTATION]
    refined_frames = frames.reshape(-1, FRAMES, 2, 3)
    damage_terms = _compute_damage(history, refined_frames, slope)
    worst_index = damage_terms[0].argmax(axis=1)[:, None]
    normal = np.take_along_axis(refined_frames[:, :, 0], worst_index[..., None], axis=1)[:, 0]
    normal = normal * np.where(normal[:, 2] < 0, -1.0, 1.0)[:, None]
    terms = [np.take_along_axis(values, worst_index, axis=1)[:, 0] for values in damage_terms]
    return dict(zip(PLANE_TERMS, [*terms, *normal.T], strict=True))


def findley(stress: xr.Dataset, limits: FatigueLimits) -> xr.Dataset:
    """Findley's criterion ``max over planes of tau_a + k sigma_n,max <= f`` for every material point.

    On a plane, ``tau_a`` is half of the largest range of the shear stress resolved in one direction during the history,
    and ``sigma_n,max`` the largest normal stress, positive in tension, at least zero by the unloaded state. The
    search starts from planes about 10 degrees apart, and rotates the worst planes until no rotation by 0.001
    degrees increases the sum. ``k`` and ``f`` follow from the limits.

    Parameters
    ----------
    stress, limits
        As for :func:`dang_van`.

    Returns
    -------
    Dataset
        As of :func:`dang_van`: `findley` (Pa), the sum on the worst plane; `utilisation` (1), the sum over ``f``;
        `findley_shear` and `findley_normal` (Pa), its ``tau_a`` and ``sigma_n,max``; `findley_plane` (..., axis),
        its unit normal with the components `axis` = x, y, z, turned towards larger depth.

    Raises
    ------
    InvalidInputError
        If a component or the rolling direction is missing, or `limits` are no FatigueLimits.

    Examples
    --------
    A cycle of pure shear at the limit in torsion has a utilisation of 1.

    >>> from contactstudy.arrays.variables import STRESSES
    >>> wave = xr.DataArray([0.0, 1.0, 0.0, -1.0], dims="y", coords={"y": [0.0, 1.0, 2.0, 3.0]})
    >>> shear = xr.Dataset({name: 0 * wave for name in STRESSES} | {"tau_yz": wave})
    >>> round(float(findley(shear, FatigueLimits(bending=1.6, torsion=1.0)).utilisation), 9)
    1.0
    """
    checks.instance("limits", limits, FatigueLimits, "a FatigueLimits")
    terms = map_histories(lambda history: _find_worst_planes(history, limits.findley_slope), stress, PLANE_TERMS)
    normals = [terms.pop(axis) for axis in AXES]
    plane = xr.concat(normals, "axis", coords="minimal", compat="override").transpose(..., "axis")
    result = _label_criterion("findley", terms.pop("damage"), limits.findley_limit, **terms, plane=plane)
    return describe(result.assign_coords(axis=list(AXES)))
