"""Page of a study: widgets on the left; numbers and figures of one case or of two cases on the right."""

from __future__ import annotations

import html
from typing import Any

import numpy as np
import panel as pn
import xarray as xr

from contactstudy.analysis import edge_factors
from contactstudy.arrays.engineering import unit_for
from contactstudy.arrays.variables import NOT_ESTIMATED, UNKNOWN_ERROR, variable_of
from contactstudy.checks import FloatArray
from contactstudy.errors import ContactStudyError
from contactstudy.explorer.cases import (
    PLANES,
    REGIONS,
    CaseFields,
    Cases,
    Image,
    Line,
    axial_line,
    choose_scale,
    numbers_by_subject,
    plane_image,
    region_limits,
    status_sentence,
    top_image,
)
from contactstudy.explorer.figures import FIRST_COLOR, SECOND_COLOR, AxialFigure, ImageFigure, StudyFigure
from contactstudy.plots.study_lines import ESTIMATED_PREFIXES
from contactstudy.report.assessment import assess_case
from contactstudy.report.tables import Quantity, Summary, summary

NAMES, COLORS = ("case", "second case"), (FIRST_COLOR, SECOND_COLOR)  # Names and colours of the page's two case slots
MAX_SLIDER_OPTIONS = 60  # Number of values of a swept parameter up to which a slider replaces a list
MEASURES = {  # Stress measures of the plane
    "von Mises stress": "von_mises",
    "largest principal stress": "principal_stress_1",
    "maximum shear stress": "maximum_shear",
}

STYLE = """
table { border-collapse: collapse; font-size: 14px; width: 100%; }
td, th { padding: 2px 10px 2px 0; border-bottom: 1px solid #dde2e6; text-align: left; vertical-align: top; }
td.n { font-variant-numeric: tabular-nums; font-weight: 600; }
p.why { border-left: 4px solid #a65f00; background: #f4f6f8; padding: 6px 10px; overflow-wrap: anywhere; }
.soft { color: #5b6975; } .yes { color: #1c7c4a; } .care { color: #a65f00; } .no { color: #b3261e; }
"""


