"""Film between two free ends from the finite elements' compliance, by a dense Newton method.

For each wavenumber along y the finite elements give the mean displacement of columns under unit pressure on columns;
the integral over the wavenumber is the displacement of cells, a mean along x at the centre along y, under unit
pressure on cells. Reynolds' equation is that of the package (eqs. 401 and 402: finite volumes, parabolas upstream,
reduced pressure, linear film between centres) in independent code: derivatives are complex steps, cavitation is the
complementarity ``min(c P, outflow) = 0``, pseudo-time steps lead from a thick film to the steady one.

Lengths are in a, heights in a**2 / R, pressures in p0.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise, product

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy import sparse
from scipy.special import sici, xlogy

from benchmarks.finite_elements.harmonics import HarmonicBody, Line
from benchmarks.finite_elements.superpose import Resolution
from contactstudy.verification.problems import LINE_LOAD, LubricatedCase

Array = NDArray[np.float64]
FACE_FILM = (0.2, 2.0)
"""Least and largest film on a face over that of the cell upstream, as in the package."""
TIMES = 0.02 * 2.0 ** np.arange(13)
"""Pseudo-time steps before the steady state, in a / um."""
START_FILM, CLOSING = 0.3, 0.6
"""Least film of the start, and largest relative decrease of a film in one step."""


def compute_compliance(case: LubricatedCase, x_edges: Array, y_edges: Array, resolution: Resolution) -> Array:
    """``E* u_z / a`` of columns at the cells' centres under unit pressure on cells (x, y, x, y), up to a constant."""
    widths, y, lengths = np.diff(x_edges), 0.5 * (y_edges[1:] + y_edges[:-1]), np.diff(y_edges)
    midpoints = x_edges[:-1] + 0.5 * widths
    x = Line(edges=np.sort(np.concatenate([x_edges, midpoints])), order=resolution.order)
    shapes = [
        (lambda x_point, low=low, high=high: 1.0 * ((x_point > low) & (x_point < high)), "z")
        for low, high in pairwise(x_edges)
    ]
    loads = np.array([x.load(shape) for shape, _ in shapes])
    depth, n = resolution.make_mesh_z(), resolution.nodes
    gauss_nodes = legendre.leggauss(n)[0]
    inverse_legendre = np.linalg.inv(legendre.legvander(gauss_nodes, n - 1))
    ends = [(y[:, None] - y + 0.5 * side * lengths).ravel() for side in (1, -1)]
    total = np.zeros((y.size**2, widths.size, widths.size))
    for low, high in pairwise(resolution.panels):
        depth_count = int(np.searchsorted(depth, 40 / low)) + 1 if low else depth.size
        body = HarmonicBody(x, Line(edges=depth[:depth_count], order=resolution.order), case.poisson)
        k = low + 0.5 * (high - low) * (gauss_nodes + 1)
        # 2 G = E* (1 - nu); means over the displaced column, per length of the loaded column.
        tops = [np.stack([u[2] @ body.top for u in body.solve(float(wave), shapes)]) for wave in k]
        response = np.array([2 * loads @ top.T for top in tops]) / ((1 - case.poisson) * np.outer(widths, widths))
        fine_nodes, weight = legendre.leggauss(24 + int(0.7 * np.abs(ends).max() * (high - low)))
        wave = low + 0.5 * (high - low) * (fine_nodes + 1)
        interpolate = (
            legendre.legvander(fine_nodes, n - 1) @ inverse_legendre * (0.5 * (high - low) * weight / np.pi)[:, None]
        )
        transform = (np.sin(np.outer(ends[0], wave)) - np.sin(np.outer(ends[1], wave))) / wave
        # The part like 1 / k at small k, equal for all columns, is integrated with cos(k y) - 1, up to a constant.
        common_response = response[:, 0, -1]
        steady_part = (transform - (ends[0] - ends[1])[:, None]) / wave @ interpolate @ (k * common_response)
        total += (
            np.tensordot(transform @ interpolate, response - common_response[:, None, None], axes=1)
            + steady_part[:, None, None]
        )
    total *= widths
    # Beyond the last panel the response falls like 1 / k.
    tail = [np.sin(high * end) / high - end * sici(high * np.maximum(np.abs(end), 1e-12))[1] for end in ends]
    total += np.multiply.outer(tail[0] - tail[1], k[-1] * response[-1] * widths / np.pi)
    return total.reshape(y.size, y.size, widths.size, widths.size).transpose(2, 0, 3, 1)


