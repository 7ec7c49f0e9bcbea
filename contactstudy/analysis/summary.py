"""Summaries of one solved case: the scalars that a parametric study compares."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy.analysis import contact_results, peak
from contactstudy.analysis.largest import largest
from contactstudy.arrays.variables import STRESSES, named
from contactstudy.errors import InvalidInputError


def pressure_summary(dataset: xr.Dataset) -> xr.Dataset:
    """Peak pressure and its place, the pressure at both ends of the contact, and the contact's length.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`: `pressure`, and for the ratios `hertz_max_pressure`.

    Returns
    -------
    Dataset
        Scalars `peak_pressure` with ``_x`` and ``_y``, `end_pressure_over_p0_first` and ``_last`` (at the roller's ends
        if they are settled, infinite where they are singular; else in the first and the last loaded cells along the
        axis), their mean `end_pressure_over_p0`, `contact_length` and `contact_width` (m, over whole cells).

    Examples
    --------
    >>> pressure = xr.DataArray([[0.0], [3.0], [1.0], [2.0]], dims=("x", "y"), coords={"x": [0, 1, 2, 3], "y": [0]})
    >>> result = pressure_summary(xr.Dataset({"pressure": pressure, "hertz_max_pressure": 2.0}))
    >>> float(result.peak_pressure_x), float(result.end_pressure_over_p0), float(result.contact_length)
    (1.0, 1.25, 3.0)
    """
    contact = contact_results(dataset).reset_coords(drop=True)
    kept = ["peak_pressure", "peak_pressure_x", "peak_pressure_y", "contact_length", "contact_width"]
    scale = float(dataset["hertz_max_pressure"])
    # Settled ends count; the outermost loaded cells say less the narrower they are.
    first, last = (
        dataset.get(f"end_pressure_{end}", contact[f"edge_pressure_{end}"]) / scale for end in ("first", "last")
    )
    ends = {
        "end_pressure_over_p0_first": first,
        "end_pressure_over_p0_last": last,
        "end_pressure_over_p0": 0.5 * (first + last),
    }
    return contact[kept].assign({name: named(name, value) for name, value in ends.items()})


def stress_summary(dataset: xr.Dataset) -> xr.Dataset:
    """Largest von Mises stress and its place; empty if the Dataset holds no stresses.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`.

    Returns
    -------
    Dataset
        Scalars `peak_von_mises` and its error (Pa), and `peak_von_mises_x`, ``_y``, ``_z`` (m), see
        :func:`contactstudy.analysis.largest`; without the six stresses, at the points of `von_mises`.

    Raises
    ------
    InvalidInputError
        If there is no number among the stresses.

    Examples
    --------
    >>> stress = xr.DataArray([[[1.0, 4.0]]], dims=("x", "y", "z"), coords={"x": [0], "y": [0], "z": [0, 2]})
    >>> float(stress_summary(xr.Dataset({"von_mises": stress})).peak_von_mises_z)
    2.0
    """
    if "von_mises" not in dataset:
        return xr.Dataset()
    if np.isnan(dataset["von_mises"].values).all():
        raise InvalidInputError("von_mises", "nan everywhere", "a field with at least one number")
    known = all(name in dataset for name in STRESSES)
    found = largest(dataset) if known else peak(dataset, "von_mises")
    return found.reset_coords(drop=True)


def summarize(dataset: xr.Dataset) -> xr.Dataset:
    """Every summary of a solved case, together with the scalars that it has already.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`; stresses may be absent.

    Returns
    -------
    Dataset
        Scalars only: those of :func:`pressure_summary`, of :func:`stress_summary` and of `dataset`, which count where
        names agree: a peak with an estimated error is more than that of the cells.

    Examples
    --------
    >>> pressure = xr.DataArray([[1.0], [2.0]], dims=("x", "y"), coords={"x": [0, 1], "y": [0]})
    >>> result = summarize(xr.Dataset({"pressure": pressure, "hertz_max_pressure": 2.0, "iterations": 7}))
    >>> int(result.iterations), float(result.peak_pressure)
    (7, 2.0)
    """
    own = dataset[[name for name, variable in dataset.data_vars.items() if variable.ndim == 0]]
    own = own.reset_coords(drop=True).drop_attrs(deep=False)
    return pressure_summary(dataset).assign(stress_summary(dataset).data_vars).assign(own.data_vars)
