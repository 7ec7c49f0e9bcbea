"""Errors of the study layer."""

from __future__ import annotations

from contactstudy.errors import ContactStudyError


class StudyFileError(ContactStudyError):
    """A study file cannot be read, or nothing in the study can be solved."""


class StoreError(ContactStudyError):
    """A result cannot be written or read: a full disk, a missing permission, a damaged or foreign file.

    While a study runs this stops the run, because the next case would meet the same disk; the cases that are
    finished stay as they are.
    """


class LockedError(ContactStudyError):
    """Another process is running a study in the same folder."""
