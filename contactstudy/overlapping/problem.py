"""A load on the top of a body with free ends, in axial modes and few wavenumbers ``k_y`` along the rolling.

The amplitudes of the body vary slowly with ``k_y``, the phase ``k_y y`` of load and position fast. The equation sets
are solved at the Gauss nodes of panels that grow from 0, and the amplitudes interpolated to the many nodes of the
phase. Within a panel a load is a sum of few products of a function of x and a function of ``k_y`` (a singular value
decomposition), and only these functions of x, the columns, are right-hand sides. Nodes and panels depend on the body,
the window and the positions: fields of loads add up.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from contactstudy.arrays.grid import EDGE_ROUNDING, Grid
from contactstudy.arrays.peaks import lagrange_weights
from contactstudy.cache import cached
from contactstudy.checks import ComplexArray, FloatArray, IntArray
from contactstudy.errors import InvalidInputError
from contactstudy.kernels.load import Load
from contactstudy.overlapping.equations import AxialModes, axial_modes
from contactstudy.overlapping.quadrature import Resolution, panel_nodes

NEGLIGIBLE_LOAD = 1e-11  # neglected share of a load; fields of several loads add up to this accuracy. Rounding.

POLES, BENDING_POLES = 2, 3
"""Order of an amplitude's pole at wavenumber 0, eq. (30); 3 if a force along x bends the body, eq. (30a). Physics."""

POLE_PANEL_FACTOR, POLE_TERMS = {POLES: 0.1, BENDING_POLES: 1.0}, {POLES: 4, BENDING_POLES: 6}
"""Wavenumber along y, over the smallest length of the problem, below which an amplitude is a sum of poles and powers,
and the number of the powers. Accuracy. The higher the pole (a double one if a sliding load off-centre turns the body),
the more it amplifies the quadrature errors of a much lower wavenumber."""

BLOCK_SIZE = 2048  # quadrature nodes whose waves are in memory at a time. Speed.
PHASE_PER_NODE = 1.8  # phase that one Gauss node follows, radians. Accuracy.

MOMENT_ORDER, MOMENT_PHASE = 16, 10.0
"""Gauss nodes, and the phase that they follow, for the integrals of powers. Accuracy."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LateralPanel:
    """Panel of the integral over the wavenumber along y."""

    nodes: FloatArray  # wavenumbers of the equation sets, 1/m
    fine_nodes: FloatArray  # quadrature nodes that follow the phase, and their weights; may be `nodes`
    weights: FloatArray
    interpolation: FloatArray | None = None  # (fine, node): from `nodes` to `fine_nodes`; None where they are the same
    reference: float | None = None
    """If given, the nodes represent an amplitude ``b / k**2 + c / k + d`` (with more powers and a higher pole, with
    more nodes) from 0 to the panel's end. The integral is a closed form, for the poles relative to ``|y| =
    reference``."""
    poles: int = POLES  # highest order of these poles

    def waves(self, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """``cos(k y)`` and ``sin(k y)`` times the weights of the integral: arrays (fine, y)."""
        return self.wave(y, 1), self.wave(y, -1)

    def wave(self, y: FloatArray, sign_y: int) -> FloatArray:
        """``cos(k y)``, even in y, or ``sin(k y)``, odd, times the weights of the integral: array (fine, y)."""
        if self.reference is not None:
            panel_end, terms = float(self.nodes[-1]), self.nodes.size - self.poles
            # Wavenumbers are divided by the panel's end, so that their powers are of similar size.
            powers = (self.nodes[:, None] / panel_end) ** np.arange(-self.poles, terms)
            scale = panel_end ** np.arange(-self.poles, terms)
            compute_moments = cosine_moments if sign_y > 0 else sine_moments
            integrals = compute_moments(panel_end, y, self.reference, terms)[BENDING_POLES - self.poles :]
            return np.asarray(np.linalg.solve(powers.T, integrals / scale[:, None]) / np.pi)
        compute_wave = np.cos if sign_y > 0 else np.sin
        return np.asarray(compute_wave(np.outer(self.fine_nodes, y)) * (self.weights[:, None] / np.pi))

    def node_waves(self, y: FloatArray, sign_y: int, factors: FloatArray) -> FloatArray:
        """Integrals of ``cos(k y)`` or ``sin(k y)`` times `factors` (fine) under unit amplitudes: array (node, y)."""
        if self.interpolation is None:
            return factors[:, None] * self.wave(y, sign_y)
        total = np.zeros((self.nodes.size, y.size))
        for first in range(0, self.fine_nodes.size, BLOCK_SIZE):
            block = slice(first, first + BLOCK_SIZE)
            panel = replace(self, fine_nodes=self.fine_nodes[block], weights=self.weights[block] * factors[block])
            total += self.interpolation[block].T @ panel.wave(y, sign_y)
        return total

    def load_waves(self, grid: Grid) -> tuple[FloatArray, FloatArray]:
        """Integrals of ``cos(k y)`` and ``sin(k y)`` over the cells along y: arrays (cell, fine)."""
        width = grid.dy * np.sinc(self.fine_nodes * grid.dy / (2 * np.pi))
        phase = np.outer(grid.y, self.fine_nodes)
        return np.cos(phase) * width, np.sin(phase) * width

    def filters(self, grid: Grid, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Matrices (node, cell, y) from even and odd loads on cells to each node's contribution at positions `y`."""
        (load_cosine, load_sine), (cosine, sine) = self.load_waves(grid), self.waves(y)
        interpolation = np.eye(self.nodes.size) if self.interpolation is None else self.interpolation
        even_filters = [(load_cosine * column) @ cosine + (load_sine * column) @ sine for column in interpolation.T]
        odd_filters = [(load_sine * column) @ cosine - (load_cosine * column) @ sine for column in interpolation.T]
        return np.array(even_filters), np.array(odd_filters)


