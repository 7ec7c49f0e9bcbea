"""Rolling-sliding contact of a roller on an elastic body with free end faces.

Names are imported when they are first used, so that ``import contactstudy`` stays fast. The file
``__init__.pyi`` lists the names and their modules.
"""

from __future__ import annotations

import logging
import sys
from importlib import import_module

import lazy_loader

# By default the package logs nothing; logging.basicConfig(level="INFO") shows its stages.
logging.getLogger(__name__).addHandler(logging.NullHandler())

_public_name, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    """Import a public name on first use; register ``Dataset.contact`` once xarray is imported."""
    if name == "__version__":
        from contactstudy.versions import version_of

        return version_of(__name__)
    value: object = _public_name(name)
    if "xarray" in sys.modules:
        import_module("contactstudy.accessor")
    return value


if "xarray" in sys.modules:
    import_module("contactstudy.accessor")
