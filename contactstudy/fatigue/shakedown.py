"""Shakedown of a body that a contact rolls over again and again: Melan's theorem with residual stress along rolling.

A perfectly plastic body shakes down, and yields no more, if some residual stress that is in equilibrium by itself
keeps the sum of it and the passing contact's elastic stress from yielding at every instant (E. Melan, Zur Plastizitaet
des raeumlichen Kontinuums, Ingenieur-Archiv 9 (1938) 116-126; for rolling contact K. L. Johnson, A shakedown limit in
rolling contact, Proc. 4th US National Congress of Applied Mechanics (1962) 971-975). Rolling makes residual stress
that does not depend on y. Then ``rho_yy(x, z)`` appears in no equation of equilibrium and in no condition on a free
face: it is free at every point of every body, free ends or not, and what it can do bounds the load rigorously.

With ``u = s_yy - (s_xx + s_zz) / 2`` and ``v = sqrt(3) / 2 (s_xx - s_zz)`` the square of von Mises' stress is
``u**2 + v**2 + 3 (t_xy**2 + t_xz**2 + t_yz**2)``, and ``rho_yy`` adds to ``u`` alone. So the least of the largest von
Mises stress of the history is the radius of the smallest ball around it whose centre lies on the axis of u.
"""

from __future__ import annotations

from collections.abc import Hashable
from functools import partial

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import dimension_along, single_case
from contactstudy.analysis.largest import Peak, labelled_peak, peak_between
from contactstudy.arrays.units import required_in_si
from contactstudy.arrays.variables import STRESSES, VARIABLES, describe, named
from contactstudy.checks import Array
from contactstudy.errors import InvalidInputError
from contactstudy.fatigue.enclosing_ball import enclosing_balls
from contactstudy.fatigue.history import FEWEST_POSITIONS, histories, of_points, over_history

FEWEST_FOR_ERROR = 2 * FEWEST_POSITIONS
"""Positions along y of which every second still is a history."""

SAME = 1e-6
"""Part of the largest stress that makes no difference when it is asked which instant decides."""


def in_ball_axes(history: Array) -> tuple[Array, Array, Array]:
    """Coordinates u and v, and the square of the rest, whose squares sum up to that of von Mises' stress.

    Parameters
    ----------
    history : array (..., 6)
        Stresses xx, yy, zz, xy, xz, yz.

    Examples
    --------
    >>> u, v, rest = in_ball_axes(np.array([0.0, -2.0, 0.0, 0.0, 0.0, 0.0]))
    >>> float(u), float(v), float(rest)
    (-2.0, 0.0, 0.0)
    """
    xx, yy, zz, xy, xz, yz = np.moveaxis(history, -1, 0)
    return yy - 0.5 * (xx + zz), 0.5 * np.sqrt(3.0) * (xx - zz), 3 * (xy**2 + xz**2 + yz**2)


def _of_history(history: Array, *, axial: bool) -> tuple[Array, ...]:
    """Yield stresses in shear for no yield and for shakedown, and the residual stresses yy and xx."""
    u, v, rest = in_ball_axes(history)
    first = np.sqrt((u**2 + v**2 + rest).max(axis=1) / 3)
    if axial:
        centre, radius = enclosing_balls(np.stack([u, v], axis=-1), np.sqrt(rest))
        # A stress xx moves u by -1/2 and v by sqrt(3)/2 of itself.
        along_x = -2 / np.sqrt(3.0) * centre[:, 1]
    else:
        centre, radius = enclosing_balls(u[..., None], np.sqrt(v**2 + rest))
        along_x = np.zeros(len(radius))
    return first, radius / np.sqrt(3.0), 0.5 * along_x - centre[:, 0], along_x


