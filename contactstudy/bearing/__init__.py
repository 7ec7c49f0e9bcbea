"""What a bearing calculation takes from a contact: its law, and edge factors with the reference life that follows.

=================  ================================================================
law.py             load and moment over approach and tilt, stiffness, the inverse
tabulation.py      that law from solved contacts
raceways.py        two contact laws in series: a roller between its raceways
nodes.py           contacts at pairs of approach and tilt
energy_spline.py   the interpolation: one function whose derivatives they are
motions.py         labelled arguments and results
laminae.py         edge factors per lamina from solved pressures
reference_life.py  life by slices, by the half-space and by free ends
=================  ================================================================
"""

from contactstudy.bearing.laminae import lamina_factors
from contactstudy.bearing.law import ContactLaw
from contactstudy.bearing.raceways import Raceways
from contactstudy.bearing.reference_life import reference_life, roller_ratings
from contactstudy.bearing.tabulation import contact_law
from contactstudy.near_names import suggest

__all__ = ["ContactLaw", "Raceways", "contact_law", "lamina_factors", "reference_life", "roller_ratings"]

suggest(__name__, __all__)
