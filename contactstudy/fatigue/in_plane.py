"""Melan's bound with all residual stress that a body's free ends allow: a convex program over the cross-section.

Beside ``rho_yy``, which is free at every point, the residual stresses ``rho_xx``, ``rho_zz`` and ``rho_xz`` help as far
as they are in equilibrium and leave top and ends free. Airy's stress function of (x, z) makes them (eigenstrain/), so
they are linear in its coefficients, and the least yield stress k is found from

    minimise t  such that  |(u + w, v + sqrt(3)/2 (rho_xx - rho_zz), sqrt(3) (t_xz + rho_xz), rest)| <= t

at every point and instant (u, v and rest as in shakedown.py; w is free at every point): a second-order cone program.
Few instants of a history decide, so the program is solved for these and those it then violates are added. Whatever the
solver leaves undone, the result is a bound: the least k is evaluated from the residual stress found, at all instants.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy import sparse

from contactstudy import checks
from contactstudy.analysis import dimension_along, single_case
from contactstudy.analysis.axes import positions
from contactstudy.arrays.variables import named
from contactstudy.bodies.models import Body
from contactstudy.checks import Array, FloatArray, IntArray
from contactstudy.eigenstrain.splines import Splines
from contactstudy.errors import InvalidInputError
from contactstudy.fatigue.enclosing_ball import enclosing_balls
from contactstudy.fatigue.history import histories, of_points
from contactstudy.fatigue.shakedown import in_ball_axes

DEGREE, CONTINUITY = 5, 3
"""Of the stress function's polynomials: stresses that are smooth between the points."""

POINTS_PER_ELEMENT = 4
"""Points per element along either axis. Accuracy: an element has two functions of its own along each, and with as few
points it would yield between them where it does not at them."""

FEWEST_POINTS = 5
"""Along x and z, for a stress function with something to choose."""

SETTLED = 1e-4
"""Part of k by which an instant may exceed the program's before it is added. Accuracy."""

MOST_ROUNDS = 20
"""Programs that are solved at most: a safeguard."""

ROOT = np.sqrt(3.0)


