"""Style of all figures: colours that keep their order in grey, dashes, units, folded labels, singular ends, saving."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import cell_edges, dimension_along, positions
from contactstudy.analysis.axial import under_roller
from contactstudy.arrays.variables import STRESSES, specification
from contactstudy.checks import BoolArray, FloatArray
from contactstudy.errors import InvalidInputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLORS = "viridis"  # Colour map of increasing lightness, legible in grey and to the colour-blind

DASHES: tuple[Any, ...] = (
    "-",
    (0, (6, 1.5)),
    (0, (6, 1.5, 1, 1.5)),
    (0, (3, 1.5)),
    (0, (1, 1)),
    (0, (8, 2, 1, 2, 1, 2)),
)
MARKERS = "osD^vPX*"

AXIS_MEANINGS = {"x": "distance from the free end", "y": "position along rolling", "z": "depth"}
"""Labels of axes, shorter than in the table of variables."""

SYMBOLS = {  # labels of swept parameters; the table of variables contains the symbols of results
    "e_over_a": "distance of the roller's end from the free end, $e/a$",
    "friction": "friction, $f$",
    "gamma": r"length over radius, $\gamma$",
    "max_pressure": "Hertz pressure, $p_0$",
}

LETTER_WIDTH = 0.073  # Width of a letter in a label, inches
MIN_LINE_LENGTH = 14  # Least length of a folded line, letters
LEGEND_STYLE: dict[str, Any] = {"frameon": False, "fontsize": "small"}
LEGEND_WIDTH = 40  # Letters in a line of a legend within the axes
WORD_PATTERN = re.compile(r"(?:\\.|\$(?:[^$\\]|\\.)*\$|\S)+")  # a formula is one word
FOLD_CHARACTERS = (";:", ",", "")  # Letters after which a text is folded, first choice first; finally after any word
MARKUP_PATTERN = re.compile(r"\\[A-Za-z]+|[\\{}$_^]")


class Units(NamedTuple):
    """Length and stress of a figure's axes in SI, and their suffixes in labels."""

    length: float
    stress: float
    over_length: str
    over_stress: str

    def axis_label(self, axis: str) -> str:
        """Label of positions along x, y or z."""
        return f"{AXIS_MEANINGS[axis]}, ${axis}{self.over_length}$"

    def position(self, axis: str, position: float) -> str:
        """Text of a position in metres."""
        number = f"{position / self.length:.3g}"
        return f"${axis}{self.over_length}$ = {number}" if self.over_length == "/a" else f"${axis}$ = {number} mm"

    def stress_label(self, variable: str) -> str:
        """Label of a stress or a pressure."""
        known_variable = specification(variable)
        if known_variable is None or not known_variable.symbol:
            meaning = known_variable.long_name if known_variable else variable.replace("_", " ")
            return f"{meaning}{' over $p_0$' if self.over_stress == '/p_0' else ' (MPa)'}"
        meaning = "" if variable in STRESSES else f"{known_variable.long_name}, "
        return f"{meaning}${known_variable.symbol}{self.over_stress}$"


MILLIMETRES = Units(1e-3, 1e6, r"\ \mathrm{(mm)}", r"\ \mathrm{(MPa)}")  # Units of figures with ``si=True``


def units(dataset: xr.Dataset, *, si: bool) -> Units:
    """Return the Hertz half-width and pressure of one case as units; or mm and MPa."""
    if si:
        return MILLIMETRES
    for name in ("hertz_half_width", "hertz_max_pressure"):
        if name not in dataset:
            raise InvalidInputError(
                "dataset", sorted(map(str, dataset.data_vars)), f"a Dataset with {name}", "draw with si=True instead"
            )
    return Units(float(dataset["hertz_half_width"]), float(dataset["hertz_max_pressure"]), "/a", "/p_0")


def escape_dollars(value: object) -> str:
    """Return a name from a study as literal text for matplotlib."""
    return str(value).replace("$", r"\$")


def new_axes(ax: Axes | None, size: tuple[float, float] = (6.4, 4.0)) -> Axes:
    """Return the given axes, or the axes of a new figure of `size` inches."""
    if ax is not None:
        return ax
    from matplotlib import pyplot

    return pyplot.subplots(figsize=size, layout="constrained")[1]


def line_styles(count: int) -> list[dict[str, Any]]:
    """Return styles of `count` lines, dark to light, with different dashes."""
    import matplotlib

    colors = matplotlib.colormaps[COLORS](np.linspace(0.0, 0.8, count))
    return [
        {"color": color, "linestyle": DASHES[index % len(DASHES)], "linewidth": 1.8}
        for index, color in enumerate(colors)
    ]


def fold_text(text: str, width: int) -> str:
    """Break a text into lines of at most `width` letters: after ; or :, else after commas, else between words."""
    return "\n".join(_fold_words(WORD_PATTERN.findall(text), width, FOLD_CHARACTERS))