class Page:
    """Widgets and figures of one visitor."""

    def __init__(self, cases: Cases) -> None:
        self.cases = cases
        self._descriptions: dict[tuple[int, ...], dict[str, str]] = {}
        # Widgets and figures of the second case are created on demand: the page opens sooner.
        self.choices: list[dict[str, Any]] = [self._create_choices(""), {}]
        self._second_choices = pn.Column(visible=False, sizing_mode="stretch_width")
        self.compare = pn.widgets.Checkbox(label="compare with a second case", value=False, visible=bool(cases.dims))
        self.region = pn.widgets.Select(label="along the axis", options=list(REGIONS))
        self.units = pn.widgets.RadioButtonGroup(options={"mm, MPa": False, "over a, p0": True}, value=False)
        self.measure = pn.widgets.Select(label="stress", options=MEASURES)
        self.plane = pn.widgets.Select(label="in the plane", options=list(PLANES))
        self.fraction = pn.widgets.FloatSlider(
            label="position of the plane, from first to last", start=0.0, end=1.0, step=0.01, value=0.5, visible=False
        )
        groups = numbers_by_subject(cases.scalars)
        first_name = next((name for names in groups.values() for name in names.values()), None)
        self.number = pn.widgets.Select(
            label="number of all cases", groups=groups, value=first_name, visible=bool(cases.dims)
        )
        dims = {_label_parameter(cases.scalars[dim]): dim for dim in cases.dims}
        self.parameter = pn.widgets.Select(label="over", options=dims, visible=len(dims) > 1)
        self.table = pn.pane.HTML("", stylesheets=[STYLE], sizing_mode="stretch_width")
        self.axial, self.study = AxialFigure(), StudyFigure()
        self.surface_figures, self.plane_figures = [ImageFigure()], [ImageFigure()]
        surface, plane = self.surface_figures[0].figure, self.plane_figures[0].figure
        figures = (self.axial.figure, surface, None, plane, None, self.study.figure)
        self.panes = [pn.pane.Bokeh(figure, sizing_mode="stretch_width") for figure in figures]
        self._settings = (self.region, self.measure, self.plane, self.fraction, self.number, self.parameter)
        for widget in (self.compare, self.units, *self._settings):
            widget.param.watch(self._on_widget_change, "value")
        self.update()

    def _create_second_case(self) -> None:
        """Create widgets and figures of the second case."""
        self.choices[1] = self._create_choices("second case: ")
        self._second_choices.objects = list(self.choices[1].values())
        self.surface_figures.append(ImageFigure())
        self.plane_figures.append(ImageFigure())
        self.panes[2].object, self.panes[4].object = self.surface_figures[1].figure, self.plane_figures[1].figure

    def _create_choices(self, prefix: str) -> dict[str, Any]:
        """Return a slider or a list for every swept parameter."""
        start, widgets = self.cases.start_values(), dict[str, Any]()
        for dim in self.cases.dims:
            values = self.cases.scalars[dim]
            options = {text: index for index, text in enumerate(self.cases.choices(dim))}
            needs_list = values.dtype.kind in "UOb" or len(options) > MAX_SLIDER_OPTIONS
            widget_class = pn.widgets.Select if needs_list else pn.widgets.DiscreteSlider
            widgets[dim] = widget_class(label=f"{prefix}{_label_parameter(values)}", options=options, value=start[dim])
            widgets[dim].param.watch(self._on_widget_change, "value")
        return widgets

    def _on_widget_change(self, event: Any) -> None:
        """Update after a change of a widget; a notebook needs a push."""
        with pn.io.hold():
            self.update()
        if not (pn.state.curdoc and pn.state.curdoc.session_context):
            pn.io.push_notebook(*self.panes)

    def index(self, slot: int) -> tuple[int, ...]:
        """Index in the study of the case in a slot of the page, 0 or 1."""
        return tuple(widget.value for widget in self.choices[slot].values())

    def update(self) -> None:
        """Draw the chosen cases."""
        if self.compare.value and not self.choices[1]:
            self._create_second_case()
        slots = [0, 1] if self.compare.value else [0]
        cases = [self._load(slot) if slot in slots else None for slot in (0, 1)]
        self._second_choices.visible = bool(self.compare.value)
        has_stress = any(case is not None and case.has_stress for case in cases)
        self.plane.visible = self.measure.visible = has_stress
        self.fraction.visible = has_stress and self.plane.value != PLANES[0]
        drawn_cases = {slot: case for slot, case in enumerate(cases) if case is not None and case.has_pressure}
        planes = self._show_fields(drawn_cases)
        self._show_study(slots)
        self._set_visible(0, bool(drawn_cases))
        for slot in (0, 1):
            self._set_visible(1 + slot, slot in drawn_cases)
            self._set_visible(3 + slot, slot in planes)
        remarks = [self._explain_missing(slot, cases[slot], has_plane=slot in planes) for slot in slots]
        if self.cases.dims and not self.panes[5].visible:
            remarks.append("No case at these values of the other parameters has this number.")
        self._show_table(cases, slots, "".join(f"<p class=why>{remark}</p>" for remark in remarks if remark))

    def _load(self, slot: int) -> CaseFields | None:
        """Return the case of a slot; None if the case is not solved."""
        try:
            return self.cases.load(self.index(slot))
        except ContactStudyError:
            return None

    def _show_table(self, cases: list[CaseFields | None], slots: list[int], remarks: str) -> None:
        """Show the numbers of the cases side by side, and remarks on missing figures."""
        columns = [self._describe_case(cases[slot], slot) for slot in slots]
        names = list(dict.fromkeys(name for column in columns for name in column))
        header = "".join(f"<th style='color:{COLORS[slot]}'>{NAMES[slot]}</th>" for slot in slots)
        body = ""
        for name in names:
            cells = "".join(f"<td class=n>{column.get(name, '')}</td>" for column in columns)
            body += f"<tr><td>{html.escape(name)}</td>{cells}</tr>"
        self.table.object = f"<table><tr><th></th>{header}</tr>{body}</table>{remarks}"

    def _describe_case(self, case: CaseFields | None, slot: int) -> dict[str, str]:
        """Numbers of a case by meaning."""
        index = self.index(slot)
        if case is None:
            return {"state": html.escape(self.cases.status(index)[0])}
        if index not in self._descriptions:
            table = summary(case.dataset)
            assessment = assess_case(case.dataset, table)
            style = {"yes": "yes", "no": "no"}.get(assessment.overall, "care")
            verdict = f"<span class={style}>{assessment.overall}</span>"
            if assessment.overall != "yes":
                reason = html.escape(assessment.verdict)
                verdict += f"<div class=soft style='white-space:normal;font-weight:400'>{reason}</div>"
            numbers = {row.meaning: html.escape(_format_number(row)) for row in table.numbers}
            self._descriptions[index] = {"is this number real?": verdict} | numbers | _edge_factors(case.dataset, table)
        return self._descriptions[index]

    def _show_fields(self, drawn_cases: dict[int, CaseFields]) -> dict[int, Image]:
        """Draw the fields of the cases with common axes and colours; return the images of the plane."""
        lines: dict[int, Line] = {}
        tops: dict[int, Image] = {}
        planes: dict[int, Image] = {}
        unit = ""
        for slot, case in drawn_cases.items():
            scale, limits = choose_scale(case, relative=self.units.value), region_limits(case, self.region.value)
            unit = scale.over_stress
            lines[slot], tops[slot] = axial_line(case, scale, limits), top_image(case, scale, limits)
            kind, fraction = self.plane.value, self.fraction.value
            if image := plane_image(case, scale, limits, kind, fraction, name=self.measure.value):
                planes[slot] = image
        self.axial.show(lines)
        measure = next(text for text, name in MEASURES.items() if name == self.measure.value)
        rows = (tops, self.surface_figures, "pressure"), (planes, self.plane_figures, measure)
        for images, figures, quantity in rows:
            color_limit = max((image.color_limit for image in images.values()), default=1.0)
            low = min((image.vertical[0] for image in images.values()), default=0.0)
            high = max((image.vertical[1] for image in images.values()), default=1.0)
            for slot, figure in enumerate(figures):
                # The title has two lines, so that it fits into a narrow window.
                title = f"{NAMES[slot]}: {quantity}{unit}" if self.compare.value else f"{quantity}{unit}"
                if slot in images:
                    clipped_note = "clipped at the end" if drawn_cases[slot].singular_ends else ""
                    notes = (images[slot].position, f"largest {images[slot].largest[0]:.4g}", clipped_note)
                    title += "\n" + ", ".join(filter(None, notes))
                figure.show(images.get(slot), color_limit, title, (low, high))
        return planes

    def _explain_missing(self, slot: int, case: CaseFields | None, *, has_plane: bool) -> str:
        """Reason of missing figures of a case; empty without missing figures."""
        if case is None:
            text = status_sentence(*self.cases.status(self.index(slot)))
        elif not case.has_pressure:
            text = "The study stores no surfaces of this case, only its numbers."
        elif not has_plane:
            reason = "have too few points in this plane" if case.has_stress else "are not stored"
            text = f"The stresses {reason}."
        else:
            return ""
        name = f"<b>{NAMES[slot]}:</b> " if self.compare.value else ""
        return f"{name}{html.escape(text)}"

    def _set_visible(self, index: int, visible: bool) -> None:
        """Show or hide a figure; the figure's pane and model must agree."""
        pane = self.panes[index]
        if pane.object is not None:
            pane.object.visible = visible
        pane.visible = visible

    def _show_study(self, slots: list[int]) -> None:
        """Draw one number of all cases over a swept parameter, with the first case's values of other parameters."""
        if not self.cases.dims or not self.number.value:
            self._set_visible(5, False)
            return
        name, parameter = self.number.value, self.parameter.value or self.cases.dims[0]
        scalars = self.cases.scalars
        dims = self.cases.dims
        numbers = scalars[name].transpose(*dims).values
        specification = variable_of(name, scalars[name].attrs)
        factor, unit = unit_for(float(np.abs(numbers[np.isfinite(numbers)]).max(initial=0.0)), specification.units)
        line_index = tuple(slice(None) if dim == parameter else i for dim, i in zip(dims, self.index(0), strict=True))
        values = np.asarray(numbers[line_index], dtype=np.float64) / factor
        x, label, ticks = self._parameter_axis(parameter)
        axis = dims.index(parameter)
        marks = [(self.index(slot)[axis], float(numbers[self.index(slot)]) / factor, COLORS[slot]) for slot in slots]
        number_label = f"{specification.long_name} ({unit})" if unit else specification.long_name
        self._set_visible(5, not np.isnan(values).all())
        errors = self._select_errors(name, line_index, values, factor)
        self.study.show(x, values, errors, marked_cases=marks, labels=(label, number_label), ticks=ticks)

    def _parameter_axis(self, parameter: str) -> tuple[FloatArray, str, dict[float, str] | None]:
        """Positions, label and ticks of a swept parameter."""
        coordinate = self.cases.scalars[parameter]
        if coordinate.dtype.kind not in "fi":
            ticks = {float(index): text for index, text in enumerate(self.cases.choices(parameter))}
            return np.arange(coordinate.size, dtype=np.float64), _label_parameter(coordinate), ticks
        factor, unit = unit_for(float(np.nanmax(np.abs(coordinate.values))), str(coordinate.attrs.get("units", "1")))
        label = f"{_label_parameter(coordinate)} ({unit})" if unit else _label_parameter(coordinate)
        return np.asarray(coordinate.values, dtype=np.float64) / factor, label, None

    def _select_errors(self, name: str, line_index: tuple[Any, ...], values: FloatArray, factor: float) -> FloatArray:
        """Errors of a number along a line of cases, NaN if not estimated; 0 for exact numbers."""
        scalars = self.cases.scalars
        if f"{name}_error" in scalars:
            errors = scalars[f"{name}_error"].transpose(*scalars["status"].dims).values[line_index] / factor
            return np.where(np.isfinite(errors) & np.isfinite(values), errors, np.nan)
        return np.full(values.size, np.nan if name.startswith(ESTIMATED_PREFIXES) else 0.0)

    def view(self) -> Any:
        """Layout of the page: columns on a wide screen, rows on a narrow screen."""
        count = int((self.cases.scalars["status"] != "excluded").sum())
        header = pn.pane.HTML(
            f"<h2 style='margin:0;font-size:20px'>{html.escape(self.cases.title)}</h2>"
            f"<div class=soft>{count} case{'s' if count != 1 else ''}</div>",
            stylesheets=[STYLE],
            sizing_mode="stretch_width",
        )
        for widget in (*self.choices[0].values(), *self.choices[1].values(), *self._settings):
            # The default width exceeds a narrow column.
            widget.param.update(width=None, sizing_mode="stretch_width")
        controls = pn.Column(
            *self.choices[0].values(),
            self.compare,
            self._second_choices,
            self.units,
            *self._settings,
            styles={"flex": "1 1 15rem", "max-width": "24rem", "min-width": "14rem"},
            sizing_mode="stretch_width",
        )
        wide_style = {"flex": "1 1 25rem", "min-width": "min(100%, 19rem)"}
        panels = [pn.Column(self.table, styles=wide_style, sizing_mode="stretch_width")]
        for pane in self.panes:
            pane.styles = wide_style
            panels.append(pane)
        body = pn.FlexBox(*panels, styles={"flex": "4 1 30rem", "gap": "0.6rem"}, sizing_mode="stretch_width")
        return pn.Column(
            header,
            pn.FlexBox(controls, body, flex_wrap="wrap", styles={"gap": "1rem"}, sizing_mode="stretch_width"),
            sizing_mode="stretch_width",
        )


