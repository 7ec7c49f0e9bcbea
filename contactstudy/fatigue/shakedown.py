"""Shakedown of a body under many passes of a contact: Melan's theorem (docs/explanation/passes.md).

E. Melan, Zur Plastizitaet des raeumlichen Kontinuums, Ingenieur-Archiv 9 (1938) 116-126; K. L. Johnson, A shakedown
limit in rolling contact, Proc. 4th US National Congress of Applied Mechanics (1962) 971-975.

`shakedown_in_plane` minimises t with ``|(u + w, v + sqrt(3)/2 (rho_xx - rho_zz), sqrt(3) (t_xz + rho_xz), remainder)|``
at most t at every point and instant, w free at every point. Few instants decide: the cone program begins with the
unloaded state of every point and the instants of the largest stress, and each solution adds those that violate it.
"""

from __future__ import annotations

import warnings
from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy import sparse

from contactstudy import checks
from contactstudy.analysis import dimension_along, single_case
from contactstudy.analysis.axes import positions
from contactstudy.analysis.peaks import interpolated_peak, label_peak
from contactstudy.arrays.variables import STRESSES, VARIABLES, describe, named, required_in_si
from contactstudy.bodies.models import Body
from contactstudy.checks import Array, FloatArray, IntArray
from contactstudy.eigenstrain.stress_function import Splines, StressFunction
from contactstudy.errors import ConvergenceWarning, InvalidInputError
from contactstudy.fatigue.history import FEWEST_POSITIONS, enclosing_balls, histories, of_points, over_history

FEWEST_FOR_ERROR = 2 * FEWEST_POSITIONS  # Least number of positions along y for a history of every second position
EQUAL = 1e-6  # Largest difference of equal instants over the largest stress


def in_ball_axes(history: Array) -> tuple[Array, Array, Array]:
    """Coordinates u and v of stresses (..., 6), and the squared remainder: all squares sum up to von Mises' squared."""
    xx, yy, zz, xy, xz, yz = np.moveaxis(history, -1, 0)
    # eq. (501)
    return yy - 0.5 * (xx + zz), 0.5 * np.sqrt(3.0) * (xx - zz), 3 * (xy**2 + xz**2 + yz**2)


def _least_yield_stress(history: Array) -> Array:
    """Least yield stresses in shear of stresses (..., 6)."""
    u, v, remainder = in_ball_axes(history)
    return np.asarray(np.sqrt((u**2 + v**2 + remainder) / 3))


