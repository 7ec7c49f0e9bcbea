"""Figures of the page: made once, and given new data when another case is chosen."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.models import (
    BasicTicker,
    ColorBar,
    ColumnDataSource,
    Legend,
    LegendItem,
    LinearColorMapper,
    Range1d,
    Whisker,
)
from bokeh.plotting import figure

from contactstudy.checks import FloatArray
from contactstudy.explorer.drawn import Image, Line
from contactstudy.explorer.pixels import Span

FIRST, SECOND, NEUTRAL = "#1f4e79", "#c05a00", "#8894a0"
"""Colours of the case, of the one that it is compared with, and of the others."""

PALETTE = "Viridis256"
HEIGHT = 290
TOOLS = "pan,wheel_zoom,box_zoom,reset,save"


def _new(**more: Any) -> Any:
    """Return a figure that takes the width that there is."""
    made = figure(
        height=HEIGHT,
        sizing_mode="stretch_width",
        tools=TOOLS,
        toolbar_location="above",
        output_backend="canvas",
        min_border_left=56,
        **more,
    )
    made.toolbar.logo = None
    made.toolbar.autohide = True
    made.grid.grid_line_color = "#e6eaed"
    return made


class AxialFigure:
    """Pressure along the axis, of one case or two."""

    def __init__(self) -> None:
        self.figure = _new(x_range=Range1d(0, 1), y_range=Range1d(0, 1))
        self._lines = [ColumnDataSource({"x": [], "p": []}) for _ in range(2)]
        self._marks = [ColumnDataSource({"x": [], "p": []}) for _ in range(2)]
        drawn = []
        for number, (color, dash) in enumerate(((FIRST, "solid"), (SECOND, "dashed"))):
            style = {"color": color, "line_width": 2, "line_dash": dash}
            drawn.append(self.figure.line("x", "p", source=self._lines[number], **style))
            mark = {"marker": "triangle", "size": 11, "fill_color": None, "line_color": color, "line_width": 1.5}
            self.figure.scatter("x", "p", source=self._marks[number], **mark)
        items = [LegendItem(label=name, renderers=[line]) for name, line in zip(("case", "other"), drawn, strict=True)]
        self._legend = Legend(items=items, orientation="horizontal", border_line_color=None, padding=2)
        self.figure.add_layout(self._legend, "above")

    def show(self, lines: list[Line | None], span: tuple[float, float], names: tuple[str, str]) -> None:
        """Draw the pressure of the cases within a span."""
        highest = 0.0
        for line in lines:
            if line is not None:
                inside = line.pressure[(line.x >= span[0]) & (line.x <= span[1])]
                highest = max(highest, float(np.nanmax(inside, initial=0.0)))
        highest = 1.06 * highest if highest > 0 else 1.0
        for line, own, marks in zip(lines, self._lines, self._marks, strict=True):
            own.data = {"x": [], "p": []} if line is None else {"x": line.x, "p": line.pressure}
            ends = [] if line is None else [end for end in line.singular if span[0] <= end <= span[1]]
            marks.data = {"x": ends, "p": [0.96 * highest] * len(ends)}
        self._legend.visible = lines[1] is not None
        self.figure.x_range.update(start=span[0], end=span[1])
        self.figure.y_range.update(start=0.0, end=highest)
        self.figure.xaxis.axis_label, self.figure.yaxis.axis_label = names


class ImageFigure:
    """A field as a picture with its colour bar."""

    def __init__(self, *, downwards: bool = False) -> None:
        self.figure = _new(x_range=Range1d(0, 1), y_range=Range1d(0, 1))
        self._downwards = downwards
        self._source = ColumnDataSource({"image": [], "x": [], "y": [], "w": [], "h": []})
        self._mapper = LinearColorMapper(palette=PALETTE, low=0.0, high=1.0)
        self.figure.image(image="image", x="x", y="y", dw="w", dh="h", source=self._source, color_mapper=self._mapper)
        bar = ColorBar(color_mapper=self._mapper, ticker=BasicTicker(desired_num_ticks=6), width=12, padding=4)
        self.figure.add_layout(bar, "right")
        self.figure.grid.visible = False

    @property
    def shows(self) -> bool:
        """Whether there is a picture."""
        return bool(self._source.data["image"])

    def show(self, image: Image | None, most: float, title: str, up: Span | None = None) -> None:
        """Draw a picture, its colours up to a largest value; nothing if there is none. `up`: what the axis spans."""
        self.figure.title.text = title
        if image is None:
            self._source.data = {"image": [], "x": [], "y": [], "w": [], "h": []}
            return
        (left, right), (low, high) = image.across, image.up
        self._source.data = {"image": [image.values], "x": [left], "y": [low], "w": [right - left], "h": [high - low]}
        self._mapper.update(high=max(most, 1e-12))
        self.figure.x_range.update(start=left, end=right)
        deep = self._downwards and image.names[1].startswith("depth")
        low, high = up or image.up
        self.figure.y_range.update(start=high if deep else low, end=low if deep else high)
        self.figure.xaxis.axis_label, self.figure.yaxis.axis_label = image.names


class StudyFigure:
    """A number of all cases over one swept parameter, the cases that are looked at marked."""

    def __init__(self) -> None:
        self.figure = _new()
        self._line = ColumnDataSource({"x": [], "v": [], "fill": [], "low": [], "high": []})
        self._endless = ColumnDataSource({"x": [], "v": []})
        self._chosen, self._chosen_endless = (ColumnDataSource({"x": [], "v": [], "color": []}) for _ in range(2))
        self.figure.line("x", "v", source=self._line, color=NEUTRAL, line_width=1.5)
        bars = {"base": "x", "lower": "low", "upper": "high", "source": self._line, "line_color": NEUTRAL}
        self.figure.add_layout(Whisker(**bars, level="underlay"))
        self.figure.scatter("x", "v", source=self._line, line_color=NEUTRAL, fill_color="fill", size=6)
        mark = {"marker": "triangle", "size": 11, "fill_color": None, "line_width": 1.5}
        self.figure.scatter("x", "v", source=self._endless, line_color=NEUTRAL, **mark)
        self.figure.scatter("x", "v", source=self._chosen, color="color", size=11)
        self.figure.scatter("x", "v", source=self._chosen_endless, line_color="color", **(mark | {"line_width": 3}))
        self.figure.y_range = Range1d(0, 1)
        self._plain, self._words = self.figure.xaxis[0].ticker, dict[float, str]()

    def show(
        self,
        values: FloatArray,
        places: FloatArray,
        ticks: dict[float, str] | None,
        chosen: list[tuple[int, float, str]],
        names: tuple[str, str],
        errors: FloatArray | None = None,
    ) -> None:
        """Draw values over places; words take the place of numbers where there are `ticks`.

        A value without a limit is a triangle at the top. `chosen` are the cases looked at: where along the parameter,
        their value, and their colour. Errors are bars; of a value whose error is NaN none is known, and its mark is
        open. Without `errors` values are taken as they are.
        """
        finite = np.isfinite(values)
        known = [*values[finite], *(value for _, value, _ in chosen if np.isfinite(value))]
        spread = np.zeros(values.size) if errors is None else np.nan_to_num(errors)
        reach = [*known, *(values + spread)[finite], *(values - spread)[finite & (spread > 0)]]
        low, high = min([0.0, *reach]), max([*reach, 1e-12]) if known else 1.0
        high += 0.06 * (high - low)
        unknown = finite & (np.isnan(errors) if errors is not None else False)
        barred = finite & (spread > 0)
        self._line.data = {
            "x": places,
            "v": np.where(finite, values, np.nan),
            "fill": np.where(unknown, "white", NEUTRAL),
            "low": np.where(barred, values - spread, np.nan),
            "high": np.where(barred, values + spread, np.nan),
        }
        said = ["bars: stated errors"] * bool(barred.any()) + ["open marks: no error known"] * bool(unknown.any())
        self.figure.title.text = "; ".join(said)
        at_top = 0.96 * high
        self._endless.data = {"x": places[np.isinf(values)], "v": np.full(int(np.isinf(values).sum()), at_top)}
        for source, endless in ((self._chosen, False), (self._chosen_endless, True)):
            own = [each for each in chosen if np.isposinf(each[1]) == endless]
            source.data = {
                "x": [places[at] for at, _, _ in own],
                "v": [at_top if endless else value for _, value, _ in own],
                "color": [color for _, _, color in own],
            }
        self.figure.y_range.update(start=low, end=high)
        self._name_ticks(ticks or {})
        self.figure.xaxis.axis_label, self.figure.yaxis.axis_label = names

    def _name_ticks(self, words: dict[float, str]) -> None:
        """Put words in the place of numbers; only where they change, for a new ticker costs as much as all the rest."""
        if words == self._words:
            return
        axis, self._words = self.figure.xaxis[0], words
        axis.ticker = list(words) if words else self._plain
        axis.major_label_overrides = words
        axis.major_label_orientation = 0.5 if words else "horizontal"
