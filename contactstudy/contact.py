"""Contact of a rigid shape with a body: pressure and gap under a prescribed load, with their certificate."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from scipy import ndimage

from contactstudy import checks
from contactstudy.bodies import Body
from contactstudy.cache import BoundedCache, digest
from contactstudy.checks import FloatArray
from contactstudy.conjugate_gradients import ContactIterate, solve_complementarity
from contactstudy.dataset import describe
from contactstudy.errors import ConvergenceWarning, InvalidInputError, WindowError
from contactstudy.grid import Grid
from contactstudy.labelled import labelled_cells
from contactstudy.surface import SurfaceOperator, surface_operator
from contactstudy.threads import one_blas_thread

# A gap counts as open when it exceeds this many tolerances of the displacement's variation.
OPEN_TOLERANCES = 10.0
COUPLED_ROUNDS = 60
# From this many cells on, the contact is first solved on coarser ones, to a tolerance that serves as a guess.
NESTED_CELLS = 4096
COARSE_TOLERANCE = 1e-3

_CONTACTS: BoundedCache[ContactIterate] = BoundedCache(2**26, lambda iterate: iterate.pressure.nbytes)


def solve_contact(
    body: Body,
    gap: xr.DataArray,
    load: float,
    friction: float = 0.0,
    coupled: bool = False,
    *,
    tolerance: float = 1e-6,
    max_iterations: int = 500,
) -> xr.Dataset:
    """Press a rigid shape on a body.

    Parameters
    ----------
    body : Body
        The elastic body.
    gap : DataArray (x, y)
        Initial gap at the cell centres of a uniform grid, metres: 0 at first touch, infinite where there is nothing
        to touch. On a finite-length space the cells span the body from end to end; elsewhere they must leave room
        around the contact.
    load : float
        Normal load, N.
    friction : float
        Coefficient ``f``; the shear traction on the body is ``f`` times the pressure along +y.
    coupled : bool
        Whether the friction also displaces the surface normally, which changes pressure and contact (it cannot when
        Poisson's ratio is 1/2).
    tolerance : float
        Bound on the violation of the gap conditions, over the variation of the displacement, and on the last change
        of the pressure, over its sum.
    max_iterations : int
        Bound on the iterations.

    Returns
    -------
    Dataset
        `pressure`, `shear_traction`, `gap`, `displacement_z` (x, y); `load`, `approach`, `iterations`, `converged`;
        and the certificate, recomputed from the pressure alone: `load_error`, `penetration_error`,
        `open_pressure_error`.

    Raises
    ------
    InvalidInputError
        If an argument is of the wrong kind or out of range, or the grid does not fit the body.
    WindowError
        If the contact reaches an edge of the grid where the body goes on.

    Warns
    -----
    ConvergenceWarning
        If the iteration stopped before its tolerance; `converged` is then False.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from contactstudy import HalfSpace, Material
    >>> centres = np.linspace(-1.5, 1.5, 65)
    >>> gap = xr.DataArray(
    ...     0.5 * (centres[:, None] ** 2 + centres**2), coords={"x": centres, "y": centres}, dims=("x", "y")
    ... )
    >>> contact = solve_contact(HalfSpace(material=Material(0.75, 0.5)), gap, load=4 / 3)
    >>> bool(contact.converged), round(float(contact.pressure.max()), 2)
    (True, 0.64)
    """
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    clearance, grid = labelled_cells("gap", gap, infinite=True)
    load = checks.positive("load", load, "N")
    friction = checks.finite("friction", friction)
    checks.instance("coupled", coupled, (bool, np.bool_), "True or False")
    tolerance = checks.positive("tolerance", tolerance)
    max_iterations = checks.count("max_iterations", max_iterations)
    if not np.isfinite(clearance).any():
        raise InvalidInputError("gap", "infinite everywhere", "finite where the shape can touch the body")
    bends = bool(coupled) and friction != 0
    total = load / grid.cell_area
    with one_blas_thread():
        operator = surface_operator(body, grid, tangential=bends)
        # Friction that does not bend the surface does not change the pressure: one contact serves all of a sweep.
        key = (body, grid, digest(clearance), total, friction if bends else 0.0, tolerance, max_iterations)
        problem = _Problem(body, grid, clearance, total, friction, tolerance, max_iterations)
        solve = _solve_coupled if bends else _solve_normal
        iterate = _CONTACTS.get(key, lambda: solve(operator, problem))
        pressure = iterate.pressure.copy()
        traction = friction * pressure
        displacement = operator(pressure, traction if bends else None)
    _check_window(body, pressure, np.isfinite(clearance))
    if not iterate.converged:
        warnings.warn(
            f"the contact iteration stopped after {iterate.applications} operator applications without reaching "
            f"tolerance = {tolerance:g}; raise max_iterations (now {max_iterations}) or coarsen the grid",
            ConvergenceWarning,
            stacklevel=2,
        )
    height = clearance + displacement
    approach = float((pressure * np.where(pressure > 0, height, 0.0)).sum() / pressure.sum())
    opening = height - approach
    variation = float(np.ptp(displacement))
    touching = pressure > 0
    violation = max(float(np.abs(opening[touching]).max()), float(-opening.min()))
    at_open_gap = pressure[opening > OPEN_TOLERANCES * tolerance * variation]
    dims = ("x", "y")
    scalars: dict[str, float | int | bool] = {
        "load": load,
        "approach": approach,
        "iterations": iterate.applications,
        "converged": iterate.converged,
        "load_error": float(pressure.sum() * grid.cell_area / load - 1),
        "penetration_error": violation / variation,
        "open_pressure_error": float(at_open_gap.max(initial=0.0) / pressure.max()),
    }
    fields = {
        "pressure": pressure,
        "shear_traction": traction,
        "gap": np.where(np.isfinite(opening), opening, np.inf),
        "displacement_z": displacement,
    }
    result = xr.Dataset(
        {name: (dims, values) for name, values in fields.items()} | scalars,
        coords={"x": gap["x"].values, "y": gap["y"].values},
    )
    if np.isfinite(operator.reference):
        result["displacement_z"].attrs["reference_distance"] = operator.reference
        result["displacement_z"].attrs["reference"] = "zero at |y| = reference_distance (m) on the top"
    return describe(result, "contact of a rigid shape with an elastic body")


@dataclass(frozen=True, eq=False)
class _Problem:
    """A contact to solve, checked."""

    body: Body
    grid: Grid
    gap: FloatArray
    total: float
    friction: float
    tolerance: float
    max_iterations: int

    def coarser(self) -> _Problem:
        """Return the same contact on cells of twice the size."""
        grid = self.grid.coarsened()
        cells = self.gap.reshape(grid.cells_x, 2, grid.cells_y, 2)
        possible = np.isfinite(cells)
        count = possible.sum(axis=(1, 3))
        mean = np.where(possible, cells, 0.0).sum(axis=(1, 3)) / np.maximum(count, 1)
        gap = np.where(count > 0, mean, np.inf)
        return replace(self, grid=grid, gap=gap, total=self.total / 4, tolerance=COARSE_TOLERANCE)


def _first_guess(operator: SurfaceOperator, problem: _Problem) -> FloatArray:
    """Pressure to begin with: the solution on coarser cells, or, on few cells, one that follows the gap."""
    gap = problem.gap
    possible = np.isfinite(gap)
    if gap.size >= NESTED_CELLS and problem.grid.cells_x % 2 == 0 and problem.grid.cells_y % 2 == 0:
        coarse = problem.coarser()
        squared = _continued_square(operator.coarse, coarse, _solve_normal(operator.coarse, coarse))
        guess = np.sqrt(np.maximum(np.where(possible, _refined(_refined(squared).T).T, 0.0), 0.0))
    else:
        level = np.quantile(gap[possible], 0.4) + 1e-3 * np.ptp(gap[possible])
        guess = np.sqrt(np.maximum(level - np.where(possible, gap, np.inf), 0.0))
    return np.asarray(guess if guess.any() else possible.astype(np.float64))


def _continued_square(operator: SurfaceOperator, problem: _Problem, found: ContactIterate) -> FloatArray:
    """Squared pressure, and outside the contact what continues it smoothly below zero.

    Close to an edge the squared pressure and the opening to the power 2/3 are both linear in the distance from it
    (Johnson, Contact Mechanics, section 5.1), so the one continues the other but for a factor. Interpolated to finer
    cells its zero puts the edge within a cell.
    """
    squared = found.pressure**2
    contact = squared > 0
    height = np.where(np.isfinite(problem.gap), problem.gap, 0.0) + operator(found.pressure)
    opening = np.where(contact | np.isinf(problem.gap), 0.0, np.maximum(height - found.approach, 0.0)) ** (2 / 3)
    inner = contact & ndimage.binary_dilation(~contact)
    outer = (opening > 0) & ndimage.binary_dilation(contact)
    if not inner.any() or not outer.any():
        return np.asarray(squared)
    return np.asarray(squared - opening * (np.median(squared[inner]) / np.median(opening[outer])))


def _refined(values: FloatArray) -> FloatArray:
    """Values on cells of half the size along the first axis, by linear interpolation between the centres."""
    before, after = np.vstack([values[:1], values[:-1]]), np.vstack([values[1:], values[-1:]])
    halves = np.stack([0.75 * values + 0.25 * before, 0.75 * values + 0.25 * after], axis=1)
    return halves.reshape(-1, values.shape[1])


def _solve_normal(operator: SurfaceOperator, problem: _Problem, start: FloatArray | None = None) -> ContactIterate:
    """Contact without the displacement from friction."""
    return solve_complementarity(
        operator,
        operator.precondition,
        problem.gap,
        problem.total,
        _first_guess(operator, problem) if start is None else start,
        tolerance=problem.tolerance,
        max_iterations=problem.max_iterations,
    )


def _solve_coupled(operator: SurfaceOperator, problem: _Problem) -> ContactIterate:
    """Contact with the displacement from friction: the traction of one round shapes the gap of the next.

    The rounds contract like ``f (1 - 2 nu) / (2 (1 - nu))``, so a few are enough.
    """
    iterate = _solve_normal(operator, problem)
    applications = iterate.applications
    for _ in range(COUPLED_ROUNDS):
        previous = iterate.pressure
        bent = operator(np.zeros_like(previous), problem.friction * previous)
        iterate = _solve_normal(operator, replace(problem, gap=problem.gap + bent), previous)
        applications += iterate.applications + 1
        change = float(np.abs(iterate.pressure - previous).sum() / problem.total)
        if change <= 3 * problem.tolerance or not iterate.converged:
            return ContactIterate(iterate.pressure, iterate.approach, applications, iterate.converged)
    return ContactIterate(iterate.pressure, iterate.approach, applications, False)


def _check_window(body: Body, pressure: FloatArray, possible: np.ndarray) -> None:
    """Raise if the contact reaches an edge of the grid that is not an end of the body."""
    low, high = body.extent
    edges = {"y_min": pressure[:, 0], "y_max": pressure[:, -1]}
    if np.isinf(low):
        edges["x_min"] = pressure[0]
    if np.isinf(high):
        edges["x_max"] = pressure[-1]
    for name, values in edges.items():
        if values.any():
            raise WindowError(
                f"the contact reaches the grid's edge {name} (pressure {values.max():.3g} Pa there): the window is too "
                f"narrow for the load; widen it along {name[0]} or lower the load"
            )
