"""Figures of a study's folder: of its scalars, and of the few cases whose surfaces are drawn."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import xarray as xr

from contactstudy.analysis import single_case
from contactstudy.plots.chosen import narrowed
from contactstudy.plots.study_lines import suiting_figures
from contactstudy.study.folder import Folder
from contactstudy.study.opened import summaries
from contactstudy.study.store import load_variables

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DRAWN = ("pressure", "initial_gap", "von_mises")
"""Variables that figures of a study's surfaces and fields need."""


class StudyFigure(NamedTuple):
    """A figure, and the parameters of which it shows one value among several, each with a value that it does not."""

    figure: Figure
    others: dict[str, str]


def figures_of_folder(path: Path, selection: Mapping[str, Any] | None = None) -> dict[str, StudyFigure]:
    """Draw the figures that suit the study in a folder, by name.

    Files are opened of the cases alone whose surfaces are drawn, so a study may have any number of them.

    Parameters
    ----------
    path : Path
        The study's folder.
    selection : mapping, optional
        Values of swept parameters, or texts that name them, to which the figures keep.

    Raises
    ------
    InvalidInputError
        If a parameter of the selection is not swept, or does not take the value.
    """
    folder, scalars = Folder(path), summaries(path)[0]
    part = narrowed(scalars, selection or {})

    def load(one: xr.Dataset) -> xr.Dataset:
        return single_case(load_variables(folder.case_path(str(one["case_id"].item())), DRAWN))

    drawn = suiting_figures(part, load)
    return {
        name: StudyFigure(figure, {dim: _last(part, dim) for dim in others}) for name, (figure, others) in drawn.items()
    }


def _last(dataset: xr.Dataset, dim: str) -> str:
    """Last value of a parameter, as a text that names it."""
    value = dataset.indexes[dim][-1]
    return value if isinstance(value, str) else f"{float(value):.10g}"
