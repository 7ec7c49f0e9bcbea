"""Figures of solved cases and of studies; lengths over the Hertz half-width a, stresses over p0, or in mm and MPa.

Every function takes results of :func:`contactstudy.solve`, or one case selected from :func:`contactstudy.open_study`,
and draws into the axes `ax` or a new figure. Colours keep their order in grey; lines differ by their dashes.
"""

from importlib import import_module

import lazy_loader

import_module("xarray")  # with it, the first use of this package registers `Dataset.contact`

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
