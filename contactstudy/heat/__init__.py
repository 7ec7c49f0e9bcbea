"""Temperature that friction raises on the surfaces of a sliding or rolling contact, and below them."""

from contactstudy.heat.flash import ThermalProperties, flash_temperature

__all__ = ["ThermalProperties", "flash_temperature"]
