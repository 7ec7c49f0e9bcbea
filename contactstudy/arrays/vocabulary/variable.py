"""The specification of a variable, and the dimensions that variables have."""

from __future__ import annotations

from typing import NamedTuple


class Variable(NamedTuple):
    """Specification of one variable.

    Attributes
    ----------
    dims : tuple of str
        Dimensions in a result of one case; a study puts its swept parameters in front.
    units : str
        SI, in the spelling of the CF conventions.
    symbol : str
        LaTeX, without dollar signs.
    long_name : str
        Meaning. ``{variable}`` stands for the meaning of the variable that a quantity was derived from, and
        ``{symbol}`` for its symbol, or its meaning if it has none. Those of
        coordinates are short: they stand on axes, where xarray breaks them after 30 characters, which is cut off.
    comment : str
        What a short meaning leaves out.

    Examples
    --------
    >>> Variable((), "N", "W", "normal load").attrs
    {'units': 'N', 'long_name': 'normal load'}
    """

    dims: tuple[str, ...]
    units: str
    symbol: str
    long_name: str
    comment: str = ""

    @property
    def attrs(self) -> dict[str, str]:
        """Attributes of the variable in a Dataset."""
        said = {"units": self.units, "long_name": self.long_name, "comment": self.comment}
        return {name: text for name, text in said.items() if text}


X, XY, XZ, YZ, XYZ, SCALAR = ("x",), ("x", "y"), ("x", "z"), ("y", "z"), ("x", "y", "z"), ()
SLICE, CHECK, ENTRY = ("slice",), ("check",), ("entry",)
EVALUATION, PARAMETER = ("evaluation",), ("parameter",)
"""Dimensions, for short."""

AXES = ("x", "y", "z")
"""Along the roller's axis, along rolling, and into the body."""

STRESSES = ("sigma_xx", "sigma_yy", "sigma_zz", "tau_xy", "tau_xz", "tau_yz")
"""The six components, in the order of every array of stresses."""
