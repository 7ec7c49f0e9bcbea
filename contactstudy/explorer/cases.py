"""Cases of a study for the page: scalars of all cases in memory; fields of a case, and arrays of figures, on demand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, lru_cache, partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy.analysis import axial_pressure, in_plane, measure, positions, single_case
from contactstudy.analysis.axes import axis_dimensions
from contactstudy.analysis.provenance import STUDY_ATTRIBUTE, attribute, study_title
from contactstudy.arrays.engineering import format_quantity
from contactstudy.arrays.variables import STRESSES, require, variable_of
from contactstudy.checks import Array, FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.plots.style import AXIS_MEANINGS, Units, cap_field, is_near_singular_end, singular_ends
from contactstudy.study import collect
from contactstudy.study.folder import Folder

CaseIndex = tuple[int, ...]  # Index of a case along the study's dimensions
FIELDS = ("pressure", "gap", "initial_gap", "von_mises", *STRESSES)  # Fields that a loaded case keeps in memory
STATUS_SENTENCES = {  # Sentence for each status without figures
    "failed": "This case failed.",
    "skipped": "This case cannot be solved.",
    "excluded": "The study leaves this case out.",
    "missing": "This case is not solved yet.",
}

MAX_CACHED_CASES = 16  # Largest number of loaded cases in memory. Speed
SUBJECTS: dict[str, tuple[str, ...]] = {  # names of numbers in order; a final underscore marks a prefix
    "pressure": ("peak_pressure", "peak_pressure_first", "peak_pressure_last", "peak_pressure_x", "peak_pressure_y"),
    "stresses": ("peak_von_mises", "peak_von_mises_z", "peak_von_mises_x", "peak_von_mises_y", "peak_"),
    "film": (
        *("central_film", "least_film", "end_film_ratio", "least_film_ratio", "least_film_middle"),
        *("least_film_first", "least_film_last", "asperity_load_share"),
    ),
    "ends": (
        *("end_pressure_over_p0", "end_pressure_over_p0_first", "end_pressure_over_p0_last"),
        *("end_pressure_first", "end_pressure_last", "end_load_first", "end_load_last"),
        *("end_intensity", "end_intensity_first", "end_intensity_last"),
        *("end_exponent", "end_exponent_first", "end_exponent_last"),
    ),
    "load and approach": (
        *("normal_load", "hertz_max_pressure", "hertz_half_width", "approach", "tilt", "reference_depth"),
        *("roller_reference_depth", "load_position", "contact_length", "contact_width", "half_width_middle"),
    ),
    "friction": (
        *("force_y", "force_x", "moment_z", "longitudinal_creepage", "lateral_creepage", "spin", "shift_y", "shift_x"),
        *("sticking_part", "friction_work"),
    ),
    "further numbers": (),  # numbers without another subject
    "cells and iteration": ("end_traction_residual", "converged", "iterations", "friction_steps"),
    "solution": ("seconds",),
}

PIXELS = (360, 150)  # Pixels of an image, horizontal and vertical
END_REGION = 8.0  # Length of the region near an end, over the Hertz half-width
REGIONS = ("whole length", "near end I", "near end II")

PLANES = ("y = 0, along the roller", "x, across the roller", "z, at a depth")  # first the axis across the plane

Span = tuple[float, float]


class CaseFields:
    """Fields of a case as arrays."""

    def __init__(self, dataset: xr.Dataset) -> None:
        self.dataset = dataset
        self.compute_measure = cache(partial(measure, dataset))  # from the measure's name
        self.hertz: tuple[float, float] | None = None  # half-width and pressure of Hertz' line contact
        if "hertz_half_width" in dataset:
            self.hertz = float(dataset["hertz_half_width"]), float(dataset["hertz_max_pressure"])
        self.singular_ends = singular_ends(dataset)
        self.has_pressure = "pressure" in dataset
        if self.has_pressure:
            axial = axial_pressure(dataset)
            self.x, self.axial_pressure = positions(axial, "x").values, axial.values
        self.has_stress = "von_mises" in dataset and not bool(dataset["von_mises"].isnull().all())
        if self.has_stress:
            self.points = {axis: positions(dataset["von_mises"], axis).values for axis in "xyz"}


@dataclass(frozen=True, eq=False)
class Cases:
    """Cases of a study: scalars over the parameters with several values, and fields of one case on demand."""

    scalars: xr.Dataset
    load: Callable[[CaseIndex], CaseFields]
    title: str

    @property
    def dims(self) -> tuple[str, ...]:
        """Swept parameters with several values."""
        return tuple(map(str, self.scalars["status"].dims))

    def choices(self, dim: str) -> list[str]:
        """Values of a swept parameter as distinct texts."""
        values = self.scalars[dim].values
        units = str(self.scalars[dim].attrs.get("units", "1"))
        columns = [
            [f"{name}={value}" for value in coordinate.values]
            for name, coordinate in self.scalars.coords.items()
            if coordinate.dims == (dim,) and name != dim and "comment" not in coordinate.attrs
        ]
        if dim == "case" and columns:
            texts = [", ".join(case_texts) for case_texts in zip(*columns, strict=True)]
        else:
            texts = [
                str(value) if isinstance(value, (bool, np.bool_, str)) else format_quantity(float(value), units, 6)
                for value in values
            ]
        return texts if len(set(texts)) == len(texts) else [f"{i}: {text}" for i, text in enumerate(texts, start=1)]

    def start_values(self) -> dict[str, int]:
        """Index of the first solved case, by swept parameter."""
        solved_indices = np.argwhere(np.isin(self.scalars["status"].values, ("ok", "stale")))
        index = solved_indices[0].tolist() if len(solved_indices) else [0] * len(self.dims)
        return dict(zip(self.dims, index, strict=True))

    def status(self, index: CaseIndex) -> tuple[str, str]:
        """Status of a case, and its reason."""
        entry = self.scalars[["status", "message"]].isel(dict(zip(self.dims, index, strict=True)))
        return str(entry["status"].item()), str(entry["message"].item())


def status_sentence(status: str, reason: str) -> str:
    """Return the reason why a case has no figures, as a sentence."""
    return f"{STATUS_SENTENCES.get(status, f'This case is {status}.')} {reason}".rstrip()


def open_cases(study: xr.Dataset | str | Path) -> Cases:
    """Return the cases of an opened study, of a result, or of a study's folder."""
    if not isinstance(study, xr.Dataset):
        cases = _open_folder(Path(study))
    else:
        cases = _open_study(study) if "status" in study else _open_result(study)
    return replace(cases, load=lru_cache(maxsize=MAX_CACHED_CASES)(cases.load))


