"""Shakedown of a body under many passes of a contact: Melan's theorem (docs/explanation/passes.md).

E. Melan, Zur Plastizitaet des raeumlichen Kontinuums, Ingenieur-Archiv 9 (1938) 116-126; K. L. Johnson, A shakedown
limit in rolling contact, Proc. 4th US National Congress of Applied Mechanics (1962) 971-975.

`shakedown_in_plane` minimises t with ``|(u + w, v + sqrt(3)/2 (rho_xx - rho_zz), sqrt(3) (t_xz + rho_xz), remainder)|``
at most t at every point and instant, w free at every point. Few instants are critical: the cone program begins with
the unloaded state of every point and the instants of the largest stress, and each solution adds violating instants.
"""

from __future__ import annotations

import warnings
from collections.abc import Hashable

import numpy as np
import xarray as xr
from scipy import sparse

from contactstudy import checks
from contactstudy.analysis import dimension_along, single_case
from contactstudy.analysis.axes import positions
from contactstudy.analysis.peaks import cell_ends, interpolated_peak, label_peak
from contactstudy.arrays.variables import STRESSES, VARIABLES, describe, name_array, require_in_si
from contactstudy.bodies.models import Body
from contactstudy.checks import Array, FloatArray
from contactstudy.eigenstrain.body import Splines, StressFunction
from contactstudy.errors import ConvergenceWarning, InvalidInputError
from contactstudy.fatigue.history import MIN_POSITIONS, enclosing_balls, label_points, map_histories, stack_history

MIN_POSITIONS_FOR_ERROR = 2 * MIN_POSITIONS  # Minimum number of positions along y for an error estimate
EQUAL_TOLERANCE = 1e-6  # Largest difference of equal stresses over the largest stress


def to_ball_axes(history: Array) -> tuple[Array, Array, Array]:
    """u, v and squared remainder of stresses (..., 6): ``u**2 + v**2 + remainder`` is the squared von Mises stress."""
    xx, yy, zz, xy, xz, yz = np.moveaxis(history, -1, 0)
    # eq. (501)
    return yy - 0.5 * (xx + zz), 0.5 * np.sqrt(3.0) * (xx - zz), 3 * (xy**2 + xz**2 + yz**2)


def _min_yield_stress(history: Array) -> Array:
    """Least yield stresses in shear of stresses (..., 6)."""
    u, v, remainder = to_ball_axes(history)
    return np.asarray(np.sqrt((u**2 + v**2 + remainder) / 3))


