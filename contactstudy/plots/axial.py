"""Lines along the roller's axis, along y and against depth: profile, pressure, stresses, film, wear, comparisons."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import (
    along_line,
    axial_pressure,
    dimension_along,
    largest_sample,
    measure,
    positions,
    single_case,
)
from contactstudy.analysis.axial import loaded_range
from contactstudy.arrays.variables import require
from contactstudy.errors import InvalidInputError
from contactstudy.plots.style import (
    LEGEND_WIDTH,
    Units,
    fold_text,
    is_near_singular_end,
    label_axes,
    line_styles,
    mark_at_top,
    new_axes,
    singular_ends,
    units,
)
from contactstudy.profiles import Profile
from contactstudy.profiles.base import check_drop

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FILM_HALF_RANGE = 1.4  # Half of the range along y in a figure of a film, over the Hertz half-width
PROFILE_POINTS = 4001
WEAR_LABELS = {"wear_depth": (1e6, "worn depth (µm)"), "line_load": (1e-3, "load per length (N/mm)")}
"""Factor from SI and label of the variables of `plot_wear`."""


def plot_axial_pressure(
    dataset: xr.Dataset, ax: Axes | None = None, *, shift: float = 0.0, si: bool = False, **style: Any
) -> Axes:
    """Largest pressure across y along the roller's axis.

    Parameters
    ----------
    dataset : Dataset
        A single case with `pressure`.
    ax : Axes, optional
        Axes to draw in; default: a new figure.
    shift : float
        Length added to the positions, in the unit of the figure.
    si : bool
        Whether to draw mm and MPa instead of lengths over a and pressures over p0.
    **style
        Style of the line, as in matplotlib.

    Returns
    -------
    Axes
        An open triangle at the top marks a singular end; the line ends 0.05 half-widths before the end.

    Raises
    ------
    InvalidInputError
        If the pressure is missing, or the Dataset contains more than one case.

    Examples
    --------
    >>> pressure = xr.DataArray([[1.0], [2.0]], dims=("x", "y"), coords={"x": [0.5, 1.5], "y": [0.0]})
    >>> case = xr.Dataset({"pressure": pressure, "hertz_half_width": 1.0, "hertz_max_pressure": 2.0})
    >>> plot_axial_pressure(case).get_ylabel()
    'contact pressure, $p/p_0$'
    """
    case = single_case(dataset)
    require(case, "pressure")
    unit = units(case, si=si)
    ax = new_axes(ax)
    draw_section_maxima(ax, case, "pressure", unit, shift, **style)
    label_axes(ax, unit.axis_label("x"), unit.stress_label("pressure"))
    return ax


def draw_section_maxima(
    ax: Axes, case: xr.Dataset, variable: str, unit: Units, shift: float = 0.0, **style: Any
) -> None:
    """Draw the largest value in each cross-section; omit the neighbourhood of singular ends, and mark these ends."""
    if variable == "pressure":
        maxima = axial_pressure(case)
    else:
        maxima = largest_sample(case, variable, along="x")[f"largest_{variable}"]
    x = maxima[dimension_along(maxima, "x")].values
    values = np.where(is_near_singular_end(case, x), np.nan, maxima.values)
    (line,) = ax.plot(x / unit.length + shift, values / unit.stress, **style)
    mark_at_top(ax, [end / unit.length + shift for end in singular_ends(case)], line.get_color())


def plot_comparison(
    results: Mapping[str, xr.Dataset],
    variable: str = "pressure",
    *,
    ax: Axes | None = None,
    si: bool = False,
    centred: bool | None = None,
) -> Axes:
    """Largest value in each cross-section along the roller's axis, for several results: profiles, bodies, loads.

    Parameters
    ----------
    results : mapping
        Single cases by their names in the legend, each drawn over its own a and p0.
    variable : str
        `pressure`, or a stress or measure, see :func:`contactstudy.analysis.measure`.
    ax, si
        As for :func:`plot_axial_pressure`.
    centred : bool, optional
        Whether positions count from the middle of the contact; default: if the middles of the contacts differ by
        more than a half-width, as for bodies of different length.

    Raises
    ------
    InvalidInputError
        If `results` is empty, a variable is missing, or a Dataset contains more than one case.

    Examples
    --------
    >>> pressure = xr.DataArray([[1.0], [2.0]], dims=("x", "y"), coords={"x": [0.5, 1.5], "y": [0.0]})
    >>> case = xr.Dataset({"pressure": pressure, "hertz_half_width": 1.0, "hertz_max_pressure": 2.0})
    >>> len(plot_comparison({"half": 0.5 * case, "full": case}, si=True).lines)
    2
    """
    if not isinstance(results, Mapping) or not results:
        raise InvalidInputError("results", results, "a mapping of names to results, at least one")
    ax = new_axes(ax)
    cases = {name: single_case(dataset) for name, dataset in results.items()}
    midpoints = {
        name: 0.5 * float(sum(loaded_range(axial_pressure(case)))) if "pressure" in case else 0.0
        for name, case in cases.items()
    }
    if centred is None:
        half_width = min(float(case.get("hertz_half_width", np.inf)) for case in cases.values())
        centred = max(midpoints.values()) - min(midpoints.values()) > half_width
    for (name, case), style in zip(cases.items(), line_styles(len(cases)), strict=True):
        unit = units(case, si=si)
        shift = -midpoints[name] / unit.length if centred else 0.0
        draw_section_maxima(ax, case, variable, unit, shift, label=fold_text(name, LEGEND_WIDTH), **style)
    ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0]))
    ax.legend(frameon=False, fontsize="small")
    x_label = unit.axis_label("x") if not centred else f"position from mid-length, $x{unit.over_length}$"
    label_axes(ax, x_label, unit.stress_label(variable))
    return ax


def plot_depth(
    dataset: xr.Dataset,
    variables: Sequence[str] = ("von_mises", "maximum_shear"),
    *,
    ax: Axes | None = None,
    x: float | None = None,
    y: float = 0.0,
    si: bool = False,
) -> Axes:
    """Stresses against depth below a point of the surface.

    Parameters
    ----------
    dataset : Dataset
        A single case with stresses.
    variables : sequence of str
        Stresses or measures, see :func:`contactstudy.analysis.measure`.
    ax, si
        As for :func:`plot_axial_pressure`.
    x, y : float, optional
        The point, metres; default: the middle of the positions of stresses along x, and ``y = 0``.

    Returns
    -------
    Axes
        With the depth downwards.

    Raises
    ------
    InvalidInputError
        If a variable is missing, the point lies outside the result, or the Dataset contains more than one case.

    Examples
    --------
    >>> field = xr.DataArray([[[1.0, 4.0]]], dims=("x", "y", "z"), coords={"x": [0.0], "y": [0.0], "z": [0.0, 1.0]})
    >>> case = xr.Dataset({"von_mises": field, "hertz_half_width": 1.0, "hertz_max_pressure": 2.0})
    >>> plot_depth(case, ["von_mises"]).get_ylabel()
    'depth, $z/a$'
    """
    names = [variables] if isinstance(variables, str) else list(variables)
    if not names:
        raise InvalidInputError("variables", variables, "at least one")
    case = single_case(dataset)
    unit = units(case, si=si)
    field = measure(case, names[0])
    depth, x_positions = positions(field, "z").values, positions(field, "x").values
    x = 0.5 * float(x_positions.min() + x_positions.max()) if x is None else x
    line_ends = ((x, y, float(depth.min())), (x, y, float(depth.max())))
    line = along_line(case, *line_ends, points=10 * np.size(depth) + 1, variables=names)
    ax = new_axes(ax, (4.8, 4.8))
    for name, style in zip(names, line_styles(len(names)), strict=True):
        label = fold_text(unit.stress_label(name), LEGEND_WIDTH)
        ax.plot(line[name].values / unit.stress, line["z"].values / unit.length, label=label, **style)
    ax.set_ylim(depth.max() / unit.length, depth.min() / unit.length)
    ax.set_title(f"below {unit.position('x', x)}, {unit.position('y', y)}", fontsize="medium")
    ax.legend(frameon=False, fontsize="small")
    label_axes(ax, "stress over $p_0$" if not si else "stress (MPa)", unit.axis_label("z"))
    return ax


def plot_wear(worn: xr.Dataset, ax: Axes | None = None, *, variable: str = "wear_depth") -> Axes:
    """Worn depth or load per length along the axis, dark to light with the distance.

    Parameters
    ----------
    worn : Dataset
        Result of `wear.wear_in`.
    ax : Axes, optional
        Axes to draw in; default: a new figure.
    variable : {"wear_depth", "line_load"}
        Variable to draw; the depth points downwards, as a profile's drop.

    Returns
    -------
    Axes
        The legend lists the distances. Columns without load are omitted.

    Raises
    ------
    InvalidInputError
        If the variable is unknown or missing.

    Examples
    --------
    >>> state = xr.DataArray([[0.0, 0.0], [2e-6, 1e-6]], dims=("distance", "x"))
    >>> worn = xr.Dataset({"wear_depth": state, "line_load": 1 + state}, {"distance": [0.0, 9.0], "x": [0.5, 1.5]})
    >>> [text.get_text() for text in plot_wear(worn).get_legend().get_texts()]
    ['0 m', '9 m']
    """
    checks.known_name("variable", variable, WEAR_LABELS)
    require(worn, variable, "line_load", argument="worn")
    factor, label = WEAR_LABELS[variable]
    ax = new_axes(ax)
    is_loaded = (worn["line_load"] > 0).any("distance").values
    distances = worn["distance"].values
    depths = worn[variable].transpose("distance", "x").values
    for index, style in enumerate(line_styles(distances.size)):
        distance = np.format_float_positional(distances[index], precision=4, fractional=False, trim="-")
        values = np.where(is_loaded, factor * depths[index], np.nan)
        ax.plot(1e3 * worn["x"].values, values, label=f"{distance} m", **style)
    if variable == "wear_depth" and not ax.yaxis_inverted():
        ax.invert_yaxis()
    ax.set_xlabel("position along the axis, $x$ (mm)")
    ax.set_ylabel(label)
    ax.legend(frameon=False, fontsize="small", title=str(worn["distance"].attrs.get("long_name", "distance")))
    return ax


def plot_film_line(
    dataset: xr.Dataset, ax: Axes | None = None, *, x: float | None = None, y: float | None = None, si: bool = False
) -> Axes:
    """Film thickness and pressure along the axis, or along y.

    Parameters
    ----------
    dataset : Dataset
        Result of `solve_film`.
    ax, si
        As for :func:`plot_axial_pressure`.
    x, y : float, optional
        Position of the line along y or along the axis, metres; default: along the axis at ``y = 0``.

    Returns
    -------
    Axes
        Axes of the film; the pressure has axes on the right.

    Raises
    ------
    InvalidInputError
        If the film is missing, both positions are given, or the Dataset contains more than one case.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5], "y": [-0.5, 0.5]}
    >>> film = xr.DataArray([[1e-6, 2e-6], [1e-6, 3e-6]], dims=("x", "y"), coords=cells)
    >>> case = xr.Dataset({"film_thickness": film, "pressure": 0 * film, "central_film": 1e-6,
    ...                    "hertz_half_width": 1.0, "hertz_max_pressure": 1.0})
    >>> plot_film_line(case, x=0.5).get_xlabel()
    'position along rolling, $y/a$'
    """
    if x is not None and y is not None:
        raise InvalidInputError("x, y", (x, y), "one of the two")
    case = single_case(dataset)
    require(case, "film_thickness", "pressure", "central_film")
    unit, ax = units(case, si=si), new_axes(ax)
    axis, fixed_axis, position = ("x", "y", y or 0.0) if x is None else ("y", "x", x)
    line = case[["film_thickness", "pressure"]].dropna("x").interp({fixed_axis: position})
    line_positions = line[axis].values / unit.length
    film_style, pressure_style, slice_style = line_styles(3)
    ax.plot(line_positions, 1e6 * line["film_thickness"].values, label="film", **film_style)
    if axis == "x" and "slice_film" in case:
        slices = case["slice_film"].sel(x=line["x"])
        ax.plot(line_positions, 1e6 * slices.values, label="slices, Moes' formula", **slice_style)
    pressure_axes = ax.twinx()
    pressure_axes.plot(line_positions, line["pressure"].values / unit.stress, label="pressure", **pressure_style)
    ax.set_ylim(0.0, 3e6 * float(case["central_film"]))
    pressure_axes.set_ylim(bottom=0.0)
    if axis == "y":
        half_range = FILM_HALF_RANGE * float(case["hertz_half_width"]) / unit.length
        ax.set_xlim(-half_range, half_range)
    pressure_axes.set_ylabel(unit.stress_label("pressure"))
    ax.legend(handles=[*ax.lines, *pressure_axes.lines], loc="lower center", frameon=False, fontsize="small")
    label_axes(ax, unit.axis_label(axis), "film thickness, $h$ (µm)", pressure_axes)
    return ax


def plot_profile(
    profile: Profile, length: float, *, ax: Axes | None = None, deepest: float | None = None, **style: Any
) -> Axes:
    """Draw the generatrix of a roller, with the drop downwards.

    Parameters
    ----------
    profile : Profile
        Profile to draw.
    length : float
        Length of the roller, metres.
    ax, **style
        As for :func:`plot_axial_pressure`.
    deepest : float, optional
        Largest drop on the axis, metres; default: the profile's largest drop. Limit it for crowns of micrometres with
        fillets of tenths of a millimetre.

    Returns
    -------
    Axes
        The line ends where the drop is infinite.

    Raises
    ------
    InvalidInputError
        If `profile` is not a profile or does not fit the length, or a number is not positive.

    Examples
    --------
    >>> from contactstudy.profiles import Lundberg
    >>> plot_profile(Lundberg(amplitude=0.2e-6), length=10e-3).get_ylabel()
    'drop (µm)'
    """
    checks.instance("profile", profile, Profile, "a profile from contactstudy.profiles")
    length = checks.positive("length", length, "metres")
    x = 0.5 * length * np.linspace(-1, 1, PROFILE_POINTS)
    drop = check_drop(profile, x, length)
    drop = np.where(np.isfinite(drop), drop, np.nan)
    ax = new_axes(ax, (6.4, 3.2))
    ax.plot(1e3 * x, 1e6 * drop, **style)
    if not ax.yaxis_inverted():
        ax.invert_yaxis()
    if deepest is not None:
        deepest = checks.positive("deepest", deepest, "metres")
        ax.set_ylim(1e6 * deepest, -0.05e6 * deepest)
    ax.set_xlabel("distance from mid-length (mm)")
    ax.set_ylabel("drop (µm)")
    return ax


def plot_profiles(
    profiles: Mapping[str, Profile], length: float, *, ax: Axes | None = None, deepest: float | None = None
) -> Axes:
    """Compare the generatrices of rollers of one length.

    Parameters
    ----------
    profiles : mapping of str to Profile
        Profiles by their names in the legend.
    length : float
        Length of the rollers, metres.
    ax, deepest
        As for :func:`plot_profile`.

    Raises
    ------
    InvalidInputError
        If `profiles` is empty, or :func:`plot_profile` rejects an argument.

    Examples
    --------
    >>> from contactstudy.profiles import Cylinder, FullCrown
    >>> ax = plot_profiles({"sharp": Cylinder(), "crowned": FullCrown(1.0)}, length=10e-3)
    >>> [text.get_text() for text in ax.get_legend().get_texts()]
    ['sharp', 'crowned']
    """
    checks.instance("profiles", profiles, Mapping, "a mapping of names to profiles")
    if not profiles:
        raise InvalidInputError("profiles", dict(profiles), "at least one profile")
    for (name, profile), style in zip(profiles.items(), line_styles(len(profiles)), strict=True):
        ax = plot_profile(profile, length, ax=ax, deepest=deepest, label=fold_text(name, LEGEND_WIDTH), **style)
    assert ax is not None
    ax.legend(frameon=False, fontsize="small", ncols=2)
    return ax
