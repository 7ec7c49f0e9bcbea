"""Laws of singular ends and convex corners of a contact.

At the distance d from a sharp end the pressure is ``K d**-m``, with ``m = 1/2`` at a rigid end; at an elastic end m
follows from the two materials or is fitted. Where the slope of the gap jumps by s > 0, it is
``E* s / pi arsinh(sqrt(d0 / 4d))``. A small radius of the edge and a blend of the corner bound the pressure.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from contactstudy import checks
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

RIGID = 0.5  # exponent at a sharp rigid end. Physics.
MIN_GROWTH_EXPONENT = 0.12  # least growth exponent between two halvings for a power law. Accuracy.
MIN_STEP_RATIO = 0.5  # least ratio of the last two steps to the two preceding steps for a logarithm. Accuracy.
FIT_START, FIT_STOP = 3.0, 64.0  # distances over the outermost width between which the intensity is fitted. Accuracy.
MIN_FIT_COLUMNS = 3  # least number of columns of a fitted intensity. Accuracy.

MAX_FIT_RATIO, NARROW_FACE_ERROR = 0.5, 0.08
"""Largest range of the fit over the length of the face beyond an end, and the additional error over K of a larger
range. Accuracy: measured as 5 % at a ratio of 2.5, 0.8 % at 0.6."""

STEP_ERROR = 3e-3  # relative error of the intensity due to steps of the pressure, the residual of the fits. Accuracy.

ELASTIC_ERROR_FACTOR = 1.5
"""Error of the intensity of an elastic end over its change when both limits of the fit double. Accuracy: unlike a rigid
end the next power of the distance is not a whole number."""

EDGE_FACTOR = 1.0734  # factor of the peak at an edge of small radius, computed for a half-space. Physics.


class Sample(NamedTuple):
    """Width of the outermost column and the largest pressure on it."""

    width: float
    pressure: float


@dataclass(frozen=True, kw_only=True)
class EndLaw:
    """Law of the pressure at a singular end."""

    exponent: float  # ``m`` of ``p = K d**-m`` from theory or a fit; NaN before the fit, 0 for a logarithm
    intensity: float = np.nan  # ``K`` and its estimated error, Pa m**m; NaN for a logarithm
    intensity_error: float = np.nan
    fitted: bool = False  # whether the exponent is fitted

    def with_intensity(self, edges: FloatArray, pressure: FloatArray, face_beyond: float) -> EndLaw:
        """Law with the intensity fitted to the pressure (column, y) at distances much smaller than `face_beyond`."""
        # A lifted end has the intensity 0, too few columns for a fit that of the outermost; both errors are infinite.
        if self.exponent == 0:
            return self
        # Friction moves the contact along y, by different distances at the ends.
        pressure = pressure[:, int(pressure[0].argmax())]
        if pressure[0] <= 0:
            return replace(self, intensity=0.0, intensity_error=np.inf)
        width, exponent, fitted = edges[1], self.exponent, bool(np.isnan(self.exponent))
        if fitted:
            from scipy.optimize import minimize_scalar

            bounds = (MIN_GROWTH_EXPONENT, RIGID)
            optimum = minimize_scalar(lambda m: _fit_law(edges, pressure, width, m)[1], bounds=bounds, method="bounded")
            exponent = float(optimum.x)
        intensities = [_fit_law(edges, pressure, width * factor, exponent)[0] for factor in (1.0, 2.0)]
        if not np.isfinite(intensities).all():  # loaded on too few columns
            intensity = float((1 - exponent) * pressure[0] * width**exponent)
            return replace(self, exponent=exponent, intensity=intensity, intensity_error=np.inf, fitted=fitted)
        error_factor = 1.0 if exponent == RIGID else ELASTIC_ERROR_FACTOR
        error = error_factor * abs(intensities[0] - intensities[1]) + STEP_ERROR * intensities[0]
        if 0 < face_beyond < FIT_START * width:  # the columns do not resolve the law
            error = np.inf
        elif FIT_STOP * width > MAX_FIT_RATIO * face_beyond:
            error += NARROW_FACE_ERROR * intensities[0]
        return replace(self, exponent=exponent, intensity=intensities[0], intensity_error=error, fitted=fitted)


def elastic_exponent(edge_compliance: float, face_compliance: float) -> float:
    """Exponent ``m`` at a sharp edge of 90 degrees on a wider face, without friction, from both bodies' ``1 / E*``."""
    # Williams (J. Appl. Mech. 19 (1952) 526), Dundurs and Lee (J. Elasticity 2 (1972) 109), with ``s = 1 - m``: k_e
    # sin(pi s) / (2 (sin(pi s / 2)**2 - s**2)) + k_f cot(pi s) = 0.
    from scipy.optimize import brentq

    def sum_slopes(s: float) -> float:
        wedge_slope = np.sin(np.pi * s) / (2 * (np.sin(0.5 * np.pi * s) ** 2 - s**2))
        return float(edge_compliance * wedge_slope + face_compliance / np.tan(np.pi * s))

    return 1 - float(brentq(sum_slopes, 0.5, 1 - 1e-9)) if edge_compliance > 0 else RIGID