def _edge_factors(case: xr.Dataset, table: Summary) -> dict[str, str]:
    """Edge factors of the pressure."""
    if "hertz_half_width" not in case or "pressure" not in case:
        return {}
    factors = edge_factors(case[["pressure", "hertz_half_width"]])
    texts = {}
    for suffix, end in (("first", "end I"), ("last", "end II")):
        name = f"end_pressure_{suffix}"
        singular = name in table and np.isinf(table[name].value)
        text = "singular" if singular else f"{float(factors[f'end_over_middle_{suffix}']):.3f} ({UNKNOWN_ERROR})"
        texts[f"edge factor of the contact towards {end} (largest within a, over its middle)"] = text
    return texts


def _label_parameter(coordinate: xr.DataArray) -> str:
    """Label of a swept parameter."""
    return str(coordinate.attrs.get("long_name", coordinate.name))


def _format_number(quantity: Quantity) -> str:
    """Text of a number with the mark of its remark."""
    texts = {
        "singular": "singular: no largest value",
        **dict.fromkeys(("open", "law"), f"{quantity.text}: {quantity.remark}"),
        "rounding": f"{quantity.text} ({quantity.remark})",
        NOT_ESTIMATED: f"{quantity.text} ({UNKNOWN_ERROR})",
    }
    return texts.get(quantity.mark, quantity.text)