@dataclass(frozen=True)
class Reynolds:
    """Net outflow of cells; pressures and films (x, y) may be complex."""

    x_edges: Array
    y_edges: Array
    speed: float
    pressure_viscosity: float

    def outflow(self, pressure: Array, film: Array) -> Array:
        """Net outflow of each cell per width along x."""
        # Q of Barus' oil, eq. (402); a negative pressure, which ends in cavitation, has the ambient viscosity.
        positive_pressure, coefficient = np.where(pressure.real > 0, pressure, 0.0), self.pressure_viscosity
        reduced_pressure = np.where(
            pressure.real > 0, -np.expm1(-coefficient * positive_pressure) / coefficient, pressure
        )
        flow_along_y = self._couette(film) - self._driven(reduced_pressure, film, self.y_edges)
        flow_along_x = -self._driven(reduced_pressure.T, film.T, self.x_edges).T
        return (
            np.diff(flow_along_y, axis=1)
            + np.diff(flow_along_x, axis=0) * np.diff(self.y_edges) / np.diff(self.x_edges)[:, None]
        )

    @cached_property
    def _face_weights(self) -> list[tuple[slice, Array]]:
        """Cells beside each face along y, and weights of the polynomial through their films."""
        edges = self.y_edges
        y = 0.5 * (edges[1:] + edges[:-1])
        weights = []
        for face, edge in enumerate(edges):
            columns = slice(max(face - 2, 0), min(max(face + 1, 2), y.size))
            distances = y[columns] - edge
            weights.append(
                (columns, np.linalg.solve(np.vander(distances, increasing=True).T, np.eye(distances.size)[0]))
            )
        return weights

    def _couette(self, film: Array) -> Array:
        """Film on the faces along y."""
        faces = []
        for face, (columns, weights) in enumerate(self._face_weights):
            value, upstream = film[:, columns] @ weights, film[:, max(face - 1, 0)]
            value = np.where(value.real < FACE_FILM[0] * upstream.real, FACE_FILM[0] * upstream, value)
            faces.append(np.where(value.real > FACE_FILM[1] * upstream.real, FACE_FILM[1] * upstream, value))
        return np.stack(faces, axis=1)

    def _driven(self, reduced_pressure: Array, film: Array, edges: Array) -> Array:
        """Flow against the last axis under the pressure gradient; the pressure on the outermost faces is ambient."""
        centres = np.concatenate([edges[:1], 0.5 * (edges[1:] + edges[:-1]), edges[-1:]])
        film_before, film_after = np.pad(film, ((0, 0), (1, 0)), "edge"), np.pad(film, ((0, 0), (0, 1)), "edge")
        slope = np.diff(np.pad(reduced_pressure, ((0, 0), (1, 1)))) / np.diff(centres)
        return 2 * (film_before * film_after) ** 2 / (film_before + film_after) / self.speed * slope

    def derivatives(self, pressure: Array, film: Array) -> tuple[Array, Array]:
        """Matrices (cell, cell) of the derivatives of the outflow by the pressure and by the film: complex steps.

        A cell depends on columns next to it and on cells from two before it to one after it: 12 steps are enough.
        """
        (rows, columns), step = np.indices(film.shape), 1e-30j
        matrices = np.zeros((2, film.size, film.size))
        for row_offset, column_offset in product(range(3), range(4)):
            mask = np.zeros(film.shape)
            mask[row_offset::3, column_offset::4] = 1.0
            row, column = rows + (row_offset - rows + 1) % 3 - 1, columns + (column_offset - columns + 2) % 4 - 2
            is_within = (row >= 0) & (row < film.shape[0]) & (column >= 0) & (column < film.shape[1])
            cells = np.flatnonzero(is_within), (row * film.shape[1] + column)[is_within]
            matrices[0][cells] = self.outflow(pressure + step * mask, film).imag[is_within] / 1e-30
            matrices[1][cells] = self.outflow(pressure, film + step * mask).imag[is_within] / 1e-30
        return matrices[0], matrices[1]


