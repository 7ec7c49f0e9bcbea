"""Verification that anyone can repeat: the solver against closed forms, finite elements, published numbers and itself.

``contactstudy verify`` runs it on the command line, `verify` from Python::

    checks = verify("quick")
    assert checks["passed"].all()

One module for each kind of reference (`half_space`, `limits`, `quarter_space`, `finite_elements`, `published`,
`consistency`, `convergence`), the references in `closed_forms` and `stored`, what a check is in `check`, the suite in
`suite`, what is written in `report` and `figures`. Every check can fail: the tests switch the physics off and see it.
"""

from __future__ import annotations

from contactstudy.verification.check import Check
from contactstudy.verification.suite import Verification, run, verify

__all__ = ["Check", "Verification", "run", "verify"]