def shakedown(stress: xr.Dataset, *, axial: bool = False) -> xr.Dataset:
    """Least yield stress with which every material point shakes down (Melan), and the residual stress that helps it.

    Parameters
    ----------
    stress : Dataset
        The six components with the rolling direction y over the whole passage, as for
        :func:`contactstudy.fatigue.dang_van`; of one case or of a study. Sliding, or rolling with stick and slip.
    axial : bool
        Whether a residual stress along the axis may help too. Only a line contact leaves it free at every depth: it may
        not change along x, and must vanish on free ends.

    Returns
    -------
    Dataset
        Without the rolling direction: `first_yield_stress` (Pa), the yield stress in shear k below which the point
        yields in the first passage; `shakedown_stress` (Pa), the k below which it yields in every passage whatever
        residual stress yy (and xx) it has; `residual_sigma_yy` and, if `axial`, `residual_sigma_xx` (Pa), the
        residual stress with which that k suffices. The largest `shakedown_stress` over x and z is a rigorous bound:
        a perfectly plastic body (von Mises) with a larger k shakes down. Values at points have no error, as a `comment`
        says; :func:`shakedown_limit` has one.

    Raises
    ------
    InvalidInputError
        If a component or the rolling direction is missing, or `axial` is asked for at several positions along x.

    Examples
    --------
    A history of pure stress along rolling, from 0 to -2: residual tension of 1 halves it.

    >>> passage = xr.DataArray([-1.0, -2.0, -1.0], dims="y", coords={"y": [-1.0, 0.0, 1.0]})
    >>> found = shakedown(xr.Dataset({name: passage * (name == "sigma_yy") for name in STRESSES}))
    >>> round(float(found.shakedown_stress / found.first_yield_stress), 6), round(float(found.residual_sigma_yy), 6)
    (0.5, 1.0)
    """
    checks.instance("axial", axial, (bool, np.bool_), "True or False")
    if axial:
        _check_line_contact(stress)
    results = over_history(partial(_of_history, axial=bool(axial)), stress, (None,) * 4)
    names = ("first_yield_stress", "shakedown_stress", "residual_sigma_yy", "residual_sigma_xx")
    found = {name: of_points(name, array) for name, array in zip(names, results, strict=True)}
    if not axial:
        del found["residual_sigma_xx"]
    return xr.Dataset(found)


def _check_line_contact(stress: xr.Dataset) -> None:
    """Raise unless the stress is known at one position along x."""
    tensor, _ = histories(stress)
    along = [str(dim) for dim in tensor.dims if str(dim).partition("_")[0] == "x"]
    if any(tensor.sizes[dim] > 1 for dim in along):
        raise InvalidInputError(
            "axial",
            True,
            f"False with {tensor.sizes[along[0]]} positions along x",
            "residual stress along the axis is free in a line contact, which one position tells",
        )


def shakedown_limit(stress: xr.Dataset, *, axial: bool = False) -> xr.Dataset:
    """Least yield stress with which the whole body shakes down, where that is decided, and its error.

    Parameters
    ----------
    stress : Dataset
        As for :func:`shakedown`: a single case, or an opened study, of which every case is looked at.
    axial : bool
        See :func:`shakedown`.

    Returns
    -------
    Dataset
        ``peak_shakedown_stress`` (Pa), the largest over x and z between the samples, its error
        ``peak_shakedown_stress_error``, and its place ``peak_shakedown_stress_x``, ``_z``; a `comment` tells
        whether that is on the top or at a free end. The same of `first_yield_stress`. With
        `hertz_max_pressure` in the Dataset also `shakedown_limit` and `first_yield_limit`, the pressure p0 over k that
        this field allows, with their errors. As in :func:`contactstudy.analysis.largest` an error is infinite where
        the largest sample lies at the edge of the positions, or the first or the last position along y decides. It has
        a part from polynomials of two degrees in x and z, and one from every second instant along y, of which the
        larger number counts. Of a study each has the swept parameters as dimensions, and there are no comments.

    Raises
    ------
    InvalidInputError
        As for :func:`shakedown`.

    Examples
    --------
    >>> y, z = np.linspace(-4, 4, 81), np.linspace(0.1, 1.5, 29)
    >>> shear = xr.DataArray(-z * np.exp(-2 * z) * (y / (1 + y**2) ** 2)[:, None], coords={"y": y, "z": z})
    >>> found = shakedown_limit(xr.Dataset({name: shear * (name == "tau_yz") for name in STRESSES}))
    >>> round(float(found.peak_shakedown_stress_z), 2)
    0.5
    """
    stress = required_in_si(stress, *STRESSES, argument="stress")
    swept = dict(stress["hertz_half_width"].sizes) if "hertz_half_width" in stress else {}
    if any(size > 1 for size in swept.values()):
        return _of_study(stress, swept, axial=axial)
    one = single_case(stress)
    rolling = dimension_along(one["tau_yz"], "y")
    names = list(STRESSES)
    # One of the two halves of the instants lacks the one that matters most.
    enough = one.sizes[rolling] >= FEWEST_FOR_ERROR
    parts = [one, *(one.isel({rolling: slice(start, None, 2)}) for start in (0, 1) if enough)]
    fields = [shakedown(part, axial=axial).compute() for part in parts]
    result = xr.Dataset()
    for variable in ("shakedown_stress", "first_yield_stress"):

        def between(points: xr.Dataset, variable: str = variable) -> xr.DataArray:
            return shakedown(points, axial=axial)[variable]

        found, *halves = (
            peak_between(part, names, field[variable], between) for part, field in zip(parts, fields, strict=True)
        )
        if not enough:
            found = found._replace(error=np.inf, comment="too few positions along y to tell")
        elif _at_border(one, fields[0], variable):
            found = found._replace(error=np.inf, comment="the first or the last position along y decides")
        else:
            found = found._replace(error=found.error + found.value - min(half.value for half in halves))
        peak = labelled_peak(variable, found, VARIABLES[variable])
        peak[f"peak_{variable}"].attrs["comment"] = _where(one, found)
        result = result.merge(peak)
        if "hertz_max_pressure" in one and found.value:
            name = variable.replace("stress", "limit")
            limit = float(one["hertz_max_pressure"]) / found.value
            result[name] = named(name, xr.DataArray(limit))
            result[f"{name}_error"] = named(f"{name}_error", xr.DataArray(limit * found.error / found.value))
    return result