@dataclass(frozen=True, kw_only=True, eq=False)
class LateralColumns:
    """A load within one panel, as few functions of x ("columns")."""

    nodes: FloatArray  # wavenumbers along y, 1/m
    along_x: FloatArray  # (cell, node or 1, column): the functions of x
    parities: IntArray  # (column): 1 or -1 for an even or odd part of the load, 0 for an unsplit load
    along_y: Mapping[int, FloatArray] = field(default_factory=dict)
    """Per parity, from the amplitudes to the quadrature nodes of the parts of the load even and odd along y: arrays (2,
    node column, fine); empty for operators that filter along y themselves."""

    def synthesis(self, load: Load, parity: int, waves: tuple[FloatArray, FloatArray]) -> tuple[FloatArray, FloatArray]:
        """Matrices (node column, y) from amplitudes of one parity to their sum at the positions of the `waves`."""
        # The matrices are for components even and odd under a load even in y. Kernels of a load that a reflection along
        # y reverses carry a factor i, which turns a cosine into a sine.
        (even_part, odd_part), (cosine, sine) = self.along_y[parity], waves
        even_filters, odd_filters = even_part @ cosine + odd_part @ sine, odd_part @ cosine - even_part @ sine
        return (even_filters, odd_filters) if load.sign_y > 0 else (odd_filters, -even_filters)


@cached("lateral panels")
def lateral_panels(
    first: float,
    max_distance: float,
    last: float,
    resolution: Resolution,
    reference: float | None = None,
    poles: int = POLES,
) -> list[LateralPanel]:
    """Panels from 0 to `last`, growing from `first`, for phases over the distance `max_distance`."""
    # With a `reference`, amplitudes have a pole at 0 up to the order `poles`, taken relative to ``|y| = reference``.
    order = resolution.lateral_nodes
    count = max(1, int(np.ceil(np.log(last / first) / np.log(resolution.lateral_ratio))))
    edges = first * (last / first) ** (np.arange(count + 1) / count)
    nodes, weights = panel_nodes(np.array([0.0, first]), order)
    panels = [LateralPanel(nodes=nodes, fine_nodes=nodes, weights=weights)]
    for low, high in pairwise(edges):
        # Amplitudes are smooth over the logarithm of the wavenumber.
        log_nodes, weights = panel_nodes(np.log([low, high]), order)
        nodes = np.exp(log_nodes)
        if high * np.log(high / low) * max_distance <= PHASE_PER_NODE * order:
            panels.append(LateralPanel(nodes=nodes, fine_nodes=nodes, weights=weights * nodes))
            continue
        panel_count = int(np.ceil((high - low) * max_distance / (PHASE_PER_NODE * resolution.lateral_order)))
        fine_nodes, weights = panel_nodes(np.linspace(low, high, panel_count + 1), resolution.lateral_order)
        panels.append(
            LateralPanel(
                nodes=nodes,
                fine_nodes=fine_nodes,
                weights=weights,
                interpolation=lagrange_weights(log_nodes, np.log(fine_nodes)),
            )
        )
    if reference is not None:
        count = poles + POLE_TERMS[poles]
        samples = first * np.arange(1.0, count + 1) / count
        panels[0] = LateralPanel(
            nodes=samples, fine_nodes=samples, weights=np.ones_like(samples), reference=reference, poles=poles
        )
    return panels


