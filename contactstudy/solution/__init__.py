"""The whole case, contact and stresses, in one Dataset."""

from contactstudy.solution.case_solution import solve
from contactstudy.solution.roller_stresses import roller_stress

__all__ = ["roller_stress", "solve"]
