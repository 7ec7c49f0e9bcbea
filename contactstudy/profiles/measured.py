"""A measured profile: highest line of a map, Gaussian filter, interpolation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from contactstudy import checks
from contactstudy.arrays.engineering import format_quantity
from contactstudy.arrays.variables import numbers_in_si
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import LEAST_JUMP, Shape, SlopeJumps
from contactstudy.profiles.instruments import Heights, of_instrument, read_heights, turned
from contactstudy.profiles.measurements import check_positions, check_values, read_columns, read_netcdf, unit_in_metres

ALPHA = np.sqrt(np.log(2) / np.pi)  # Makes the transmission one half at the cut-off (ISO 16610-21)
REACH = 2.2  # Half the width of the weight over ``ALPHA`` times the cut-off; beyond it is less than 3e-7 of its peak
CHUNK = 256  # Points that are filtered at once


def gaussian_filtered(x: FloatArray, values: FloatArray, cutoff: float) -> FloatArray:
    """Values low-passed with ISO 16610-21's weight: transmission ``2**-(cutoff / l)**2`` at wavelength l."""
    # A weighted linear fit at each point keeps zeroth and first moments at the ends (ISO 16610-28; Brinkmann 2001).
    width = ALPHA * cutoff
    step = (x[-1] - x[0]) / (x.size - 1)
    # Deviation from even spacing, over a step, up to which Fourier transforms filter the points
    even = np.abs(x - np.linspace(x[0], x[-1], x.size)).max() <= 1e-3 * step
    zeroth, first, second, mean, moment = _even(step / width, values) if even else _uneven(x / width, values)
    return np.asarray((second * mean - first * moment) / (zeroth * second - first**2))


def _even(step: float, values: FloatArray) -> tuple[FloatArray, ...]:
    """Return the sums of the weight times 1, ``s``, ``s**2``, the values and ``s`` times these at each even point."""
    from scipy.signal import oaconvolve

    reach = min(int(REACH / step), values.size - 1)
    s = step * np.arange(reach, -reach - 1, -1)  # a convolution turns it round
    weight = step * np.exp(-np.pi * s**2)
    shares = np.ones(values.size)
    shares[[0, -1]] = 0.5  # half a step belongs to each end
    pairs = [(weight * s**power, shares) for power in range(3)]
    pairs += [(weight * s**power, shares * values) for power in range(2)]
    return tuple(oaconvolve(samples, kernel, mode="full")[reach : reach + values.size] for kernel, samples in pairs)


def _uneven(x: FloatArray, values: FloatArray) -> tuple[FloatArray, ...]:
    """Return the same sums for points anywhere, in widths of the weight."""
    shares = np.gradient(x)  # axial length per point
    shares[[0, -1]] *= 0.5
    moments = np.empty((5, x.size))
    for begin in range(0, x.size, CHUNK):
        centres = x[begin : begin + CHUNK]
        low, high = np.searchsorted(x, (centres[0] - REACH, centres[-1] + REACH))
        near = slice(low, high)
        s = x[near] - centres[:, None]
        weight = np.where(np.abs(s) <= REACH, shares[near] * np.exp(-np.pi * s**2), 0.0)
        sums = [np.sum(weight * s**power, axis=1) for power in range(3)]
        moments[:, begin : begin + CHUNK] = [*sums, weight @ values[near], (weight * s) @ values[near]]
    return tuple(moments)


def ridge(x: FloatArray, y: FloatArray, heights: FloatArray) -> FloatArray:
    """Heights (x) along the highest line of a roller from a map (x, y); NaN where half of a section is missing.

    Least squares fit ``h = p(x) + a y + b x y + c y**2``; the line is ``y = -(a + b x) / (2 c)``.
    """
    measured = np.isfinite(heights)
    counts = measured.sum(axis=1)
    complete = 2 * counts > y.size
    scale, length = max(float(np.abs(y).max()), 1e-300), max(float(np.abs(x).max()), 1e-300)
    lateral, axial = np.broadcast_to(y / scale, heights.shape), (x / length)[:, None]

    def centred(values: FloatArray) -> FloatArray:
        """Without the mean of each section."""
        means = np.sum(values, axis=1, where=measured) / np.maximum(counts, 1)
        return np.asarray((values - means[:, None])[measured])

    terms = np.stack([centred(term) for term in (lateral, axial * lateral, lateral**2)], axis=1)
    filled = np.where(measured, heights, 0.0)
    a, b, c = np.linalg.lstsq(terms, centred(filled), rcond=None)[0]
    slope = a + b * x / length
    highest = -0.5 * scale * slope / c if c < 0 else np.full(x.size, np.nan)
    inside = (highest >= y[0]) & (highest <= y[-1])
    if not inside[complete].all() or not complete.any():
        raise InvalidInputError(
            "height",
            "a map without the highest line of a roller in it",
            "such that the surface rises to one line across the map and falls again",
            "turn=90 takes the other axis for the roller's; for a part that is straight across give one line as CSV",
        )
    form = slope[:, None] * lateral + c * lateral**2
    means = np.sum(filled - form, axis=1, where=measured) / np.maximum(counts, 1)
    return np.where(complete, means - slope**2 / (4 * c), np.nan)