def lateral_columns(panel: LateralPanel, parity_loads: Mapping[int, FloatArray], grid: Grid) -> LateralColumns | None:
    """Columns of the `parity_loads` of a cell-wise uniform load within one panel; None if the panel needs no column."""
    # With an interpolation the load is represented by few functions of x at few nodes.
    waves, fine_count = panel.load_waves(grid), panel.fine_nodes.size
    parity_spectra = {parity: [cell_loads @ wave for wave in waves] for parity, cell_loads in parity_loads.items()}
    min_amplitude = NEGLIGIBLE_LOAD * max(
        (np.abs(amplitude).max() for amplitudes in parity_spectra.values() for amplitude in amplitudes), default=0.0
    )
    along_x, along_y, parities = [], {}, []
    for parity, spectra in parity_spectra.items():
        parts = [part for part, spectrum in enumerate(spectra) if np.abs(spectrum).max() > min_amplitude]
        if not parts:
            continue
        functions = np.stack([spectra[part] for part in parts], axis=-1)  # (cell, fine, part)
        if panel.interpolation is None:
            along_nodes = np.eye(fine_count)[None, :, None, :] * np.eye(len(parts))[:, None, :, None]
        else:
            matrix = functions.reshape(functions.shape[0], -1)
            along_cells, singular_values, right_vectors = np.linalg.svd(matrix, full_matrices=False)
            rank = int((singular_values > NEGLIGIBLE_LOAD * singular_values[0]).sum())
            functions = along_cells[:, None, :rank]
            factors = (singular_values[:rank, None] * right_vectors[:rank]).reshape(rank, fine_count, -1)
            along_nodes = panel.interpolation.T[None, :, None, :] * factors.transpose(2, 0, 1)[:, None]
        along_x.append(functions)
        parities.append(np.full(functions.shape[2], parity))
        along_y[parity] = np.zeros((2, along_nodes[0, ..., 0].size, fine_count))
        along_y[parity][parts] = along_nodes.reshape(len(parts), -1, fine_count)
    if not along_x:
        return None
    return LateralColumns(
        nodes=panel.nodes, along_x=np.concatenate(along_x, axis=2), parities=np.concatenate(parities), along_y=along_y
    )


def cosine_moments(panel_end: float, y: FloatArray, reference: float, terms: int = 1) -> FloatArray:
    """Integrals of ``cos(k y)`` times ``k**-3, k**-2, k**-1, 1, ...`` over k from 0 to `panel_end`: (3 + terms, y)."""
    # Integrals of poles are finite parts, zero at ``|y| = reference = r``. Over all k, past `panel_end` too, they are,
    # k**-3: y**2 / 2 ln(|y| / r) + 3 / 4 (r**2 - y**2),   k**-2: pi / 2 (r - |y|),   k**-1: ln(r / |y|).
    from scipy.special import sici

    distance = np.maximum(np.abs(y), 1e-30 / panel_end)
    argument = panel_end * distance
    sine_integral, cosine_integral = sici(argument)
    logarithm = cosine_integral - np.log(distance / reference)
    cubic_pole = 0.75 * (reference**2 - distance**2) - 0.5 * distance**2 * logarithm  # eq. (30c)
    return np.array(
        [
            cubic_pole - 0.5 * (np.cos(argument) / panel_end - distance * np.sin(argument)) / panel_end,
            (-np.cos(argument)) / panel_end - distance * sine_integral + 0.5 * np.pi * reference,
            logarithm,
            *_power_moments(np.cos, panel_end, y, terms),
        ]
    )


def sine_moments(panel_end: float, y: FloatArray, reference: float, terms: int = 1) -> FloatArray:
    """Integrals of ``sin(k y)`` times the same powers, consistent with `cosine_moments` integrated along y."""
    from scipy.special import sici

    argument = panel_end * y
    _, double_pole, simple_pole = cosine_moments(panel_end, y, reference, 0)
    return np.array(
        [
            0.5 * y * (double_pole + 0.5 * np.pi * reference) - 0.5 * np.sin(argument) / panel_end**2,
            y * (1 - np.sinc(argument / np.pi) + simple_pole),
            sici(argument)[0],
            *_power_moments(np.sin, panel_end, y, terms),
        ]
    )


