"""Stresses under `g(x) h(y)` from the finite-element harmonics: the integral over the wavenumber in y.

The response to `cos(k y)` varies smoothly with k, on the scale of 1 over the body's length at the low end and
of 1 over the depth at the high end. It is computed at Gauss nodes of panels that about double, interpolated
inside each panel, and integrated against the oscillating transform of h on a finer Gauss rule.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.special import j1, spherical_jn

from benchmarks.finite_elements.harmonics import COMPONENTS, HarmonicBody, Line
from contactstudy.verification.problems import LoadCase

Array = NDArray[np.float64]
PANELS = (0, 0.01, 0.03, 0.08, 0.2, 0.45, 0.9, 1.8, 3.5, 7, 13, 25, 50, 100)


def transform_quartic(k: Array) -> Array:
    """Cosine transform of `(1 - y^2)^2` over `|y| < 1`: `16 j_2(k) / k^2`."""
    return np.asarray(16 * spherical_jn(2, k) / k**2)


def transform_ellipse(k: Array) -> Array:
    """Cosine transform of `sqrt(1 - y^2)`: `pi J_1(k) / k`."""
    return np.asarray(np.pi * j1(k) / k)


@dataclass(frozen=True, kw_only=True)
class Resolution:
    """Element order, growth of the elements into depth, depth, smallest element, quadrature in k."""

    order: int = 6
    growth: float = 1.65
    depth: float = 2e4
    smallest: float = 0.03
    nodes: int = 6
    panels: tuple[float, ...] = PANELS

    def make_mesh_x(self, length: float) -> Array:
        """Edges graded towards both ends; the inner edges are multiples of 1/2, where loads begin and end."""
        step = min(0.5, 0.25 * length)
        half_nodes = [0.0]
        while half_nodes[-1] < 0.25:
            half_nodes.append(max(self.smallest, self.growth * 1.2 * half_nodes[-1]))
        graded_edges = step / half_nodes[-1] * np.array(half_nodes)
        inner_nodes = np.linspace(step, length - step, round(length / step) - 1)
        return np.concatenate([graded_edges[:-1], inner_nodes, (length - graded_edges[::-1])[1:]])

    def make_mesh_z(self) -> Array:
        edges = [0.0, self.smallest]
        while edges[-1] < self.depth:
            edges.append(edges[-1] * self.growth)
        return np.array(edges)


@dataclass(frozen=True)
class Harmonics:
    """Responses of one body at all wavenumbers: `stress[k, shape, component, x, z]` and `surface[k, shape, x]`."""

    resolution: Resolution
    k: Array
    stress: Array
    surface: Array


def harmonics(
    length: float,
    poisson: float,
    shapes: Sequence[tuple[Callable[[Array], Array], str]],
    x: Sequence[float],
    z: Sequence[float],
    resolution: Resolution,
) -> Harmonics:
    """Solve for every wavenumber; a shape is `g` and the direction of the load."""
    body = HarmonicBody(
        Line(edges=resolution.make_mesh_x(length), order=resolution.order),
        Line(edges=resolution.make_mesh_z(), order=resolution.order),
        poisson,
    )
    node = legendre.leggauss(resolution.nodes)[0]
    edges = np.array(resolution.panels, dtype=float)
    wavenumbers = (edges[:-1, None] + 0.5 * np.diff(edges)[:, None] * (node + 1)).ravel()
    stress, surface = [], []
    for k in wavenumbers:
        u = body.solve(float(k), shapes)
        stress.append(body.stresses(float(k), u, x, z))
        surface.append(body.surface(u, x))
    return Harmonics(resolution, wavenumbers, np.array(stress), np.array(surface))


def _make_panels(
    resolution: Resolution, transform: Callable[[Array], Array]
) -> Iterator[tuple[slice, Array, Array, Array]]:
    """For each panel: its slice of the nodes, fine nodes, their weights times `h(k) / pi`, interpolation."""
    n = resolution.nodes
    inverse_legendre = np.linalg.inv(legendre.legvander(legendre.leggauss(n)[0], n - 1))
    for i, (low, high) in enumerate(zip(resolution.panels[:-1], resolution.panels[1:], strict=True)):
        node, weight = legendre.leggauss(24 + int(2 * (high - low)))
        fine_nodes = low + 0.5 * (high - low) * (node + 1)
        weights = 0.5 * (high - low) * weight * transform(fine_nodes) / np.pi
        yield slice(i * n, (i + 1) * n), fine_nodes, weights, legendre.legvander(node, n - 1) @ inverse_legendre


def superpose_stresses(
    harmonics: Harmonics,
    normal: int,
    tangential: int | None,
    friction: float,
    y: Sequence[float],
    transform: Callable[[Array], Array] = transform_quartic,
) -> dict[str, Array]:
    """The six components on `(x, y, z)`, from the indices of the normal and of the tangential shape."""
    positions = np.asarray(y, dtype=float)
    total = np.zeros((len(COMPONENTS), positions.size, *harmonics.stress.shape[3:]))
    sine = np.array([name in ("tau_xy", "tau_yz") for name in COMPONENTS])
    for panel, k, weight, interpolate in _make_panels(harmonics.resolution, transform):
        cos, sin = ((np.cos, np.sin)[i](np.outer(positions, k)) * weight @ interpolate for i in (0, 1))
        for index, factor, even, odd in ((normal, 1.0, cos, sin), (tangential, friction, sin, -cos)):
            if index is None:
                continue
            values = harmonics.stress[panel, index]
            total[~sine] += factor * np.einsum("yk,kcxz->cyxz", even, values[:, ~sine])
            total[sine] += factor * np.einsum("yk,kcxz->cyxz", odd, values[:, sine])
    return {name: field.transpose(1, 0, 2) for name, field in zip(COMPONENTS, total, strict=True)}


def superpose_displacement(
    harmonics: Harmonics,
    case: LoadCase,
    normal: int,
    tangential: int | None,
    y: Sequence[float],
    reference: int,
    transform: Callable[[Array], Array] = transform_quartic,
) -> Array:
    """`E u_z` of the top on `(x, y)` less that at `(x[reference], 0)`: only for loads even about mid-length.

    The response grows like `1/k` at low k, the same all along x: the differences along x are smooth in k, and
    so is k times the response at the reference.
    """
    positions = np.asarray(y, dtype=float)
    total = np.zeros((positions.size, harmonics.surface.shape[2]))
    for panel, k, weight, interpolate in _make_panels(harmonics.resolution, transform):
        phases, node_k = np.outer(positions, k), harmonics.k[panel]
        surface = harmonics.surface[panel, normal]
        base = surface[:, reference]
        total += np.cos(phases) * weight @ interpolate @ (surface - base[:, None])
        total += ((np.cos(phases) - 1) / k * weight @ interpolate @ (node_k * base))[:, None]
        if tangential is not None:
            scaled_response = harmonics.surface[panel, tangential] * node_k[:, None]
            total += case.friction * (np.sin(phases) / k * weight @ interpolate @ scaled_response)
    return (1 + case.poisson) * total.T
