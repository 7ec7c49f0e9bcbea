"""The whole case, contact and stresses, in one Dataset.

===================  ====================================================
whole_case.py        a case, from its contact to its provenance
contact_of_case.py   its contact, on refined, chosen or given cells
stresses_of_case.py  stresses in the body, their peak, what the ends keep
in_the_roller.py     stresses in an elastic roller
===================  ====================================================
"""

from contactstudy.solution.in_the_roller import roller_stress
from contactstudy.solution.whole_case import solve

__all__ = ["roller_stress", "solve"]