def shakedown(stress: xr.Dataset, *, axial: bool = False) -> xr.Dataset:
    """Least yield stress with which every material point shakes down (Melan), and the point's residual stress.

    Parameters
    ----------
    stress : Dataset
        The six components with the rolling direction y over the whole passage, of one case or of a study.
    axial : bool
        Whether to include a residual stress along the axis. This stress may not change along x and vanishes on free
        ends: only in a line contact is the stress free at every depth.

    Returns
    -------
    Dataset
        Without the rolling direction: `first_yield_stress` (Pa), the yield stress in shear k below which the point
        yields in the first passage; `shakedown_stress` (Pa), the k below which it yields in every passage with any
        residual stress yy (and xx); `residual_sigma_yy` and, if `axial`, `residual_sigma_xx` (Pa), the
        residual stress with which that k suffices. The largest `shakedown_stress` over x and z is a rigorous bound:
        a perfectly plastic body (von Mises) with a larger k shakes down; :func:`shakedown_limit` estimates its error.

    Raises
    ------
    InvalidInputError
        If a component or the rolling direction is missing, or `axial` is True with several positions along x.

    Examples
    --------
    A residual tension of 1 halves the least yield stress of a uniaxial stress between 0 and -2.

    >>> passage = xr.DataArray([-1.0, -2.0, -1.0], dims="y", coords={"y": [-1.0, 0.0, 1.0]})
    >>> result = shakedown(xr.Dataset({name: passage * (name == "sigma_yy") for name in STRESSES}))
    >>> round(float(result.shakedown_stress / result.first_yield_stress), 6), round(float(result.residual_sigma_yy), 6)
    (0.5, 1.0)
    """
    checks.instance("axial", axial, (bool, np.bool_), "True or False")
    if axial:
        tensor, _ = stack_history(stress)
        axial_dims = [str(dim) for dim in tensor.dims if str(dim).partition("_")[0] == "x"]
        if any(tensor.sizes[dim] > 1 for dim in axial_dims):
            hint = "residual stress along the axis is free only in a line contact, a result with one position along x"
            raise InvalidInputError("axial", True, f"False with {tensor.sizes[axial_dims[0]]} positions along x", hint)

    def compute_yield_stresses(history: Array) -> dict[str, Array]:
        """Least yield stresses in shear without yield and with shakedown, and the residual stresses yy and xx."""
        u, v, remainder = to_ball_axes(history)
        if axial:
            centre, radius = enclosing_balls(np.stack([u, v], axis=-1), np.sqrt(remainder))
            # A stress xx changes u by -1/2 and v by sqrt(3)/2 times its value.
            residual_xx = -2 / np.sqrt(3.0) * centre[:, 1]
        else:
            centre, radius = enclosing_balls(u[..., None], np.sqrt(v**2 + remainder))  # eq. (502)
            residual_xx = np.zeros(len(radius))
        stresses = {"first_yield_stress": _min_yield_stress(history).max(axis=1), "shakedown_stress": radius / 3**0.5}
        return stresses | {"residual_sigma_yy": 0.5 * residual_xx - centre[:, 0], "residual_sigma_xx": residual_xx}

    names = ("first_yield_stress", "shakedown_stress", "residual_sigma_yy", "residual_sigma_xx")
    results = map_histories(compute_yield_stresses, stress, names)
    result = {name: label_points(name, array) for name, array in results.items()}
    if not axial:
        del result["residual_sigma_xx"]
    return xr.Dataset(result)


