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

GAIN = 4.0
"""By how much an interpolation is taken to err less than one that lacks a line of its nodes, whose steps are twice as
long there. A smooth function of this degree gains far more; where the contact reaches an end it is less smooth."""


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

    def without(self, axis: int, line: int) -> Nodes:
        """Return the nodes without one approach (axis 0) or one tilt (axis 1)."""
        values = [np.delete(each, line, axis=axis) for each in (self.energy, self.load, self.moment)]
        lines = [np.delete(each, line) if axis == number else each for number, each in enumerate(self[:2])]
        return Nodes(lines[0], lines[1], values[0], values[1], values[2])


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
    def averaged(cls, places: FloatArray) -> Axis:
        """As many splines as places: knots are the means of as many places as the degree (de Boor)."""
        degree = min(DEGREE, places.size - 1)
        inner = [places[first : first + degree].mean() for first in range(1, places.size - degree)]
        return cls(_with_ends(places, inner, degree), degree)

    @classmethod
    def at(cls, places: FloatArray) -> Axis:
        """Knots at the places, whose slopes are known as well as the values."""
        degree = min(DEGREE, places.size - 1)
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
    def fitted(cls, nodes: Nodes) -> EnergySpline:
        """Fit energy, load and moment at once."""
        u, scale = np.log(nodes.approaches), float(np.abs(nodes.tilts).max())
        t = nodes.tilts / scale
        first, second = Axis.averaged(u), Axis.at(t)
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
    """Errors of the interpolation: at the nodes, and at lines of nodes that a second fit does not know."""
    worst = _errors_at(EnergySpline.fitted(nodes), nodes, length)
    for axis, lines in enumerate((nodes.approaches, nodes.tilts)):
        for line in range(1, lines.size - 1):
            fewer = EnergySpline.fitted(nodes.without(axis, line))
            left_out = _only(nodes, axis, line)
            # The tilt is scaled by the largest, which stays.
            load, moment = _errors_at(fewer, left_out, length)
            worst = worst.larger(FitErrors(load / GAIN, moment / GAIN))
    return worst


def _only(nodes: Nodes, axis: int, line: int) -> Nodes:
    """Return one line of the nodes."""
    index = [slice(None), slice(None)]
    index[axis] = slice(line, line + 1)
    values = [each[tuple(index)] for each in nodes[2:]]
    return Nodes(nodes.approaches[index[0]], nodes.tilts[index[1]], values[0], values[1], values[2])


def _errors_at(spline: EnergySpline, nodes: Nodes, length: float) -> FitErrors:
    """Largest errors of a spline at nodes."""
    delta, theta = np.meshgrid(nodes.approaches, nodes.tilts, indexing="ij")
    found = spline(delta, theta)
    load = np.abs(found.load / nodes.load - 1)
    moment = np.abs(found.moment - nodes.moment) / (nodes.load * length)
    return FitErrors(float(load.max()), float(moment.max()))
