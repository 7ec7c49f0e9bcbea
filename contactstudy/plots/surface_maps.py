"""Maps of the top of the body: pressure, traction, slip, stick, temperature and film, cropped to the contact."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import dimension_along, positions, single_case
from contactstudy.arrays.engineering import unit_for
from contactstudy.arrays.variables import require, variable_of
from contactstudy.checks import BoolArray, FloatArray, IntArray
from contactstudy.plots.axial import FILM_HALF_RANGE
from contactstudy.plots.style import COLORS, cap_field, label_axes, new_axes, units

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh

HEAT_COLORS = "inferno"
STICK_COLOR, SLIP_COLOR = "0.55", "0.88"
CONTACT_BORDER: dict[str, Any] = {"colors": "0.35", "linewidths": 0.9}
STICK_BORDER: dict[str, Any] = {"colors": "#e8513a", "linewidths": 1.8}  # legible on every colour of the map
BORDER_LEVEL = 0.01  # Squared pressure at the drawn border over its maximum; it is linear in the distance
MARGIN = 0.1  # Margin around the contact over its width
ARROW_LENGTH = 1.5  # Length of the longest arrow over the arrows' spacing along x
VECTORS = ("traction", "slip")
EQUAL_MAXIMA = 1e-6  # relative difference of two maxima that are equal up to the solver's tolerance
TEMPERATURE_NAMES = {"body": "temperature_rise", "roller": "roller_temperature_rise"}


class Surface:
    """Surface of a single case: positions in the units of the figure, and load and contact over (y, x)."""

    def __init__(self, dataset: xr.Dataset, *names: str, si: bool, load: str = "pressure") -> None:
        self.case = single_case(dataset)
        require(self.case, *names)
        self.unit = units(self.case, si=si)
        self.x, self.y = (positions(self.case[load], axis).values / self.unit.length for axis in "xy")
        self.pressure = self.values(load)
        self.in_contact: BoolArray = self.pressure > 0

    def values(self, name: str) -> FloatArray:
        """Variable over (y, x)."""
        array = self.case[name]
        x, y = (dimension_along(array, axis) for axis in "xy")
        values: FloatArray = np.asarray(array.transpose(y, x).values, dtype=np.float64)
        return values


def _draw_mesh(ax: Axes, surface: Surface, values: Any, **style: Any) -> QuadMesh:
    """Draw values over (y, x) as cells."""
    return ax.pcolormesh(surface.x, surface.y, values, shading="nearest", rasterized=True, **style)


def _draw_border(ax: Axes, surface: Surface, values: FloatArray, threshold: float, **style: Any) -> Any:
    """Draw a closed contour of values over (y, x), 0 beyond the cells; None for too few cells."""
    if min(values.shape) < 2 or values.max() <= threshold:
        return None
    # The contour may reach the outer edges of the cells.
    x, y = (
        np.concatenate([[axis[0] - 0.5 * (axis[1] - axis[0])], axis, [axis[-1] + 0.5 * (axis[-1] - axis[-2])]])
        for axis in (surface.x, surface.y)
    )
    return ax.contour(x, y, np.pad(values, 1), levels=[threshold], **style)


def _extend(values: FloatArray, in_contact: BoolArray) -> FloatArray:
    """Values over (y, x), which continue the contact's outermost values along y; 0 in columns without contact."""
    rows = np.arange(len(values))[:, None]
    first_row, last_row = in_contact.argmax(axis=0), len(values) - 1 - in_contact[::-1].argmax(axis=0)
    extended = np.take_along_axis(values, np.clip(rows, first_row, last_row), axis=0)
    return np.where(in_contact.any(axis=0), extended, 0.0)


def _draw_contact_border(ax: Axes, surface: Surface, *artists: Any) -> None:
    """Draw the border of the contact, and clip artists to this border."""
    max_pressure = float(cap_field(surface.case, surface.case["pressure"])[0].max())
    threshold = BORDER_LEVEL * (max_pressure * max_pressure)
    border = _draw_border(ax, surface, surface.pressure**2, threshold, **CONTACT_BORDER)
    for artist in artists:
        if border is not None and artist is not None:
            artist.set_clip_path(border.get_paths()[0], ax.transData)


