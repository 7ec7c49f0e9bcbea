"""The page: choices on the left, numbers and figures on the right, everything of one case and of another beside it."""

from __future__ import annotations

import html
from typing import Any

import numpy as np
import panel as pn
import xarray as xr

from contactstudy.analysis import edge_factors, short
from contactstudy.analysis.certainty import certainty_of
from contactstudy.analysis.short import NOT_PRESSED, ShortView
from contactstudy.arrays.engineering import unit_for
from contactstudy.arrays.variables import variable_of
from contactstudy.checks import FloatArray
from contactstudy.errors import ContactStudyError
from contactstudy.explorer.cases import Cases, sentence
from contactstudy.explorer.drawn import PLANES, REGIONS, Image, axial, plane, region, scale_of, top
from contactstudy.explorer.figures import FIRST, SECOND, AxialFigure, ImageFigure, StudyFigure
from contactstudy.explorer.looked import Looked
from contactstudy.explorer.numbers import by_subject
from contactstudy.plots.study_lines import FOUND

MOST_STEPS = 60
"""Values of a swept parameter up to which it has a slider; names have a list to choose from."""

STYLE = """
table { border-collapse: collapse; font-size: 14px; width: 100%; }
td, th { padding: 2px 10px 2px 0; border-bottom: 1px solid #dde2e6; text-align: left; vertical-align: top; }
td.n { font-variant-numeric: tabular-nums; font-weight: 600; }
p.why { border-left: 4px solid #a65f00; background: #f4f6f8; padding: 6px 10px; overflow-wrap: anywhere; }
.soft { color: #5b6975; } .yes { color: #1c7c4a; } .care { color: #a65f00; } .no { color: #b3261e; }
"""