def compute_mean_gap(case: LubricatedCase, x_edges: Array, y: Array) -> Array:
    """Gap, mean over columns, at positions along y."""
    position = 2 * x_edges / case.length - 1
    integral = xlogy(1 + position, 1 + position) - xlogy(1 - position, 1 - position) - 2 * position
    drop = -case.amplitude * np.diff(integral) / np.diff(position)
    return drop[:, None] + 0.5 * y**2


def solve(
    case: LubricatedCase, compliance_matrix: Array, x_edges: Array, y_edges: Array, *, tolerance: float = 1e-9
) -> tuple[Array, Array]:
    """Pressure and film (x, y), by pseudo-time steps and then the steady state."""
    x, y = (0.5 * (edges[1:] + edges[:-1]) for edges in (x_edges, y_edges))
    gap, lengths = compute_mean_gap(case, x_edges, y), np.diff(y_edges)
    # Load of the line contact of half-width and peak pressure 1 over the whole length
    load = LINE_LOAD * case.length
    areas = np.multiply.outer(np.diff(x_edges), lengths).ravel()
    # Heights are in a**2 / R and p0 = E* a / (2 R).
    matrix = 0.5 * compliance_matrix.reshape(gap.size, gap.size)
    pressure = np.sqrt(np.clip(1 - y**2, 0, None)) + 0 * gap
    pressure *= load / (areas @ pressure.ravel())
    film = gap + (matrix @ pressure.ravel()).reshape(gap.shape)
    film += START_FILM - film.min()
    # Speed number of eq. (404), by (a / R)**2 = 8 W / pi, and pressure-viscosity coefficient times the peak pressure
    speed = 3 * np.pi**2 / (8 * case.load_number**2)
    pressure_viscosity = float(case.lubricant_number * np.sqrt(case.load_number / (2 * np.pi)))
    reynolds = Reynolds(x_edges, y_edges, speed, pressure_viscosity)
    for time in (*TIMES, np.inf):
        previous_film, length_per_time = film, lengths / time
        for _ in range(60 if np.isinf(time) else 8):
            outflow = (reynolds.outflow(pressure, film) + length_per_time * (film - previous_film)).ravel()
            pressure_derivative, film_derivative = reynolds.derivatives(pressure, film)
            film_derivative += np.diag(np.tile(length_per_time, x.size))
            jacobian = pressure_derivative + sparse.csr_array(film_derivative) @ matrix
            scale = np.abs(jacobian.diagonal())
            is_cavitated = scale * pressure.ravel() < outflow
            rows = np.where(is_cavitated[:, None], np.eye(gap.size), jacobian / scale[:, None])
            approach_derivative = np.where(is_cavitated, 0.0, film_derivative.sum(axis=1) / scale)
            right_side = np.append(
                np.where(is_cavitated, -pressure.ravel(), -outflow / scale), load - areas @ pressure.ravel()
            )
            change = np.linalg.solve(np.block([[rows, approach_derivative[:, None]], [areas, np.zeros(1)]]), right_side)
            film_change = change[-1] + matrix @ change[:-1]
            step_fraction = min(1.0, CLOSING / max((-film_change / film.ravel()).max(), 1e-300))
            pressure = pressure + step_fraction * change[:-1].reshape(gap.shape)
            film = film + step_fraction * film_change.reshape(gap.shape)
            if np.abs(change[:-1]).max() < tolerance:
                break
    if np.abs(change[:-1]).max() >= tolerance:
        raise RuntimeError("no convergence of the film")
    return pressure, film
