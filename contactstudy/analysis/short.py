"""The main numbers of a result with their errors, as a small table."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from contactstudy.analysis.axes import single_case
from contactstudy.analysis.cut_ends import cut_ends
from contactstudy.analysis.edges import contact_length
from contactstudy.analysis.largest import largest
from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, attribute
from contactstudy.arrays.engineering import quantity, with_error
from contactstudy.arrays.html_table import LEFT, NUMBER, html_table
from contactstudy.arrays.required import require
from contactstudy.arrays.variables import STRESSES, UNBOUNDED, variable_of
from contactstudy.case.settings import TOLERANCE

SINGULAR = "singular: it grows without a limit towards a sharp end"
OF_CELLS = f"mean of the highest cell, {UNBOUNDED}"
NOT_PRESSED = "the end is not pressed"

ENDS = {"first": "end I", "last": "end II"}
"""Ends of the roller, as names of variables and as the reader knows them."""

PLAIN = {
    "approach": "approach of roller and body",
    "tilt": "tilt",
    "load_position": "position x of the resultant",
    "force_x": "force along the axis",
    "force_y": "force along rolling",
    "moment_z": "moment about z",
    "longitudinal_creepage": "longitudinal creepage",
    "lateral_creepage": "lateral creepage",
    "spin": "spin",
    "shift_x": "shift along the axis",
    "shift_y": "shift along rolling",
    "friction_work": "frictional work",
}
"""Scalars that are shown where they are there and not zero."""

FOUND = ("approach", "load_position", "force_x", "force_y", "moment_z", "shift_x", "shift_y", "friction_work")
"""Those of them that follow from the solution unless they are prescribed."""

CERTIFICATES = ("load_position",)
"""Scalars of which the variable with ``_error`` says how well a prescribed value was met, in other units."""

ROUNDING = TOLERANCE
"""Share of the largest tangential force that counts as nothing: what the iteration of the tractions leaves by default.