def _open_folder(folder: Path) -> Cases:
    """Cases in a study's folder; each file is read on demand."""
    scalars, results = collect(folder).squeeze(), Folder(folder).results()

    def load(index: CaseIndex) -> CaseFields:
        return CaseFields(results.case(str(scalars["case_id"].values[index]), FIELDS))

    return Cases(scalars, load, study_title(attribute(scalars, STUDY_ATTRIBUTE), folder.name))


def _open_result(result: xr.Dataset) -> Cases:
    """Return a result of one case as a study."""
    require(result, "pressure")
    case = single_case(result)
    scalars = case[[name for name, entry in case.data_vars.items() if entry.ndim == 0]].reset_coords(drop=True)
    scalars = scalars.assign(status=xr.DataArray("ok"), message=xr.DataArray(""))
    fields = CaseFields(case)
    return Cases(scalars, lambda index: fields, str(result.attrs.get("title", "result")))


def _open_study(study: xr.Dataset) -> Cases:
    """Cases of an opened study."""
    study = study.squeeze([dim for dim in study["status"].dims if study.sizes[dim] == 1])
    dims = study["status"].dims
    scalars = study[[name for name, entry in study.data_vars.items() if set(entry.dims) <= set(dims)]]
    scalars = scalars.drop_vars([name for name in scalars.coords if not set(scalars[name].dims) <= set(dims)])

    def load(index: CaseIndex) -> CaseFields:
        entry = study.isel(dict(zip(dims, index, strict=True)))
        if str(entry["status"].item()) not in ("ok", "stale"):
            raise InvalidInputError("case", index, "a solved case")
        names = [name for name in study.data_vars if name in FIELDS or name in scalars]
        return CaseFields(single_case(entry[[name for name in names if entry[name].dtype.kind not in "UO"]]).compute())

    return Cases(scalars.load(), load, study_title(attribute(study, STUDY_ATTRIBUTE), "study"))