def shakedown(stress: xr.Dataset, *, axial: bool = False) -> xr.Dataset:
    """Least yield stress with which every material point shakes down (Melan), and the residual stress that helps it.

    Parameters
    ----------
    stress : Dataset
        The six components with the rolling direction y over the whole passage, of one case or of a study.
    axial : bool
        Whether a residual stress along the axis may help too. Only a line contact leaves it free at every depth: it may
        not change along x, and must vanish on free ends.

    Returns
    -------
    Dataset
        Without the rolling direction: `first_yield_stress` (Pa), the yield stress in shear k below which the point
        yields in the first passage; `shakedown_stress` (Pa), the k below which it yields in every passage whatever
        residual stress yy (and xx) it has; `residual_sigma_yy` and, if `axial`, `residual_sigma_xx` (Pa), the
        residual stress with which that k suffices. The largest `shakedown_stress` over x and z is a rigorous bound:
        a perfectly plastic body (von Mises) with a larger k shakes down; :func:`shakedown_limit` estimates its error.

    Raises
    ------
    InvalidInputError
        If a component or the rolling direction is missing, or `axial` is True with several positions along x.

    Examples
    --------
    A history of pure stress along rolling, from 0 to -2: residual tension of 1 halves it.

    >>> passage = xr.DataArray([-1.0, -2.0, -1.0], dims="y", coords={"y": [-1.0, 0.0, 1.0]})
    >>> found = shakedown(xr.Dataset({name: passage * (name == "sigma_yy") for name in STRESSES}))
    >>> round(float(found.shakedown_stress / found.first_yield_stress), 6), round(float(found.residual_sigma_yy), 6)
    (0.5, 1.0)
    """
    checks.instance("axial", axial, (bool, np.bool_), "True or False")
    if axial:
        tensor, _ = histories(stress)
        axial_dims = [str(dim) for dim in tensor.dims if str(dim).partition("_")[0] == "x"]
        if any(tensor.sizes[dim] > 1 for dim in axial_dims):
            raise InvalidInputError(
                "axial",
                True,
                f"False with {tensor.sizes[axial_dims[0]]} positions along x",
                "residual stress along the axis is free in a line contact, which one position tells",
            )

    def least_yield_stresses(history: Array) -> tuple[Array, ...]:
        """Yield stresses in shear for no yield and for shakedown, and the residual stresses yy and xx."""
        u, v, remainder = in_ball_axes(history)
        if axial:
            centre, radius = enclosing_balls(np.stack([u, v], axis=-1), np.sqrt(remainder))
            # A stress xx moves u by -1/2 and v by sqrt(3)/2 of itself.
            residual_xx = -2 / np.sqrt(3.0) * centre[:, 1]
        else:
            centre, radius = enclosing_balls(u[..., None], np.sqrt(v**2 + remainder))  # eq. (502)
            residual_xx = np.zeros(len(radius))
        first = _least_yield_stress(history).max(axis=1)
        return first, radius / np.sqrt(3.0), 0.5 * residual_xx - centre[:, 0], residual_xx

    results = over_history(least_yield_stresses, stress, 4)
    names = ("first_yield_stress", "shakedown_stress", "residual_sigma_yy", "residual_sigma_xx")
    result = {name: of_points(name, array) for name, array in zip(names, results, strict=True)}
    if not axial:
        del result["residual_sigma_xx"]
    return xr.Dataset(result)


def shakedown_limit(stress: xr.Dataset, *, axial: bool = False) -> xr.Dataset:
    """Least yield stress with which the body shakes down, the deciding position, and its error.

    Parameters
    ----------
    stress : Dataset
        As for :func:`shakedown`: a single case, or an opened study with all its cases.
    axial : bool
        See :func:`shakedown`.

    Returns
    -------
    Dataset
        ``peak_shakedown_stress`` (Pa), the largest over x and z between the samples, its error
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
    >>> found = shakedown_limit(xr.Dataset({name: shear * (name == "tau_yz") for name in STRESSES}))
    >>> round(float(found.peak_shakedown_stress_z), 2)
    0.5
    """
    stress = required_in_si(stress, *STRESSES, argument="stress")
    swept = dict(stress["hertz_half_width"].sizes) if "hertz_half_width" in stress else {}
    if any(size > 1 for size in swept.values()):
        return _of_study(stress, swept, axial=axial)
    case = single_case(stress)
    rolling = dimension_along(case["tau_yz"], "y")
    # One of the two halves of the instants lacks the one that matters most.
    enough = case.sizes[rolling] >= FEWEST_FOR_ERROR
    samples = [case, *(case.isel({rolling: slice(start, None, 2)}) for start in (0, 1) if enough)]
    fields = [shakedown(sample, axial=axial).compute() for sample in samples]
    result = xr.Dataset()
    for variable in ("shakedown_stress", "first_yield_stress"):

        def between(points: xr.Dataset, variable: str = variable) -> xr.DataArray:
            return shakedown(points, axial=axial)[variable]

        largest, *halves = (
            interpolated_peak(sample, list(STRESSES), field[variable], between)
            for sample, field in zip(samples, fields, strict=True)
        )
        if not enough:
            largest = largest._replace(error=np.inf, comment="too few positions along y to tell")
        elif _border_decides(case, fields[0], variable):
            largest = largest._replace(error=np.inf, comment="the first or the last position along y decides")
        else:
            largest = largest._replace(error=largest.error + largest.value - min(half.value for half in halves))
        peak = label_peak(variable, largest, VARIABLES[variable])
        words = ["on the top" if largest.position.get("z", 1.0) == 0 else "below the top"]
        if "x" in largest.position and "x_bounds" in case.coords:
            bounds = case["x_bounds"].values
            ends = [bounds.min(), bounds.max()]
            if np.isclose(largest.position["x"], ends, rtol=0, atol=1e-9 * np.ptp(bounds)).any():
                words.append("at an end")
        peak[f"peak_{variable}"].attrs["comment"] = ", ".join(words)
        result = result.merge(peak)
        if "hertz_max_pressure" in case and largest.value:
            name = variable.replace("stress", "limit")
            limit = float(case["hertz_max_pressure"]) / largest.value
            result[name] = named(name, xr.DataArray(limit))
            result[f"{name}_error"] = named(f"{name}_error", xr.DataArray(limit * largest.error / largest.value))
    return result


