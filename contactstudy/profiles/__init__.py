"""Roller profiles: drop of a roller's generatrix below the cylinder (docs/reference/profiles.md).

A profile has one method ``drop(x, length)``: the material removed, in metres and not negative, at the distance `x` from
mid-length of a roller of the given `length`, fillets included. ``profile + other`` is the sum of two profiles.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