def _of_study(study: xr.Dataset, swept: dict[Hashable, int], *, axial: bool) -> xr.Dataset:
    """Limits of every case of a study; NaN where there are no stresses."""
    numbers: dict[str, Array] = {}
    for index in np.ndindex(*swept.values()):
        case = study.isel(dict(zip(swept, index, strict=True))).compute()
        if np.isnan(case["tau_yz"].values).all():
            continue
        for name, number in shakedown_limit(case, axial=axial).items():
            numbers.setdefault(str(name), np.full(tuple(swept.values()), np.nan))[index] = float(number)
    coordinates = {name: study[name] for name in swept if name in study.coords}
    found = xr.Dataset({name: (tuple(swept), values) for name, values in numbers.items()}, coordinates)
    return describe(found)


def shakedown_summary(dataset: xr.Dataset) -> xr.Dataset:
    """Limits of first yield and shakedown of a solved case, as a study keeps them.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`; stresses may be absent.

    Returns
    -------
    Dataset
        Scalars of :func:`shakedown_limit`; empty without stresses, without load, or where the stresses have fewer
        than six positions along y: the passage of a material point is not known then, and nor is any bound.

    Examples
    --------
    >>> stress = xr.DataArray(np.zeros((1, 1, 2)), dims=("x", "y", "z"), coords={"x": [0], "y": [0], "z": [0, 2]})
    >>> len(shakedown_summary(xr.Dataset({name: stress for name in STRESSES})))
    0
    """
    if not all(name in dataset for name in STRESSES):
        return xr.Dataset()
    if dataset.sizes[dimension_along(dataset["tau_yz"], "y")] < FEWEST_FOR_ERROR:
        return xr.Dataset()
    if not any(dataset[name].values.any() for name in STRESSES):
        return xr.Dataset()
    return shakedown_limit(dataset).reset_coords(drop=True)


def _at_border(one: xr.Dataset, fields: xr.Dataset, variable: str) -> bool:
    """Whether the first or the last instant alone is as bad as the largest: worse ones may lie beyond."""
    tensor, _ = histories(one)
    worst = {dim: int(index) for dim, index in fields[variable].argmax(...).items()}
    point = tensor.isel(worst).values
    eased = np.zeros(len(STRESSES))
    if variable == "shakedown_stress":
        eased[1] = float(fields["residual_sigma_yy"].isel(worst))
        eased[0] = float(fields["residual_sigma_xx"].isel(worst)) if "residual_sigma_xx" in fields else 0.0
    u, v, rest = in_ball_axes(point + eased)
    size = np.sqrt((u**2 + v**2 + rest) / 3)
    held = float(fields[variable].isel(worst))
    # An unloaded border is as bad as the unloaded state may be, which is known.
    at_rest = np.abs(point[[0, -1]]).max(axis=-1) <= SAME * held
    return bool(((size[[0, -1]] >= held * (1 - SAME)) & ~at_rest).any())


def _where(one: xr.Dataset, found: Peak) -> str:
    """Say whether a place is on the top, and whether at an end of the cells."""
    words = ["on the top" if found.place.get("z", 1.0) == 0 else "below the top"]
    if "x" in found.place and "x_bounds" in one.coords:
        bounds = one["x_bounds"].values
        if np.isclose(found.place["x"], [bounds.min(), bounds.max()], rtol=0, atol=1e-9 * np.ptp(bounds)).any():
            words.append("at an end")
    return ", ".join(words)