def shakedown_limit(stress: xr.Dataset, *, axial: bool = False) -> xr.Dataset:
    """Least yield stress with which the body shakes down, the deciding position, and its error.

    Parameters
    ----------
    stress, axial
        As for :func:`shakedown`; the stresses of a single case, or of an opened study with all its cases.

    Returns
    -------
    Dataset
        ``peak_shakedown_stress`` (Pa), the maximum over x and z between the samples, its error
        ``peak_shakedown_stress_error``, and its position ``peak_shakedown_stress_x``, ``_z``; a `comment` states
        whether it lies on the top or at a free end. The same of `first_yield_stress`. With
        `hertz_max_pressure` in the Dataset also `shakedown_limit` and `first_yield_limit`, the pressure p0 over k that
        this field allows, with their errors. As in :func:`contactstudy.analysis.peak` an error is infinite where
        the largest sample lies at the edge of the positions, or the first or the last position along y decides. It sums
        the difference of polynomials of two degrees in x and z, and the larger change with every second instant along
        y. The swept parameters of a study are dimensions, without comments.

    Raises
    ------
    InvalidInputError
        As for :func:`shakedown`.

    Examples
    --------
    >>> y, z = np.linspace(-4, 4, 81), np.linspace(0.1, 1.5, 29)
    >>> shear = xr.DataArray(-z * np.exp(-2 * z) * (y / (1 + y**2) ** 2)[:, None], coords={"y": y, "z": z})
    >>> result = shakedown_limit(xr.Dataset({name: shear * (name == "tau_yz") for name in STRESSES}))
    >>> round(float(result.peak_shakedown_stress_z), 2)
    0.5
    """
    stress = require_in_si(stress, *STRESSES, argument="stress")
    swept_sizes = dict(stress["hertz_half_width"].sizes) if "hertz_half_width" in stress else {}
    if any(size > 1 for size in swept_sizes.values()):
        return _study_limits(stress, swept_sizes, axial=axial)
    case = single_case(stress)
    rolling_dim = dimension_along(case["tau_yz"], "y")
    # Each subset has every second instant: one of the two subsets lacks the critical instant.
    has_error = case.sizes[rolling_dim] >= MIN_POSITIONS_FOR_ERROR
    sampled_cases = [case, *(case.isel({rolling_dim: slice(start, None, 2)}) for start in (0, 1) if has_error)]
    fields = [shakedown(sampled_case, axial=axial).compute() for sampled_case in sampled_cases]
    result = xr.Dataset()
    for variable in ("shakedown_stress", "first_yield_stress"):

        def interpolate(points: xr.Dataset, variable: str = variable) -> xr.DataArray:
            return shakedown(points, axial=axial)[variable]

        maximum, *half_maxima = (
            interpolated_peak(sampled_case, list(STRESSES), field[variable], interpolate)
            for sampled_case, field in zip(sampled_cases, fields, strict=True)
        )
        if not has_error:
            maximum = maximum._replace(error=np.inf, comment="too few positions along y for an estimate")
        elif _is_border_critical(case, fields[0], variable):
            maximum = maximum._replace(error=np.inf, comment="the first or the last position along y decides")
        else:
            min_value = min(half_maximum.value for half_maximum in half_maxima)
            maximum = maximum._replace(error=maximum.error + maximum.value - min_value)
        peak = label_peak(variable, maximum, VARIABLES[variable])
        position_notes = ["on the top" if maximum.position.get("z", 1.0) == 0 else "below the top"]
        ends = cell_ends(case) if "x" in maximum.position else ()
        if ends and np.isclose(maximum.position["x"], ends, rtol=0, atol=1e-9 * np.ptp(ends)).any():
            position_notes.append("at an end")
        peak[f"peak_{variable}"].attrs["comment"] = ", ".join(position_notes)
        result = result.merge(peak)
        if "hertz_max_pressure" in case and maximum.value:
            name = variable.replace("stress", "limit")
            limit = float(case["hertz_max_pressure"]) / maximum.value
            result[name] = name_array(name, xr.DataArray(limit))
            result[f"{name}_error"] = name_array(f"{name}_error", xr.DataArray(limit * maximum.error / maximum.value))
    return result


def _study_limits(study: xr.Dataset, swept_sizes: dict[Hashable, int], *, axial: bool) -> xr.Dataset:
    """Limits of every case of a study; NaN without stresses."""
    limits: dict[str, Array] = {}
    for index in np.ndindex(*swept_sizes.values()):
        case = study.isel(dict(zip(swept_sizes, index, strict=True))).compute()
        if np.isnan(case["tau_yz"].values).all():
            continue
        for name, value in shakedown_limit(case, axial=axial).items():
            limits.setdefault(str(name), np.full(tuple(swept_sizes.values()), np.nan))[index] = float(value)
    coordinates = {name: study[name] for name in swept_sizes if name in study.coords}
    result = xr.Dataset({name: (tuple(swept_sizes), values) for name, values in limits.items()}, coordinates)
    return describe(result)


def shakedown_summary(dataset: xr.Dataset) -> xr.Dataset:
    """Limits of first yield and shakedown of a solved case; empty without stresses, load, or six positions along y."""
    if (
        all(name in dataset for name in STRESSES)
        and dataset.sizes[dimension_along(dataset["tau_yz"], "y")] >= MIN_POSITIONS_FOR_ERROR
        and any(dataset[name].values.any() for name in STRESSES)
    ):
        return shakedown_limit(dataset).reset_coords(drop=True)
    return xr.Dataset()


