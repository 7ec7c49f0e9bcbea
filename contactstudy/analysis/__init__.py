"""Numbers from Datasets: functions that take and return Datasets of results, files and opened studies."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