VALUES = ("drop", "height")  # Values of a file along x: missing material, or excess material
# Change of the slope at a point, over the usual change and over the change this many steps away, above which the points
# do not resolve a corner
CORNER_BENDS, CORNER_REACH = 4.0, 2
FEWEST = 5  # Smallest number of measured points
# Smallest number of steps between points in the cut-off of a filter: with fewer its weight is not seen
FEWEST_IN_WAVE = 5
# A point is an outlier if it stands out of the median of five points by more than this many times the usual bend around
# it (median of half the second differences of eleven points, or of all if that is more), and by more than this share of
# the profile's height (without the outer tenth of its values)
SPIKE_BENDS, SPIKE_SHARE = 8.0, 0.02


@dataclass(frozen=True, repr=False)
class Measured(Shape):
    """A measured profile, interpolated without overshoot between its points.

    Parameters
    ----------
    positions : sequence of float
        Positions along the roller, metres, increasing. Only differences count: the middle of the measured range is
        mid-length.
    drops : sequence of float
        Drop at each position, metres, not negative.
    largest_spike : float, optional
        How far (metres) a point, or two beside each other, may stand out of the median of five points before it is
        refused as an outlier. Default: 8 times the usual bend around it, at least 0.02 of the profile's height.
    cutoff : float, optional
        Cut-off of a Gaussian filter, metres: of waves of this length one half is left, of shorter ones less. The
        filtered drop is counted from its highest point. Default: the points as they are.

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
    largest_spike: float | None = None
    cutoff: float | None = None

    def __post_init__(self) -> None:
        x = checks.coordinates("positions", numbers_in_si("positions", self.positions, "m"), "metres")
        try:
            drops = np.asarray(numbers_in_si("drops", self.drops, "m"), dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise InvalidInputError("drops", self.drops, "numbers (metres)") from None
        if drops.shape != x.shape:
            raise InvalidInputError("drops", f"{drops.size} values", f"one for each of {x.size} positions")
        check_positions("positions", x, FEWEST)
        check_values("drops", drops, ("x", x))
        if drops.max() > checks.MAX_MAGNITUDE:
            raise InvalidInputError("drops", drops.max(), f"at most {checks.MAX_MAGNITUDE:g} (metres)", "units are SI")
        if drops.min() < 0:
            index = int(drops.argmin())
            raise InvalidInputError(
                "drops",
                f"{drops[index]:g} m at x = {x[index]:g} m",
                "not below zero",
                "remove_offset=True when reading",
            )
        if self.largest_spike is not None:
            object.__setattr__(self, "largest_spike", checks.positive("largest_spike", self.largest_spike, "metres"))
        if self.cutoff is not None:
            length = checks.positive("cutoff", self.cutoff, "metres")
            least, most = FEWEST_IN_WAVE * float(np.diff(x).max()), float(x[-1] - x[0])
            if not least <= length <= most:
                allowed = f"from {FEWEST_IN_WAVE} steps between points, {least:g} m, to the measured length, {most:g} m"
                raise InvalidInputError("cutoff", length, allowed, "units are SI")
            checks.store(self, cutoff=length)
        refuse_outliers(x, drops, self.largest_spike)
        object.__setattr__(self, "positions", tuple(x.tolist()))
        object.__setattr__(self, "drops", tuple(drops.tolist()))

    def __repr__(self) -> str:
        length, drop = (
            format_quantity(self.positions[-1] - self.positions[0], "m"),
            format_quantity(float(self._smooth.max()), "m"),
        )
        filtered = "" if self.cutoff is None else f", Gaussian filter with cut-off {format_quantity(self.cutoff, 'm')}"
        return f"Measured({len(self.positions)} points over {length}, drop up to {drop}{filtered})"

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
            CSV or netCDF (ending ``.nc``) with positions `x` and either `drop` (positive where material is missing)
            or `height` (positive where it is too much), all with units of length. Or an instrument's file with the
            heights of a line or of a map, x3p or a format of SurfaceTopography, with the extra `measured`. Of a map
            the roller's highest line is taken, averaged over the map's width.
        remove_tilt : bool
            Whether the slope of the straight line that fits the points best is taken off, about mid-length.
        remove_offset : bool
            Whether the drop is counted from the highest point. Needed for waviness about a mean line, for heights,
            and mostly after removing a tilt.
        largest_spike, cutoff : float, optional
            See the class.
        turn : {0, 90, 180, 270}
            Degrees by which the part is turned about the axis of the heights, from x to y: 180 exchanges the roller's
            ends, 90 takes a map's y for the roller's axis.

        Raises
        ------
        InvalidInputError
            If the file cannot be read, has other columns or units, or its points are refused by the class.
        ContactStudyError
            If the file needs the extra `measured`, and that is not installed.
        """
        for flag, value in (("remove_tilt", remove_tilt), ("remove_offset", remove_offset)):
            checks.instance(flag, value, (bool, np.bool_), "True or False")
        x, drop, name = _read(Path(path), turn)
        if remove_tilt or remove_offset:
            check_positions("x", x, FEWEST)
            check_values(name, drop, ("x", x))
        if remove_tilt:
            from_middle = x - 0.5 * (x[0] + x[-1])
            drop = drop - np.polynomial.polynomial.polyfit(from_middle, drop, 1)[1] * from_middle
        if remove_offset:
            drop = drop - drop.min()
        return cls(x.tolist(), drop.tolist(), largest_spike, cutoff)

    @cached_property
    def _smooth(self) -> FloatArray:
        """Drops at the positions, filtered if that is wanted."""
        drops = np.asarray(self.drops)
        if self.cutoff is None:
            return drops
        filtered = gaussian_filtered(np.asarray(self.positions), drops, self.cutoff)
        return np.asarray(filtered - filtered.min())

    @cached_property
    def _interpolation(self) -> Any:
        from scipy.interpolate import CubicHermiteSpline

        x, drops = self._from_middle, self._smooth
        spline = CubicHermiteSpline(x, drops, _limited_slopes(x, drops))
        extrema = spline.derivative().roots(discontinuity=False, extrapolate=False)
        spline.c[3] -= min(0.0, float(np.min(spline(extrema[np.isfinite(extrema)]), initial=0.0)))
        return spline

    @property
    def _from_middle(self) -> FloatArray:
        """Positions from mid-length, metres."""
        x = np.asarray(self.positions)
        return np.asarray(x - 0.5 * (x[0] + x[-1]))

    def nodes(self, length: float) -> FloatArray:
        """Distances from mid-length (m) of the points."""
        return self._from_middle

    def slope_jumps(self, length: float) -> SlopeJumps:
        """Points at which the slope changes within one or two steps, so that the points do not resolve the corner.

        A filtered profile has none: its bends extend over the cut-off.
        """
        x, drops = self._from_middle, self._smooth
        bends = np.zeros(x.size)
        bends[1:-1] = np.diff(np.diff(drops) / np.diff(x))
        if self.cutoff is not None:
            return super().slope_jumps(length)
        size = np.abs(bends)
        padded = np.pad(size, CORNER_REACH, mode="edge")
        neighbours = np.maximum(padded[: x.size], padded[2 * CORNER_REACH :])
        largest = sliding_window_view(np.pad(size, 1), 3).max(axis=-1)
        usual = np.maximum(neighbours, np.median(size))
        corner = (size == largest) & (size > CORNER_BENDS * usual) & (size > LEAST_JUMP)
        total = np.convolve(bends, np.ones(3), mode="same")
        return SlopeJumps(x[corner], total[corner])

    def second_interpolation(self) -> Measured:
        """Profile through the same points with harmonic-mean slopes."""
        return _HarmonicMean(self.positions, self.drops, largest_spike=self.largest_spike, cutoff=self.cutoff)

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        measured = self.positions[-1] - self.positions[0]
        # Largest difference of a measured length from the roller's, over the latter
        if abs(measured - length) > 1e-3 * length:
            word = "longer" if measured > length else "shorter"
            raise InvalidInputError(
                "positions", f"{measured:g} m from first to last", f"the roller's length, {length:g} m", f"it is {word}"
            )
        inside = np.clip(x, -measured / 2, measured / 2)
        return np.asarray(np.maximum(self._interpolation(inside), 0.0))