def _is_border_critical(case: xr.Dataset, fields: xr.Dataset, variable: str) -> bool:
    """Whether the first or the last instant has the critical stress: larger stresses may lie beyond."""
    tensor, _ = stack_history(case)
    position = {dim: int(index) for dim, index in fields[variable].argmax(...).items()}
    point = tensor.isel(position).values
    residual = np.zeros(len(STRESSES))
    if variable == "shakedown_stress":
        residual[1] = float(fields["residual_sigma_yy"].isel(position))
        residual[0] = float(fields["residual_sigma_xx"].isel(position)) if "residual_sigma_xx" in fields else 0.0
    yield_stresses = _min_yield_stress(point + residual)
    max_stress = float(fields[variable].isel(position))
    # A history that ends unloaded is complete.
    is_unloaded = np.abs(point[[0, -1]]).max(axis=-1) <= EQUAL_TOLERANCE * max_stress
    return bool(((yield_stresses[[0, -1]] >= max_stress * (1 - EQUAL_TOLERANCE)) & ~is_unloaded).any())


DEGREE, CONTINUITY = 5, 3  # Degree and continuity of the stress function's polynomials: smooth stresses
# Points per element along either axis. Accuracy: with two points, as many as functions, the body yields between them
POINTS_PER_ELEMENT = 4
MIN_POINTS = 5  # Minimum number of points along x and z: with fewer, the stress function has no free coefficients
MAX_DUALITY_GAP = 1e-4  # Relative duality gap of convergence
MAX_CONE_PROGRAMS = 20  # Bound on the programs; about six suffice
SQRT3 = np.sqrt(3.0)


def shakedown_in_plane(stress: xr.Dataset, body: Body) -> xr.Dataset:
    """Least yield stress with which the body shakes down, with every admissible residual stress.

    Parameters
    ----------
    stress : Dataset
        As for :func:`shakedown`, a single case. The residual stress reaches from the top to the largest z, and from the
        first to the last x, or to the free ends.
    body : Body
        The body, for its free ends.

    Returns
    -------
    Dataset
        As of :func:`contactstudy.fatigue.shakedown`, with the residual stresses in the plane as well:
        `residual_sigma_xx`, `residual_sigma_zz`, `residual_tau_xz` (Pa). They are in equilibrium and leave top and ends
        free exactly, and with `shakedown_stress` no point yields at its position. Its largest value over x and z is
        the bound, `peak_shakedown_stress` (Pa). `program_gap` (1) is the relative gain that other
        coefficients of the stress function allow; their number grows with the positions along x and z.

    Raises
    ------
    InvalidInputError
        If a component or a direction is missing, or the result has fewer than five positions along x or z.
    ImportError
        Without the package clarabel, which solves the program.

    Warns
    -----
    ConvergenceWarning
        If `program_gap` exceeds 1e-4.

    Examples
    --------
    >>> from contactstudy import HalfSpace, Material
    >>> from contactstudy.arrays.variables import STRESSES
    >>> y, z, x = np.linspace(-3, 3, 13), np.linspace(0, 2, 9), np.linspace(-2, 2, 7)
    >>> pull = xr.DataArray(np.exp(-y**2)[:, None] * np.exp(-((z - 1) ** 2) * 4), {"y": y, "z": z}, ("y", "z"))
    >>> pull = pull * xr.DataArray(np.exp(-x**2), {"x": x}, "x")
    >>> passage = xr.Dataset({name: pull * (name == "sigma_xx") for name in STRESSES})
    >>> result = shakedown_in_plane(passage, HalfSpace(material=Material(1.0, 0.3)))
    >>> bool(result.shakedown_stress.max() < 0.9 * result.first_yield_stress.max())
    True
    """
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    case = single_case(stress)
    tensor, rolling_dim = stack_history(case)
    dims = [dimension_along(tensor, axis) for axis in ("x", "z")]
    x, z = (checks.increasing(f"stress.{axis}", positions(tensor, axis).values, minimum=MIN_POINTS) for axis in "xz")
    values = tensor.transpose(*dims, rolling_dim, ...).values.astype(np.float64)
    history = values.reshape(-1, *values.shape[2:])
    history = np.concatenate([history, np.zeros_like(history[:, :1])], axis=1)
    scale = float(np.abs(history).max()) or 1.0
    stress_matrices = _stress_matrices(body.extent, x, z)
    program = _ConeProgram(history / scale, stress_matrices)
    coefficients, max_stress, bound = program.solve()
    duality_gap = max(max_stress - bound, 0.0) / max(max_stress, 1e-300)
    if duality_gap > MAX_DUALITY_GAP:
        message = f"the shakedown program has a gap of {duality_gap:.2g} after {MAX_CONE_PROGRAMS} programs"
        hint = "the bound holds, and a larger load may shake down; take fewer positions along x and z"
        warnings.warn(f"{message}: {hint}", ConvergenceWarning, stacklevel=2)
    plane_stresses = [scale * (matrix @ coefficients) for matrix in stress_matrices]
    centre, radius, _ = program.compute_balls(coefficients)
    xx, zz, xz = plane_stresses
    results = {
        "first_yield_stress": _min_yield_stress(history).max(axis=1),
        "shakedown_stress": scale * radius / SQRT3,
        "residual_sigma_xx": xx,
        # The free stress along u is rho_yy - (rho_xx + rho_zz) / 2.
        "residual_sigma_yy": -scale * centre + 0.5 * (xx + zz),
        "residual_sigma_zz": zz,
        "residual_tau_xz": xz,
    }
    template = tensor.isel({rolling_dim: 0, tensor.dims[-1]: 0}, drop=True).transpose(*dims)
    result = xr.Dataset(
        {name: label_points(name, template.copy(data=field.reshape(template.shape))) for name, field in results.items()}
    )
    result["peak_shakedown_stress"] = label_points("peak_shakedown_stress", result["shakedown_stress"].max())
    result["program_gap"] = name_array("program_gap", xr.DataArray(duality_gap))
    return result