def shakedown_in_plane(stress: xr.Dataset, body: Body) -> xr.Dataset:
    """Least yield stress with which the body shakes down when every residual stress helps that its ends allow.

    Parameters
    ----------
    stress : Dataset
        A single case with the six components along x, y and z, as for :func:`contactstudy.fatigue.shakedown`. The
        residual stress reaches from the top to the largest z, and from the first to the last x, or to the free ends.
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
    one = single_case(stress)
    tensor, rolling = histories(one)
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
    airy, attained, bound = program.solved()
    in_plane = [scale * (matrix @ airy) for matrix in function]
    u, v, rest = in_ball_axes(history)
    first = np.sqrt((u**2 + v**2 + rest).max(axis=1) / 3)
    centre, radius = program.pointwise(airy)
    xx, zz, xz = in_plane
    results = {
        "first_yield_stress": first,
        "shakedown_stress": scale * radius / ROOT,
        "residual_sigma_xx": xx,
        # The free stress along u is rho_yy - (rho_xx + rho_zz) / 2.
        "residual_sigma_yy": -scale * centre + 0.5 * (xx + zz),
        "residual_sigma_zz": zz,
        "residual_tau_xz": xz,
    }
    like = tensor.isel({rolling: 0, tensor.dims[-1]: 0}, drop=True).transpose(*dims)
    found = xr.Dataset(
        {name: of_points(name, like.copy(data=flat.reshape(like.shape))) for name, flat in results.items()}
    )
    found["peak_shakedown_stress"] = of_points("peak_shakedown_stress", found["shakedown_stress"].max())
    found["program_gap"] = named("program_gap", xr.DataArray(max(attained - bound, 0.0) / max(attained, 1e-300)))
    return found


def _stresses(extent: tuple[float, float], x: FloatArray, z: FloatArray) -> list[sparse.csr_matrix]:
    """Stresses xx, zz and xz at the points per coefficient of Airy's function: arrays (point, coefficient)."""
    ends = [end if np.isfinite(end) else own for end, own in zip(extent, x[[0, -1]], strict=True)]
    along_x = Splines(_elements(x, *ends), DEGREE, CONTINUITY, vanishing=2)
    along_z = Splines(_elements(z, 0.0, z[-1]), DEGREE, CONTINUITY, vanishing=2)
    size = 0.5 * (along_x.edges[-1] - along_x.edges[0]), 0.5 * along_z.edges[-1]
    # Both sides scaled to a length of about an element make the coefficients stresses.
    step = [own / max(splines.edges.size - 1, 1) for own, splines in zip(size, (along_x, along_z), strict=True)]
    at_x, at_z = (
        [sparse.csr_matrix(splines.values(points, derivative)) for derivative in range(3)]
        for splines, points in ((along_x, x), (along_z, z))
    )
    unit = step[0] * step[1]
    return [
        sparse.csr_matrix(sign * unit * sparse.kron(at_x[i], at_z[j]))
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
    function: list[sparse.csr_matrix]

    def __post_init__(self) -> None:
        xx, zz, xz = self.function
        self._v, self._xz = sparse.csr_matrix(0.5 * ROOT * (xx - zz)), sparse.csr_matrix(ROOT * xz)
        self.u, self.v, _ = in_ball_axes(self.history)
        self.xz = ROOT * self.history[..., 4]
        self.rest = np.sqrt(3 * (self.history[..., 3] ** 2 + self.history[..., 5] ** 2))

    def pointwise(self, airy: FloatArray) -> tuple[Array, Array]:
        """Free stress along u and least von Mises stress at every point, with the residual stress in the plane."""
        v, xz = self.v + (self._v @ airy)[:, None], self.xz + (self._xz @ airy)[:, None]
        centre, radius = enclosing_balls(self.u[..., None], np.sqrt(v**2 + xz**2 + self.rest**2))
        return centre[:, 0], radius

    def solved(self) -> tuple[FloatArray, float, float]:
        """Coefficients, the largest von Mises stress that they leave, and the program's lower bound of it."""
        airy = np.zeros(self._v.shape[1])
        active = np.zeros(self.history.shape[:2], dtype=bool)
        best, least, bound = airy, float(self.pointwise(airy)[1].max()), 0.0
        for _ in range(MOST_ROUNDS):
            centre, radius = self.pointwise(airy)
            if radius.max() < least:
                best, least = airy, float(radius.max())
            if least - bound <= SETTLED * least:
                break
            active |= self._exceeding(airy, centre, radius, bound)
            airy, bound = self._minimised(active)
        return best, least, bound

    def _exceeding(self, airy: FloatArray, centre: Array, radius: Array, bound: float) -> Array:
        """Instants that hold the smallest ball at points where it exceeds what the program believes."""
        v, xz = self.v + (self._v @ airy)[:, None], self.xz + (self._xz @ airy)[:, None]
        size = np.sqrt((self.u - centre[:, None]) ** 2 + v**2 + xz**2 + self.rest**2)
        wanted = radius > max(bound, 0.5 * radius.max())
        return np.asarray((size >= radius[:, None] * (1 - 0.3 * SETTLED)) & wanted[:, None])

    def _minimised(self, active: Array) -> tuple[FloatArray, float]:
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
        def placed(row: int, columns: IntArray, width: int) -> sparse.csr_matrix:
            return sparse.csr_matrix((np.full(count, -1.0), (5 * rows + row, columns)), shape=(5 * count, width))

        spread = [placed(row, rows, count) for row in (2, 3)]
        of_airy = spread[0] @ self._v[point] + spread[1] @ self._xz[point]
        matrix = sparse.hstack([placed(0, 0 * rows, 1), placed(1, owner, free), of_airy], format="csc")
        constants = [
            0 * self.u[point, instant],
            *(each[point, instant] for each in (self.u, self.v, self.xz, self.rest)),
        ]
        right = np.stack(constants, axis=1).ravel()
        cost = np.zeros(1 + free + coefficients)
        cost[0] = 1.0
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        solver = clarabel.DefaultSolver(
            sparse.csc_matrix((cost.size, cost.size)),
            cost,
            matrix,
            right,
            [clarabel.SecondOrderConeT(5)] * count,
            settings,
        )
        solution = solver.solve()
        return np.asarray(solution.x)[1 + free :], float(solution.obj_val_dual)
