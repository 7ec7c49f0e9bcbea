"""Verification that anyone can repeat: the solver against closed forms, finite elements, published numbers and itself.

``contactstudy verify`` runs the checks on the command line, `verify` in Python::

    checks = verify("quick")
    assert checks["passed"].all()
"""

from __future__ import annotations

from contactstudy.verification.problems import Check
from contactstudy.verification.suite import Verification, run, verify

__all__ = ["Check", "Verification", "run", "verify"]
