"""A store of what is expensive to make, bounded in bytes: it lets the cases of a sweep share their work."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from collections.abc import Callable, Hashable
from threading import local
from typing import Generic, TypeVar

import numpy as np

from contactstudy.checks import FloatArray

Value = TypeVar("Value")


class BoundedCache(Generic[Value]):
    """Values by key, the least recently used dropped first when all together take more than a bound.

    What is kept depends on nothing but the key, so results are the same to the last bit with and without it. Each
    thread keeps its own, because operators own buffers.

    Parameters
    ----------
    limit : int
        Bytes that the kept values may take together; the newest is kept in any case.
    size : callable
        Bytes that a value takes.

    Examples
    --------
    >>> cache = BoundedCache(1000, len)
    >>> cache.get("key", lambda: "made once"), cache.get("key", lambda: "never made")
    ('made once', 'made once')
    """

    def __init__(self, limit: int, size: Callable[[Value], int]) -> None:
        self.limit = limit
        self._size = size
        self._threads = local()

    def get(self, key: Hashable, make: Callable[[], Value]) -> Value:
        """Return the value of `key`, making it if it is not at hand."""
        own = self._threads.__dict__
        kept: OrderedDict[Hashable, tuple[Value, int]] = own.setdefault("kept", OrderedDict())
        if key in kept:
            kept.move_to_end(key)
            return kept[key][0]
        value = make()
        kept[key] = value, self._size(value)
        own["held"] = own.get("held", 0) + kept[key][1]
        while len(kept) > 1 and own["held"] > self.limit:
            own["held"] -= kept.popitem(last=False)[1][1]
        return value


def digest(*arrays: FloatArray) -> str:
    """Fingerprint of the shapes and values of arrays, to stand for them in a key."""
    found = hashlib.blake2b(digest_size=16)
    for array in arrays:
        found.update(repr(array.shape).encode())
        found.update(np.ascontiguousarray(array).tobytes())
    return found.hexdigest()
