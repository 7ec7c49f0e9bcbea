"""Which case a file was solved for."""

from __future__ import annotations

import xarray as xr

from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, attribute, solved_case
from contactstudy.case.case import Case
from contactstudy.errors import InvalidInputError
from contactstudy.study.setup import build_setup
from contactstudy.study.store import CASE_ATTRIBUTE


def case_of(dataset: xr.Dataset) -> Case | None:
    """Case of a result, from what `solve` or a study wrote into it; None if nothing did.

    Examples
    --------
    >>> case_of(xr.Dataset()) is None
    True
    """
    if INPUTS_ATTRIBUTE in dataset.attrs:
        return solved_case(dataset)
    parameters = attribute(dataset, CASE_ATTRIBUTE)
    if not parameters:
        return None
    try:
        return build_setup(parameters).case
    except InvalidInputError:  # a file of a version that knew other parameters
        return None