class Page:
    """Widgets and figures of one visitor.

    Parameters
    ----------
    cases : Cases
        The study.
    """

    def __init__(self, cases: Cases) -> None:
        self.cases = cases
        self._columns: dict[tuple[int, ...], dict[str, str]] = {}
        # What belongs to the other case is made when it is asked for: the page opens sooner without.
        self.choices: list[dict[str, Any]] = [self._widgets("case"), {}]
        self._other_choices = pn.Column(visible=False, sizing_mode="stretch_width")
        self.compare = pn.widgets.Checkbox(label="compare with another case", value=False, visible=bool(cases.dims))
        self.region = pn.widgets.Select(label="along the axis", options=list(REGIONS))
        self.units = pn.widgets.RadioButtonGroup(options={"mm, MPa": False, "over a, p0": True}, value=False)
        self.plane = pn.widgets.Select(label="von Mises in the plane", options=list(PLANES))
        self.where = pn.widgets.FloatSlider(
            label="where the plane is, from first to last", start=0.0, end=1.0, step=0.01, value=0.5, visible=False
        )
        groups = by_subject(cases.scalars)
        first = next((name for names in groups.values() for name in names.values()), None)
        self.number = pn.widgets.Select(
            label="number of all cases", groups=groups, value=first, visible=bool(cases.dims)
        )
        dims = {_called(cases.scalars[dim]): dim for dim in cases.dims}
        self.over = pn.widgets.Select(label="over", options=dims, visible=len(dims) > 1)
        self.table = pn.pane.HTML("", stylesheets=[STYLE], sizing_mode="stretch_width")
        self.axial, self.study = AxialFigure(), StudyFigure()
        self.tops, self.planes = [ImageFigure()], [ImageFigure(downwards=True)]
        figures = (self.axial.figure, self.tops[0].figure, None, self.planes[0].figure, None, self.study.figure)
        self.panes = [pn.pane.Bokeh(each, sizing_mode="stretch_width") for each in figures]
        for widget in (self.compare, self.region, self.units, self.plane, self.where, self.number, self.over):
            widget.param.watch(self._changed, "value")
        self.update()

    def _make_other(self) -> None:
        """Make the choices and the figures of the other case."""
        self.choices[1] = self._widgets("other")
        self._other_choices.objects = list(self.choices[1].values())
        self.tops.append(ImageFigure())
        self.planes.append(ImageFigure(downwards=True))
        self.panes[2].object, self.panes[4].object = self.tops[1].figure, self.planes[1].figure

    def _widgets(self, side: str) -> dict[str, Any]:
        """Return a slider or a list for every swept parameter."""
        prefix = "other: " if side == "other" else ""
        start, found = self.cases.first_solved(), dict[str, Any]()
        for dim in self.cases.dims:
            scalars = self.cases.scalars
            entry = scalars[dim]
            options = {text: at for at, text in enumerate(self.cases.choices(dim))}
            words = entry.dtype.kind in "UOb" or len(options) > MOST_STEPS
            kind = pn.widgets.Select if words else pn.widgets.DiscreteSlider
            found[dim] = kind(label=f"{prefix}{_called(entry)}", options=options, value=start[dim])
            found[dim].param.watch(self._changed, "value")
        return found

    def _changed(self, event: Any) -> None:
        """Follow a widget; figures in a notebook have to be told."""
        with pn.io.hold():
            self.update()
        if not (pn.state.curdoc and pn.state.curdoc.session_context):
            pn.io.push_notebook(*self.panes)

    def place(self, side: int) -> tuple[int, ...]:
        """Place of a chosen case in the study."""
        return self.cases.place({dim: widget.value for dim, widget in self.choices[side].items()})

    def update(self) -> None:
        """Draw what is chosen."""
        if self.compare.value and not self.choices[1]:
            self._make_other()
        sides = [0, 1] if self.compare.value else [0]
        loaded = [self._loaded(side) if side in sides else None for side in (0, 1)]
        self._other_choices.visible = bool(self.compare.value)
        stressed = any(one is not None and one.has_stress for one in loaded)
        self.plane.visible = stressed
        self.where.visible = stressed and self.plane.value != PLANES[0]
        self._show_axial(loaded)
        self._show_fields(loaded)
        self._show_study(sides)
        self._show_table(loaded, sides, self._reasons(loaded, sides))

    def _loaded(self, side: int) -> Looked | None:
        """Return a chosen case; None if it is not solved."""
        try:
            return self.cases.load(self.place(side))
        except ContactStudyError:
            return None

    def _show_table(self, loaded: list[Looked | None], sides: list[int], reasons: str) -> None:
        """Show the main numbers of the cases side by side, whether they are real, and why figures are missing."""
        columns = [self._column(loaded[side], side) for side in sides]
        rows = list(dict.fromkeys(name for column in columns for name in column))
        head = "".join(
            f"<th style='color:{color}'>{'case' if side == 0 else 'other'}</th>"
            for side, color in zip(sides, (FIRST, SECOND), strict=False)
        )
        body = ""
        for name in rows:
            cells = "".join(f"<td class=n>{column.get(name, '')}</td>" for column in columns)
            body += f"<tr><td>{html.escape(name)}</td>{cells}</tr>"
        self.table.object = f"<table><tr><th></th>{head}</tr>{body}</table>{reasons}"

    def _column(self, one: Looked | None, side: int) -> dict[str, str]:
        """Numbers of one case, by their meaning."""
        place = self.place(side)
        if one is None:
            return {"state": html.escape(self.cases.state(place).partition(": ")[0])}
        if place not in self._columns:
            self._columns[place] = self._numbers_of(one.dataset)
        return self._columns[place]

    def _numbers_of(self, one: xr.Dataset) -> dict[str, str]:
        """Numbers of a case that is solved."""
        numbers = short(one)
        found = certainty_of(one, numbers)
        word = {"yes": "yes", "no": "no"}.get(found.overall, "care")
        said = f"<span class={word}>{found.overall}</span>"
        if found.overall != "yes":
            said += f"<div class=soft style='white-space:normal;font-weight:400'>{html.escape(found.summary)}</div>"
        column = {"is this number real?": said}
        column |= {row.meaning: html.escape(_marked(row.text, row.remark)) for row in numbers.numbers}
        return column | self._factors(one, numbers)

    def _factors(self, one: xr.Dataset, numbers: ShortView) -> dict[str, str]:
        """Edge factors of the pressure: ends over the middle."""
        if "hertz_half_width" not in one or "pressure" not in one:
            return {}
        factors = edge_factors(one[["pressure", "hertz_half_width"]])
        found = {}
        for end, place in (("first", "end I"), ("last", "end II")):
            name = f"end_pressure_{end}"
            endless = name in numbers and np.isinf(numbers[name].value)
            value = float(factors[f"end_over_middle_{end}"])
            text = "singular" if endless else f"{value:.3f} (no error known)"
            found[f"edge factor of the contact towards {place} (largest within a, over its middle)"] = text
        return found

    def _show_axial(self, loaded: list[Looked | None]) -> None:
        """Pressure along the axis."""
        present = [one for one in loaded if one is not None and one.has_pressure]
        if not present:
            self.axial.show([None, None], (0.0, 1.0), ("", ""))
            return
        scales = [scale_of(one, relative=self.units.value) for one in present]
        spans = [region(one, self.region.value) for one in present]
        span = (
            min(low / scale.length for (low, _), scale in zip(spans, scales, strict=True)),
            max(high / scale.length for (_, high), scale in zip(spans, scales, strict=True)),
        )
        lines = [
            None if one is None or not one.has_pressure else axial(one, scale_of(one, relative=self.units.value))
            for one in loaded
        ]
        scale = scales[0]
        names = (f"distance from the free end, x{scale.length_name}", f"pressure along the axis{scale.stress_name}")
        self.axial.show(lines, span, names)

    def _show_fields(self, loaded: list[Looked | None]) -> None:
        """Pressure on the top and von Mises stress, with one scale of colours for both cases."""
        tops: list[Image | None] = []
        planes: list[Image | None] = []
        units = ""
        for one in loaded:
            if one is None or not one.has_pressure:
                tops.append(None)
                planes.append(None)
                continue
            scale, shown = scale_of(one, relative=self.units.value), region(one, self.region.value)
            units = scale.stress_name
            tops.append(top(one, scale, shown))
            planes.append(plane(one, scale, shown, self.plane.value, self.where.value))
        for images, figures, what in ((tops, self.tops, "pressure"), (planes, self.planes, "von Mises stress")):
            present = [image for image in images if image is not None]
            most = max((image.most for image in present), default=1.0)
            lows, highs = zip(*(image.up for image in present), strict=True) if present else ((0.0,), (1.0,))
            up = (min(lows), max(highs))
            for side, (one, image, each) in enumerate(zip(loaded, images, figures, strict=False)):
                name = ("case: " if side == 0 else "other: ") if self.compare.value else ""
                beyond = ", more beside the singular end" if one is not None and one.has_pressure and one.ends else ""
                place = image.place if image is not None else ""
                each.show(image, most, f"{name}{what}{units}{place}{beyond}", up)

    def _reasons(self, loaded: list[Looked | None], sides: list[int]) -> str:
        """Return in words why figures are missing, and hide their empty axes."""
        drawn = [each.shows for each in (*self.tops, *self.planes)]
        tops, planes = drawn[: len(self.tops)], drawn[len(self.tops) :]
        self._reveal(0, any(tops))
        for pane, images in ((1, tops), (3, planes)):
            for side in (0, 1):
                self._reveal(pane + side, side in sides and images[side])
        said = []
        for side in sides:
            if (one := loaded[side]) is None:
                text = sentence(self.cases.state(self.place(side)))
            elif not tops[side]:
                text = "The study keeps no surfaces of this case, only its numbers."
            elif not planes[side]:
                kept = "at too few points for this plane" if one.has_stress else "not computed or not kept"
                text = f"Its stresses are {kept}."
            else:
                continue
            name = f"<b>{'case' if side == 0 else 'other'}:</b> " if self.compare.value else ""
            said.append(f"<p class=why>{name}{html.escape(text)}</p>")
        if self.cases.dims and not self.panes[5].visible:
            said.append(
                "<p class=why>No case with these values of the other parameters has the number of all cases.</p>"
            )
        return "".join(said)

    def _reveal(self, number: int, shown: bool) -> None:
        """Show or hide a figure; panel takes what its model says for the truth, so both must agree."""
        pane = self.panes[number]
        if pane.object is not None:
            pane.object.visible = shown
        pane.visible = shown

    def _show_study(self, sides: list[int]) -> None:
        """One number of all cases over one swept parameter; the others as in the case that is looked at."""
        if not self.cases.dims or not self.number.value:
            self._reveal(5, False)
            return
        over, name = self.over.value or self.cases.dims[0], self.number.value
        scalars = self.cases.scalars
        base = variable_of(name, scalars[name].attrs)
        all_values = scalars[name].transpose(*scalars["status"].dims).values
        finite = all_values[np.isfinite(all_values)]
        factor, unit = unit_for(float(np.abs(finite).max(initial=0.0)), base.units)
        dims = [str(dim) for dim in scalars["status"].dims]
        place = list(self.place(0))
        line = tuple(slice(None) if dim == over else at for dim, at in zip(dims, place, strict=True))
        values = np.asarray(all_values[line], dtype=np.float64) / factor
        entry = scalars[over]
        ticks, meaning = None, _called(entry)
        if entry.dtype.kind in "fi":
            step, own = unit_for(float(np.nanmax(np.abs(entry.values))), str(entry.attrs.get("units", "1")))
            places = np.asarray(entry.values, dtype=np.float64) / step
            meaning += f" ({own})" if own else ""
        else:
            places = np.arange(entry.size, dtype=np.float64)
            ticks = {float(at): text for at, text in enumerate(self.cases.choices(over))}
        errors = self._errors(name, line, values, factor)
        chosen = []
        for side, color in zip(sides, (FIRST, SECOND), strict=False):
            at = self.place(side)
            chosen.append((at[dims.index(over)], float(all_values[at]) / factor, color))
        named = f"{base.long_name} ({unit})" if unit else base.long_name
        self._reveal(5, not np.isnan(values).all())
        self.study.show(values, places, ticks, chosen, (meaning, named), errors)

    def _errors(self, name: str, line: tuple[Any, ...], values: FloatArray, factor: float) -> FloatArray | None:
        """Errors of a number of the cases along a line, NaN where none is known; None of what has no error."""
        scalars = self.cases.scalars
        if f"{name}_error" in scalars:
            stated = scalars[f"{name}_error"].transpose(*scalars["status"].dims).values[line] / factor
            return np.where(np.isfinite(stated) & np.isfinite(values), stated, np.nan)
        return np.full(values.size, np.nan) if name.startswith(FOUND) else None

    def view(self) -> Any:
        """Everything, side by side on a wide screen and below each other on a narrow one."""
        count = int((self.cases.scalars["status"] != "excluded").sum())
        head = pn.pane.HTML(
            f"<h2 style='margin:0;font-size:20px'>{html.escape(self.cases.title)}</h2>"
            f"<div class=soft>{count} case{'s' if count != 1 else ''}</div>",
            stylesheets=[STYLE],
            sizing_mode="stretch_width",
        )
        widgets = (self.region, self.plane, self.where, self.number, self.over)
        for widget in (*self.choices[0].values(), *self.choices[1].values(), *widgets):
            # Their own width would reach beyond a narrow column.
            widget.param.update(width=None, sizing_mode="stretch_width")
        controls = pn.Column(
            *self.choices[0].values(),
            self.compare,
            self._other_choices,
            self.units,
            *widgets,
            styles={"flex": "1 1 15rem", "max-width": "24rem", "min-width": "14rem"},
            sizing_mode="stretch_width",
        )
        wide = {"flex": "1 1 25rem", "min-width": "min(100%, 19rem)"}
        boxes = [pn.Column(self.table, styles=wide, sizing_mode="stretch_width")]
        for pane in self.panes:
            pane.styles = wide
            boxes.append(pane)
        body = pn.FlexBox(*boxes, styles={"flex": "4 1 30rem", "gap": "0.6rem"}, sizing_mode="stretch_width")
        return pn.Column(
            head,
            pn.FlexBox(controls, body, flex_wrap="wrap", styles={"gap": "1rem"}, sizing_mode="stretch_width"),
            sizing_mode="stretch_width",
        )


def _called(entry: xr.DataArray) -> str:
    """Return what a swept parameter is called beside a widget and an axis."""
    return str(entry.attrs.get("long_name", entry.name))


def _marked(text: str, remark: str) -> str:
    """Return a number with the mark that it needs."""
    if remark.startswith("singular"):
        return "singular: no largest value"
    if remark == NOT_PRESSED or remark.startswith("p = K"):
        return f"{text}: {remark}"
    if remark.startswith("rounding"):
        return f"{text} ({remark})"
    return f"{text} (no error known)" if "no error known" in remark else text