def _crop_axes(ax: Axes, surface: Surface) -> None:
    """Limit the axes to the contact with a margin."""
    for centres, axis, set_limits in ((surface.x, 0, ax.set_xlim), (surface.y, 1, ax.set_ylim)):
        loaded_indices = np.flatnonzero(surface.in_contact.any(axis=axis))
        if loaded_indices.size > 1:
            low, high = centres[loaded_indices[0]], centres[loaded_indices[-1]]
            margin = MARGIN * (high - low)
            set_limits(low - margin, high + margin)


def _label_map(ax: Axes, surface: Surface, colours: Any, label: str, extend: str | None = None) -> None:
    """Label the axes and the colour bar of a mesh or of filled contours."""
    bar = ax.figure.colorbar(colours, ax=ax, label=label, extend=extend)
    label_axes(ax, surface.unit.axis_label("x"), surface.unit.axis_label("y"), bar.ax)


def plot_pressure_map(dataset: xr.Dataset, ax: Axes | None = None, *, si: bool = False) -> Axes:
    """Pressure on the top of the body.

    Parameters
    ----------
    dataset, ax, si
        As for :func:`plot_axial_pressure`.

    Returns
    -------
    Axes
        Cropped to the contact. Near a singular end the colours stop at the pressure 0.05 a from the end.

    Raises
    ------
    InvalidInputError
        If the pressure is missing, or the Dataset contains more than one case.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5], "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray([[1.0, 1.0], [2.0, 2.0]], dims=("x", "y"), coords=cells)
    >>> case = xr.Dataset({"pressure": pressure, "hertz_half_width": 1.0, "hertz_max_pressure": 2.0})
    >>> plot_pressure_map(case).get_ylabel()
    'position along rolling, $y/a$'
    """
    surface = Surface(dataset, "pressure", si=si)
    ax = new_axes(ax)
    stress, (_, bound) = surface.unit.stress, cap_field(surface.case, surface.case["pressure"])
    max_value = bound / stress if bound < np.inf else None
    mesh = _draw_mesh(ax, surface, surface.pressure / stress, cmap=COLORS, vmin=0.0, vmax=max_value)
    _draw_contact_border(ax, surface, mesh)
    _crop_axes(ax, surface)
    _label_map(ax, surface, mesh, surface.unit.stress_label("pressure"), None if max_value is None else "max")
    return ax


def plot_stick_and_slip(dataset: xr.Dataset, ax: Axes | None = None, *, si: bool = False, arrows: int = 24) -> Axes:
    """Areas that stick and slip, with arrows of the tractions on the body.

    Parameters
    ----------
    dataset : Dataset
        A single case with stick and slip.
    ax, si
        As for :func:`plot_axial_pressure`.
    arrows : int
        Number of arrows along x; half as many along y.

    Returns
    -------
    Axes
        Cropped to the contact; its axes have different scales. An arrow has the direction of the traction in equal
        scales; the arrow above the axes is the scale of the lengths.

    Raises
    ------
    InvalidInputError
        If tractions are missing, or the Dataset contains more than one case.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5], "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray(np.ones((2, 2)), dims=("x", "y"), coords=cells)
    >>> case = xr.Dataset({"pressure": pressure, "traction_x": 0 * pressure, "traction_y": 0.1 * pressure,
    ...                    "stick": pressure > 0, "hertz_half_width": 1.0, "hertz_max_pressure": 1.0})
    >>> len(plot_stick_and_slip(case).get_legend().get_texts())
    2
    """
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    checks.count("arrows", arrows)
    surface = Surface(dataset, "pressure", "traction_x", "traction_y", "stick", si=si)
    ax = new_axes(ax)
    slip = np.where(surface.values("stick") > 0, 0.0, 1.0)
    mesh = _draw_mesh(
        ax, surface, _extend(slip, surface.in_contact), cmap=ListedColormap([STICK_COLOR, SLIP_COLOR]), vmin=0, vmax=1
    )
    _draw_contact_border(ax, surface, mesh)
    rows, columns = _arrow_cells(surface, arrows)
    traction = [surface.values(f"traction_{axis}")[rows, columns] / surface.unit.stress for axis in "xy"]
    max_traction = float(np.hypot(*traction).max(initial=0.0))
    _crop_axes(ax, surface)
    if max_traction > 0:
        scale = max_traction * arrows / ARROW_LENGTH
        vectors = ax.quiver(
            surface.x[columns], surface.y[rows], *traction, scale_units="width", scale=scale, width=3e-3
        )
        label = f"${max_traction:.3g}\\,p_0$" if not si else f"{max_traction:.3g} MPa"
        ax.quiverkey(vectors, 0.86, 1.06, max_traction, label, labelpos="W", coordinates="axes")
    handles = [Patch(facecolor=STICK_COLOR, label="stick"), Patch(facecolor=SLIP_COLOR, label="slip")]
    ax.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, frameon=False, fontsize="small")
    label_axes(ax, surface.unit.axis_label("x"), surface.unit.axis_label("y"))
    return ax


