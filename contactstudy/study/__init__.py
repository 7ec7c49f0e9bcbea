"""Parametric studies: many cases, mapped over processes, one file per case, opened as one Dataset."""

from contactstudy.near_names import suggest
from contactstudy.study.definition import Study
from contactstudy.study.errors import LockedError, StoreError, StudyFileError
from contactstudy.study.opened import collect, open_study
from contactstudy.study.plan import Plan, PlannedCase
from contactstudy.study.run import RunReport, rerun_study, run_study

__all__ = [
    "LockedError",
    "Plan",
    "PlannedCase",
    "RunReport",
    "StoreError",
    "Study",
    "StudyFileError",
    "collect",
    "open_study",
    "rerun_study",
    "run_study",
]

suggest(__name__, __all__)
