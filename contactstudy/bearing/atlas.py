"""Atlas of logarithmic rollers: pressure, stress and stiffness by interpolation of solved contacts."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache, cached_property
from importlib.resources import files
from pathlib import Path

import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy.interpolate import RBFInterpolator
from scipy.spatial import cKDTree

from contactstudy.arrays.variables import describe
from contactstudy.checks import BoolArray, FloatArray, IntArray
from contactstudy.errors import InvalidInputError

# Dimensionless groups, in the order of the coordinates of the interpolation
GROUPS = ("length_over_a", "e_over_a", "crown", "tilt_ratio", "poisson")
# Interpolated quantities; the logarithm of all but the last is interpolated, and their errors are relative
QUANTITIES = ("peak_pressure_ratio", "peak_von_mises_ratio", "approach_ratio", "stiffness_ratio", "end_load_ratio")
LOGARITHMIC_QUANTITIES = QUANTITIES[:-1]
NEIGHBOUR_COUNT = 6  # Nearest points; a branch is defined where one of these points belongs to the branch
RESIDUAL_COUNT = 12  # Nearest points whose mean residual is the local error


def atlas(
    length_over_a: npt.ArrayLike | xr.DataArray,
    e_over_a: npt.ArrayLike | xr.DataArray,
    crown: npt.ArrayLike | xr.DataArray,
    tilt_ratio: npt.ArrayLike | xr.DataArray = 0.0,
    poisson: npt.ArrayLike | xr.DataArray = 0.3,
) -> xr.Dataset:
    """Interpolate the contact of a rigid roller with a logarithmic profile between free ends (`studies/atlas.py`).

    The scales are those of the Hertz line contact: half-width a, pressure p0, load ``P = pi E* a**2 L / (4 R)``.
    The friction is 0, and the approach is relative to a depth equal to the body's length.

    Parameters
    ----------
    length_over_a : float or array
        Length of the roller over the half-width, ``L / a``.
    e_over_a : float or array
        Distance of the roller's ends from the free ends over the half-width, ``e / a``.
    crown : float or array
        Amplitude A of `profiles.Lundberg`, ``A R / a**2``. A crown for the pressure pd has ``(pd / p0)**2 / 4``.
    tilt_ratio : float or array
        Drop of one end by the roller's rotation theta, ``theta L R / (2 a**2)``.
    poisson : float or array
        Poisson's ratio of the body.

    Returns
    -------
    Dataset
        `peak_pressure_ratio` and `peak_von_mises_ratio` over p0, `approach_ratio` over ``a**2 / R``,
        `stiffness_ratio` dP/d(approach) over ``E* L`` at a constant rotation, and `end_load_ratio`, the load on the
        last half-width of the deeper end over the mean load per half-width; each with its error
        ``<name>_error``, of solver and interpolation, which covers 96 % of 1000 other points. DataArrays are broadcast;
        other arrays of one dimension have the dimension `point`.

    Raises
    ------
    InvalidInputError
        If a value is not a finite number inside the range of the atlas.

    Examples
    --------
    >>> roller = atlas(length_over_a=100, e_over_a=[0.0, 2.0], crown=0.25)
    >>> roller["peak_pressure_ratio"].dims, bool((roller["peak_pressure_ratio_error"] < 0.05).all())
    (('point',), True)
    """
    table = atlas_table()
    arguments = dict(zip(GROUPS, (length_over_a, e_over_a, crown, tilt_ratio, poisson), strict=True))
    groups = xr.broadcast(*(_check_group(name, value, table.ranges[name]) for name, value in arguments.items()))
    points = np.stack([group.values.ravel() for group in groups], axis=1)
    shape, dims = groups[0].shape, groups[0].dims
    variables = {name: (dims, values.reshape(shape)) for name, values in table.evaluate(points).items()}
    result = xr.Dataset(variables).assign_coords(dict(zip(GROUPS, groups, strict=True)))
    return describe(result, "atlas of logarithmic rollers between free ends")


def _check_group(name: str, value: npt.ArrayLike | xr.DataArray, valid_range: tuple[float, float]) -> xr.DataArray:
    """Return a group as a DataArray; raise outside the range of the atlas."""
    try:
        values = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise InvalidInputError(name, value, "numbers") from None
    low, high = valid_range
    is_outside = ~((values >= low * (1 - 1e-9)) & (values <= high * (1 + 1e-9)))
    if is_outside.any():
        raise InvalidInputError(name, float(values[is_outside][0]), f"from {low:g} to {high:g}", "solve the case")
    if isinstance(value, xr.DataArray):
        return value.astype(float)
    if values.ndim > 1:
        raise InvalidInputError(name, f"{values.ndim} dimensions", "a number, a sequence or a DataArray")
    return xr.DataArray(values, dims=("point",)[: values.ndim])


@dataclass(frozen=True, eq=False)
class AtlasTable:
    """Solved points and their interpolation; a residual is the difference from interpolation between other points."""

    dataset: xr.Dataset  # (point): groups; quantities with scales, solver_error, coverage_factor; residuals; *_at_end
    _interpolators: dict[str, list[RBFInterpolator]] = field(default_factory=dict)

    @cached_property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Minimum and maximum of each group."""
        return {name: tuple(self.dataset[name].attrs["valid_range"]) for name in GROUPS}

    def coordinates(self, points: FloatArray) -> FloatArray:
        """Coordinates of points (point, group) from 0 to 1, over which the quantities vary evenly."""
        lows, highs = np.array([self.ranges[name] for name in GROUPS]).T
        low, value, high = (transform_groups(np.atleast_2d(groups)) for groups in (lows, points, highs))
        return np.asarray((value - low) / (high - low))

    @cached_property
    def points(self) -> FloatArray:
        """Coordinates of the solved points (point, group)."""
        return self.coordinates(np.stack([self.dataset[name].values for name in GROUPS], axis=1))

    def interpolated_samples(self, name: str) -> FloatArray:
        """Values at the solved points that are interpolated: a quantity or the quantity's logarithm."""
        values = self.dataset[name].values
        return np.asarray(np.log(values) if name in LOGARITHMIC_QUANTITIES else values)

    def branches(self, name: str) -> list[BoolArray]:
        """Masks of the points of each smooth branch; a maximum with two possible places has a branch for each place."""
        if f"{name}_at_end" not in self.dataset:
            return [np.ones(len(self.points), dtype=bool)]
        at_end = self.dataset[f"{name}_at_end"].values.astype(bool)
        return [at_end, ~at_end]

    def branch_values(self, name: str, coordinates: FloatArray) -> FloatArray:
        """Interpolated values (branch, point) at coordinates; minus infinity away from the branch's points."""
        branches = self.branches(name)
        if name not in self._interpolators:
            nodes, samples = self.scale(name, self.points), self.interpolated_samples(name)
            self._interpolators[name] = [
                RBFInterpolator(nodes[mask], samples[mask], kernel="cubic", degree=2) for mask in branches
            ]
        _, nearest = cKDTree(self.points).query(coordinates, NEIGHBOUR_COUNT)
        scaled_coordinates = self.scale(name, coordinates)
        values = [interpolator(scaled_coordinates) for interpolator in self._interpolators[name]]
        return np.where([mask[nearest].any(axis=1) for mask in branches], values, -np.inf)

    def scale(self, name: str, coordinates: FloatArray) -> FloatArray:
        """Coordinates (point, group) whose distances measure the variation of a quantity."""
        return np.asarray(self.dataset[name].attrs["scales"] * coordinates)

    def interpolate(self, name: str, coordinates: FloatArray) -> tuple[FloatArray, IntArray]:
        """Interpolated values at coordinates (point, group), and the branch of each."""
        values = self.branch_values(name, coordinates)
        return values.max(axis=0), values.argmax(axis=0)

    def local_residual(
        self, name: str, coordinates: FloatArray, branch: IntArray, omitted_count: int = 0
    ) -> FloatArray:
        """Mean residual of the nearest points of the same branch, without the `omitted_count` nearest."""
        residuals, local_residuals = np.abs(self.dataset[f"{name}_residual"].values), np.zeros(len(coordinates))
        points, scaled_coordinates = self.scale(name, self.points), self.scale(name, coordinates)
        for branch_index, mask in enumerate(self.branches(name)):
            in_branch = branch == branch_index
            if in_branch.any():
                _, nearest = cKDTree(points[mask]).query(scaled_coordinates[in_branch], omitted_count + RESIDUAL_COUNT)
                local_residuals[in_branch] = residuals[mask][nearest[:, omitted_count:]].mean(axis=1)
        return local_residuals

    def evaluate(self, points: FloatArray) -> dict[str, FloatArray]:
        """Quantities and their errors at points (point, group)."""
        coordinates, ratios = self.coordinates(points), {}
        for name in QUANTITIES:
            interpolated_values, branch = self.interpolate(name, coordinates)
            attributes = self.dataset[name].attrs
            local_residual = self.local_residual(name, coordinates, branch)
            error = np.hypot(attributes["coverage_factor"] * local_residual, attributes["solver_error"])
            is_logarithmic = name in LOGARITHMIC_QUANTITIES
            ratios[name] = np.exp(interpolated_values) if is_logarithmic else np.maximum(interpolated_values, 0.0)
            ratios[f"{name}_error"] = error * ratios[name] if is_logarithmic else error
        return ratios


def transform_groups(points: FloatArray) -> FloatArray:
    """Transform groups (point, group) to coordinates over which the quantities vary evenly."""
    length, distance, crown, tilt, poisson = points.T
    return np.stack([np.log(length), np.sqrt(distance), np.log(crown), tilt, poisson], axis=1)


@cache
def atlas_table() -> AtlasTable:
    """Return the table of the package."""
    package_path = Path(str(files("contactstudy.bearing"))) / "data" / "atlas.nc"
    path = package_path if package_path.exists() else Path(__file__).resolve().parents[2] / "data" / "atlas.nc"
    return AtlasTable(xr.load_dataset(path))