class _HarmonicMean(Measured):
    """Measured profile with harmonic-mean slopes."""

    @cached_property
    def _interpolation(self) -> Any:
        from scipy.interpolate import PchipInterpolator

        with np.errstate(over="ignore"):  # steps of 1e-300 m, harmless in a harmonic mean
            return PchipInterpolator(self._from_middle, self._smooth)

    def second_interpolation(self) -> Measured:
        """Profile itself."""
        return self


def _limited_slopes(x: FloatArray, drops: FloatArray) -> FloatArray:
    """Slopes of the parabolas through three points, limited by Huynh's constraint M3."""
    steps = np.diff(x)
    secants = np.diff(drops) / steps
    bends = np.diff(secants) / (steps[1:] + steps[:-1])
    bends = np.concatenate([bends[:1], bends, bends[-1:]])
    slopes = np.append(secants - bends[:-1] * steps, secants[-1] + bends[-1] * steps[-1])
    shared = _minmod(bends[:-1], bends[1:])
    from_left, from_right = secants + shared * steps, secants - shared * steps
    quadratic = np.concatenate([from_right[:1], _minmod(from_left[:-1], from_right[1:]), from_left[-1:]])
    monotone = np.concatenate([secants[:1], _minmod(secants[:-1], secants[1:]), secants[-1:]])
    limits = np.copysign(np.maximum(3 * np.abs(monotone), 1.5 * np.abs(quadratic)), quadratic)
    return _minmod(slopes, np.where(quadratic == 0, 0.0, limits))


