"""Parametric studies: many cases, solved together, stored in batches, opened as one Dataset.

A *case* is one set of parameters; a hash of the set is its identity. A *group* contains the cases that differ in
friction only and slide fully without coupling; these cases share one contact, solved once. Groups follow from the
study's file alone. A *task* contains consecutive groups with a common operator and keeps one worker busy for about ten
seconds. A *batch* is a netCDF file of finished cases, which a worker writes and the run joins with others. A *share* is
an independent subset of the groups, for job arrays. The numbers of a case follow from the contact of its group and
from its friction alone, so results depend on neither workers, tasks, shares nor finished cases, to the last bit.
"""

from contactstudy.errors import LockedError, StoreError, StudyFileError
from contactstudy.study.dataset import collect, load_case, open_study
from contactstudy.study.definition import Study
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
    "load_case",
    "open_study",
    "rerun_study",
    "run_study",
]
