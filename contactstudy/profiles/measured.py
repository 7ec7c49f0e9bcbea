"""A profile as it was measured."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from contactstudy import checks
from contactstudy.arrays.engineering import quantity
from contactstudy.arrays.gaussian_filter import gaussian_filtered
from contactstudy.arrays.instruments import Heights, of_instrument, read_heights, turned
from contactstudy.arrays.measurements import check_positions, check_values, read_columns, read_netcdf, unit_in_metres
from contactstudy.arrays.units import numbers_in_si
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.base import Shape
from contactstudy.profiles.ridge import ridge

VALUES = ("drop", "height")
"""What a file may say along x: material that is missing, or that is too much."""

FITS = 1e-3
"""Largest difference of a measured length from the roller's, over the latter."""

FEWEST = 5
"""Smallest number of measured points."""

FEWEST_IN_WAVE = 5
"""Smallest number of steps between points in the cut-off of a filter: with fewer its weight is not seen. Accuracy."""

SPIKE_BENDS, SPIKE_SHARE = 8.0, 0.02
"""A point is an outlier if it stands out of the median of five points by more than this many times the usual bend
around it (median of half the second differences of eleven points, or of all if that is more), and by more than this
share of the profile's height (without the outer tenth of its values)."""


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
    The filter is that of ISO 16610-21: of a wavelength `l` it transmits ``2**-(cutoff / l)**2``. Within a cut-off of
    the ends a straight line is fitted with the filter's weight, so that an inclined end keeps its inclination (moment
    criterion, ISO 16610-28). Outliers are looked for before. Features shorter than the cut-off are rounded off, edges
    too: a filter for the shape of an end is shorter than the end.

    The interpolation is piecewise cubic with continuous slope (F. N. Fritsch, J. Butland, SIAM Journal on Scientific
    and Statistical Computing 5 (1984) 300-304): monotone between two points, so it adds no height of its own. A
    median does not change where a profile only rises or falls, so steep ends are no outliers. Of the very first and
    last point nothing can be said.

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
        """Check the points, and keep them as tuples so that equal profiles are equal."""
        x = checks.coordinates("positions", numbers_in_si("positions", self.positions, "m"), "metres")
        try:
            drops = np.asarray(numbers_in_si("drops", self.drops, "m"), dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise InvalidInputError("drops", self.drops, "numbers (metres)") from None
        if drops.shape != x.shape:
            raise InvalidInputError("drops", f"{drops.size} values", f"one for each of {x.size} positions")
        check_positions("positions", x, FEWEST)
        check_values("drops", drops, ("x", x))
        if drops.max() > checks.LARGEST:
            raise InvalidInputError("drops", drops.max(), f"at most {checks.LARGEST:g} (metres)", "units are SI")
        if drops.min() < 0:
            at = int(drops.argmin())
            raise InvalidInputError(
                "drops", f"{drops[at]:g} m at x = {x[at]:g} m", "not below zero", "remove_offset=True when reading"
            )
        if self.largest_spike is not None:
            object.__setattr__(self, "largest_spike", checks.positive("largest_spike", self.largest_spike, "metres"))
        if self.cutoff is not None:
            checks.store(self, cutoff=_checked_cutoff(self.cutoff, x))
        refuse_outliers(x, drops, self.largest_spike)
        object.__setattr__(self, "positions", tuple(x.tolist()))
        object.__setattr__(self, "drops", tuple(drops.tolist()))

    def __repr__(self) -> str:
        said = dict(self._said())
        filtered = f", Gaussian filter with cut-off {said['cut-off']}" if "cut-off" in said else ""
        return f"Measured({said['points']} points over {said['over']}, drop up to {said['drop up to']}{filtered})"

    def _said(self) -> Iterator[tuple[str, str]]:
        """Size of what was measured; the points would fill pages."""
        yield "points", str(len(self.positions))
        yield "over", quantity(self.positions[-1] - self.positions[0], "m")
        yield "drop up to", quantity(float(self._smooth.max()), "m")
        if self.cutoff is not None:
            yield "cut-off", quantity(self.cutoff, "m")

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
            heights of a line or of a map: x3p (``.x3p``), or a format that SurfaceTopography knows; both need the
            extra `measured`. Of a map the roller's highest line is taken, wherever it runs, averaged over the map's
            width.
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
        from scipy.interpolate import PchipInterpolator

        x = np.asarray(self.positions)
        with np.errstate(over="ignore"):  # steps of 1e-300 m, harmless in a harmonic mean
            return PchipInterpolator(x - 0.5 * (x[0] + x[-1]), self._smooth)

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        measured = self.positions[-1] - self.positions[0]
        if abs(measured - length) > FITS * length:
            word = "longer" if measured > length else "shorter"
            raise InvalidInputError(
                "positions", f"{measured:g} m from first to last", f"the roller's length, {length:g} m", f"it is {word}"
            )
        inside = np.clip(x, -measured / 2, measured / 2)
        return np.asarray(np.maximum(self._interpolation(inside), 0.0))


def _checked_cutoff(cutoff: object, x: FloatArray) -> float:
    """Return a cut-off that suits the positions, or raise."""
    found = checks.positive("cutoff", cutoff, "metres")
    least, most = FEWEST_IN_WAVE * float(np.diff(x).max()), float(x[-1] - x[0])
    if not least <= found <= most:
        allowed = f"from {FEWEST_IN_WAVE} steps between points, {least:g} m, to the measured length, {most:g} m"
        raise InvalidInputError("cutoff", found, allowed, "units are SI")
    return found


def _read(path: Path, turn: int) -> tuple[FloatArray, FloatArray, str]:
    """Positions and drops of a file, metres, and what the file calls the latter."""
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
    """Raise if a point stands far out of its neighbours.

    Parameters
    ----------
    x, drops : array
        Positions and drops, metres.
    largest : float, optional
        How far is too far, metres; default as in :class:`Measured`.

    Raises
    ------
    InvalidInputError
        With the positions of the outliers.
    """
    spikes = np.abs(drops - _running_median(drops, 2, "odd"))
    if largest is None:
        low, high = np.quantile(drops, [0.05, 0.95])
        bends = np.pad(0.5 * np.abs(np.diff(drops, 2)), 1, mode="reflect")
        # The median of eleven bends of mere noise is now and then small; that of all is not.
        usual = np.maximum(_running_median(bends, 5, "even"), np.median(bends))
        limits = np.maximum(SPIKE_BENDS * usual, SPIKE_SHARE * (high - low))
    else:
        limits = np.full(drops.shape, largest)
    # beside an outlier the median is that of other points: only the worst of neighbours is named
    worst = sliding_window_view(np.pad(spikes, 2), 5).max(axis=-1)
    outliers = np.flatnonzero((spikes > limits) & (spikes == worst))
    if outliers.size:
        shown = ", ".join(f"{spikes[at]:.2g} m at x = {x[at]:g} m" for at in outliers[:5])
        raise InvalidInputError(
            "drops",
            f"{outliers.size} outliers: {shown}",
            f"within {limits[outliers[0]]:.2g} m of the median of their neighbours",
        )


def _running_median(values: FloatArray, reach: int, mirror: Literal["odd", "even"]) -> FloatArray:
    """Median of each value and `reach` on either side; beyond its ends the series is its own mirror image."""
    reach = min(reach, values.size - 1)
    padded = np.pad(values, reach, mode="reflect", reflect_type=mirror)
    return np.asarray(np.median(sliding_window_view(padded, 2 * reach + 1), axis=-1))
