"""``dataset.contact``: the functions of :mod:`contactstudy.analysis` as methods of every Dataset.

``import contactstudy`` alone does not import xarray, to stay fast. The accessor is registered once xarray is imported
and any public name of contactstudy has been used, or xarray opens a file (:mod:`contactstudy.study.xarray_backend`).
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy import analysis
from contactstudy.analysis.certainty import Certainty
from contactstudy.analysis.citations import Citations
from contactstudy.analysis.short import ShortView
from contactstudy.case.case import Case
from contactstudy.near_names import missing


@xr.register_dataset_accessor("contact")
class ContactAccessor:
    """View of a Dataset that calls the functions of :mod:`contactstudy.analysis`; it has no state of its own.

    Parameters
    ----------
    dataset : Dataset
        A result or an opened study.

    Examples
    --------
    >>> pressure = xr.DataArray([[1.0], [2.0]], dims=("x", "y"))
    >>> xr.Dataset({"pressure": pressure}).contact.axial_pressure().values.tolist()
    [1.0, 2.0]
    """

    def __init__(self, dataset: xr.Dataset) -> None:
        self._dataset = dataset

    def __repr__(self) -> str:
        text = self._summary()
        return text if isinstance(text, str) else repr(text)

    if not TYPE_CHECKING:  # to a type checker, a class with __getattr__ has every name

        def __getattr__(self, name: str) -> object:
            raise missing(
                name, "the accessor Dataset.contact", [each for each in dir(self) if not each.startswith("_")]
            )

    def _repr_html_(self) -> str:
        text = self._summary()
        return f"<pre>{text}</pre>" if isinstance(text, str) else text._repr_html_()

    def _summary(self) -> ShortView | str:
        """Return the main numbers of a case, or how many cases of which status a study has."""
        if "status" in self._dataset and self._dataset["status"].size > 1:
            found, counts = np.unique(self._dataset["status"].values, return_counts=True)
            said = ", ".join(f"{count} {name}" for name, count in zip(found, counts, strict=True))
            swept = ", ".join(f"{dim} ({self._dataset.sizes[dim]})" for dim in self._dataset["status"].dims)
            return f"study of {self._dataset['status'].size} cases over {swept}: {said}; select one for its numbers"
        return analysis.short(self._dataset)

    def explore(self) -> Any:
        """See :func:`contactstudy.explore`."""
        # The page stands above the analysis, which need not know it: it is found by its name.
        return import_module("contactstudy.explorer").explore(self._dataset)

    def short(self) -> ShortView:
        """See :func:`contactstudy.analysis.short`."""
        return analysis.short(self._dataset)

    def certainty(self) -> Certainty:
        """See :func:`contactstudy.analysis.certainty`."""
        return analysis.certainty(self._dataset)

    def citations(self) -> Citations:
        """See :func:`contactstudy.analysis.citations`."""
        return analysis.citations(self._dataset)

    def solved_case(self) -> Case:
        """See :func:`contactstudy.analysis.solved_case`."""
        return analysis.solved_case(self._dataset)

    def axial_pressure(self) -> xr.DataArray:
        """See :func:`contactstudy.analysis.axial_pressure`."""
        return analysis.axial_pressure(self._dataset)

    def line_load(self) -> xr.DataArray:
        """See :func:`contactstudy.analysis.line_load`."""
        return analysis.line_load(self._dataset)

    def load_between(self, start: xr.DataArray | float, stop: xr.DataArray | float) -> xr.DataArray:
        """See :func:`contactstudy.analysis.load_between`."""
        return analysis.load_between(self._dataset, start, stop)

    def half_width(self) -> xr.Dataset:
        """See :func:`contactstudy.analysis.half_width`."""
        return analysis.half_width(self._dataset)

    def unloaded_gap(self) -> xr.DataArray:
        """See :func:`contactstudy.analysis.unloaded_gap`."""
        return analysis.unloaded_gap(self._dataset)

    def axial_profiles(self) -> xr.Dataset:
        """See :func:`contactstudy.analysis.axial_profiles`."""
        return analysis.axial_profiles(self._dataset)

    def edge_pressure(self) -> xr.Dataset:
        """See :func:`contactstudy.analysis.edge_pressure`."""
        return analysis.edge_pressure(self._dataset)

    def contact_edges(self) -> xr.Dataset:
        """See :func:`contactstudy.analysis.contact_edges`."""
        return analysis.contact_edges(self._dataset)

    def contact_results(self, about: float | None = None) -> xr.Dataset:
        """See :func:`contactstudy.analysis.contact_results`."""
        return analysis.contact_results(self._dataset, about)

    def measure(self, name: str) -> xr.DataArray:
        """See :func:`contactstudy.analysis.measure`."""
        return analysis.measure(self._dataset, name)

    def peak(self, variable: str = "von_mises") -> xr.Dataset:
        """See :func:`contactstudy.analysis.peak`."""
        return analysis.peak(self._dataset, variable)

    def largest(self, variable: str = "von_mises") -> xr.Dataset:
        """See :func:`contactstudy.analysis.largest`."""
        return analysis.largest(self._dataset, variable)

    def section_peak(self, variable: str = "von_mises") -> xr.Dataset:
        """See :func:`contactstudy.analysis.section_peak`."""
        return analysis.section_peak(self._dataset, variable)

    def edge_factors(
        self, variable: str = "pressure", reference: xr.Dataset | None = None, *, reach: float | None = None
    ) -> xr.Dataset:
        """See :func:`contactstudy.analysis.edge_factors`."""
        return analysis.edge_factors(self._dataset, variable, reference, reach=reach)

    def along_line(
        self,
        start: Sequence[float],
        end: Sequence[float],
        *,
        points: int = 101,
        variables: str | Sequence[str] | None = None,
    ) -> xr.Dataset:
        """See :func:`contactstudy.analysis.along_line`."""
        return analysis.along_line(self._dataset, start, end, points=points, variables=variables)

    def in_plane(
        self,
        *,
        x: float | None = None,
        y: float | None = None,
        z: float | None = None,
        variables: str | Sequence[str] | None = None,
    ) -> xr.Dataset:
        """See :func:`contactstudy.analysis.in_plane`."""
        return analysis.in_plane(self._dataset, x=x, y=y, z=z, variables=variables)

    def normalized(self) -> xr.Dataset:
        """See :func:`contactstudy.analysis.normalized`."""
        return analysis.normalized(self._dataset)

    def positions_over_a(self) -> xr.Dataset:
        """See :func:`contactstudy.analysis.positions_over_a`."""
        return analysis.positions_over_a(self._dataset)

    def slices(self, count: int = 30) -> xr.Dataset:
        """See :func:`contactstudy.analysis.slices`."""
        return analysis.slices(self._dataset, count)

    def single_case(self) -> xr.Dataset:
        """See :func:`contactstudy.analysis.single_case`."""
        return analysis.single_case(self._dataset)
