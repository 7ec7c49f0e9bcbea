"""``dataset.contact``: the functions of Datasets in ``analysis``, ``report`` and ``explorer`` as methods.

``import contactstudy`` alone does not import xarray. The accessor is registered when a public name of contactstudy is
first used after xarray is imported, or when xarray opens a file (:mod:`contactstudy.study.xarray_backend`).
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from importlib import import_module
from typing import Any

import numpy as np
import xarray as xr

from contactstudy import analysis


def _method(module: str, name: str) -> Callable[..., Any]:
    """Return a function of a Dataset, whose module is imported at the first call, as a method of the accessor."""

    def method(self: ContactAccessor, *arguments: Any, **options: Any) -> Any:
        return getattr(import_module(module), name)(self._dataset, *arguments, **options)

    method.__name__, method.__doc__ = name, f"See :func:`{module}.{name}`."
    return method


@xr.register_dataset_accessor("contact")
class ContactAccessor:
    """Functions of :mod:`contactstudy.analysis` with a Dataset as first argument, and a few others, as methods.

    Examples
    --------
    >>> pressure = xr.DataArray([[1.0], [2.0]], dims=("x", "y"))
    >>> xr.Dataset({"pressure": pressure}).contact.axial_pressure().values.tolist()
    [1.0, 2.0]
    """

    def __init__(self, dataset: xr.Dataset) -> None:
        self._dataset = dataset

    def __repr__(self) -> str:
        return self._count_cases() or repr(self.summary())

    def _repr_html_(self) -> str:
        counts = self._count_cases()
        html: str = f"<pre>{counts}</pre>" if counts else self.summary()._repr_html_()
        return html

    def _count_cases(self) -> str:
        """Return the number of cases of each status in a study; empty for a single case."""
        if "status" not in self._dataset or self._dataset["status"].size < 2:
            return ""
        status = self._dataset["status"]
        names, counts = np.unique(status.values, return_counts=True)
        by_status = ", ".join(f"{count} {name}" for name, count in zip(names, counts, strict=True))
        dims = ", ".join(f"{dim} ({status.sizes[dim]})" for dim in status.dims)
        return f"study of {status.size} cases over {dims}: {by_status}; select one for its numbers"

    summary = _method("contactstudy.report", "summary")
    assess = _method("contactstudy.report", "assess")
    citations = _method("contactstudy.report", "citations")
    explore = _method("contactstudy.explorer", "explore")


for _name in dir(analysis):
    _function = getattr(analysis, _name)
    if inspect.isfunction(_function) and next(iter(inspect.signature(_function).parameters)) == "dataset":
        setattr(ContactAccessor, _name, wraps(_function)(_method("contactstudy.analysis", _name)))
