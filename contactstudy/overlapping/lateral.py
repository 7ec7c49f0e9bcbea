"""The direction along the rolling: few wavenumbers ``k_y`` for the body, many for the load.

What a body answers to a load varies slowly with ``k_y``; what varies fast is the phase ``k_y y`` of the load and of the
point. So the body is asked at the Gauss nodes of panels that grow from 0, and its answers are interpolated to the many
nodes that follow the phase. Within a panel a load is a sum of few products of a function of x and a function of
``k_y`` (a singular value decomposition), often a single one, and only these functions of x are asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from contactstudy.arrays.grid import Grid
from contactstudy.checks import FloatArray, IntArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.quadrature import Resolution, lagrange, panel_nodes

NEGLIGIBLE = 1e-7
"""Part of a load that is left out: a contact that is symmetric but for its tolerance is symmetric. Accuracy."""

LEAST_PRODUCT = 1e-7
"""Part of the largest product of a load that is left out within a panel. Accuracy."""

POLES, BENDING_POLES = 2, 3
"""Order of an amplitude's pole at wavenumber 0: 3 under a force along x, which bends the body as a plate."""

ALONE, TERMS = {POLES: 0.1, BENDING_POLES: 1.0}, {POLES: 4, BENDING_POLES: 6}
"""Wavenumber along y, over the smallest length of the problem, below which an amplitude is its poles and this number of
powers from the constant on. Accuracy. The higher the pole (a double one if a sliding load off-centre turns the body),
the more it amplifies what the quadratures leave, if the wavenumber is much lower."""

PHASE_PER_NODE = 1.8
"""Phase that one Gauss node follows, radians. Accuracy."""

MOMENT_ORDER, MOMENT_PHASE = 16, 10.0
"""Gauss nodes, and the phase that they follow, for the integrals of powers. Accuracy."""

BATCH = 32
"""Columns, over all their wavenumbers, that share one set of points and one product along y. Speed."""


ANSWER = 4
"""Columns that cost as much as asking the body at one wavenumber costs without any. Speed."""