Of contacts that are the same on both sides of y = 0 it left up to 3e-8 of it across. A moment is compared with this
force at the distance a. Presentation only."""


class MainNumber(NamedTuple):
    """One row: name of the variable, its meaning, value and error in SI (NaN: no estimate), both as text, a remark."""

    name: str
    meaning: str
    value: float
    error: float
    units: str
    text: str
    remark: str = ""


@dataclass(frozen=True)
class ShortView:
    """Main numbers of a result; shows itself as text and in a notebook.

    Parameters
    ----------
    numbers : tuple of MainNumber
        The rows.

    Examples
    --------
    >>> ShortView((MainNumber("normal_load", "normal load", 20.0, np.nan, "N", "20 N"),))
    normal load  20 N
    """

    numbers: tuple[MainNumber, ...]

    def __getitem__(self, name: str) -> MainNumber:
        """Row of a variable."""
        return next(number for number in self.numbers if number.name == name)

    def __contains__(self, name: object) -> bool:
        """Whether there is a row of a variable."""
        return any(number.name == name for number in self.numbers)

    def __repr__(self) -> str:
        meaning = max((len(row.meaning) for row in self.numbers), default=0)
        text = max((len(row.text) for row in self.numbers), default=0)
        return "\n".join(f"{row.meaning:{meaning}}  {row.text:{text}}  {row.remark}".rstrip() for row in self.numbers)

    def _repr_html_(self) -> str:
        rows = ((row.meaning, row.text, row.remark) for row in self.numbers)
        return html_table([("", rows)], styles=(LEFT, NUMBER, LEFT))

    def to_dataframe(self) -> pd.DataFrame:
        """Table of the numbers in SI, by name."""
        columns = ["name", "value", "error", "units", "meaning", "remark"]
        rows = [(row.name, row.value, row.error, row.units, row.meaning, row.remark) for row in self.numbers]
        return pd.DataFrame(rows, columns=columns).set_index("name")


def short(dataset: xr.Dataset) -> ShortView:
    """Return the main numbers of a result with their errors, in the units of engineers.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`, a file of it, or one case selected from a study.

    Returns
    -------
    ShortView
        Load, Hertz' pressure and half-width, peak and end pressures, laws of singular ends, loads on the ends, length
        of the contact, largest von Mises stress, approach and tilt; what the result lacks is left out. It prints as a
        table, and has `to_dataframe` for the values in SI.

    Raises
    ------
    InvalidInputError
        If there is more than one case.

    Examples
    --------
    >>> pressure = xr.DataArray([[1.0e9], [2.0e9]], dims=("x", "y"), coords={"x": [0.0, 1e-3], "y": [0.0]})
    >>> short(xr.Dataset({"pressure": pressure, "hertz_max_pressure": 1.5e9}))
    Hertz pressure p0  1.5 GPa
    largest pressure   2 GPa    mean of the highest cell, no error known
    """
    require(dataset)
    one = single_case(dataset)
    return ShortView(tuple(_numbers(one)))


def _numbers(one: xr.Dataset) -> Iterator[MainNumber]:
    """Rows of one case."""
    for name, meaning in (
        ("normal_load", "normal load"),
        ("hertz_max_pressure", "Hertz pressure p0"),
        ("hertz_half_width", "Hertz half-width a"),
    ):
        if name in one:
            yield (_settled if f"{name}_error" in one else _row)(one, name, meaning)
    yield from _peak(one)
    for end, place in ENDS.items():
        if f"end_pressure_{end}" in one:
            yield _settled(one, f"end_pressure_{end}", f"pressure at {place} of the roller")
        if f"end_intensity_{end}" in one:
            yield _intensity(one, end, place)
        if f"end_load_{end}" in one:
            yield _settled(one, f"end_load_{end}", f"load on the last half-width, {place}")
    if {"pressure", "gap"} <= set(one.data_vars) and bool((one["pressure"] > 0).any()) and not any(cut_ends(one)):
        yield _row(one.assign(contact_length=contact_length(one)), "contact_length", "length of the contact", UNBOUNDED)
    elif "contact_length" in one:
        yield _row(one, "contact_length", "length of the contact", UNBOUNDED)
    yield from _stress(one)
    for name, meaning in PLAIN.items():
        if name in one and float(one[name]) != 0 and np.isfinite(float(one[name])):
            with_estimate = f"{name}_error" in one and name not in CERTIFICATES
            row = _settled(one, name, meaning) if with_estimate else _row(one, name, meaning, _unknown(one, name))
            yield _without_rounding(one, row)
    yield from _stick(one)


def _without_rounding(one: xr.Dataset, row: MainNumber) -> MainNumber:
    """Row of a force or moment that is nothing but rounding, with the text of none."""
    given = _prescribed(one, row.name)
    force = max((abs(float(one[name])) for name in ("force_x", "force_y") if name in one), default=0.0)
    arms = {"force_x": 1.0, "force_y": 1.0, "moment_z": float(one.get("hertz_half_width", 0.0))}
    limit = ROUNDING * force * arms.get(row.name, 0.0)
    # A value that its error tells from nothing is one, however small; and a larger error is worth to be seen.
    within = np.isnan(row.error) or abs(row.value) <= row.error < limit
    if abs(row.value) < limit and within and not given:
        remark = f"rounding: below {ROUNDING:g} of the largest force{' times a' if row.name == 'moment_z' else ''}"
        return row._replace(text=f"0 {row.units}", remark=remark)
    return row


def _stick(one: xr.Dataset) -> Iterator[MainNumber]:
    """Rows of stick and slip: how much of the contact sticks, and the largest traction and slip."""
    if "sticking_part" in one:
        yield _row(one, "sticking_part", "part of the contact that sticks", UNBOUNDED)
    if "stick" not in one:
        return
    for name, meaning in (("traction", "largest traction"), ("slip", "largest slip")):
        parts = [one[f"{name}_{axis}"] for axis in "xy" if f"{name}_{axis}" in one]
        if len(parts) == 2 and "pressure" in one:
            size = ((parts[0] ** 2 + parts[1] ** 2) ** 0.5).where(one["pressure"] > 0, 0.0)
            units = variable_of(f"{name}_y", parts[1].attrs).units
            value = float(size.max())
            text = quantity(value, units) + ("" if units == "m" or name == "traction" else " per distance rolled")
            yield MainNumber(f"largest_{name}", meaning, value, np.nan, units, text, "of a cell, no error known")


def _unknown(one: xr.Dataset, name: str) -> str:
    """Say that a number has no known error, unless it was prescribed."""
    # Of a study's case the certificate says it: it misses what was prescribed by a little, and else by nothing.
    met = name in CERTIFICATES and float(one.get(f"{name}_error", 0.0)) > 0
    if _prescribed(one, name) is not None or met or name not in FOUND:
        return ""
    return UNBOUNDED


def _prescribed(one: xr.Dataset, name: str) -> Any:
    """Value that the case of a result gives for a number that otherwise follows from the solution; None: it does."""
    case = attribute(one, INPUTS_ATTRIBUTE).get("case", {})
    motion = case.get("motion", {})
    return case.get(name, motion.get(name, motion.get(name.removeprefix("shift_"))))


def _row(one: xr.Dataset, name: str, meaning: str = "", remark: str = "") -> MainNumber:
    """Row of a scalar without an error."""
    known = variable_of(name, one[name].attrs)
    value = float(one[name])
    text = quantity(value, known.units)
    return MainNumber(name, meaning or known.long_name, value, np.nan, known.units, text, remark)


def _settled(one: xr.Dataset, name: str, meaning: str) -> MainNumber:
    """Row of a scalar with its error; one without a limit says so."""
    value = float(one[name])
    error = float(one[f"{name}_error"]) if f"{name}_error" in one else None
    units = variable_of(name, one[name].attrs).units
    remark = str(one[f"{name}_error"].attrs.get("comment", "")) if error is not None else ""
    if np.isinf(value):
        remark = SINGULAR
    elif error is None or np.isnan(error):
        remark = UNBOUNDED
    elif np.isinf(error):
        remark = f"{UNBOUNDED}: {remark}" if remark else f"{UNBOUNDED}: two grids show no limit"
    elif value == 0 and error == 0 and name.startswith("end_"):
        remark = NOT_PRESSED
    return MainNumber(
        name, meaning, value, np.nan if error is None else error, units, with_error(value, error, units), remark
    )


def _peak(one: xr.Dataset) -> Iterator[MainNumber]:
    """Row of the largest pressure, settled or of a cell."""
    meaning = "largest pressure"
    if "peak_pressure_error" in one or ("peak_pressure" in one and np.isinf(float(one["peak_pressure"]))):
        yield _settled(one, "peak_pressure", meaning)
    elif "peak_pressure" in one or "pressure" in one:
        value = float(one["peak_pressure"] if "peak_pressure" in one else one["pressure"].max())
        yield MainNumber("peak_pressure", meaning, value, np.nan, "Pa", quantity(value, "Pa"), OF_CELLS)


def _intensity(one: xr.Dataset, end: str, place: str) -> MainNumber:
    """Row of the law of a singular end."""
    name = f"end_intensity_{end}"
    value, exponent = float(one[name]), float(one[f"end_exponent_{end}"])
    error = float(one[f"{name}_error"]) if f"{name}_error" in one else np.nan
    factor = 1e9 * 1e-3**exponent
    unit = f"GPa mm^{exponent:.3g}"
    known = error if np.isfinite(error) else None
    text = with_error(value / factor, None if known is None else known / factor, unit)
    remark = f"p = K / d^{exponent:.3g} at the distance d from the end"
    return MainNumber(name, f"intensity K at {place}", value, error, f"Pa m^{exponent:.3g}", text, remark)


def _stress(one: xr.Dataset) -> Iterator[MainNumber]:
    """Rows of the largest von Mises stress and its depth; a singular pressure leaves it no largest value."""
    singular = "peak_pressure" in one and np.isinf(float(one["peak_pressure"]))
    if "peak_von_mises" not in one:
        if not all(name in one for name in STRESSES) or bool(one[STRESSES[0]].isnull().all()):
            return
        one = one if singular else largest(one)
    meaning = "largest von Mises stress"
    if singular:
        yield MainNumber("peak_von_mises", meaning, np.inf, np.nan, "Pa", quantity(np.inf, "Pa"), SINGULAR)
        return
    yield _settled(one, "peak_von_mises", meaning)
    if "peak_von_mises_z" in one:
        yield _row(one, "peak_von_mises_z", "depth of the largest von Mises stress", UNBOUNDED)
