"""Height maps of rough surfaces on a grid: random surfaces and measurements.

A height map is a DataArray ``(x, y)`` of metres on cell centres, positive where material sticks out and closes the gap.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import in_si, labelled_cells, labels, name_array
from contactstudy.case.magnitudes import warn_of_values
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.profiles.measurement_files import check_positions, check_values, read_measurement, rotate_heights

COORDINATE_TOLERANCE = 1e-3  # Difference over a cell of positions that count as equal. Rounding.


def _height_map(grid: Grid, heights: FloatArray, source: str) -> xr.DataArray:
    """Heights on a grid with their CF attributes."""
    positions = {"x": grid.x, "y": grid.y}
    coordinates = {name: (name, values, labels(name, coordinate=True)) for name, values in positions.items()}
    return name_array("height", xr.DataArray(heights, coordinates, ("x", "y"))).assign_attrs(source=source)


def self_affine(
    grid: Grid, *, rms_height: float, hurst: float, longest: float, shortest: float, seed: int
) -> xr.DataArray:
    """Isotropic self-affine surface with Gaussian heights.

    Filtered white noise: the power spectral density is ``q**(-2 (1 + hurst))`` between the wavenumbers
    ``2 pi / longest`` and ``2 pi / shortest``, and zero outside.

    Parameters
    ----------
    grid : Grid
        Cells; the surface is periodic over their ranges.
    rms_height : float
        Root mean square of the heights over the grid, metres, kept exactly; the mean is 0. Not negative.
    hurst : float
        Hurst exponent, 0 to 1; the fractal dimension of the surface is ``3 - hurst``. Ground steel has about 0.8.
    longest, shortest : float
        Wavelengths between which the surface is rough, metres: `shortest` at least two cells, `longest` at most the
        larger side of the grid.
    seed : int
        The same seed, grid and values give the same surface, bit for bit with the same version of numpy.

    Returns
    -------
    DataArray (x, y)
        Heights, metres.

    Raises
    ------
    InvalidInputError
        If a value is out of range, or the grid holds no wave between the wavelengths.

    References
    ----------
    Y. Z. Hu, K. Tonder, Simulation of 3-D random rough surface by 2-D digital filter and Fourier analysis,
    International Journal of Machine Tools and Manufacture 32 (1992) 83-90. B. N. J. Persson et al., On the nature of
    surface roughness, Journal of Physics: Condensed Matter 17 (2005) R1-R62 (power spectral density).

    Examples
    --------
    >>> grid = Grid(x_range=(0.0, 1e-3), y_range=(-0.5e-3, 0.5e-3), cells_x=64, cells_y=64)
    >>> rough = self_affine(grid, rms_height=0.2e-6, hurst=0.8, longest=0.5e-3, shortest=50e-6, seed=1)
    >>> rough.dims, round(1e6 * float(np.sqrt((rough**2).mean())), 12)
    (('x', 'y'), 0.2)
    """
    checks.instance("grid", grid, Grid, "a Grid")
    rms_height = checks.not_negative("rms_height", rms_height, "metres")
    hurst = checks.finite("hurst", hurst)
    if not 0 <= hurst <= 1:
        raise InvalidInputError("hurst", hurst, "between 0 and 1")
    longest, shortest = checks.positive("longest", longest, "metres"), checks.positive("shortest", shortest, "metres")
    seed = checks.count("seed", seed, minimum=0)
    minimum = 2 * max(grid.dx, grid.dy)
    if shortest < minimum * (1 - 1e-12):
        raise InvalidInputError("shortest", shortest, f"at least two cells, {minimum:g} m", "or take a finer grid")
    larger_side = max(grid.dx * grid.cells_x, grid.dy * grid.cells_y)
    if not shortest <= longest <= larger_side * (1 + 1e-12):
        raise InvalidInputError("longest", longest, f"between shortest and the grid's larger side, {larger_side:g} m")
    frequency_x, frequency_y = np.fft.fftfreq(grid.cells_x, grid.dx), np.fft.rfftfreq(grid.cells_y, grid.dy)
    frequency = np.hypot(frequency_x[:, None], frequency_y[None, :])
    is_rough = (frequency >= (1 - 1e-9) / longest) & (frequency <= (1 + 1e-9) / shortest)
    if not is_rough.any():
        allowed = "wavelengths with at least one wave of the grid between them"
        raise InvalidInputError("longest, shortest", (longest, shortest), allowed)
    amplitude = np.zeros(frequency.shape)
    amplitude[is_rough] = frequency[is_rough] ** -(1 + hurst)
    noise = np.random.default_rng(seed).standard_normal(grid.shape)
    heights = np.fft.irfft2(amplitude * np.fft.rfft2(noise), s=grid.shape)
    heights *= rms_height / np.sqrt(np.mean(heights**2))
    arguments = f"rms_height={rms_height:g}, hurst={hurst:g}, longest={longest:g}, shortest={shortest:g}, seed={seed}"
    return _height_map(grid, heights, f"contactstudy.roughness.self_affine({arguments})")


def read_height_map(
    path: str | Path,
    grid: Grid,
    *,
    remove_slope: bool = False,
    remove_form: bool = False,
    turn: int = 0,
    mirror: bool = False,
    corner: tuple[float, float] | None = None,
) -> xr.DataArray:
    """Read a measured height map and bring it onto a grid.

    Parameters
    ----------
    path : str or Path
        CSV with one line for each point and the columns `x`, `y`, `height`, in any order of the points; or netCDF
        (ending ``.nc``) with a variable `height` along `x` and `y`. All with units of length. Or an instrument's file,
        x3p or a format of SurfaceTopography, with the extra `measured`. Positions refer to the grid's axes.
    grid : Grid
        Cells; their centres must lie within the measured area. Between measured points heights are interpolated
        linearly along both axes. Cells wider than the steps of the measurement omit or alias short waves: filter
        the map first.
    remove_slope : bool
        Whether to subtract the plane that fits the measured heights best.
    remove_form : bool
        Whether to subtract the surface of second order that fits the measured heights best: the curvature of roller
        and raceway, and the slope.
    turn : {0, 90, 180, 270}
        Degrees by which the part is turned about the axis of the heights, from x to y.
    mirror : bool
        Whether to reverse the y axis after the turn: z points into the body, so the instrument's y of the body's
        surface is opposite to the grid's y; the instrument's y of the roller's surface is not.
    corner : tuple of float, optional
        Position of the first point along x and y, metres, after turning. Default: the file's
        position, mostly (0, 0) for an instrument.

    Returns
    -------
    DataArray (x, y)
        Heights, metres.

    Raises
    ------
    InvalidInputError
        If the file cannot be read, has other columns or units, gaps, missing, repeated or infinite values (with
        their places), or does not cover the grid.
    ContactStudyError
        If the file needs the extra `measured`, which is not installed.
    """
    path = Path(path)
    checks.instance("grid", grid, Grid, "a Grid")
    for name, value in (("remove_slope", remove_slope), ("remove_form", remove_form)):
        checks.instance(name, value, bool, "True or False")
    x, y, heights = rotate_heights(read_measurement(path, ("x", "y"), ("height",))[0], turn, mirror)
    if y is None:
        raise InvalidInputError("path", str(path), "a file with heights over x and y", "it holds one line")
    if corner is not None:
        first_point = checks.coordinates("corner", corner, "metres")
        if first_point.size != 2:
            raise InvalidInputError("corner", corner, "two positions, x and y (metres)")
        x, y = x - x[0] + first_point[0], y - y[0] + first_point[1]
    check_positions("x", x)
    check_positions("y", y)
    check_values("height", heights, ("x", x), ("y", y))
    _check_cover(x, y, grid)
    if remove_slope or remove_form:
        heights = heights - _fit_form(x, y, heights, order=2 if remove_form else 1)
    return _height_map(grid, _interpolate(x, y, heights, grid), f"measured, {path.name}")


def heights_on(grid: Grid, heights: xr.DataArray) -> FloatArray:
    """Heights of a map at the cell centres of a grid, metres.

    Parameters
    ----------
    grid : Grid
        Cells; their centres must lie within the map.
    heights : DataArray (x, y)
        Height map on any uniform grid, metres. Between its points heights are interpolated linearly along
        both axes; on the cells of the grid they remain unchanged.

    Raises
    ------
    InvalidInputError
        If `heights` is not a DataArray (x, y) on a uniform grid, has a value that is not finite, or misses cells.

    Warns
    -----
    MagnitudeWarning
        If the heights from peak to valley have a size that suggests a wrong unit.

    Examples
    --------
    >>> cells = Grid(x_range=(0.0, 4.0), y_range=(0.0, 2.0), cells_x=4, cells_y=2)
    >>> slope = _height_map(cells, np.repeat(cells.x[:, None], 2, axis=1), "made up")
    >>> heights_on(Grid(x_range=(1.0, 3.0), y_range=(0.5, 1.5), cells_x=2, cells_y=1), slope).tolist()
    [[1.5], [2.5]]
    """
    values, cells = labelled_cells("roughness", in_si("roughness", heights, "m"))
    warn_of_values(roughness=float(np.ptp(values)))
    if cells.shape == grid.shape and all(
        np.allclose(position, centres, rtol=0.0, atol=COORDINATE_TOLERANCE * step)
        for position, centres, step in ((cells.x, grid.x, grid.dx), (cells.y, grid.y, grid.dy))
    ):
        return values
    _check_cover(cells.x, cells.y, grid, "roughness, grid")
    return _interpolate(cells.x, cells.y, values, grid)


def _check_cover(x: FloatArray, y: FloatArray, grid: Grid, argument: str = "grid") -> None:
    """Raise unless the measured positions cover the cell centres."""
    for name, map_centres, centres in (("x", x, grid.x), ("y", y, grid.y)):
        tolerance = 1e-9 * (map_centres[-1] - map_centres[0])
        if centres[0] < map_centres[0] - tolerance or centres[-1] > map_centres[-1] + tolerance:
            allowed = f"within the measured {map_centres[0]:g} to {map_centres[-1]:g} m"
            raise InvalidInputError(f"{argument}.{name}", f"{centres[0]:g} to {centres[-1]:g} m", allowed)


def _interpolate(x: FloatArray, y: FloatArray, heights: FloatArray, grid: Grid) -> FloatArray:
    """Heights at the cell centres, bilinear between the positions."""
    from scipy.interpolate import RegularGridInterpolator

    clipped_positions = np.clip(grid.x, x[0], x[-1])[:, None], np.clip(grid.y, y[0], y[-1])[None, :]
    return np.asarray(RegularGridInterpolator((x, y), heights)(clipped_positions))


def _fit_form(x: FloatArray, y: FloatArray, heights: FloatArray, order: int) -> FloatArray:
    """Polynomial of an order that fits the heights by least squares."""
    # Normal equations need no array per term; for these few terms they lose at most two digits.
    along_x, along_y = (
        np.polynomial.legendre.legvander(np.interp(axis, axis[[0, -1]], [-1.0, 1.0]), order) for axis in (x, y)
    )
    terms = [(i, j) for i in range(order + 1) for j in range(order + 1 - i)]
    products_x, products_y = along_x.T @ along_x, along_y.T @ along_y
    matrix = np.array([[products_x[i, k] * products_y[j, m] for k, m in terms] for i, j in terms])
    moments = along_x.T @ heights @ along_y
    coefficients = np.zeros((order + 1, order + 1))
    projections = np.array([moments[term] for term in terms])
    coefficients[tuple(np.transpose(terms))] = np.linalg.lstsq(matrix, projections, rcond=None)[0]
    return np.asarray(along_x @ coefficients @ along_y.T)