def _arrow_cells(surface: Surface, arrows: int) -> tuple[IntArray, IntArray]:
    """Rows and columns of evenly spread cells of the contact, `arrows` along x, half as many along y."""
    indices = []
    for axis, (values, count) in enumerate(((surface.x, arrows), (surface.y, (arrows + 1) // 2))):
        contact_positions = values[surface.in_contact.any(axis=axis)]
        targets = contact_positions[0] + (np.arange(count) + 0.5) * float(np.ptp(contact_positions)) / count
        indices.append(np.unique(np.abs(values[:, None] - targets).argmin(axis=0)))
    columns, rows = (index.ravel() for index in np.meshgrid(*indices, indexing="ij"))
    in_contact = surface.in_contact[rows, columns]
    return rows[in_contact], columns[in_contact]


def plot_traction_map(
    dataset: xr.Dataset, ax: Axes | None = None, *, variable: str = "traction", si: bool = False
) -> Axes:
    """Magnitude of the traction or the slip on the top, with the borders of contact and stick area.

    Parameters
    ----------
    dataset, ax, si
        As for :func:`plot_stick_and_slip`.
    variable : {"traction", "slip"}
        Vector to draw. The slip is the roller's against the body: per distance rolled, or of a shift.

    Returns
    -------
    Axes
        Cropped to the contact; its two axes have different scales.

    Raises
    ------
    InvalidInputError
        If the variable or stick is missing, or the Dataset contains more than one case.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5], "y": [-0.5, 0.5]}
    >>> pressure = xr.DataArray(np.ones((2, 2)), dims=("x", "y"), coords=cells)
    >>> case = xr.Dataset({"pressure": pressure, "traction_x": 0.3 * pressure, "traction_y": 0.4 * pressure,
    ...                    "stick": pressure > 0, "hertz_half_width": 1.0, "hertz_max_pressure": 1.0})
    >>> float(plot_traction_map(case).collections[0].get_array().max())
    0.5
    """
    checks.known_name("variable", variable, VECTORS)
    surface = Surface(dataset, "pressure", "stick", f"{variable}_x", f"{variable}_y", si=si)
    ax = new_axes(ax)
    magnitude = np.hypot(surface.values(f"{variable}_x"), surface.values(f"{variable}_y"))
    max_traction = float(magnitude[surface.in_contact].max(initial=0.0))
    factor, label = surface.unit.stress, f"traction{' (MPa)' if si else ' over $p_0$'}"
    if variable == "slip":
        factor, unit = unit_for(max_traction, str(surface.case["slip_y"].attrs.get("units", "1")))
        label = f"slip ({unit})" if unit else "slip per distance rolled"
    mesh = _draw_mesh(ax, surface, _extend(magnitude / factor, surface.in_contact), cmap=COLORS, vmin=0.0)
    border = _draw_border(ax, surface, _extend(surface.values("stick"), surface.in_contact), 0.5, **STICK_BORDER)
    _draw_contact_border(ax, surface, mesh, border)
    _crop_axes(ax, surface)
    _label_map(ax, surface, mesh, label)
    return ax


def plot_temperature_map(
    dataset: xr.Dataset, ax: Axes | None = None, *, surface: str = "body", si: bool = False
) -> Axes:
    """Temperature rise of a surface, with the hottest cell and the border of the contact.

    Parameters
    ----------
    dataset : Dataset
        Result of `flash_temperature`.
    ax, si
        As for :func:`plot_axial_pressure`.
    surface : {"body", "roller"}
        Surface to draw.

    Returns
    -------
    Axes
        A cross marks the hottest cell; a white line encloses the heated cells.

    Raises
    ------
    InvalidInputError
        If the surface has no temperature, or the Dataset contains more than one case.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5], "y": [-0.5, 0.5]}
    >>> rise = xr.DataArray([[1.0, 1.0], [2.0, 2.5]], dims=("x", "y"), coords=cells)
    >>> hot = xr.Dataset({"temperature_rise": rise, "frictional_heat": 0 * rise, "hertz_half_width": 1.0})
    >>> plot_temperature_map(hot.assign(hertz_max_pressure=1.0)).get_ylabel()
    'position along rolling, $y/a$'
    """
    checks.known_name("surface", surface, TEMPERATURE_NAMES)
    name = TEMPERATURE_NAMES[surface]
    face = Surface(dataset, name, "frictional_heat", si=si, load="frictional_heat")
    ax = new_axes(ax)
    rise = face.values(name)
    mesh = _draw_mesh(ax, face, rise, cmap=HEAT_COLORS)
    _draw_border(ax, face, face.pressure, 1e-3 * float(face.pressure.max()), colors="white", linewidths=0.8)
    # Of equal maxima at both ends the cross marks the maximum nearer to end I.
    row, column = divmod(int((rise >= (1 - EQUAL_MAXIMA) * rise.max()).argmax()), rise.shape[1])
    ax.plot(face.x[column], face.y[row], "+", color="black", markersize=9)
    _label_map(ax, face, mesh, f"{variable_of(name, face.case[name].attrs).long_name} (K)")
    return ax


def plot_film_map(dataset: xr.Dataset, ax: Axes | None = None, *, fringes: int = 12, si: bool = False) -> Axes:
    """Film thickness with contours, like an interferogram.

    Parameters
    ----------
    dataset, ax, si
        As for :func:`plot_film_line`.
    fringes : int
        Number of contours up to 1.5 times the central film.

    Returns
    -------
    Axes
        A cross marks the least film.

    Raises
    ------
    InvalidInputError
        If the film is missing, or the Dataset contains more than one case.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5], "y": [-0.5, 0.5]}
    >>> film = xr.DataArray([[1e-6, 2e-6], [1e-6, 3e-6]], dims=("x", "y"), coords=cells)
    >>> scalars = {"central_film": 2e-6, "least_film_x": 0.5, "least_film_y": -0.5, "hertz_half_width": 1.0}
    >>> case = xr.Dataset({"film_thickness": film, **scalars, "hertz_max_pressure": 1.0})
    >>> plot_film_map(case).get_ylabel()
    'position along rolling, $y/a$'
    """
    checks.count("fringes", fringes)
    names = ("film_thickness", "central_film", "least_film_x", "least_film_y")
    surface, ax = Surface(dataset, *names, si=si, load="film_thickness"), new_axes(ax)
    case, unit, x, y = surface.case, surface.unit, surface.x, surface.y
    film = 1e6 * surface.values("film_thickness")
    max_film = 1.5e6 * float(case["central_film"])
    levels = np.linspace(0.0, max_film, fringes + 1)
    contours = ax.contourf(x, y, film, levels=levels, cmap=COLORS, extend="max")
    ax.contour(x, y, film, levels=levels[1:], colors="0.25", linewidths=0.5)
    ax.plot(float(case["least_film_x"]) / unit.length, float(case["least_film_y"]) / unit.length, "x", color="#e8513a")
    half_range = FILM_HALF_RANGE * float(case["hertz_half_width"]) / unit.length
    ax.set_ylim(max(-half_range, y.min()), min(half_range, y.max()))
    _label_map(ax, surface, contours, "film thickness, $h$ (µm)")
    return ax
