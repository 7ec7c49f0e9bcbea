"""Quadratures over wavenumbers: Gauss-Legendre's on panels, and the trapezoidal rule over their logarithm.

What is integrated along axial and depth wavenumbers is smooth over their logarithm ``u``: its nearest poles lie at the
angle `Resolution.angle` from the path. The trapezoidal rule of step h over u leaves ``exp(-2 pi angle / h)`` there,
with half the nodes of Gauss's on growing panels (L. N. Trefethen and J. A. C. Weideman, SIAM Review 56 (2014) 385).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from contactstudy import checks
from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.kernels.load import Load


@lru_cache(maxsize=32)
def _gauss(order: int) -> tuple[FloatArray, FloatArray]:
    nodes, weights = np.polynomial.legendre.leggauss(order)
    return nodes, weights


def panel_nodes(edges: FloatArray, order: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights of composite Gauss-Legendre quadrature on the panels between `edges`.

    Examples
    --------
    >>> nodes, weights = panel_nodes(np.array([0.0, 1.0, 3.0]), 4)
    >>> round(float(weights @ nodes**5), 6)
    121.5
    """
    nodes, weights = _gauss(order)
    half = 0.5 * np.diff(edges)[:, None]
    middle = 0.5 * (edges[1:] + edges[:-1])[:, None]
    return (middle + half * nodes).ravel(), (half * weights).ravel()


def lagrange(nodes: FloatArray, points: FloatArray) -> FloatArray:
    """Matrix (point, node) that interpolates from `nodes` to `points` by one polynomial.

    Examples
    --------
    >>> lagrange(np.array([0.0, 1.0, 2.0]), np.array([0.5])).tolist()
    [[0.375, 0.75, -0.125]]
    """
    matrix = np.empty((points.size, nodes.size))
    for i, node in enumerate(nodes):
        others = np.delete(nodes, i)
        matrix[:, i] = np.prod((points[:, None] - others) / (node - others), axis=1)
    return matrix


def growing_edges(first: float, last: float, ratio: float = 2.0) -> FloatArray:
    """Panel edges ``0, first, ratio first, ratio**2 first, ...`` up to at least `last`.

    Examples
    --------
    >>> growing_edges(1.0, 7.0).tolist()
    [0.0, 1.0, 2.0, 4.0, 8.0]
    """
    panels = max(1, int(np.ceil(np.log(last / first) / np.log(ratio))) + 1)
    return np.concatenate([[0.0], first * ratio ** np.arange(panels)])


AXIAL_STEP, AXIAL_REACH = 0.16, 1000.0
"""Largest step and least reach under loads along x. Accuracy: where they bend the body, H and V grow and cancel; on a
corner their normal stress on the end is singular."""

START, LOWEST = 0.3, -2.8
"""Wavenumber about which the nodes begin to thin out towards 0, over the smallest scale, and the least ``u``.
Accuracy: below it lies 1e-7 of that scale."""


@dataclass(frozen=True)
class Resolution:
    """Settings of the quadratures behind the equivalent loads; the defaults leave errors below 2e-5 of a load.

    Reaches are over the smallest distance from a loaded corner that is asked for: points nearer to it refine them.

    Parameters
    ----------
    step : float
        Step of axial and depth wavenumbers over their logarithm.
    angle : float
        Angle of the rays to the real axis, radians. Axial and depth wavenumbers are turned by the same angle; twice
        the angle must stay well below pi/2, where ``k_x**2 + k_y**2 + k_z**2`` would vanish.
    reach : float
        Largest axial and depth wavenumber, times the smallest distance from a loaded corner.
    ray_reach : float
        Likewise on the ray of depth wavenumbers, where the loads are evaluated and no longer solved for.
    modes : int
        Axial modes that are summed one by one.
    lateral_nodes : int
        Wavenumbers along y per panel at which the body is asked.
    lateral_ratio : float
        Growth of these panels, whose nodes are Gauss's over the logarithm.
    lateral_order : int
        Gauss nodes per panel of the finer wavenumbers along y, which follow the load's phase.
    lateral_reach : float
        Largest wavenumber along y, times the smallest distance from a loaded corner.

    Raises
    ------
    InvalidInputError
        If a setting cannot resolve anything.
    """

    step: float = 0.22
    angle: float = np.pi / 6
    reach: float = 200.0
    ray_reach: float = 50.0
    modes: int = 8
    lateral_nodes: int = 7
    lateral_ratio: float = 5.5
    lateral_order: int = 16
    lateral_reach: float = 10.0

    def __post_init__(self) -> None:
        """Refuse settings with which the ends would carry traction that looks like a result."""
        for name in ("modes", "lateral_nodes", "lateral_order"):
            checks.count(name, getattr(self, name), least=2)
        for name in ("reach", "ray_reach", "lateral_reach"):
            checks.positive(name, getattr(self, name))
        if not 0 < self.step <= 1:
            raise InvalidInputError("step", self.step, "more than 0 and at most 1")
        if not self.lateral_ratio > 1:
            raise InvalidInputError("lateral_ratio", self.lateral_ratio, "more than 1: the panels grow")
        if not 0 < self.angle < np.pi / 4:
            raise InvalidInputError("angle", self.angle, "between 0 and pi/4, where k_x^2 + k_y^2 + k_z^2 vanishes")

    def for_loads(self, loads: Iterable[Load]) -> Resolution:
        """Return settings that resolve loads in these directions as well as these do a pressure."""
        if Load.ALONG_X not in loads:
            return self
        return replace(self, step=min(self.step, AXIAL_STEP), reach=max(self.reach, AXIAL_REACH))


def scale_nodes(first: float, last: float, step: float) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights of an integral from 0 to about `last`, of what is smooth over the logarithm from `first` on.

    The trapezoidal rule over ``u`` with ``k = start exp(u - exp(-u))``, where k falls to 0 doubly exponentially.

    Examples
    --------
    >>> nodes, weights = scale_nodes(1.0, 1e6, 0.25)
    >>> nodes.size, bool(abs(weights @ (1 + nodes) ** -2.0 - 1) < 3e-6)
    (74, True)
    """
    start = START * first
    lowest, highest = int(np.floor(LOWEST / step)), int(np.ceil(np.log(last / start) / step))
    u = step * np.arange(lowest, highest + 1.0)
    nodes = start * np.exp(u - np.exp(-u))
    return nodes, step * nodes * (1 + np.exp(-u))


def ray_nodes(first: float, last: float, resolution: Resolution) -> tuple[ComplexArray, ComplexArray]:
    """Nodes and weights along the ray from 0 at the resolution's angle, of scales from `first` to `last`."""
    nodes, weights = scale_nodes(first, last, resolution.step)
    turn = np.exp(1j * resolution.angle)
    return nodes * turn, weights * turn