def _of_study(study: xr.Dataset, swept: dict[Hashable, int], *, axial: bool) -> xr.Dataset:
    """Limits of every case of a study; NaN without stresses."""
    numbers: dict[str, Array] = {}
    for index in np.ndindex(*swept.values()):
        case = study.isel(dict(zip(swept, index, strict=True))).compute()
        if np.isnan(case["tau_yz"].values).all():
            continue
        for name, number in shakedown_limit(case, axial=axial).items():
            numbers.setdefault(str(name), np.full(tuple(swept.values()), np.nan))[index] = float(number)
    coordinates = {name: study[name] for name in swept if name in study.coords}
    result = xr.Dataset({name: (tuple(swept), values) for name, values in numbers.items()}, coordinates)
    return describe(result)


def shakedown_summary(dataset: xr.Dataset) -> xr.Dataset:
    """Limits of first yield and shakedown of a solved case; empty without stresses, load, or six positions along y."""
    if (
        all(name in dataset for name in STRESSES)
        and dataset.sizes[dimension_along(dataset["tau_yz"], "y")] >= FEWEST_FOR_ERROR
        and any(dataset[name].values.any() for name in STRESSES)
    ):
        return shakedown_limit(dataset).reset_coords(drop=True)
    return xr.Dataset()


def _border_decides(case: xr.Dataset, fields: xr.Dataset, variable: str) -> bool:
    """Whether the first or the last instant alone is as bad as the largest: worse ones may lie beyond."""
    tensor, _ = histories(case)
    worst = {dim: int(index) for dim, index in fields[variable].argmax(...).items()}
    point = tensor.isel(worst).values
    eased = np.zeros(len(STRESSES))
    if variable == "shakedown_stress":
        eased[1] = float(fields["residual_sigma_yy"].isel(worst))
        eased[0] = float(fields["residual_sigma_xx"].isel(worst)) if "residual_sigma_xx" in fields else 0.0
    size = _least_yield_stress(point + eased)
    largest = float(fields[variable].isel(worst))
    # An unloaded border is as bad as the unloaded state may be, which is known.
    unloaded = np.abs(point[[0, -1]]).max(axis=-1) <= EQUAL * largest
    return bool(((size[[0, -1]] >= largest * (1 - EQUAL)) & ~unloaded).any())


DEGREE, CONTINUITY = 5, 3  # Of the stress function's polynomials: stresses that are smooth between the points
# Points per element along either axis. Accuracy: an element has two functions along each axis; with two points it would
# yield between them
POINTS_PER_ELEMENT = 4
FEWEST_POINTS = 5  # Along x and z, for a stress function with something to choose
LARGEST_GAP = 1e-4  # Gap of the program, over k, at which it has converged
MOST_PROGRAMS = 20  # Programs that are solved at most; about six suffice
ROOT = np.sqrt(3.0)


