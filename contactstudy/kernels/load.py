"""Directions of a load on the top of a body, and what a reflection does to each."""

from __future__ import annotations

from enum import Enum


class Load(Enum):
    """Direction of a load on the top.

    A reflection in a plane ``x = const`` or ``y = const`` keeps a load or turns it round. This sign decides three
    things: the sign of the load's mirror image in a free end, whether a field component is even or odd against its
    parity under a pressure, and whether a kernel's Fourier transform carries a factor i against that of a pressure.

    Attributes
    ----------
    sign_x, sign_y : int
        1 if the reflection along x, along y keeps the load, -1 if it turns it round.

    Examples
    --------
    >>> Load.ALONG_Y.sign_x, Load.ALONG_Y.sign_y
    (1, -1)
    """

    NORMAL = ("pressure, positive into the body", 1, 1)
    ALONG_X = ("traction on the body along +x", -1, 1)
    ALONG_Y = ("traction on the body along +y", 1, -1)

    def __init__(self, meaning: str, sign_x: int, sign_y: int) -> None:
        self.meaning = meaning
        self.sign_x = sign_x
        self.sign_y = sign_y
