"""Directions of a load on the top of a body, and their parities under reflection."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class Load(Enum):
    """Direction of a load on the top; sign_x, sign_y: 1 if a reflection along x, along y keeps the load, -1 if not."""

    NORMAL = (1, 1)  # pressure, positive into the body
    ALONG_X = (-1, 1)  # traction on the body along +x
    ALONG_Y = (1, -1)  # traction on the body along +y

    def __init__(self, sign_x: int, sign_y: int) -> None:
        self.sign_x = sign_x
        self.sign_y = sign_y


class Response(NamedTuple):
    """Displacement in one direction under a load in one direction."""

    displacement: Load  # direction of the displacement: the load in this direction does work on it
    load: Load

    @property
    def sign_x(self) -> int:
        """1 if the kernel is even along x, -1 if it is odd."""
        return self.displacement.sign_x * self.load.sign_x

    @property
    def sign_y(self) -> int:
        """1 if the kernel is even along y, -1 if it is odd."""
        return self.displacement.sign_y * self.load.sign_y


NORMAL_RESPONSE = Response(Load.NORMAL, Load.NORMAL)  # normal displacement of the top under a pressure
