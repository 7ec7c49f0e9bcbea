"""Temperature that friction raises on the surfaces of a sliding or rolling contact, and below them."""

from typing import TYPE_CHECKING

from contactstudy.heat.flash import flash_temperature
from contactstudy.heat.properties import ThermalProperties
from contactstudy.near_names import suggesting

__all__ = ["ThermalProperties", "flash_temperature"]

if not TYPE_CHECKING:  # to a type checker, a module with __getattr__ has every name
    __getattr__ = suggesting(__name__, __all__)