def law_of(samples: list[Sample], exponent: float) -> EndLaw | None:
    """Law of a loaded end; None for a finite pressure."""
    # Without an exponent of the materials (NaN) the growth of the outermost column between splittings determines it.
    if not np.isnan(exponent):
        return EndLaw(exponent=exponent) if samples[-1].pressure > 0 else None
    widths, pressures = np.array(samples).T
    if len(samples) < 4 or pressures[-1] <= pressures[-2] or pressures[-3:].min() <= 0:
        return None
    log_ratios = np.log(widths[:-1] / widths[1:])
    if (np.log(pressures[-2:] / pressures[-3:-1]) > MIN_GROWTH_EXPONENT * log_ratios[-2:]).all():
        return EndLaw(exponent=exponent)
    steps = np.diff(pressures) / log_ratios
    if steps.size >= 4 and steps[-2:].sum() > MIN_STEP_RATIO * steps[-4:-2].sum() > 0:
        return EndLaw(exponent=0.0)
    return None


def _columns_between(edges: FloatArray, axial_pressure: FloatArray, start: float, stop: float) -> FloatArray:
    """Edges and pressures (3, column) of the loaded columns between two distances."""
    columns = np.stack([edges[:-1], edges[1:], axial_pressure])
    return columns[:, (edges[:-1] >= 0.999 * start) & (edges[1:] <= 1.001 * stop) & (axial_pressure > 0)]


def _fit_law(edges: FloatArray, axial_pressure: FloatArray, width: float, exponent: float) -> tuple[float, float]:
    """Fit ``K d**-m (1 + c d)`` to the columns' means by relative least squares; return K and the residual."""
    low, high, pressure = _columns_between(edges, axial_pressure, FIT_START * width, FIT_STOP * width)
    if pressure.size < MIN_FIT_COLUMNS:
        return np.nan, np.inf
    powers = [1 - exponent, 2 - exponent]
    # eq. (41)
    means = [(high**power - low**power) / (power * (high - low)) for power in powers]
    matrix = np.stack(means, axis=1) / pressure[:, None]
    coefficients = np.linalg.lstsq(matrix, np.ones(pressure.size), rcond=None)[0]
    return float(coefficients[0]), float(np.sqrt(np.mean((matrix @ coefficients - 1) ** 2)))


def edge_peak(intensity: float, modulus: float, edge_radius: float) -> float:
    """Peak pressure at an end with an edge of small radius.

    Parameters
    ----------
    intensity : float
        ``K`` of the sharp end, ``p = K / sqrt(d)``, Pa m**0.5.
    modulus : float
        Contact modulus ``E*``, Pa.
    edge_radius : float
        Radius ``r0`` of the edge, metres; much smaller than the half-width.

    Returns
    -------
    float
        Pa.

    Raises
    ------
    InvalidInputError
        If an argument is not positive.

    Examples
    --------
    >>> round(edge_peak(1e7, 231e9, 1e-5) / 1e9, 3)
    14.189
    """
    k = checks.positive("intensity", intensity, "Pa m**0.5")
    modulus = checks.positive("modulus", modulus, "Pa")
    radius = checks.positive("edge_radius", edge_radius, "metres")
    return float(EDGE_FACTOR * (k**2 * modulus / radius) ** (1 / 3))  # eq. (42)


CORNER_FIT_START, CORNER_FIT_STOP = 4.0, 64.0  # range of the fit of d0, over the corner's column. Accuracy.
CORNER_STEP_ERROR = 1e-2  # relative error of d0 due to steps of the pressure. Accuracy.
MAX_BLEND_WIDTH = 0.1  # width b of a blend over d0 up to which its peak follows from the law. Accuracy: 1 % at 0.1.


