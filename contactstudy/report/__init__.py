"""Reports for readers: tables of a result, and one HTML page of a result or of a study.

A page contains all of its styles and pictures, without scripts.
"""

from contactstudy.report.assessment import assess
from contactstudy.report.page import html, provenance, write
from contactstudy.report.sources import citations
from contactstudy.report.tables import case_table, summary

__all__ = ["assess", "case_table", "citations", "html", "provenance", "summary", "write"]