def shakedown_in_plane(stress: xr.Dataset, body: Body) -> xr.Dataset:
    """Least yield stress with which the body shakes down, with every residual stress that its ends allow.

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
        the bound, `peak_shakedown_stress` (Pa). `program_gap` (1) is the part of it that a better choice of the
        coefficients could still gain. With more positions along x and z the stress function has more of them.

    Raises
    ------
    InvalidInputError
        If a component or a direction is missing, or there are fewer than five positions along x or z.
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
    >>> found = shakedown_in_plane(passage, HalfSpace(material=Material(1.0, 0.3)))
    >>> bool(found.shakedown_stress.max() < 0.9 * found.first_yield_stress.max())
    True
    """
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    case = single_case(stress)
    tensor, rolling = histories(case)
    dims = [dimension_along(tensor, axis) for axis in ("x", "z")]
    x, z = (np.asarray(positions(tensor, axis).values, dtype=np.float64) for axis in ("x", "z"))
    for axis, points in (("x", x), ("z", z)):
        if points.size < FEWEST_POINTS or (np.diff(points) <= 0).any():
            raise InvalidInputError(
                f"stress.{axis}", points, f"at least {FEWEST_POINTS} positions, increasing", "solve with more of them"
            )
    values = tensor.transpose(*dims, rolling, ...).values.astype(np.float64)
    history = values.reshape(-1, *values.shape[2:])
    history = np.concatenate([history, np.zeros_like(history[:, :1])], axis=1)
    scale = float(np.abs(history).max()) or 1.0
    function = _stresses(body.extent, x, z)
    program = _Program(history / scale, function)
    airy, attained, bound = program.solve()
    gap = max(attained - bound, 0.0) / max(attained, 1e-300)
    if gap > LARGEST_GAP:
        warnings.warn(
            f"the shakedown program has a gap of {gap:.2g} after {MOST_PROGRAMS} programs: the bound holds, and a "
            "larger load may shake down; take fewer positions along x and z",
            ConvergenceWarning,
            stacklevel=2,
        )
    in_plane = [scale * (matrix @ airy) for matrix in function]
    centre, radius, _ = program.balls(airy)
    xx, zz, xz = in_plane
    results = {
        "first_yield_stress": _least_yield_stress(history).max(axis=1),
        "shakedown_stress": scale * radius / ROOT,
        "residual_sigma_xx": xx,
        # The free stress along u is rho_yy - (rho_xx + rho_zz) / 2.
        "residual_sigma_yy": -scale * centre + 0.5 * (xx + zz),
        "residual_sigma_zz": zz,
        "residual_tau_xz": xz,
    }
    template = tensor.isel({rolling: 0, tensor.dims[-1]: 0}, drop=True).transpose(*dims)
    result = xr.Dataset(
        {name: of_points(name, template.copy(data=flat.reshape(template.shape))) for name, flat in results.items()}
    )
    result["peak_shakedown_stress"] = of_points("peak_shakedown_stress", result["shakedown_stress"].max())
    result["program_gap"] = named("program_gap", xr.DataArray(gap))
    return result


def _stresses(extent: tuple[float, float], x: FloatArray, z: FloatArray) -> list[sparse.csr_array]:
    """Stresses xx, zz and xz at the points per coefficient of Airy's function: arrays (point, coefficient)."""
    ends = [end if np.isfinite(end) else edge for end, edge in zip(extent, x[[0, -1]], strict=True)]
    along_x = Splines(_elements(x, *ends), DEGREE, CONTINUITY, vanishing_orders=2)
    along_z = Splines(_elements(z, 0.0, z[-1]), DEGREE, CONTINUITY, vanishing_orders=2)
    size = 0.5 * (along_x.edges[-1] - along_x.edges[0]), 0.5 * along_z.edges[-1]
    # Both sides scaled to a length of about an element make the coefficients stresses.
    step = [half / max(splines.edges.size - 1, 1) for half, splines in zip(size, (along_x, along_z), strict=True)]
    values_x, values_z = StressFunction(along_x, along_z).values(x, z)
    unit = step[0] * step[1]
    return [
        sparse.csr_array(sign * unit * sparse.kron(sparse.csr_array(values_x[i]), values_z[j]))
        for i, j, sign in ((0, 2, 1), (2, 0, 1), (1, 1, -1))
    ]


