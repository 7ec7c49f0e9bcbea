"""Strain energy of a contact over approach and tilt as one smooth function: load, moment and stiffness derive from it.

Load and moment are the derivatives of the energy with respect to approach and tilt, so the stiffness matrix is its
matrix of second derivatives and symmetric by construction. The logarithm of the energy is a tensor product of B-splines
in the logarithm of the approach and in the tilt, fitted to energy, load and moment together by least squares: contacts
follow powers of the approach, which are straight lines there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.interpolate import BSpline

from contactstudy.checks import FloatArray

DEGREE = 4
"""Of the splines: the stiffness, a second derivative, then has two continuous derivatives itself. Accuracy."""

LOWER, SAFETY, BETWEEN = 3, 1.5, 4
"""Degree of the splines whose difference tells the error, a factor on that, and steps from node to node in which it is
looked for. Accuracy: so it covered the error of springs of power 3/2, which leave the surface, on 5 to 9 nodes."""


class Nodes(NamedTuple):
    """What is known of a contact at pairs of approach and tilt.

    Attributes
    ----------
    approaches, tilts : array
        Metres, positive, and radians; increasing.
    energy, load, moment : array (approach, tilt)
        J, N and N m.
    """

    approaches: FloatArray
    tilts: FloatArray
    energy: FloatArray
    load: FloatArray
    moment: FloatArray


class Motion(NamedTuple):
    """What an approach and a tilt take, and the stiffness matrix; arrays of one shape.

    Attributes
    ----------
    load, moment : array
        N and N m.
    normal, coupling, tilting : array
        ``dQ/d delta`` (N/m), ``dQ/d theta = dM/d delta`` (N/rad) and ``dM/d theta`` (N m/rad).
    """

    load: FloatArray
    moment: FloatArray
    normal: FloatArray
    coupling: FloatArray
    tilting: FloatArray


@dataclass(frozen=True, eq=False)
class Axis:
    """B-splines along one axis.

    Attributes
    ----------
    knots : array
        Knots, the ends repeated.
    degree : int
        Degree.
    """

    knots: FloatArray
    degree: int

    @classmethod
    def averaged(cls, places: FloatArray, degree: int) -> Axis:
        """As many splines as places: knots are the means of as many places as the degree (de Boor)."""
        degree = min(degree, places.size - 1)
        inner = [places[first : first + degree].mean() for first in range(1, places.size - degree)]
        return cls(_with_ends(places, inner, degree), degree)

    @classmethod
    def at(cls, places: FloatArray, degree: int) -> Axis:
        """Knots at the places, whose slopes are known as well as the values."""
        degree = min(degree, places.size - 1)
        return cls(_with_ends(places, list(places[1:-1]), degree), degree)

    def __call__(self, places: FloatArray, derivative: int = 0) -> FloatArray:
        """Every spline at every place: array (place, spline)."""
        count = self.knots.size - self.degree - 1
        return np.asarray(BSpline(self.knots, np.eye(count), self.degree)(places, nu=derivative))


def _with_ends(places: FloatArray, inner: list[float], degree: int) -> FloatArray:
    """Knots with the ends of the places repeated."""
    return np.concatenate([np.repeat(places[0], degree + 1), inner, np.repeat(places[-1], degree + 1)])


@dataclass(frozen=True, eq=False)
class EnergySpline:
    """Logarithm of the strain energy as a tensor product of splines.

    Attributes
    ----------
    along_approach, along_tilt : Axis
        Splines in the logarithm of the approach, and in the tilt over the largest.
    largest_tilt : float
        Radians.
    coefficients : array
        One per pair of splines.
    """

    along_approach: Axis
    along_tilt: Axis
    largest_tilt: float
    coefficients: FloatArray

    @classmethod
    def fitted(cls, nodes: Nodes, degree: int = DEGREE) -> EnergySpline:
        """Fit energy, load and moment at once."""
        u, scale = np.log(nodes.approaches), float(np.abs(nodes.tilts).max())
        t = nodes.tilts / scale
        first, second = Axis.averaged(u, degree), Axis.at(t, degree)
        rows = [np.kron(first(u, i), second(t, j)) for i, j in ((0, 0), (1, 0), (0, 1))]
        # d ln U / d ln delta = delta Q / U, and d ln U / d theta = M / U.
        known = [
            np.log(nodes.energy),
            nodes.approaches[:, None] * nodes.load / nodes.energy,
            scale * nodes.moment / nodes.energy,
        ]
        found = np.linalg.lstsq(np.concatenate(rows), np.concatenate([each.ravel() for each in known]), rcond=None)[0]
        return cls(first, second, scale, found.reshape(first(u).shape[1], -1))

    def __call__(self, approach: FloatArray, tilt: FloatArray) -> Motion:
        """Load, moment and stiffness at pairs of approach and tilt, of one shape."""
        shape = np.shape(approach)
        delta, theta = np.ravel(approach), np.ravel(tilt)
        u, t = np.log(delta), theta / self.largest_tilt
        first = [self.along_approach(u, order) for order in range(3)]
        second = [self.along_tilt(t, order) for order in range(3)]

        def derived(i: int, j: int) -> FloatArray:
            return np.asarray(np.einsum("pi,ij,pj->p", first[i], self.coefficients, second[j]))

        energy = np.exp(derived(0, 0))
        v_u, v_t, v_uu, v_ut, v_tt = (derived(*order) for order in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2)))
        scale = self.largest_tilt
        values = (
            energy * v_u / delta,
            energy * v_t / scale,
            energy * (v_uu + v_u**2 - v_u) / delta**2,
            energy * (v_ut + v_u * v_t) / (delta * scale),
            energy * (v_tt + v_t**2) / scale**2,
        )
        return Motion(*(each.reshape(shape) for each in values))


class FitErrors(NamedTuple):
    """Errors of load over the load, and of the moment over load and length."""

    load: float
    moment: float

    def larger(self, other: FitErrors) -> FitErrors:
        """Return the larger of either error."""
        return FitErrors(max(self.load, other.load), max(self.moment, other.moment))


def fit_errors(nodes: Nodes, length: float) -> FitErrors:
    """Errors of the interpolation: what it misses at the nodes, and what another degree changes between them."""
    spline, lower = EnergySpline.fitted(nodes), EnergySpline.fitted(nodes, LOWER)
    missed = _differences(spline(*_pairs(nodes.approaches, nodes.tilts)), nodes.load, nodes.moment, length)
    pairs = _pairs(np.exp(_finer(np.log(nodes.approaches))), _finer(nodes.tilts))
    other = lower(*pairs)
    load, moment = _differences(spline(*pairs), other.load, other.moment, length)
    return missed.larger(FitErrors(SAFETY * load, SAFETY * moment))


def _pairs(approaches: FloatArray, tilts: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Every approach with every tilt."""
    delta, theta = np.meshgrid(approaches, tilts, indexing="ij")
    return delta, theta


def _finer(places: FloatArray) -> FloatArray:
    """Return the places and some between them."""
    count = places.size
    return np.asarray(np.interp(np.arange(BETWEEN * (count - 1) + 1) / BETWEEN, np.arange(count), places))


def _differences(found: Motion, load: FloatArray, moment: FloatArray, length: float) -> FitErrors:
    """Largest differences of load and moment."""
    turned = np.abs(found.moment - moment) / (load * length)
    return FitErrors(float(np.abs(found.load / load - 1).max()), float(turned.max()))
