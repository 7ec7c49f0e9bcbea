"""A measured profile: highest line of a map, Gaussian filter, interpolation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from contactstudy import checks
from contactstudy.arrays.engineering import format_quantity
from contactstudy.arrays.variables import in_si
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import MIN_JUMP, POSITIVE_LENGTH, Shape, SlopeJumps
from contactstudy.profiles.measurement_files import check_positions, check_values, read_measurement, rotate_heights

ALPHA = np.sqrt(np.log(2) / np.pi)  # Constant of transmission one half at the cut-off (ISO 16610-21). Physics.
WEIGHT_REACH = 2.2  # Half the weight's support, over ``ALPHA`` times the cut-off; below 3e-7 beyond. Accuracy.


def filter_gaussian(x: FloatArray, values: FloatArray, cutoff: float) -> FloatArray:
    """Filter values with ISO 16610-21's low-pass weight: transmission ``2**-(cutoff / l)**2`` at wavelength l."""
    # A weighted linear fit at each point keeps zeroth and first moments at the ends (ISO 16610-28; Brinkmann 2001).
    width = ALPHA * cutoff
    step = (x[-1] - x[0]) / (x.size - 1)
    # Fourier transforms filter points with deviations of up to 1e-3 steps from even spacing.
    is_even = np.abs(x - np.linspace(x[0], x[-1], x.size)).max() <= 1e-3 * step
    zeroth, first, second, mean, moment = (
        _sum_even_points(step / width, values) if is_even else _sum_uneven_points(x / width, values)
    )
    return np.asarray((second * mean - first * moment) / (zeroth * second - first**2))


def _sum_even_points(step: float, values: FloatArray) -> tuple[FloatArray, ...]:
    """Return the sums of the weight times 1, ``s``, ``s**2``, the values and ``s`` times the values at even points."""
    from scipy.signal import oaconvolve

    reach = min(int(WEIGHT_REACH / step), values.size - 1)
    s = step * np.arange(reach, -reach - 1, -1)  # a convolution reverses the order
    weight = step * np.exp(-np.pi * s**2)
    point_weights = np.ones(values.size)
    point_weights[[0, -1]] = 0.5  # end points represent half a step
    kernels = [(weight * s**power, point_weights) for power in range(3)]
    kernels += [(weight * s**power, point_weights * values) for power in range(2)]
    return tuple(oaconvolve(samples, kernel, mode="full")[reach : reach + values.size] for kernel, samples in kernels)


def _sum_uneven_points(x: FloatArray, values: FloatArray) -> tuple[FloatArray, ...]:
    """Return the sums of `_sum_even_points` for uneven points, in widths of the weight."""
    point_weights = np.gradient(x)  # axial length per point
    point_weights[[0, -1]] *= 0.5
    moments = np.empty((5, x.size))
    for index, centre in enumerate(x):
        nearby = slice(*np.searchsorted(x, (centre - WEIGHT_REACH, centre + WEIGHT_REACH)))
        s = x[nearby] - centre
        weight = point_weights[nearby] * np.exp(-np.pi * s**2)
        moments[:, index] = [weight @ term for term in (np.ones(s.size), s, s**2, values[nearby], s * values[nearby])]
    return tuple(moments)


def extract_ridge(x: FloatArray, y: FloatArray, heights: FloatArray) -> FloatArray:
    """Heights (x) along the highest line of a roller from a map (x, y); NaN where half of a section is missing."""
    # Least squares fit h = p(x) + a y + b x y + c y**2; the line is y = -(a + b x) / (2 c).
    is_measured = np.isfinite(heights)
    counts = is_measured.sum(axis=1)
    is_complete = 2 * counts > y.size
    scale, length = max(float(np.abs(y).max()), 1e-300), max(float(np.abs(x).max()), 1e-300)
    lateral, axial = np.broadcast_to(y / scale, heights.shape), (x / length)[:, None]

    def subtract_means(values: FloatArray) -> FloatArray:
        """Subtract the mean of each section."""
        means = np.sum(values, axis=1, where=is_measured) / np.maximum(counts, 1)
        return np.asarray((values - means[:, None])[is_measured])

    terms = np.stack([subtract_means(term) for term in (lateral, axial * lateral, lateral**2)], axis=1)
    filled_heights = np.where(is_measured, heights, 0.0)
    a, b, c = np.linalg.lstsq(terms, subtract_means(filled_heights), rcond=None)[0]
    slope = a + b * x / length
    ridge_y = -0.5 * scale * slope / c if c < 0 else np.full(x.size, np.nan)
    is_inside = (ridge_y >= y[0]) & (ridge_y <= y[-1])
    if not is_inside[is_complete].all() or not is_complete.any():
        allowed = "such that the surface rises to one line across the map and falls again"
        hint = (
            "turn=90 takes the other axis for the roller's; for a roller without curvature across give one line as CSV"
        )
        raise InvalidInputError("height", "a map without the highest line of a roller", allowed, hint)
    fitted_heights = slope[:, None] * lateral + c * lateral**2
    means = np.sum(filled_heights - fitted_heights, axis=1, where=is_measured) / np.maximum(counts, 1)
    return np.where(is_complete, means - slope**2 / (4 * c), np.nan)


