"""From gap to pressure: unilateral contact of a body with a shape or a second body."""

from contactstudy.contact.refinement.laws import corner_peak, edge_peak
from contactstudy.contact.solve import ContactSettings, solve_contact

__all__ = ["ContactSettings", "corner_peak", "edge_peak", "solve_contact"]