def _minmod(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return the value closer to 0 where both signs agree; 0 elsewhere."""
    smaller = np.minimum(np.abs(first), np.abs(second))
    return np.asarray(np.where(first * second > 0, np.copysign(smaller, first), 0.0))


def _read(path: Path, turn: int) -> tuple[FloatArray, FloatArray, str]:
    """Positions and drops of a file, metres, and the name of the values."""
    if of_instrument(path):
        x, y, heights = turned(read_heights(path), turn)
        return x, -(heights if y is None else ridge(x, y, heights)), "height"
    columns = _read_netcdf(path) if path.suffix.lower() == ".nc" else read_columns(path, ("x",), VALUES)
    name = next(name for name in columns if name != "x")
    x, _, values = turned(Heights(columns["x"], None, columns[name]), turn)
    return x, values if name == "drop" else -values, name


def _read_netcdf(path: Path) -> dict[str, FloatArray]:
    """Positions and values of a netCDF file, in metres."""
    dataset = read_netcdf(path)
    present = [name for name in VALUES if name in dataset.data_vars]
    if len(present) != 1 or "x" not in dataset.variables or dataset[present[0]].dims != dataset["x"].dims:
        raise InvalidInputError("path", str(path), f"a file with x and one of {', '.join(VALUES)} along it")
    return {
        name: unit_in_metres(name, dataset[name].attrs.get("units")) * dataset[name].values.astype(np.float64)
        for name in ("x", present[0])
    }


def refuse_outliers(x: FloatArray, drops: FloatArray, largest: float | None = None) -> None:
    """Raise if a drop differs from its neighbours by more than `largest`, metres; default as in :class:`Measured`."""
    spikes = np.abs(drops - _running_median(drops, 2, "odd"))
    if largest is None:
        low, high = np.quantile(drops, [0.05, 0.95])
        bends = np.pad(0.5 * np.abs(np.diff(drops, 2)), 1, mode="reflect")
        # The median of eleven bends of noise is small by chance; the median of all is not.
        usual = np.maximum(_running_median(bends, 5, "even"), np.median(bends))
        limits = np.maximum(SPIKE_BENDS * usual, SPIKE_SHARE * (high - low))
    else:
        limits = np.full(drops.shape, largest)
    # next to an outlier the median contains it: only the worst of neighbours is named
    worst = sliding_window_view(np.pad(spikes, 2), 5).max(axis=-1)
    outliers = np.flatnonzero((spikes > limits) & (spikes == worst))
    if outliers.size:
        listing = ", ".join(f"{spikes[index]:.2g} m at x = {x[index]:g} m" for index in outliers[:5])
        raise InvalidInputError(
            "drops",
            f"{outliers.size} outliers: {listing}",
            f"within {limits[outliers[0]]:.2g} m of the median of their neighbours",
        )


def _running_median(values: FloatArray, reach: int, mirror: Literal["odd", "even"]) -> FloatArray:
    """Median of each value and `reach` on either side; beyond its ends the series is its own mirror image."""
    reach = min(reach, values.size - 1)
    padded = np.pad(values, reach, mode="reflect", reflect_type=mirror)
    return np.asarray(np.median(sliding_window_view(padded, 2 * reach + 1), axis=-1))