@dataclass(frozen=True, kw_only=True)
class CornerLaw:
    """Pressure at a convex corner: a logarithm within d0, ``d**-0.5`` beyond the d0 of a steep corner."""

    x: float  # position, metres
    slope: float  # jump ``s`` of the slope
    intensity: float  # ``E* s / (2 pi)``, Pa
    distance: float  # ``d0`` and its estimated error, metres; NaN, with an infinite error, on too few columns
    distance_error: float


@np.errstate(over="ignore")  # d0 of an almost flat corner
def corner_law(
    corner: tuple[float, float], modulus: float, edges: FloatArray, pressure: FloatArray
) -> CornerLaw | None:
    """Law of a corner (position, jump of the slope) from the pressure (column, y); None without contact."""
    x, slope = corner
    intensity = modulus * slope / (2 * np.pi)  # eq. (42a)
    index = int(np.abs(edges - x).argmin())
    if not 0 < index < edges.size - 1 or not pressure[index - 1 : index + 1].any():
        return None
    axial_pressure = pressure[:, int((pressure[index - 1] + pressure[index]).argmax())] / intensity
    sides = (edges[index:] - x, axial_pressure[index:]), (x - edges[index::-1], axial_pressure[index - 1 :: -1])
    # On the outer side, which carries less, the contact ends at d0 / 4 from a steep corner.
    reach = CORNER_FIT_STOP * float(edges[index + 1] - x)
    edge_distances, ratio = max(sides, key=lambda side: float(np.diff(np.minimum(side[0], reach)) @ side[1]))
    log_distances = [_log_distance(edge_distances, ratio, edge_distances[1] * factor) for factor in (1.0, 2.0)]
    distance = float(np.exp(log_distances[0]))
    error = distance * (abs(float(np.expm1(log_distances[1] - log_distances[0]))) + CORNER_STEP_ERROR)
    return CornerLaw(
        x=x, slope=slope, intensity=intensity, distance=distance, distance_error=np.inf if np.isnan(error) else error
    )


def _log_distance(edges: FloatArray, ratio: FloatArray, width: float) -> float:
    """Logarithm of d0 from a fit, with terms d and 1/d, to pressures over K; NaN on too few columns."""
    low, high, ratio = _columns_between(edges, ratio, CORNER_FIT_START * width, CORNER_FIT_STOP * width)
    if ratio.size < MIN_FIT_COLUMNS:
        return np.nan
    # The term 1/d is the shift of a contact's end by a fraction of a column.
    middle = 0.25 * (np.sqrt(low) + np.sqrt(high)) ** 2  # where ``d**-0.5`` has its mean
    terms = np.stack([np.ones(ratio.size), middle / width, width / middle], axis=1)
    values = np.log(middle) + ratio + 2 * np.log1p(-np.exp(-ratio))  # eq. (42a): 4 d sinh(p / 2K)**2
    return float(np.linalg.lstsq(terms, values, rcond=None)[0][0])


def corner_peak(intensity: float, distance: float, slope: float, blend_radius: float) -> float:
    """Peak pressure at a convex corner with a small blend radius.

    Parameters
    ----------
    intensity : float
        ``E* s / (2 pi)``, Pa: `corner_intensity` of a result.
    distance : float
        ``d0``, metres: `corner_distance` of a result.
    slope : float
        Jump ``s`` of the slope: `corner_slope` of a result.
    blend_radius : float
        Radius ``rho`` of the blend, metres.

    Returns
    -------
    float
        Pa.

    Raises
    ------
    InvalidInputError
        If an argument is not positive, or the blend is wider than a tenth of d0.

    Examples
    --------
    >>> round(corner_peak(1.3e9, 50e-6, 0.035, 20e-6) / 1e9, 2)
    7.75
    """
    corner_intensity = checks.positive("intensity", intensity, "Pa")
    distance = checks.positive("distance", distance, "metres")
    width = checks.positive("blend_radius", blend_radius, "metres") * checks.positive("slope", slope)
    if width > MAX_BLEND_WIDTH * distance:
        bound = MAX_BLEND_WIDTH * distance / slope
        raise InvalidInputError("blend_radius", blend_radius, f"at most {bound:.3g} m", "solve the blended profile")
    return float(corner_intensity * (np.log(2 * distance / width) + 1))  # eq. (42b)