@dataclass(frozen=True, eq=False)
class LateralPanel:
    """Part of the integral over the wavenumber along y.

    Attributes
    ----------
    nodes : array
        Wavenumbers at which the body's answer is known, 1/m.
    fine, weights : array
        Quadrature nodes that follow the phase, and their weights; `nodes` themselves where these suffice.
    interpolation : array (fine, node), or None
        From `nodes` to `fine`; None where they are the same.
    reference : float or None
        If given, the nodes stand for an answer ``b / k**2 + c / k + d`` (more of them, for one with higher powers, and
        a higher pole) from 0 to the panel's end, whose integral is taken in closed form; the poles' are relative to
        ``|y| = reference``.
    poles : int
        Highest order of these poles.
    """

    nodes: FloatArray
    fine: FloatArray
    weights: FloatArray
    interpolation: FloatArray | None = None
    reference: float | None = None
    poles: int = POLES

    def waves(self, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """``cos(k y)`` and ``sin(k y)`` times the weights of the integral: arrays (fine, y)."""
        if self.reference is not None:
            first, terms = float(self.nodes[-1]), self.nodes.size - self.poles
            # Over the panel's end, for the powers to be alike.
            powers = (self.nodes[:, None] / first) ** np.arange(-self.poles, terms)
            scale = first ** np.arange(-self.poles, terms)
            waves = []
            for moments in (cosine_moments, sine_moments):
                own = moments(first, y, self.reference, terms)[BENDING_POLES - self.poles :]
                waves.append(np.asarray(np.linalg.solve(powers.T, own / scale[:, None]) / np.pi))
            return waves[0], waves[1]
        phase, weights = np.outer(self.fine, y), self.weights[:, None] / np.pi
        return np.cos(phase) * weights, np.sin(phase) * weights


@dataclass(frozen=True, eq=False)
class LateralColumns:
    """A load within one panel or a part of it, as few functions of x ("columns") for which the body is solved.

    Attributes
    ----------
    nodes : array
        Wavenumbers along y, 1/m.
    along_x : array (cell, node or 1, column)
        The functions of x.
    parities : array (column)
        1 or -1 for a part of the load even or odd about mid-length, 0 for a load that is not split.
    even, odd : array (node, column, y)
        From the answers to their sum at positions y, for what under a load even in y is even or odd.
    """

    nodes: FloatArray
    along_x: FloatArray
    parities: IntArray
    even: FloatArray
    odd: FloatArray

    def synthesis(self, load: Load, parity: int) -> tuple[FloatArray, FloatArray]:
        """`even` and `odd` of one parity for a load in one direction: arrays (node column, y).

        Kernels of a load that a reflection along y turns round carry a factor i, which turns a cosine into a sine.
        """
        own = self.parities == parity
        even, odd = (waves[:, own].reshape(-1, waves.shape[2]) for waves in (self.even, self.odd))
        return (even, odd) if load.sign_y > 0 else (odd, -even)

    def batches(self) -> Iterator[LateralColumns]:
        """Parts of about `BATCH` columns over all their nodes."""
        step = max(1, BATCH // max(1, self.parities.size))
        for start in range(0, self.nodes.size, step):
            part = slice(start, start + step)
            along_x = self.along_x if self.along_x.shape[1] == 1 else self.along_x[:, part]
            yield LateralColumns(self.nodes[part], along_x, self.parities, self.even[part], self.odd[part])


def lateral_panels(
    first: float,
    reach: float,
    last: float,
    resolution: Resolution,
    reference: float | None = None,
    poles: int = POLES,
) -> list[LateralPanel]:
    """Panels from 0 to `last`, growing from `first`, for phases over the distance `reach`.

    With a `reference`, answers have a pole at 0 up to the order `poles`, taken relative to ``|y| = reference``.

    Examples
    --------
    >>> panels = lateral_panels(1e-3, 30.0, 40.0, Resolution())
    >>> found = 0.0
    >>> for panel in panels:
    ...     answer = np.exp(-panel.nodes)
    ...     if panel.interpolation is not None:
    ...         answer = panel.interpolation @ answer
    ...     found += float(panel.waves(np.array([30.0]))[0][:, 0] @ answer) * np.pi
    >>> abs(found - 1 / 901) < 1e-5
    True
    """
    order = resolution.lateral_nodes
    count = max(1, int(np.ceil(np.log(last / first) / np.log(resolution.lateral_ratio))))
    edges = first * (last / first) ** (np.arange(count + 1) / count)
    nodes, weights = panel_nodes(np.array([0.0, first]), order)
    panels = [LateralPanel(nodes, nodes, weights)]
    for low, high in pairwise(edges):
        # The answers are smooth over the logarithm of the wavenumber.
        places, weights = panel_nodes(np.log([low, high]), order)
        nodes = np.exp(places)
        if high * np.log(high / low) * reach <= PHASE_PER_NODE * order:
            panels.append(LateralPanel(nodes, nodes, weights * nodes))
            continue
        pieces = int(np.ceil((high - low) * reach / (PHASE_PER_NODE * resolution.lateral_order)))
        fine, weights = panel_nodes(np.linspace(low, high, pieces + 1), resolution.lateral_order)
        panels.append(LateralPanel(nodes, fine, weights, lagrange(places, np.log(fine))))
    if reference is not None:
        count = poles + TERMS[poles]
        samples = first * np.arange(1.0, count + 1) / count
        panels[0] = LateralPanel(samples, samples, np.ones_like(samples), reference=reference, poles=poles)
    return panels


def lateral_columns(
    panel: LateralPanel, parts: Mapping[int, FloatArray], grid: Grid, y: FloatArray
) -> LateralColumns | None:
    """Columns of the `parts` (by parity) of a cell-wise uniform load within one panel; None if there are none."""
    width = grid.dy * np.sinc(panel.fine * grid.dy / (2 * np.pi))
    phase = np.outer(grid.y, panel.fine)
    waves = [function(phase) * width for function in (np.cos, np.sin)]
    cosine, sine = panel.waves(y)
    along_x, parities, even, odd = [], [], [], []
    spectra_of = {parity: [cells @ wave for wave in waves] for parity, cells in parts.items()}
    least = NEGLIGIBLE * max((np.abs(each).max() for own in spectra_of.values() for each in own), default=0.0)
    for parity, spectra in spectra_of.items():
        for spectrum, at_even, at_odd in zip(spectra, (cosine, sine), (-sine, cosine), strict=True):
            if np.abs(spectrum).max() > least:
                along_x.append(spectrum)
                parities.append(parity)
                even.append(at_even)
                odd.append(at_odd)
    if not along_x:
        return None
    columns = LateralColumns(
        panel.fine, np.stack(along_x, axis=-1), np.array(parities), np.stack(even, axis=1), np.stack(odd, axis=1)
    )
    return columns if panel.interpolation is None else _at_nodes(columns, panel.nodes, panel.interpolation)


def _at_nodes(columns: LateralColumns, nodes: FloatArray, interpolation: FloatArray) -> LateralColumns:
    """Return the same load as few functions of x at few nodes; as it is, if that is not less to solve for."""
    cells, fine, given = columns.along_x.shape
    along_x, parities, factors = [], [], []
    for parity in np.unique(columns.parities):
        own = columns.parities == parity
        left, values, right = np.linalg.svd(columns.along_x[..., own].reshape(cells, -1), full_matrices=False)
        rank = int((values > LEAST_PRODUCT * values[0]).sum())
        along = (values[:rank, None] * right[:rank]).reshape(rank, fine, -1)
        along_x.append(left[:, :rank])
        parities.append(np.full(rank, parity))
        factors.append((own, interpolation.T[:, None, :, None] * along))
    count = np.concatenate(parities)
    if nodes.size * (ANSWER + count.size) >= fine * (ANSWER + given):
        return columns
    even, odd = (
        np.concatenate([np.tensordot(factor, waves[:, own], axes=2) for own, factor in factors], axis=1)
        for waves in (columns.even, columns.odd)
    )
    return LateralColumns(nodes, np.concatenate(along_x, axis=1)[:, None, :], count, even, odd)


def cosine_moments(first: float, y: FloatArray, reference: float, terms: int = 1) -> FloatArray:
    """Integrals of ``cos(k y)`` times ``k**-3, k**-2, k**-1, 1, ...`` over k from 0 to `first`: array (3 + terms, y).

    The poles' are relative to ``|y| = reference``, of which all wavenumbers are taken here: with the integrals from
    `first` on they sum up to functions that are zero there,

        k**-3: y**2 / 2 ln(|y| / r) + 3 / 4 (r**2 - y**2),   k**-2: pi / 2 (r - |y|),   k**-1: ln(r / |y|),

    of which the first has no curvature there either. They stand for rigid motions (and, the first one, for pure bending
    of the body about its depth), and no more than these is to be moved.
    """
    from scipy.special import sici

    distance = np.maximum(np.abs(y), 1e-30 / first)
    argument = first * distance
    sine_integral, cosine_integral = sici(argument)
    logarithm = cosine_integral - np.log(distance / reference)
    bent = 0.75 * (reference**2 - distance**2) - 0.5 * distance**2 * logarithm
    return np.array(
        [
            bent - 0.5 * (np.cos(argument) / first - distance * np.sin(argument)) / first,
            (-np.cos(argument)) / first - distance * sine_integral + 0.5 * np.pi * reference,
            logarithm,
            *_powers(np.cos, first, y, terms),
        ]
    )


def sine_moments(first: float, y: FloatArray, reference: float, terms: int = 1) -> FloatArray:
    """Likewise of ``sin(k y)``, such that where a cosine's is integrated along y, its motion is moved with it."""
    from scipy.special import sici

    argument = first * y
    _, second, pole = cosine_moments(first, y, reference, 0)
    return np.array(
        [
            0.5 * y * (second + 0.5 * np.pi * reference) - 0.5 * np.sin(argument) / first**2,
            y * (1 - np.sinc(argument / np.pi) + pole),
            sici(argument)[0],
            *_powers(np.sin, first, y, terms),
        ]
    )


def _powers(wave: Callable[[FloatArray], FloatArray], first: float, y: FloatArray, terms: int) -> FloatArray:
    """Integrals of ``wave(k y)`` times ``1, k, k**2, ...`` over k from 0 to `first`: array (terms, y)."""
    pieces = max(1, int(np.ceil(first * np.abs(y).max(initial=0.0) / MOMENT_PHASE)))
    nodes, weights = panel_nodes(np.linspace(0.0, first, pieces + 1), MOMENT_ORDER)
    return np.asarray((nodes[:, None] ** np.arange(terms) * weights[:, None]).T @ wave(np.outer(nodes, y)))