def numbers_by_subject(scalars: xr.Dataset) -> dict[str, dict[str, str]]:
    """Return the names of the numbers of all cases, by subject and meaning."""
    names = [
        str(name)
        for name, entry in scalars.data_vars.items()
        if entry.dtype.kind == "f" and not str(name).endswith("_error") and bool(entry.notnull().any())
    ]
    meanings = [variable_of(name, scalars[name].attrs).long_name for name in names]

    entries = [(subject, entry) for subject, group in SUBJECTS.items() for entry in group or ("",)]
    default_rank = entries.index(("further numbers", ""))

    def rank(name: str) -> int:
        is_member = (name == entry or (entry.endswith("_") and name.startswith(entry)) for _, entry in entries)
        return next((index for index, member in enumerate(is_member) if member), default_rank)

    groups: dict[str, dict[str, str]] = {}
    for index, name, meaning in sorted((rank(name), name, text) for name, text in zip(names, meanings, strict=True)):
        # The texts of all groups are distinct.
        text = meaning if meanings.count(meaning) == 1 else f"{meaning}, {name}"
        groups.setdefault(entries[index][0], {})[text] = name
    return groups


class Line(NamedTuple):
    """Pressure along the axis, positions of singular ends, limits of the positions, and labels of both axes."""

    x: FloatArray
    pressure: FloatArray
    singular_ends: list[float]
    span: Span
    axis_labels: tuple[str, str]


class Image(NamedTuple):
    """Image (vertical, horizontal) of a field in a plane, limits and labels of both axes, and limit of the colours."""

    values: Array
    horizontal: Span
    vertical: Span
    color_limit: float
    axis_labels: tuple[str, str]
    has_depth: bool  # whether the vertical axis is the depth, which points downwards
    largest: tuple[float, float, float]  # size and position of the largest value, which pixels may miss
    position: str = ""


def choose_scale(case: CaseFields, *, relative: bool) -> Units:
    """Return mm and MPa, or half-width and pressure of Hertz' line contact, with suffixes as plain text."""
    if relative and case.hertz is not None:
        return Units(*case.hertz, "/a", "/p0")
    return Units(1e-3, 1e6, " (mm)", " (MPa)")


def region_limits(case: CaseFields, name: str) -> Span:
    """Return the limits of a region along the axis, metres."""
    low, high = float(case.x.min()), float(case.x.max())
    loaded_x = case.x[case.axial_pressure > 0]
    if name == REGIONS[0] or not loaded_x.size or case.hertz is None:
        return low, high
    length = END_REGION * case.hertz[0]
    end, fraction_before = (loaded_x[0], 0.25) if name == REGIONS[1] else (loaded_x[-1], 0.75)
    return max(low, end - fraction_before * length), min(high, end + (1 - fraction_before) * length)


def axial_line(case: CaseFields, scale: Units, limits: Span) -> Line:
    """Return the largest pressure across the contact along the axis, without the vicinity of singular ends."""
    values = np.where(is_near_singular_end(case.dataset, case.x), np.nan, case.axial_pressure / scale.stress)
    singular = [end / scale.length for end in case.singular_ends]
    labels = f"{AXIS_MEANINGS['x']}, x{scale.over_length}", f"pressure along the axis{scale.over_stress}"
    return Line(case.x / scale.length, values, singular, (limits[0] / scale.length, limits[1] / scale.length), labels)


