"""Input of bearing calculations from contacts: contact law, edge factors, and reference life."""

from contactstudy.bearing.laminae import lamina_factors, reference_life, roller_ratings, slice_model
from contactstudy.bearing.law import ContactLaw, Raceways
from contactstudy.bearing.tabulation import contact_law

__all__ = ["ContactLaw", "Raceways", "contact_law", "lamina_factors", "reference_life", "roller_ratings", "slice_model"]
