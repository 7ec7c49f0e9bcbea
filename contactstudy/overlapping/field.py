"""Stresses and displacements of the free ends, to be added to the field of the mirrored half-space.

For each wavenumber along y the equivalent load ``R`` (in H) and the face loads ``S`` (in V) are evaluated on their
rays, where every factor decays with the distance from the loaded corner; the field is a sum of separable terms
``f(k, x) g(k, z)``, the harmonics of H and of V: matrix products. At a high wavenumber only positions within reach of a
corner are evaluated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from contactstudy.arrays.grid import Points
from contactstudy.cache import cached
from contactstudy.checks import ComplexArray, FloatArray, IntArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.equations import DECAY_LENGTHS, AuxiliaryLoads, AxialModes, EquationSet, real_product
from contactstudy.overlapping.problem import (
    EndProblem,
    LateralColumns,
    LateralPanel,
    View,
    lateral_columns,
    make_views,
)
from contactstudy.overlapping.quadrature import graded_interpolation
from contactstudy.threads import one_blas_thread

POSITION_DIGITS = 12  # digits of positions over the length that are compared for symmetry. Rounding.


@dataclass(frozen=True, kw_only=True)
class Harmonics:
    """A field of H under the equivalent load and of V under the face loads, for some wavenumbers along y."""

    equivalent_load_field: Callable[[AuxiliaryLoads, ComplexArray, ComplexArray, FloatArray], FloatArray]
    """From auxiliary loads, cosine, sine (mode, x) and depths to amplitudes (load, component, x, z, node, column)."""
    face_load_field: Callable[[AuxiliaryLoads, FloatArray, FloatArray], FloatArray]
    """From auxiliary loads, distances from the end and depths to amplitudes of the same shape."""
    count: int  # number of components
    even_in_y: list[int]  # components that under a pressure even in y are even; the others are odd
    odd_along_x: list[int]  # components that change sign from one end to the other
    growing_signs: tuple[int, ...]  # signs of mirror images with which the field between two ends grows far along y


class _FoldedPositions:
    """Positions at which waves are summed: few distances from the nearest end, none on the loaded corner."""

    def __init__(self, problem: EndProblem, points: Points) -> None:
        # Many positions along x are interpolated from fewer, graded towards the ends.
        length, offset = problem.length, problem.corner_offset
        grading = graded_interpolation(points.x, length)
        positions = points.x if grading is None else grading[0]
        self._interpolation = None if grading is None else grading[1]
        self.x, self._distance_indices = positions, np.arange(positions.size)
        if np.isfinite(length):
            distances, self._distance_indices = np.unique(
                np.round(problem.from_end(positions) / length, POSITION_DIGITS), return_inverse=True
            )
            self.x = length * distances
        self._in_far_half = positions > 0.5 * length
        # The last depth is a little below the corner if the corner is a position.
        self._corner = np.flatnonzero(self.x < offset), np.flatnonzero(points.z < offset)
        self._has_corner = bool(self._corner[0].size and self._corner[1].size)
        self.y, self.z = points.y, np.append(points.z, offset) if self._has_corner else points.z

    @property
    def distance(self) -> FloatArray:
        """Distance of the points from the loaded corner: array (x, z)."""
        distance = np.hypot(self.x[:, None], self.z[None, :])
        if self._has_corner:
            distance[np.ix_(*self._corner)] = np.inf
        return distance

    def unfold(self, fields: Mapping[int, FloatArray], odd_along_x: list[int]) -> FloatArray:
        """Field (load, component, x, y, z) at all positions from the sums by parity (load, component, x, z, y)."""
        if self._has_corner:
            rows, columns = self._corner
            for field in fields.values():
                field[:, :, rows[:, None], columns] = field[:, :, rows, -1:]
            fields = {parity: field[:, :, :, :-1] for parity, field in fields.items()}
        total: FloatArray | None = None
        for parity, field in fields.items():
            far_signs = np.array(
                [-parity if component in odd_along_x else parity for component in range(field.shape[1])]
            )
            # With one end no position lies beyond mid-length.
            position_field = field[:, :, self._distance_indices]
            position_field *= np.where(self._in_far_half & (parity != 0), far_signs[:, None], 1)[..., None, None]
            total = position_field if total is None else np.add(total, position_field, out=total)
        assert total is not None
        if self._interpolation is not None:
            interpolated_field = self._interpolation @ total.reshape(*total.shape[:3], -1)
            total = interpolated_field.reshape(*interpolated_field.shape[:3], *total.shape[3:])
        return np.asarray(total.swapaxes(3, 4))


def end_fields(
    problem: EndProblem, harmonics: Harmonics, point_sets: Sequence[Points], reference: float = np.inf
) -> list[dict[Load, FloatArray]]:
    """Field of the free ends, without the half-space with all mirrored loads: arrays (component, x, y, z)."""
    # A field that grows with distance is relative to ``|y| = reference`` if `reference` is finite.
    fields: list[dict[Load, FloatArray]] = [{} for _ in point_sets]
    with one_blas_thread():
        for subproblem in problem.by_mirror_sign:
            folded_sets = [_FoldedPositions(subproblem, points) for points in point_sets]
            parity_fields = _sum_over_wavenumbers(subproblem, harmonics, folded_sets, reference)
            for load_fields, points, sums in zip(fields, folded_sets, parity_fields, strict=True):
                load_fields |= dict(zip(subproblem.loads, points.unfold(sums, harmonics.odd_along_x), strict=True))
    return fields


def _sum_over_wavenumbers(
    problem: EndProblem, harmonics: Harmonics, point_sets: list[_FoldedPositions], reference: float
) -> list[dict[int, FloatArray]]:
    """Field (load, component, x, z, y) by parity: the integral over the wavenumber along y."""
    counts, parities = (len(problem.loads), harmonics.count), problem.split_by_parity(problem.cell_loads)
    parity_fields = [
        {parity: np.zeros((*counts, points.x.size, points.z.size, points.y.size)) for parity in parities}
        for points in point_sets
    ]
    y_stops = np.cumsum([points.y.size for points in point_sets])
    y = np.concatenate([points.y for points in point_sets])
    panels = _panel_amplitudes(problem, harmonics, point_sets, reference, _solve_panel)
    for panel, columns, indices, amplitudes in panels:
        waves = panel.waves(y)
        for parity in columns.along_y:
            for i, load in enumerate(problem.loads):
                even_waves, odd_waves = columns.synthesis(load, parity, waves)
                for total, (rows, depths), stop, set_amplitudes in zip(
                    parity_fields, indices, y_stops, amplitudes, strict=True
                ):
                    if not rows.size:
                        continue
                    columns_of_parity = set_amplitudes[i][..., columns.parities == parity]
                    section = slice(stop - total[parity].shape[-1], stop)
                    shape, block = (rows.size, depths.size, -1), np.ix_(rows, depths)
                    for component in range(harmonics.count):
                        wave = even_waves if component in harmonics.even_in_y else odd_waves
                        amplitude_rows = columns_of_parity[component].reshape(rows.size * depths.size, -1)
                        total[parity][i, component][block] += (amplitude_rows @ wave[:, section]).reshape(shape)
    return parity_fields


class SolvedPanel(NamedTuple):
    """Loads on the auxiliary bodies within one panel, which all points share."""

    columns: LateralColumns
    views: list[tuple[View, AuxiliaryLoads]]


@cached("auxiliary loads")
def _solve_panel(problem: EndProblem, panel: LateralPanel, shortest: float) -> SolvedPanel | None:
    """Solve for the auxiliary loads of a problem within one panel; None if the panel needs no column."""
    columns = lateral_columns(panel, problem.split_by_parity(problem.cell_loads), problem.grid)
    return None if columns is None else _solve_columns(problem, columns, shortest)


def _solve_columns(problem: EndProblem, columns: LateralColumns, shortest: float) -> SolvedPanel:
    """Solve for the auxiliary loads of columns."""
    poisson, settings = problem.poisson, problem.resolution
    views = []
    for view in make_views(problem, columns, shortest):
        node_loads = [
            EquationSet.build(view.modes, lateral, poisson, shortest, settings).auxiliary_loads(
                view.spectra[:, min(node, view.spectra.shape[1] - 1)],
                problem.loads,
                shortest=shortest,
                resolution=settings,
            )
            for node, lateral in enumerate(columns.nodes.tolist())
        ]
        views.append((view, AuxiliaryLoads.join(node_loads)))
    return SolvedPanel(columns, views)


def _panel_amplitudes(
    problem: EndProblem,
    harmonics: Harmonics,
    point_sets: list[_FoldedPositions],
    reference: float,
    solve: Callable[[EndProblem, LateralPanel, float], SolvedPanel | None],
) -> Iterator[tuple[LateralPanel, LateralColumns, list[tuple[IntArray, IntArray]], list[FloatArray]]]:
    """Yield panels, columns, indices of x and z within reach, and amplitudes, per set of points."""
    distances = [points.distance for points in point_sets]
    nearest = min(float(distance.min()) for distance in distances)
    shortest = problem.smallest_scale(nearest)
    field_grows = np.isfinite(reference) and problem.sign_x in harmonics.growing_signs
    y = np.concatenate([points.y for points in point_sets])
    for panel in problem.panels(y, shortest, reference if field_grows else None):
        if panel.nodes[0] * nearest >= DECAY_LENGTHS:
            break
        solved_panel = solve(problem, panel, shortest)
        if solved_panel is None:
            continue
        is_near = [panel.nodes[0] * distance < DECAY_LENGTHS for distance in distances]
        indices = [(np.flatnonzero(near.any(axis=1)), np.flatnonzero(near.any(axis=0))) for near in is_near]
        axes = [(points.x[rows], points.z[depths]) for points, (rows, depths) in zip(point_sets, indices, strict=True)]
        amplitudes = _compute_amplitudes(solved_panel, harmonics, axes, len(problem.loads))
        yield panel, solved_panel.columns, indices, amplitudes


class UnitFields(NamedTuple):
    """Field of the free ends under unit loads on the cells along x, in one panel of wavenumbers along y."""

    # The field under a load (cell_x, cell_y) is the sum of ``amplitudes`` times the load times the filters.

    amplitudes: FloatArray  # (component, x, node, cell_x, z): amplitudes at the nodes
    filters: FloatArray  # (component, node, cell_y, y): from a load along y to the node's field at the positions y


def unit_fields(problem: EndProblem, harmonics: Harmonics, points: Points, reference: float) -> Iterator[UnitFields]:
    """Yield the field of the free ends under unit loads in the direction of a problem, panel by panel."""
    (load,) = problem.loads
    folded = _FoldedPositions(problem, points)
    parity_loads = problem.split_by_parity(np.eye(problem.grid.cells_x))
    parities = np.repeat(list(parity_loads), problem.grid.cells_x)
    unit_loads = np.concatenate(list(parity_loads.values()), axis=1)[:, None, :]

    def solve(problem: EndProblem, panel: LateralPanel, shortest: float) -> SolvedPanel:
        columns = LateralColumns(nodes=panel.nodes, along_x=unit_loads, parities=parities)
        return _solve_columns(problem, columns, shortest)

    for panel, _, ((rows, depths),), (amplitudes,) in _panel_amplitudes(problem, harmonics, [folded], reference, solve):
        shape = (1, harmonics.count, folded.x.size, folded.z.size, panel.nodes.size, problem.grid.cells_x)
        fields = {}
        for parity in parity_loads:
            field = np.zeros(shape)
            field[:, :, rows[:, None], depths] = amplitudes[..., parities == parity]
            fields[parity] = field.reshape(*shape[:4], -1)
        field_at_nodes = folded.unfold(fields, harmonics.odd_along_x)[0]
        even_filters, odd_filters = panel.filters(problem.grid, points.y)
        even_filters, odd_filters = (even_filters, odd_filters) if load.sign_y > 0 else (odd_filters, -even_filters)
        filters = np.stack(
            [even_filters if component in harmonics.even_in_y else odd_filters for component in range(harmonics.count)]
        )
        component_count, x_count = harmonics.count, points.x.size
        yield UnitFields(field_at_nodes.reshape(component_count, x_count, panel.nodes.size, -1, points.z.size), filters)


def _compute_amplitudes(
    solved_panel: SolvedPanel, harmonics: Harmonics, points: list[tuple[FloatArray, FloatArray]], load_count: int
) -> list[FloatArray]:
    """Amplitudes of columns at the positions (x, z): arrays (load, component, x, z, wavenumber, column)."""
    columns, views = solved_panel
    shape = (columns.nodes.size, columns.parities.size)
    amplitudes = [np.zeros((load_count, harmonics.count, x.size, z.size, *shape)) for x, z in points]
    starts = np.cumsum([0, *(x.size for x, _ in points)])
    for view, loads in views:
        rows, distance = view.positions(np.concatenate([x for x, _ in points]))
        cosine, sine = view.modes.cosine(distance), view.modes.sine(distance)
        for amplitude, (_, z), (start, stop) in zip(amplitudes, points, pairwise(starts), strict=True):
            is_in_set = (rows >= start) & (rows < stop)
            if not is_in_set.any():
                continue
            field = harmonics.equivalent_load_field(loads, cosine[:, is_in_set], sine[:, is_in_set], z)
            field += harmonics.face_load_field(loads, distance[is_in_set], z)
            set_rows, depths, nodes, indices = np.ix_(
                rows[is_in_set] - start, np.arange(z.size), np.arange(columns.nodes.size), view.columns
            )
            amplitude[:, :, set_rows, depths, nodes, indices] = field
    return amplitudes


Terms = Mapping[int, tuple[ComplexArray, ComplexArray]]  # by component: a constant and the factor of the depth


def _field_of_equivalent_load(
    loads: AuxiliaryLoads, z: FloatArray, k: ComplexArray, waves: Sequence[tuple[ComplexArray, Terms]]
) -> FloatArray:
    """Field (load, component, x, z, node, column) of H: sums of waves (mode, x) times ``exp(-k z)`` times terms."""
    decay = np.exp(-k[:, None] * z[:, None])
    z_times_decay = decay * z[:, None]
    count = sum(len(terms) for _, terms in waves)
    nodes, columns = loads.lateral.size, loads.equivalent_load[0].shape[2]
    fields = np.empty((len(loads.equivalent_load), count, waves[0][0].shape[1], z.size, nodes, columns))
    for wave, terms in waves:
        along_z = np.stack([a[:, None] * decay + b[:, None] * z_times_decay for a, b in terms.values()], axis=1)
        right_factor = along_z.reshape(nodes, -1, k.shape[1]).view(np.float64).swapaxes(1, 2)
        for load_field, spectrum in zip(fields, loads.equivalent_load, strict=True):
            along_x = np.multiply(spectrum.swapaxes(1, 2)[:, :, None], wave.T, order="C").conj()
            # Real and imaginary parts alternate in memory: the product with the conjugate is the real part.
            product = along_x.reshape(nodes, -1, k.shape[1]).view(np.float64) @ right_factor
            load_field[list(terms)] = product.reshape(nodes, columns, -1, len(terms), z.size).transpose(3, 2, 4, 0, 1)
    return fields


def _stress_of_equivalent_load(
    loads: AuxiliaryLoads, cosine: ComplexArray, sine: ComplexArray, z: FloatArray
) -> FloatArray:
    """Stresses of H under the equivalent load, by the harmonics of a pressure: (load, 6, x, z, node, column)."""
    nu, lateral, axial = loads.poisson, loads.lateral[:, None], loads.modes.wavenumbers
    k = np.sqrt(axial**2 + lateral**2)
    c2, s2 = (axial / k) ** 2, (lateral / k) ** 2  # eq. (9)
    zero = np.zeros_like(k)
    # eqs. (11), (12) and (13)
    cosine_terms = {
        0: (-(c2 + 2 * nu * s2), c2 * k),
        1: (-(s2 + 2 * nu * c2), s2 * k),
        2: (zero - 1, -k),
        5: (zero, zero + lateral),
    }
    sine_terms = {3: (-(1 - 2 * nu) * axial * lateral / k**2, axial * lateral / k), 4: (zero, zero - axial)}
    return _field_of_equivalent_load(loads, z, k, [(cosine, cosine_terms), (sine, sine_terms)])


def _field_of_face_load(loads: AuxiliaryLoads, along_x: ComplexArray, along_z: ComplexArray) -> FloatArray:
    """Field (load, component, x, z, node, column) of V from waves (component, x, depth) and (depth, z)."""
    node_slices = [slice(stop - count, stop) for stop, count in zip(np.cumsum(loads.counts), loads.counts, strict=True)]
    fields = [
        [real_product(along_x[..., node], along_z[node, :, None] * columns[node, None]) for node in node_slices]
        for columns in loads.face_load
    ]
    return np.stack([np.stack(node_fields, axis=-2) for node_fields in fields])


def _stress_of_face_load(loads: AuxiliaryLoads, x: FloatArray, z: FloatArray) -> FloatArray:
    """Stresses of V under the face loads on its two ends: (load, 6, x, z, node, column)."""
    # A slab's harmonic is the sum of a half-space harmonic from each end: its amplitude and ``exp(-X)`` times the terms
    # below, where ``X`` is kappa times the distance from that end and ``Phi = 1 - 2 nu - tau - X``.
    nu, modes, depth = loads.poisson, loads.modes, loads.depth
    lateral = np.repeat(loads.lateral, loads.counts)
    kappa, tau, along_z = _face_waves(loads, lateral, z)
    (decay, even_growth), (_, odd_growth) = _sums_over_ends(modes, x, kappa, tau)
    potential = (1 - 2 * nu) * decay - even_growth
    lateral_term = 2 * nu * decay
    # eqs. (11) and (12) with the waves of eq. (25): xx, yy, zz, xy from cosines along z, xz and yz from sines
    along_x: ComplexArray = np.empty((6, x.size, depth.size), np.complex128)
    np.add(decay, even_growth, out=along_x[0])
    np.add((lateral / kappa) ** 2 * potential, lateral_term, out=along_x[1])
    np.add((depth / kappa) ** 2 * potential, lateral_term, out=along_x[2])
    np.multiply(-lateral / kappa, odd_growth, out=along_x[3])
    np.multiply(-1j * depth / kappa, odd_growth, out=along_x[4])
    np.multiply(-1j * lateral * depth / kappa**2, potential, out=along_x[5])
    return _field_of_face_load(loads, along_x, along_z)


def _face_waves(
    loads: AuxiliaryLoads, lateral: FloatArray, z: FloatArray
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """``kappa`` and ``tau`` of depth wavenumbers, and the waves (depth, z) of V from either face per unit load."""
    kappa = np.sqrt(loads.depth**2 + lateral**2)
    amplitude, tau = loads.modes.face_amplitude(kappa)
    return kappa, tau, amplitude[:, None] * np.exp(1j * np.outer(loads.depth, z))


def _sums_over_ends(
    modes: AxialModes, x: FloatArray, kappa: ComplexArray, tau: ComplexArray
) -> list[tuple[ComplexArray, ComplexArray]]:
    """Sum ``exp(-X)`` and ``(tau + X) exp(-X)`` (x, depth) over the ends, for even and for odd components."""
    waves = []
    for distance in (x, modes.length - x) if modes.parity else (x,):
        scaled_distance = np.outer(distance, kappa)
        decay = np.exp(-scaled_distance)
        scaled_distance += tau
        scaled_distance *= decay
        waves.append((decay, scaled_distance))
    if not modes.parity:
        return 2 * waves
    (decay, growth), (far_decay, far_growth) = waves
    return [(decay + sign * far_decay, growth + sign * far_growth) for sign in (modes.parity, -modes.parity)]


STRESS = Harmonics(  # components xx, yy, zz, xy, xz, yz
    equivalent_load_field=_stress_of_equivalent_load,
    face_load_field=_stress_of_face_load,
    count=6,
    even_in_y=[0, 1, 2, 4],
    odd_along_x=[3, 4],
    growing_signs=(-1,),  # bending
)


def _displacement_of_equivalent_load(
    loads: AuxiliaryLoads, cosine: ComplexArray, sine: ComplexArray, z: FloatArray
) -> FloatArray:
    """``2 G u`` of H under the equivalent load, by the harmonics of a pressure: (load, 3, x, z, node, column)."""
    nu, lateral, axial = loads.poisson, loads.lateral[:, None], loads.modes.wavenumbers
    k = np.sqrt(axial**2 + lateral**2)
    compressibility = 1 - 2 * nu
    # eqs. (10) and (13)
    sine_terms = {0: (-compressibility * axial / k**2, axial / k)}
    cosine_terms = {1: (compressibility * lateral / k**2, -lateral / k), 2: (2 * (1 - nu) / k, np.ones_like(k))}
    return _field_of_equivalent_load(loads, z, k, [(cosine, cosine_terms), (sine, sine_terms)])


def _displacement_of_face_load(loads: AuxiliaryLoads, x: FloatArray, z: FloatArray) -> FloatArray:
    """``2 G u`` of V under the face loads on its two ends: (load, 3, x, z, node, column)."""
    # With the potential ``psi = -exp(-X) / kappa`` of either end: ``2 G u = -grad(Phi) + 4 (1 - nu) psi e_x``.
    nu, modes, depth = loads.poisson, loads.modes, loads.depth
    lateral = np.repeat(loads.lateral, loads.counts)
    kappa, tau, along_z = _face_waves(loads, lateral, z)
    (decay, growth), (odd_decay, odd_growth) = _sums_over_ends(modes, x, kappa, tau)
    potential = (1 - 2 * nu) * decay - growth  # eq. (10)
    along_x = np.empty((3, x.size, depth.size), np.complex128)
    np.divide(odd_growth + 2 * (1 - nu) * odd_decay, -kappa, out=along_x[0])
    np.multiply(-lateral / kappa**2, potential, out=along_x[1])
    np.multiply(-1j * depth / kappa**2, potential, out=along_x[2])
    return _field_of_face_load(loads, along_x, along_z)


DISPLACEMENT = Harmonics(  # components along x, y, z, times ``2 G``
    equivalent_load_field=_displacement_of_equivalent_load,
    face_load_field=_displacement_of_face_load,
    count=3,
    even_in_y=[0, 2],
    odd_along_x=[0],
    growing_signs=(1, -1),
)