def top_image(case: CaseFields, scale: Units, limits: Span) -> Image:
    """Return the pressure on the top of the body."""
    pressure = case.dataset["pressure"]
    y = positions(pressure, "y").values
    return _create_image(pressure, (limits, (float(y[0]), float(y[-1]))), _find_color_limit(case, pressure), scale)


def plane_image(
    case: CaseFields, scale: Units, limits: Span, plane_name: str, fraction: float, *, name: str = "von_mises"
) -> Image | None:
    """Return a stress measure in a plane at a fraction of the range; None without stresses or with too few points."""
    if not case.has_stress:
        return None
    points, normal = case.points, plane_name[0]
    horizontal, vertical = (axis for axis in "xyz" if axis != normal)
    contains_axis = points["y"][0] <= 0 <= points["y"][-1]
    if min(points[horizontal].size, points[vertical].size) < 2 or (normal == "y" and not contains_axis):
        return None
    plane_start, plane_stop = limits if normal == "x" else (float(points[normal][0]), float(points[normal][-1]))
    position = 0.0 if normal == "y" else plane_start + fraction * (plane_stop - plane_start)
    # The image continues the stress beyond the outermost points as a constant.
    nearest = float(np.clip(position, points[normal][0], points[normal][-1]))
    plane = in_plane(case.compute_measure(name).to_dataset(name=name), variables=name, **{normal: nearest})[name]
    left, right = float(points[horizontal][0]), float(points[horizontal][-1])
    if horizontal == "x":
        left, right = max(left, limits[0]), min(right, limits[1])
    spans = ((left, right), (float(points[vertical][0]), float(points[vertical][-1])))
    image = _create_image(plane, spans, _find_color_limit(case, case.compute_measure(name)), scale)
    unit = scale.over_length.strip(" ()/")
    return image._replace(position=f"{normal} = {position / scale.length:.3g} {unit}")


def _find_color_limit(case: CaseFields, field: xr.DataArray) -> float:
    """Largest value away from singular ends, or of all values."""
    return max(0.0, float(cap_field(case.dataset, field)[0].max()))


def _create_image(plane: xr.DataArray, spans: tuple[Span, Span], limit: float, scale: Units) -> Image:
    """Image in the units of the page."""
    dims = axis_dimensions(plane)
    values = plane.transpose(*dims.values()).values
    axes = tuple(positions(plane, axis).values for axis in dims)
    horizontal_label, vertical_label = (f"{AXIS_MEANINGS[axis]}, {axis}{scale.over_length}" for axis in dims)
    (left, right), (low, high) = ((start / scale.length, stop / scale.length) for start, stop in spans)
    # The largest value of the field up to the limit may lie between the pixels.
    in_span = [(points >= start) & (points <= stop) for points, (start, stop) in zip(axes, spans, strict=True)]
    visible_values = np.where(in_span[0][:, None] & in_span[1] & (values <= limit), values, -np.inf)
    row, column = np.unravel_index(int(visible_values.argmax()), visible_values.shape)
    largest = (visible_values[row, column] / scale.stress, axes[0][row] / scale.length, axes[1][column] / scale.length)
    return Image(
        values=(np.minimum(to_pixels(values, axes, spans), limit) / scale.stress).astype(np.float32),
        horizontal=(left, right),
        vertical=(low, high),
        color_limit=limit / scale.stress,
        axis_labels=(horizontal_label, vertical_label),
        has_depth="z" in dims,
        largest=largest if np.isfinite(largest[0]) else (np.nan, np.nan, np.nan),
    )


def to_pixels(values: FloatArray, axes: tuple[FloatArray, ...], spans: tuple[Span, Span]) -> FloatArray:
    """Return values (horizontal, vertical) at the centres of pixels (vertical, horizontal), constant beyond points."""
    for axis, (points, (start, stop), count) in enumerate(zip(axes, spans, PIXELS, strict=True)):
        centres = start + (np.arange(count) + 0.5) * (stop - start) / count
        values = np.apply_along_axis(partial(np.interp, centres, points), axis, values)
    return np.ascontiguousarray(values.T)