def _fold_words(words: list[str], width: int, breaks: Sequence[str]) -> list[str]:
    """Lines of words, broken after letters in `breaks[0]`; too long phrases are broken after letters in `breaks[1]`."""
    lines, phrase = [""], []
    for count, word in enumerate(words, start=1):
        phrase.append(word)
        if breaks[0] and count < len(words) and not word.endswith(tuple(breaks[0])):
            continue
        text = " ".join(phrase)
        if _visible_length(f"{lines[-1]} {text}".strip()) <= width:
            lines[-1] = f"{lines[-1]} {text}".strip()
        elif _visible_length(text) <= width or (not breaks[0] and "$" in text):
            lines.append(text)
        elif breaks[0]:
            lines += _fold_words(phrase, width, breaks[1:])
        else:
            lines += [text[start : start + width] for start in range(0, len(text), width)]
        phrase = []
    return [line for line in lines if line]


def _visible_length(text: str) -> int:
    """Letters of a text without the markup of formulas."""
    return len(MARKUP_PATTERN.sub("", text))


def fold_labels(*axes: Axes) -> None:
    """Fold labels and titles of axes to the length of their side."""
    for ax in axes:
        extent = ax.get_window_extent()
        width_in_letters, height_in_letters = (
            max(MIN_LINE_LENGTH, int(size / ax.figure.dpi / LETTER_WIDTH)) for size in (extent.width, extent.height)
        )
        for text, width in (
            (ax.xaxis.label, width_in_letters),
            (ax.yaxis.label, height_in_letters),
            (ax.title, width_in_letters),
        ):
            if text.get_text():
                text.set_text(fold_text(text.get_text(), width))


def label_axes(ax: Axes, x: str, y: str, *others: Axes) -> None:
    """Label axes, and fold the labels of these and of `others`, such as a colour bar."""
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    fold_labels(ax, *others)


OMITTED_DISTANCE = 0.05  # From a singular end, over the Hertz half-width, within which figures omit the pressure

SINGULAR_MARK: dict[str, Any] = {"marker": "^", "markersize": 7, "markerfacecolor": "none", "linestyle": "none"}
SINGULAR_LABEL = "singular: unbounded"
MARK_HEIGHT = 0.965  # Height of a mark over the height of the axes


def singular_ends(case: xr.Dataset) -> list[float]:
    """Positions of the roller's ends with a singular pressure, metres."""
    is_singular = [np.isinf(float(case.get(f"end_pressure_{end}", 0.0))) for end in ("first", "last")]
    if not any(is_singular) or "pressure" not in case:
        return []
    is_facing = under_roller(case).values
    lower_edges, upper_edges = (edges.values[is_facing] for edges in cell_edges(case["pressure"], "x"))
    ends = np.array([lower_edges[0], upper_edges[-1]])
    return [float(end) for end in ends[is_singular]]


def is_near_singular_end(case: xr.Dataset, x: FloatArray) -> BoolArray:
    """Whether positions along x lie within `OMITTED_DISTANCE` of a singular end."""
    distance = OMITTED_DISTANCE * float(case.get("hertz_half_width", 0.0))
    return np.asarray((np.abs(x[:, None] - singular_ends(case)) < distance).any(axis=1))


def cap_field(case: xr.Dataset, field: xr.DataArray) -> tuple[xr.DataArray, float]:
    """Field clipped to its largest value away from singular ends, and this bound; infinite without singular ends."""
    if not singular_ends(case):
        return field, np.inf
    x = dimension_along(field, "x")
    is_regular = ~is_near_singular_end(case, positions(field, "x").values)
    bound = float(field.isel({x: is_regular}).max()) if is_regular.any() else np.nan
    if not np.isfinite(bound):
        return field, np.inf
    return field.clip(max=bound).assign_attrs(field.attrs), bound


def mark_at_top(ax: Axes, x: list[float], color: Any) -> None:
    """Mark unbounded values at the top of the axes."""
    if x:
        ax.plot(x, [MARK_HEIGHT] * len(x), transform=ax.get_xaxis_transform(), color=color, **SINGULAR_MARK)


def save(figure: Figure, path: str | Path, formats: Sequence[str] = ("png", "pdf")) -> list[Path]:
    """Write a figure for the screen and for a journal.

    Parameters
    ----------
    figure : Figure
        The figure.
    path : str or Path
        File name; a suffix among `formats` is removed.
    formats : sequence of str
        Formats of matplotlib.

    Returns
    -------
    list of Path
        The files: PNG with 200 dots per inch, PDF with text as text.

    Raises
    ------
    InvalidInputError
        If matplotlib does not support a format.
    StoreError
        If a file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from matplotlib.figure import Figure
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [file.name for file in save(Figure(), Path(folder) / "pressure.png")]
    ['pressure.png', 'pressure.pdf']
    """
    import matplotlib

    supported = figure.canvas.get_supported_filetypes()
    for name in formats:
        if name not in supported:
            raise InvalidInputError("formats", name, f"among {', '.join(sorted(supported))}")
    base_path = Path(path)
    if base_path.suffix.removeprefix(".") in formats:
        base_path = base_path.with_suffix("")
    files = [base_path.with_name(f"{base_path.name}.{name}") for name in formats]
    with matplotlib.rc_context({"pdf.fonttype": 42}):
        for file, name in zip(files, formats, strict=True):
            with checks.writing(file) as temporary_path:
                figure.savefig(temporary_path, dpi=200, bbox_inches="tight", format=name)
    return files
