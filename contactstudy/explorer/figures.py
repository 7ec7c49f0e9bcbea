"""Bokeh figures of the page: created once, with new data for each choice."""

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
from contactstudy.explorer.cases import Image, Line, Span

FIRST_COLOR, SECOND_COLOR, NEUTRAL_COLOR = "#1f4e79", "#c05a00", "#8894a0"  # first case, second case, other cases

PALETTE = "Viridis256"
MARK_COLOR = "#e8513a"  # legible on every colour of the palette
HEIGHT = 290
TOOLS = "pan,wheel_zoom,box_zoom,reset,save"
TRIANGLE = {"marker": "triangle", "size": 11, "fill_color": None, "line_width": 1.5}  # an unbounded value


def _create_figure(**options: Any) -> Any:
    """Return a figure of the available width."""
    new_figure = figure(
        height=HEIGHT,
        sizing_mode="stretch_width",
        tools=TOOLS,
        toolbar_location="above",
        output_backend="canvas",
        min_border_left=56,
        **options,
    )
    new_figure.toolbar.logo = None
    new_figure.toolbar.autohide = True
    new_figure.grid.grid_line_color = "#e6eaed"
    return new_figure


class AxialFigure:
    """Pressure along the axis, of one or two cases."""

    def __init__(self) -> None:
        self.figure = _create_figure(x_range=Range1d(0, 1), y_range=Range1d(0, 1))
        self._lines = [ColumnDataSource({"x": [], "p": []}) for _ in range(2)]
        self._marks = [ColumnDataSource({"x": [], "p": []}) for _ in range(2)]
        renderers = []
        for index, (color, dash) in enumerate(((FIRST_COLOR, "solid"), (SECOND_COLOR, "dashed"))):
            style = {"color": color, "line_width": 2, "line_dash": dash}
            renderers.append(self.figure.line("x", "p", source=self._lines[index], **style))
            self.figure.scatter("x", "p", source=self._marks[index], line_color=color, **TRIANGLE)
        axis_labels = zip(("case", "second case"), renderers, strict=True)
        items = [LegendItem(label=name, renderers=[renderer]) for name, renderer in axis_labels]
        self._legend = Legend(items=items, orientation="horizontal", border_line_color=None, padding=2)
        self.figure.add_layout(self._legend, "above")

    def show(self, lines: dict[int, Line]) -> None:
        """Draw the pressure of the cases by slot, 0 or 1, with the labels of the first case."""
        start = min((line.span[0] for line in lines.values()), default=0.0)
        stop = max((line.span[1] for line in lines.values()), default=1.0)
        visible_pressures = [line.pressure[(line.x >= start) & (line.x <= stop)] for line in lines.values()]
        peak = max((float(np.nanmax(pressure, initial=0.0)) for pressure in visible_pressures), default=0.0)
        max_pressure = 1.06 * peak if peak > 0 else 1.0
        for slot, (source, marks) in enumerate(zip(self._lines, self._marks, strict=True)):
            x, pressure, singular_positions, *_ = lines.get(slot, ([], [], []))
            source.data = {"x": x, "p": pressure}
            visible_ends = [end for end in singular_positions if start <= end <= stop]
            marks.data = {"x": visible_ends, "p": [0.96 * max_pressure] * len(visible_ends)}
        self._legend.visible = 1 in lines
        self.figure.x_range.update(start=start, end=stop)
        self.figure.y_range.update(start=0.0, end=max_pressure)
        labels = next((line.axis_labels for line in lines.values()), ("", ""))
        self.figure.xaxis.axis_label, self.figure.yaxis.axis_label = labels


class ImageFigure:
    """Field as an image with a colour bar and a cross at the field's largest value; depths increase downwards."""

    def __init__(self) -> None:
        self.figure = _create_figure(x_range=Range1d(0, 1), y_range=Range1d(0, 1))
        self._source = ColumnDataSource({"image": [], "x": [], "y": [], "w": [], "h": []})
        self._mapper = LinearColorMapper(palette=PALETTE, low=0.0, high=1.0)
        self.figure.image(image="image", x="x", y="y", dw="w", dh="h", source=self._source, color_mapper=self._mapper)
        self._peak = ColumnDataSource({"x": [], "y": []})
        self.figure.scatter("x", "y", source=self._peak, marker="x", size=10, line_color=MARK_COLOR, line_width=2)
        bar = ColorBar(color_mapper=self._mapper, ticker=BasicTicker(desired_num_ticks=6), width=12, padding=4)
        self.figure.add_layout(bar, "right")
        self.figure.grid.visible = False

    def show(self, image: Image | None, limit: float, title: str, vertical: Span) -> None:
        """Draw an image, or none, with colours up to a limit and the vertical axis between two values."""
        self.figure.title.text = title
        if image is None:
            for source in (self._source, self._peak):
                source.data = {name: [] for name in source.data}
            return
        (start, stop), (low, high) = image.horizontal, image.vertical
        self._source.data = {"image": [image.values], "x": [start], "y": [low], "w": [stop - start], "h": [high - low]}
        self._peak.data = {"x": [image.largest[1]], "y": [image.largest[2]]}
        self._mapper.update(high=max(limit, 1e-12))
        self.figure.x_range.update(start=start, end=stop)
        self.figure.y_range.update(start=vertical[image.has_depth], end=vertical[not image.has_depth])
        self.figure.xaxis.axis_label, self.figure.yaxis.axis_label = image.axis_labels