def _elements(points: FloatArray, low: float, high: float) -> FloatArray:
    """Edges from `low` to `high` with every so many of the points."""
    inner = points[(points > low) & (points < high)]
    chosen = inner[POINTS_PER_ELEMENT - 1 : 1 - POINTS_PER_ELEMENT or None : POINTS_PER_ELEMENT]
    return np.concatenate([[low], chosen, [high]])


@dataclass(eq=False)
class _Program:
    """The cone program: histories over their largest stress, and the stresses per coefficient."""

    history: Array
    function: list[sparse.csr_array]

    def __post_init__(self) -> None:
        xx, zz, xz = self.function
        self._v, self._xz = sparse.csr_array(0.5 * ROOT * (xx - zz)), sparse.csr_array(ROOT * xz)
        self.u, self.v, _ = in_ball_axes(self.history)
        self.xz = ROOT * self.history[..., 4]
        self.rest = np.sqrt(3 * (self.history[..., 3] ** 2 + self.history[..., 5] ** 2))

    def balls(self, airy: FloatArray) -> tuple[Array, Array, Array]:
        """Free stress along u and least von Mises stress at every point, with the residual stress in the plane.

        The third is the von Mises stress at every instant.
        """
        v, xz = self.v + (self._v @ airy)[:, None], self.xz + (self._xz @ airy)[:, None]
        squared = v**2 + xz**2 + self.rest**2
        centre, radius = enclosing_balls(self.u[..., None], np.sqrt(squared))
        return centre[:, 0], radius, np.sqrt((self.u - centre) ** 2 + squared)

    def solve(self) -> tuple[FloatArray, float, float]:
        """Coefficients, the largest von Mises stress with them, and the program's lower bound of it."""
        best, least, bound = np.zeros(self._v.shape[1]), np.inf, 0.0
        airy = best
        # The unloaded state at every point bounds all coefficients.
        active = np.zeros(self.history.shape[:2], dtype=bool)
        active[:, -1] = True
        for number in range(MOST_PROGRAMS + 1):
            _, radius, stress = self.balls(airy)
            if radius.max() < least:
                best, least = airy, float(radius.max())
            if number == MOST_PROGRAMS or least - bound <= LARGEST_GAP * least:
                break
            # Instants that support the smallest ball at points with a ball above the program's bound.
            critical = radius > max(bound, 0.5 * radius.max())
            active |= (stress >= radius[:, None] * (1 - 0.3 * LARGEST_GAP)) & critical[:, None]
            airy, bound = self._minimise(active)
        return best, least, bound

    def _minimise(self, active: Array) -> tuple[FloatArray, float]:
        """Coefficients and least largest stress over the active instants."""
        try:
            import clarabel
        except ImportError as error:
            raise ImportError("cone programs need the package clarabel: install contactstudy[shakedown]") from error
        point, instant = np.nonzero(active)
        owners, owner = np.unique(point, return_inverse=True)
        count, free, coefficients = point.size, owners.size, self._v.shape[1]
        rows = np.arange(count)

        # Variables: t, the free stress of each point, the coefficients. Rows: t, u, v, xz, rest of every instant.
        def placed(row: int, columns: IntArray, width: int) -> sparse.csr_array:
            return sparse.csr_array((np.full(count, -1.0), (5 * rows + row, columns)), shape=(5 * count, width))

        spread = [placed(row, rows, count) for row in (2, 3)]
        of_airy = spread[0] @ self._v[point] + spread[1] @ self._xz[point]
        matrix = sparse.hstack([placed(0, 0 * rows, 1), placed(1, owner, free), of_airy], format="csc")
        constants = [
            0 * self.u[point, instant],
            *(values[point, instant] for values in (self.u, self.v, self.xz, self.rest)),
        ]
        right = np.stack(constants, axis=1).ravel()
        cost = np.zeros(1 + free + coefficients)
        cost[0] = 1.0
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        solver = clarabel.DefaultSolver(
            sparse.csc_array((cost.size, cost.size)),
            cost,
            matrix,
            right,
            [clarabel.SecondOrderConeT(5)] * count,
            settings=settings,
        )
        solution = solver.solve()
        return np.asarray(solution.x)[1 + free :], float(solution.obj_val_dual)