def _power_moments(wave: Callable[[FloatArray], FloatArray], panel_end: float, y: FloatArray, terms: int) -> FloatArray:
    """Integrals of ``wave(k y)`` times ``1, k, k**2, ...`` over k from 0 to `panel_end`: array (terms, y)."""
    panel_count = max(1, int(np.ceil(panel_end * np.abs(y).max(initial=0.0) / MOMENT_PHASE)))
    nodes, weights = panel_nodes(np.linspace(0.0, panel_end, panel_count + 1), MOMENT_ORDER)
    return np.asarray((nodes[:, None] ** np.arange(terms) * weights[:, None]).T @ wave(np.outer(nodes, y)))


CORNER_OFFSET = 1e-2
"""Depth below a loaded corner, over a cell, at which points on the corner are evaluated. Accuracy. H and V each have a
logarithm at the corner; their sum is finite."""

FIRST_PANEL_FACTOR = 0.1
"""End of the first panel along ``k_y``, over the smallest length of the problem, of a field without poles. Accuracy."""

MIN_LENGTH_RATIO = 0.004
"""Least length of a body over the width of the load. Accuracy: at this length the ends keep a stress of 6e-4 of the
pressure, at a third of this length a tenth."""


@dataclass(frozen=True, kw_only=True, eq=False)
class EndProblem:
    """A distribution of load on the top of a body with one end or two, acting in one direction or in several."""

    length: float  # distance between the ends, metres; infinite for one end
    poisson: float
    cell_loads: FloatArray  # (cell_x, cell_y): load per area on the cells of `grid`, Pa
    loads: tuple[Load, ...]  # directions of the load, each a separate problem; mirror images keep all or reverse all
    grid: Grid  # cells, from ``x = 0``
    resolution: Resolution  # quadrature settings
    mirrored_once: bool = False  # whether loads have one pair of images only instead of all
    finest: float | None = None  # size of the cells of the given load, metres, if `grid` is finer

    def __post_init__(self) -> None:
        loaded_rows = np.flatnonzero(self.cell_loads.any(axis=0))
        width = self.grid.dy * (loaded_rows[-1] - loaded_rows[0] + 1) if loaded_rows.size else 0.0
        if self.length < MIN_LENGTH_RATIO * width:
            raise InvalidInputError(
                "body.length",
                self.length,
                f"at least {MIN_LENGTH_RATIO:g} of the width of the contact, {width:.3g} m: the traction left on the "
                "ends of a thinner body exceeds 1e-3 of the pressure",
                "such a disc is in plane stress",
            )

    @cached_property
    def column_edges(self) -> FloatArray:
        """Edges of the columns, metres: edges of the cells and, between two ends, mirror images of these edges."""
        edges = self.grid.x_edges
        if self.grid.uniform or np.isinf(self.length):
            return edges
        symmetric_edges = np.union1d(edges, self.length - edges)
        symmetric_edges = symmetric_edges[np.append(True, np.diff(symmetric_edges) > EDGE_ROUNDING * self.length)]
        symmetric_edges[0], symmetric_edges[-1] = 0.0, self.length
        return np.asarray(0.5 * (symmetric_edges + self.length - symmetric_edges[::-1]))

    @cached_property
    def cell_of_column(self) -> IntArray:
        """Index of the cell that contains each column."""
        edges = self.column_edges
        cells = np.searchsorted(self.grid.x_edges, 0.5 * (edges[1:] + edges[:-1])) - 1
        return np.asarray(np.clip(cells, 0, self.grid.cells_x - 1))

    @property
    def sign_x(self) -> int:
        """1 if a mirror image keeps the loads, -1 if it reverses them."""
        return self.loads[0].sign_x

    @cached_property
    def by_mirror_sign(self) -> list[EndProblem]:
        """Problem of the loads that images keep, and problem of the loads that images reverse."""
        groups = (tuple(load for load in self.loads if load.sign_x == sign) for sign in (1, -1))
        return [replace(self, loads=loads, resolution=self.resolution.for_loads(loads)) for loads in groups if loads]

    def split_by_parity(self, cell_loads: FloatArray) -> dict[int, FloatArray]:
        """Return a load on the columns (column, y), between two ends its even (1) and odd (-1) parts."""
        column_loads = cell_loads[self.cell_of_column]
        return {0: column_loads} if np.isinf(self.length) else split_by_parity(column_loads, self.sign_x)

    @property
    def corner_offset(self) -> float:
        """Least distance of evaluated positions from the corner, metres."""
        return CORNER_OFFSET * self.finest_size

    @property
    def finest_size(self) -> float:
        """Size of a cell, metres; of graded cells the size along y."""
        return self.finest or finest_cell(self.grid)

    def smallest_scale(self, nearest: float) -> float:
        """Smallest relevant distance from a corner, for positions at least `nearest` from the corner, metres."""
        # A field depends on the steps of the load near a corner, at distant positions as well; every edge is
        # included, so that fields of loads add up.
        inner_edges = self.column_edges[1:-1]
        return max(min(nearest, float(self.from_end(inner_edges).min(initial=nearest))), self.corner_offset)

    def from_end(self, x: FloatArray) -> FloatArray:
        """Distance of positions from the nearest end."""
        return np.minimum(x, self.length - x)

    def panels(self, y: FloatArray, shortest: float, reference: float | None = None) -> list[LateralPanel]:
        """Panels along ``k_y`` for points at `y` no nearer than `shortest` to a loaded corner."""
        grid = self.grid
        # Points inside the window have equal panels: they share the auxiliary loads.
        half_window = max(map(abs, grid.y_range))
        max_distance = half_window + max(half_window, np.abs(y).max())
        poles = BENDING_POLES if self.sign_x < 0 else POLES
        first_panel_factor = FIRST_PANEL_FACTOR if reference is None else POLE_PANEL_FACTOR[poles]
        first_wavenumber = first_panel_factor / min(self.length, 4 * max(grid.x_range[1], max_distance))
        # Along y the load is uniform in cells: half a cell is the finest scale.
        last_wavenumber = self.resolution.lateral_reach / max(shortest, 0.5 * self.finest_size)
        return lateral_panels(first_wavenumber, max_distance, last_wavenumber, self.resolution, reference, poles=poles)


