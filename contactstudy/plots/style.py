"""What all figures share: colours that keep their order in grey, line styles, units and labels, saving."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.variables import STRESSES, specification
from contactstudy.errors import InvalidInputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLORS = "viridis"
"""Colour map whose lightness grows from end to end, so that it can be read in grey and by the colour-blind."""

DASHES: tuple[Any, ...] = (
    "-",
    (0, (6, 1.5)),
    (0, (6, 1.5, 1, 1.5)),
    (0, (3, 1.5)),
    (0, (1, 1)),
    (0, (8, 2, 1, 2, 1, 2)),
)
"""Lines differ by their dashes as well as by colour."""

AXIS_MEANINGS = {"x": "distance from the free end", "y": "position along rolling", "z": "depth"}
"""Words for the axes, shorter than in the table of variables."""

SYMBOLS = {
    "e_over_a": "distance of the roller's end from the free end, $e/a$",
    "friction": "friction, $f$",
    "gamma": r"length over radius, $\gamma$",
    "max_pressure": "Hertz pressure, $p_0$",
}
"""Labels of swept parameters that the theory has a symbol for; the symbols of variables stand in their table."""


class Units(NamedTuple):
    """Length and stress that a figure is drawn in, and how its labels name them."""

    length: float
    stress: float
    over_length: str
    over_stress: str

    def axis(self, axis: str) -> str:
        """Label of positions along x, y or z."""
        return f"{AXIS_MEANINGS[axis]}, ${axis}{self.over_length}$"

    def place(self, axis: str, position: float) -> str:
        """Text for a position in metres."""
        shown = f"{position / self.length:.3g}"
        return f"${axis}{self.over_length}$ = {shown}" if self.over_length == "/a" else f"${axis}$ = {shown} mm"

    def stress_label(self, variable: str) -> str:
        """Label of a stress or a pressure."""
        known = specification(variable)
        if known is None or not known.symbol:
            meaning = known.long_name if known else variable.replace("_", " ")
            return f"{meaning}{' over $p_0$' if self.over_stress == '/p_0' else ' (MPa)'}"
        meaning = "" if variable in STRESSES else f"{known.long_name}, "
        return f"{meaning}${known.symbol}{self.over_stress}$"


MILLIMETRES = Units(1e-3, 1e6, r"\ \mathrm{(mm)}", r"\ \mathrm{(MPa)}")
"""What figures with ``si=True`` are drawn in."""


def units(dataset: xr.Dataset, *, si: bool) -> Units:
    """Return the Hertz half-width and pressure of one case as units; or mm and MPa.

    Raises
    ------
    InvalidInputError
        If the result lacks its Hertz half-width and pressure.

    Examples
    --------
    >>> units(xr.Dataset(), si=True).stress
    1000000.0
    """
    if si:
        return MILLIMETRES
    for name in ("hertz_half_width", "hertz_max_pressure"):
        if name not in dataset:
            raise InvalidInputError(
                "dataset", sorted(map(str, dataset.data_vars)), f"a Dataset with {name}", "draw with si=True instead"
            )
    return Units(float(dataset["hertz_half_width"]), float(dataset["hertz_max_pressure"]), "/a", "/p_0")


def as_written(value: object) -> str:
    r"""Return a name from a study as text that matplotlib shows as it is, dollar signs included.

    Examples
    --------
    >>> print(as_written("$1 roller"))
    \$1 roller
    """
    return str(value).replace("$", r"\$")


def new_axes(ax: Axes | None, size: tuple[float, float] = (6.4, 4.0)) -> Axes:
    """Return the given axes, or those of a new figure of `size` inches."""
    if ax is not None:
        return ax
    from matplotlib import pyplot

    return pyplot.subplots(figsize=size, layout="constrained")[1]


def line_styles(count: int) -> list[dict[str, Any]]:
    """Return styles of `count` lines, dark to light, each with its own dashes."""
    import matplotlib

    colors = matplotlib.colormaps[COLORS](np.linspace(0.0, 0.8, count))
    return [
        {"color": color, "linestyle": DASHES[number % len(DASHES)], "linewidth": 1.8}
        for number, color in enumerate(colors)
    ]


def save(figure: Figure, path: str | Path, formats: Sequence[str] = ("png", "pdf")) -> list[Path]:
    """Write a figure for the screen and for a journal.

    Parameters
    ----------
    figure : Figure
        The figure.
    path : str or Path
        File name; its suffix, if it is one of `formats`, is left out.
    formats : sequence of str
        Formats that matplotlib knows.

    Returns
    -------
    list of Path
        The files: PNG with 200 dots per inch, PDF with text as text.

    Raises
    ------
    InvalidInputError
        If matplotlib cannot write a format, or a file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from matplotlib.figure import Figure
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [file.name for file in save(Figure(), Path(folder) / "pressure.png")]
    ['pressure.png', 'pressure.pdf']
    """
    import matplotlib

    known = figure.canvas.get_supported_filetypes()
    for name in formats:
        if name not in known:
            raise InvalidInputError("formats", name, f"among {', '.join(sorted(known))}")
    base = Path(path)
    if base.suffix.removeprefix(".") in formats:
        base = base.with_suffix("")
    files = [base.with_name(f"{base.name}.{name}") for name in formats]
    with matplotlib.rc_context({"pdf.fonttype": 42}), checks.writing(base.parent):
        for file in files:
            figure.savefig(file, dpi=200, bbox_inches="tight")
    return files