def _stress_matrices(extent: tuple[float, float], x: FloatArray, z: FloatArray) -> list[sparse.csr_array]:
    """Stresses xx, zz and xz at the points per coefficient of Airy's function: arrays (point, coefficient)."""
    ends = [end if np.isfinite(end) else edge for end, edge in zip(extent, x[[0, -1]], strict=True)]
    splines_x = Splines(_element_edges(x, *ends), DEGREE, CONTINUITY, vanishing_orders=2)
    splines_z = Splines(_element_edges(z, 0.0, z[-1]), DEGREE, CONTINUITY, vanishing_orders=2)
    # A scale of about an element's length gives coefficients in units of stress.
    scale_x, scale_z = (0.5 * np.ptp(splines.edges) / (splines.edges.size - 1) for splines in (splines_x, splines_z))
    values_x, values_z = StressFunction(splines_x, splines_z).values(x, z)
    scale = scale_x * scale_z
    return [
        sparse.csr_array(sign * scale * sparse.kron(sparse.csr_array(values_x[i]), values_z[j]))
        for i, j, sign in ((0, 2, 1), (2, 0, 1), (1, 1, -1))
    ]


def _element_edges(points: FloatArray, low: float, high: float) -> FloatArray:
    """Edges from `low` to `high`, at every `POINTS_PER_ELEMENT`-th point."""
    inner_points = points[(points > low) & (points < high)]
    borders = inner_points[POINTS_PER_ELEMENT - 1 : 1 - POINTS_PER_ELEMENT or None : POINTS_PER_ELEMENT]
    return np.concatenate([[low], borders, [high]])


