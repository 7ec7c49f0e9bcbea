"""Temperature that friction raises on the surfaces of a sliding or rolling contact, and below them."""

from contactstudy.heat.flash import flash_temperature
from contactstudy.heat.properties import ThermalProperties
from contactstudy.near_names import suggest

__all__ = ["ThermalProperties", "flash_temperature"]

suggest(__name__, __all__)