class StudyFigure:
    """One number for all cases over one swept parameter, with marks at the page's cases."""

    def __init__(self) -> None:
        self.figure = _create_figure()
        self._line = ColumnDataSource({"x": [], "v": [], "fill": [], "low": [], "high": []})
        self._unbounded = ColumnDataSource({"x": [], "v": []})
        self._case_marks, self._case_triangles = (ColumnDataSource({"x": [], "v": [], "color": []}) for _ in range(2))
        self.figure.line("x", "v", source=self._line, color=NEUTRAL_COLOR, line_width=1.5)
        bars = {"base": "x", "lower": "low", "upper": "high", "source": self._line, "line_color": NEUTRAL_COLOR}
        self.figure.add_layout(Whisker(**bars, level="underlay"))
        self.figure.scatter("x", "v", source=self._line, line_color=NEUTRAL_COLOR, fill_color="fill", size=6)
        self.figure.scatter("x", "v", source=self._unbounded, line_color=NEUTRAL_COLOR, **TRIANGLE)
        self.figure.scatter("x", "v", source=self._case_marks, color="color", size=11)
        triangle = TRIANGLE | {"line_width": 3}
        self.figure.scatter("x", "v", source=self._case_triangles, line_color="color", **triangle)
        self.figure.y_range = Range1d(0, 1)
        self._ticker = self.figure.xaxis[0].ticker  # of numeric axes

    def show(
        self,
        x: FloatArray,
        values: FloatArray,
        errors: FloatArray,  # NaN: an open mark; 0: exact values
        *,
        marked_cases: list[tuple[int, float, str]],  # of the page: number along the parameter, value, colour
        labels: tuple[str, str],
        ticks: dict[float, str] | None = None,  # texts by position
    ) -> None:
        """Draw values with bars of errors over a swept parameter; an unbounded value as a triangle at the top."""
        is_finite = np.isfinite(values)
        bars = np.nan_to_num(errors)
        finite_values = [*values[is_finite], *(value for _, value, _ in marked_cases if np.isfinite(value))]
        bar_values = [*finite_values, *(values + bars)[is_finite], *(values - bars)[is_finite & (bars > 0)]]
        low, high = min([0.0, *bar_values]), max([*bar_values, 1e-12]) if finite_values else 1.0
        high += 0.06 * (high - low)
        lacks_error = is_finite & np.isnan(errors)
        has_bar = is_finite & (bars > 0)
        self._line.data = {
            "x": x,
            "v": np.where(is_finite, values, np.nan),
            "fill": np.where(lacks_error, "white", NEUTRAL_COLOR),
            "low": np.where(has_bar, values - bars, np.nan),
            "high": np.where(has_bar, values + bars, np.nan),
        }
        legend = ["bars: estimated errors"] * bool(has_bar.any())
        legend += ["open marks: error not estimated"] * bool(lacks_error.any())
        self.figure.title.text = "; ".join(legend)
        mark_height = 0.96 * high
        self._unbounded.data = {"x": x[np.isinf(values)], "v": np.full(int(np.isinf(values).sum()), mark_height)}
        for source, is_unbounded in ((self._case_marks, False), (self._case_triangles, True)):
            cases = [case for case in marked_cases if np.isposinf(case[1]) == is_unbounded]
            source.data = {
                "x": [x[index] for index, _, _ in cases],
                "v": [mark_height if is_unbounded else value for _, value, _ in cases],
                "color": [color for _, _, color in cases],
            }
        self.figure.y_range.update(start=low, end=high)
        axis = self.figure.xaxis[0]
        axis.ticker, axis.major_label_overrides = list(ticks) if ticks else self._ticker, ticks or {}
        axis.major_label_orientation = 0.5 if ticks else "horizontal"
        self.figure.xaxis.axis_label, self.figure.yaxis.axis_label = labels
