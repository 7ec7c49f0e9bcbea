"""From gap to pressure: unilateral contact of a body with a shape or a second body, and the slice model."""

from contactstudy.contact import slice_model as slices
from contactstudy.contact.solve import solve_contact

__all__ = ["slices", "solve_contact"]
