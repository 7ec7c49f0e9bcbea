"""Numbers from Datasets: functions that take and return Datasets of results, files and opened studies."""

from importlib import import_module

import lazy_loader

import_module("xarray")  # with it, the first use of this package registers `Dataset.contact`

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