def finest_cell(grid: Grid) -> float:
    """Size of a cell, metres; of graded cells the size along y."""
    return min(grid.dx, grid.dy) if grid.uniform else grid.dy


def split_by_parity(cell_loads: FloatArray, sign_x: int) -> dict[int, FloatArray]:
    """Even (1) and odd (-1) parts of a load (x, y) about mid-length, if not negligible; `sign_x` -1 swaps the parts."""
    parity_loads = {parity: 0.5 * (cell_loads + sign_x * parity * cell_loads[::-1]) for parity in (1, -1)}
    min_amplitude = NEGLIGIBLE_LOAD * np.abs(cell_loads).max()
    return {
        parity: parity_load for parity, parity_load in parity_loads.items() if np.abs(parity_load).max() > min_amplitude
    }


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """A load in one set of axial modes."""

    modes: AxialModes
    spectra: ComplexArray  # (axial wavenumber, node or 1, column)
    columns: IntArray  # indices of the columns
    end: float  # position of the end from which distances are counted, metres

    def positions(self, x: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return indices of the positions within reach among `x`, and their distances from the end."""
        distance = np.abs(x - self.end)
        rows = np.flatnonzero(distance <= self.modes.reach)
        return rows, distance[rows]


def make_views(problem: EndProblem, load: LateralColumns, shortest: float) -> list[View]:
    """Return views of a load, one per set of axial modes."""
    # Ends too far apart to interact are two quarter spaces; a load split by parity has positions in the first half.
    length, edges = problem.length, problem.column_edges
    is_split = bool(load.parities.all())
    views = []
    for modes in axial_modes(
        length, float(load.nodes[0]), shortest, problem.resolution, mirrored_once=problem.mirrored_once
    ):
        columns = np.flatnonzero((load.parities == modes.parity) | (load.parities == 0) | (modes.parity == 0))
        if not columns.size:
            continue
        integrals = modes.load_weights[:, None] * modes.cell_integrals(problem.loads[0], edges)
        for end in (0.0, length) if np.isfinite(length) and not modes.parity and not is_split else (0.0,):
            end_integrals = problem.sign_x * integrals[:, ::-1] if end else integrals
            spectra = np.tensordot(end_integrals, load.along_x[..., columns], axes=1)
            views.append(View(modes=modes, spectra=spectra, columns=columns, end=end))
    return views
