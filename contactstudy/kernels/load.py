"""Directions of a load on the top of a body, and what a reflection does to each."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


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


class Response(NamedTuple):
    """What a load in one direction displaces in the same or another one: one of nine pairs.

    Attributes
    ----------
    displacement : Load
        Direction of the displacement: that of the load which does work on it.
    load : Load
        Direction of the load.

    Examples
    --------
    >>> across = Response(Load.ALONG_X, Load.ALONG_Y)
    >>> across.sign_x, across.sign_y, across.reciprocal == Response(Load.ALONG_Y, Load.ALONG_X)
    (-1, -1, True)
    """

    displacement: Load
    load: Load

    @property
    def sign_x(self) -> int:
        """1 if the kernel is even along x, -1 if it is odd."""
        return self.displacement.sign_x * self.load.sign_x

    @property
    def sign_y(self) -> int:
        """1 if the kernel is even along y, -1 if it is odd."""
        return self.displacement.sign_y * self.load.sign_y

    @property
    def reciprocal(self) -> Response:
        """The pair whose kernel is this one seen backwards."""
        return Response(self.load, self.displacement)


SINKS = Response(Load.NORMAL, Load.NORMAL)
"""How far a pressure sinks the top."""