VALUE_NAMES = ("drop", "height")  # names of the values in a file: missing or excess material
# Unresolved corner: least change of the slope over typical changes; distance of the latter in steps. Accuracy.
CORNER_RATIO, CORNER_STEPS = 4.0, 2
MIN_POINTS = 5  # Minimum number of measured points. Limit.
# Minimum number of steps between points in the cut-off, to resolve the filter's weight. Accuracy.
MIN_STEPS = 5
# Outlier: minimum difference from the median of five points over the typical bend (median of half the second
# differences of eleven points, or of all points if larger), and over the height without its outer tenth. Accuracy.
SPIKE_RATIO, SPIKE_FRACTION = 8.0, 0.02


@dataclass(frozen=True, repr=False)
class Measured(Shape):
    """A measured profile, interpolated without overshoot between its points.

    Parameters
    ----------
    positions : sequence of float
        Positions along the roller, metres, increasing. The midpoint of the measured range is mid-length.
    drops : sequence of float
        Drop at each position, metres, not negative.
    largest_spike : float, optional
        Maximum difference (metres) of a point, or of two neighbours, from the median of five points; larger differences
        are outliers. Default: 8 times the typical bend nearby, at least 0.02 of the profile's height.
    cutoff : float, optional
        Cut-off of a Gaussian filter, metres: the wavelength of transmission one half. The filtered drop is relative to
        its highest point. Default: no filter.

    Raises
    ------
    InvalidInputError
        If positions and drops differ in number, positions are not increasing or have a gap, a value is negative or
        not finite, a point is an outlier (with the positions), the cut-off is shorter than five steps or longer than
        the profile, or (on use) the measured length differs from the roller's by more than 0.1 %.

    Notes
    -----
    The interpolation is piecewise cubic with continuous slope: at each point the slope of the parabola through it and
    its neighbours, limited so that the cubic is monotone between points except at a crest whose curvature the
    neighbouring points share (H. T. Huynh, SIAM Journal on Numerical Analysis 30 (1993) 57-100, constraint M3). `solve`
    adds to the error of the peak the difference from a second interpolation, with harmonic-mean slopes (F. N. Fritsch,
    J. Butland, SIAM Journal on Scientific and Statistical Computing 5 (1984) 300-304).

    Examples
    --------
    >>> x = np.linspace(0.0, 10e-3, 101)
    >>> profile = Measured(positions=x, drops=(x - 5e-3) ** 2 / (2 * 1.25))
    >>> (1e6 * profile.drop(np.array([0.0, 5e-3]), length=10e-3)).round(3).tolist()
    [0.0, 10.0]
    """

    positions: Sequence[float]
    drops: Sequence[float]
    largest_spike: float | None = field(default=None, metadata=POSITIVE_LENGTH)
    cutoff: float | None = field(default=None, metadata=POSITIVE_LENGTH)

    def __post_init__(self) -> None:
        x = checks.coordinates("positions", in_si("positions", self.positions, "m"), "metres")
        try:
            drops = np.asarray(in_si("drops", self.drops, "m"), dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise InvalidInputError("drops", self.drops, "numbers (metres)") from None
        if drops.shape != x.shape:
            raise InvalidInputError("drops", f"{drops.size} values", f"one for each of {x.size} positions")
        check_positions("positions", x, MIN_POINTS)
        check_values("drops", drops, ("x", x))
        if drops.max() > checks.MAX_MAGNITUDE:
            raise InvalidInputError("drops", drops.max(), f"at most {checks.MAX_MAGNITUDE:g} (metres)", "units are SI")
        if drops.min() < 0:
            index = int(drops.argmin())
            value = f"{drops[index]:g} m at x = {x[index]:g} m"
            raise InvalidInputError("drops", value, "not below zero", "remove_offset=True when reading")
        super().__post_init__()
        if self.cutoff is not None:
            min_cutoff, max_cutoff = MIN_STEPS * float(np.diff(x).max()), float(x[-1] - x[0])
            if not min_cutoff <= self.cutoff <= max_cutoff:
                allowed = (
                    f"from {MIN_STEPS} steps between points, {min_cutoff:g} m, to the measured length, {max_cutoff:g} m"
                )
                raise InvalidInputError("cutoff", self.cutoff, allowed, "units are SI")
        check_outliers(x, drops, self.largest_spike)
        checks.store(self, positions=tuple(x.tolist()), drops=tuple(drops.tolist()))

    def __repr__(self) -> str:
        length = format_quantity(self.positions[-1] - self.positions[0], "m")
        drop = format_quantity(float(self._filtered.max()), "m")
        cutoff = "" if self.cutoff is None else f", Gaussian filter with cut-off {format_quantity(self.cutoff, 'm')}"
        return f"Measured({len(self.positions)} points over {length}, drop up to {drop}{cutoff})"

    @classmethod
    def from_file(
        cls,
        path: str | Path,
        *,
        remove_tilt: bool = False,
        remove_offset: bool = False,
        largest_spike: float | None = None,
        cutoff: float | None = None,
        turn: int = 0,
    ) -> Measured:
        """Read a profile from a file.

        Parameters
        ----------
        path : str or Path
            CSV or netCDF (ending ``.nc``) with positions `x` and either `drop` (positive for missing material)
            or `height` (positive for excess material), all with units of length. Or an instrument's file with the
            heights of a line or of a map, x3p or a format of SurfaceTopography, with the extra `measured`. From a map
            the code extracts the roller's highest line, averaged over the map's width.
        remove_tilt : bool
            Whether to subtract the slope of the best straight line, about mid-length.
        remove_offset : bool
            Whether to subtract the drop of the highest point. Necessary for waviness about a mean line, for heights,
            and usually after removing a tilt.
        largest_spike, cutoff : float, optional
            See the class.
        turn : {0, 90, 180, 270}
            Rotation of the measured heights about their axis, degrees, from x to y: 180 exchanges the roller's ends, 90
            exchanges the axes of a map.

        Raises
        ------
        InvalidInputError
            If the file is unreadable, has other columns or units, or the class rejects its points.
        ContactStudyError
            If the file needs the extra `measured`, which is not installed.
        """
        for flag, value in (("remove_tilt", remove_tilt), ("remove_offset", remove_offset)):
            checks.instance(flag, value, (bool, np.bool_), "True or False")
        measured, name = read_measurement(Path(path), ("x",), VALUE_NAMES)
        x, y, drop = rotate_heights(measured, turn)
        if y is not None:
            drop = extract_ridge(x, y, drop)
        if name == "height":
            drop = -drop
        if remove_tilt or remove_offset:
            check_positions("x", x, MIN_POINTS)
            check_values(name, drop, ("x", x))
        if remove_tilt:
            axial_distance = x - 0.5 * (x[0] + x[-1])
            drop = drop - np.polynomial.polynomial.polyfit(axial_distance, drop, 1)[1] * axial_distance
        if remove_offset:
            drop = drop - drop.min()
        return cls(x.tolist(), drop.tolist(), largest_spike, cutoff)

    @cached_property
    def _filtered(self) -> FloatArray:
        """Drops at the positions, filtered with a cut-off."""
        drops = np.asarray(self.drops)
        if self.cutoff is None:
            return drops
        filtered = filter_gaussian(np.asarray(self.positions), drops, self.cutoff)
        return np.asarray(filtered - filtered.min())

    @cached_property
    def _interpolation(self) -> Any:
        spline = interpolate_with_limited_slopes(self._axial_distances, self._filtered)
        extrema = spline.derivative().roots(discontinuity=False, extrapolate=False)
        spline.c[3] -= min(0.0, float(np.min(spline(extrema[np.isfinite(extrema)]), initial=0.0)))
        return spline

    @property
    def _axial_distances(self) -> FloatArray:
        """Positions from mid-length, metres."""
        x = np.asarray(self.positions)
        return np.asarray(x - 0.5 * (x[0] + x[-1]))

    def nodes(self, length: float) -> SlopeJumps:
        """Points, with the jumps at unresolved corners, where the slope changes within one or two steps.

        A filtered profile has no corners: its slope changes over the cut-off.
        """
        x, drops = self._axial_distances, self._filtered
        slope_changes = np.zeros(x.size)
        if self.cutoff is not None:
            return SlopeJumps(x, slope_changes)
        slope_changes[1:-1] = np.diff(np.diff(drops) / np.diff(x))
        magnitude = np.abs(slope_changes)
        padded = np.pad(magnitude, CORNER_STEPS, mode="edge")
        neighbours = np.maximum(padded[: x.size], padded[2 * CORNER_STEPS :])
        local_maxima = sliding_window_view(np.pad(magnitude, 1), 3).max(axis=-1)
        typical_slope_changes = np.maximum(neighbours, np.median(magnitude))
        is_corner = (
            (magnitude == local_maxima) & (magnitude > CORNER_RATIO * typical_slope_changes) & (magnitude > MIN_JUMP)
        )
        corner_jumps = np.convolve(slope_changes, np.ones(3), mode="same")
        return SlopeJumps(x, np.where(is_corner, corner_jumps, 0.0))

    def second_interpolation(self) -> Measured:
        """Profile through the same points with harmonic-mean slopes."""
        return _HarmonicMean(self.positions, self.drops, largest_spike=self.largest_spike, cutoff=self.cutoff)

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        measured_length = self.positions[-1] - self.positions[0]
        # Largest difference of a measured length from the roller's, over the latter
        if abs(measured_length - length) > 1e-3 * length:
            value = f"{measured_length:g} m from first to last"
            hint = f"it is {'longer' if measured_length > length else 'shorter'}"
            raise InvalidInputError("positions", value, f"the roller's length, {length:g} m", hint)
        clipped_x = np.clip(x, -measured_length / 2, measured_length / 2)
        return np.asarray(np.maximum(self._interpolation(clipped_x), 0.0))


class _HarmonicMean(Measured):
    """Measured profile with harmonic-mean slopes."""

    @cached_property
    def _interpolation(self) -> Any:
        from scipy.interpolate import PchipInterpolator

        with np.errstate(over="ignore"):  # steps of 1e-300 m, harmless in a harmonic mean
            return PchipInterpolator(self._axial_distances, self._filtered)

    def second_interpolation(self) -> Measured:
        """Return the profile."""
        return self


def interpolate_with_limited_slopes(x: FloatArray, drops: FloatArray) -> Any:
    """Cubic spline with slopes of the parabolas through three points, limited by Huynh's constraint M3."""
    from scipy.interpolate import CubicHermiteSpline

    steps = np.diff(x)
    secants = np.diff(drops) / steps
    bends = np.diff(secants) / (steps[1:] + steps[:-1])
    bends = np.concatenate([bends[:1], bends, bends[-1:]])
    slopes = np.append(secants - bends[:-1] * steps, secants[-1] + bends[-1] * steps[-1])
    shared_bends = minmod(bends[:-1], bends[1:])
    left_slopes, right_slopes = secants + shared_bends * steps, secants - shared_bends * steps
    quadratic_slopes = np.concatenate([right_slopes[:1], minmod(left_slopes[:-1], right_slopes[1:]), left_slopes[-1:]])
    monotone_slopes = np.concatenate([secants[:1], minmod(secants[:-1], secants[1:]), secants[-1:]])
    limits = np.copysign(np.maximum(3 * np.abs(monotone_slopes), 1.5 * np.abs(quadratic_slopes)), quadratic_slopes)
    return CubicHermiteSpline(x, drops, minmod(slopes, np.where(quadratic_slopes == 0, 0.0, limits)))


def minmod(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return of `a` and `b` the value closer to 0 where both signs agree; 0 elsewhere."""
    smaller = np.minimum(np.abs(a), np.abs(b))
    return np.asarray(np.where(a * b > 0, np.copysign(smaller, a), 0.0))


def check_outliers(x: FloatArray, drops: FloatArray, max_spike: float | None = None) -> None:
    """Raise if a drop differs from its neighbours by more than `max_spike`, metres; default as in :class:`Measured`."""
    spikes = np.abs(drops - _running_median(drops, 2, "odd"))
    if max_spike is None:
        low, high = np.quantile(drops, [0.05, 0.95])
        bends = np.pad(0.5 * np.abs(np.diff(drops, 2)), 1, mode="reflect")
        # The median of eleven bends of noise may be small by chance, unlike the median of all bends.
        typical_bends = np.maximum(_running_median(bends, 5, "even"), np.median(bends))
        limits = np.maximum(SPIKE_RATIO * typical_bends, SPIKE_FRACTION * (high - low))
    else:
        limits = np.full(drops.shape, max_spike)
    # The medians next to an outlier contain it: only the largest of neighbouring spikes is an outlier.
    local_max = sliding_window_view(np.pad(spikes, 2), 5).max(axis=-1)
    outliers = np.flatnonzero((spikes > limits) & (spikes == local_max))
    if outliers.size:
        listing = ", ".join(f"{spikes[index]:.2g} m at x = {x[index]:g} m" for index in outliers[:5])
        allowed = f"within {limits[outliers[0]]:.2g} m of the median of their neighbours"
        raise InvalidInputError("drops", f"{outliers.size} outliers: {listing}", allowed)


def _running_median(values: FloatArray, half_count: int, parity: Literal["odd", "even"]) -> FloatArray:
    """Median of each value and `half_count` neighbours on either side; the series is mirrored at its ends."""
    half_count = min(half_count, values.size - 1)
    padded = np.pad(values, half_count, mode="reflect", reflect_type=parity)
    return np.asarray(np.median(sliding_window_view(padded, 2 * half_count + 1), axis=-1))