class _ConeProgram:
    """Cone program: histories in units of their largest stress, and residual stresses per coefficient."""

    def __init__(self, history: Array, stress_matrices: list[sparse.csr_array]) -> None:
        xx, zz, xz = stress_matrices
        self._v_matrix, self._xz_matrix = sparse.csr_array(0.5 * SQRT3 * (xx - zz)), sparse.csr_array(SQRT3 * xz)
        self.u, self.v, _ = to_ball_axes(history)
        self.xz = SQRT3 * history[..., 4]
        self.fixed_shear = np.sqrt(3 * (history[..., 3] ** 2 + history[..., 5] ** 2))

    def compute_balls(self, coefficients: FloatArray) -> tuple[Array, Array, Array]:
        """Free stress along u, least von Mises stress of every point, and von Mises stress of every instant."""
        v, xz = self.v + (self._v_matrix @ coefficients)[:, None], self.xz + (self._xz_matrix @ coefficients)[:, None]
        squared = v**2 + xz**2 + self.fixed_shear**2
        centre, radius = enclosing_balls(self.u[..., None], np.sqrt(squared))
        return centre[:, 0], radius, np.sqrt((self.u - centre) ** 2 + squared)

    def solve(self) -> tuple[FloatArray, float, float]:
        """Coefficients, the largest von Mises stress with these coefficients, and the lower bound of this stress."""
        best_coefficients, min_radius, bound = np.zeros(self._v_matrix.shape[1]), np.inf, 0.0
        coefficients = best_coefficients
        # The unloaded state at every point bounds all coefficients.
        is_active = np.zeros(self.u.shape, dtype=bool)
        is_active[:, -1] = True
        for program_index in range(MAX_CONE_PROGRAMS + 1):
            _, radius, stress = self.compute_balls(coefficients)
            if radius.max() < min_radius:
                best_coefficients, min_radius = coefficients, float(radius.max())
            if program_index == MAX_CONE_PROGRAMS or min_radius - bound <= MAX_DUALITY_GAP * min_radius:
                break
            # Add the instants that support the smallest ball at points above the program's bound.
            is_critical = radius > max(bound, 0.5 * radius.max())
            is_active |= (stress >= radius[:, None] * (1 - 0.3 * MAX_DUALITY_GAP)) & is_critical[:, None]
            coefficients, bound = self._minimise(is_active)
        return best_coefficients, min_radius, bound

    def _minimise(self, is_active: Array) -> tuple[FloatArray, float]:
        """Coefficients that minimise the largest stress of the active instants, and a lower bound of this stress."""
        try:
            import clarabel
        except ImportError as error:
            raise ImportError("cone programs need the package clarabel: install contactstudy[shakedown]") from error
        point, instant = np.nonzero(is_active)
        points, point_index = np.unique(point, return_inverse=True)
        cone_count, point_count = point.size, points.size
        # Variables: t, the free stress of each point, the coefficients. Rows: t, u, v, xz, fixed shear per instant.
        t_row, u_row, v_row, xz_row, _ = (sparse.csr_array(-row[:, None]) for row in np.eye(5))
        is_point = sparse.csr_array((np.ones(cone_count), (np.arange(cone_count), point_index)))
        airy_matrix = sparse.kron(self._v_matrix[point], v_row) + sparse.kron(self._xz_matrix[point], xz_row)
        t_column = sparse.kron(np.ones((cone_count, 1)), t_row)
        matrix = sparse.csc_array(sparse.hstack([t_column, sparse.kron(is_point, u_row), airy_matrix]))
        constants = [values[point, instant] for values in (0 * self.u, self.u, self.v, self.xz, self.fixed_shear)]
        right_hand_side = np.stack(constants, axis=1).ravel()
        cost = np.zeros(matrix.shape[1])
        cost[0] = 1.0
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        quadratic, cones = sparse.csc_array((cost.size, cost.size)), [clarabel.SecondOrderConeT(5)] * cone_count
        solver = clarabel.DefaultSolver(quadratic, cost, matrix, right_hand_side, cones, settings=settings)
        solution = solver.solve()
        return np.asarray(solution.x)[1 + point_count :], float(solution.obj_val_dual)
