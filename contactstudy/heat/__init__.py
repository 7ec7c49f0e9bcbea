"""Temperature that friction raises on the surfaces of a sliding or rolling contact, and below them."""

from contactstudy.heat.flash import flash_temperature
from contactstudy.heat.moving_source import ThermalProperties

__all__ = ["ThermalProperties", "flash_temperature"]
