"""Errors of the study layer."""

from __future__ import annotations

from contactstudy.errors import ContactStudyError


class StudyFileError(ContactStudyError):
    """A study file cannot be read, or nothing in the study can be solved."""


class StoreError(ContactStudyError):
    """A result cannot be written or read: a full disk, a missing permission, a damaged file; ends a run."""


class LockedError(ContactStudyError):
    """Another process is running a study in the same folder."""
