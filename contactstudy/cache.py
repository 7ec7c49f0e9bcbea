"""What is expensive to make and worth keeping: one store, bounded in bytes, for the whole process.

The cases of a sweep share operators, kernels and fields through it. What is kept depends on nothing but its request,
the one argument that its maker is called with, so results are the same to the last bit with and without the store.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from functools import wraps
from threading import RLock
from typing import Any, TypeVar

import numpy as np
from cachetools import LRUCache

from contactstudy import checks
from contactstudy.checks import FloatArray

LIMIT = 3 * 2**29
"""Bytes that all kept values together take at most, unless `limit` says otherwise. Speed only."""

Request = TypeVar("Request", bound=Hashable)
Value = TypeVar("Value")


@dataclass(frozen=True)
class Kept:
    """What is kept of one kind.

    Attributes
    ----------
    values : int
        Number of values kept now.
    nbytes : int
        Memory that they take, bytes.
    reused, made : int
        How often a value was found and how often it was made, in this process.
    """

    values: int = 0
    nbytes: int = 0
    reused: int = 0
    made: int = 0


@dataclass(frozen=True)
class CacheInfo:
    """State of the store.

    Attributes
    ----------
    limit : int
        Bytes that all values together may take.
    nbytes : int
        Bytes that they take.
    kinds : dict of str to Kept
        The same by kind.
    """

    limit: int
    nbytes: int
    kinds: dict[str, Kept]

    def __str__(self) -> str:
        """Return a table."""
        rows = [f"{self.nbytes / 2**20:.1f} of {self.limit / 2**20:.0f} MiB"]
        rows += [
            f"  {kind}: {kept.values} in {kept.nbytes / 2**20:.1f} MiB, made {kept.made}, reused {kept.reused}"
            for kind, kept in self.kinds.items()
        ]
        return "\n".join(rows)


@dataclass(frozen=True)
class _Entry:
    value: Any
    nbytes: int


_lock = RLock()
_counts: dict[str, list[int]] = {}
_store: LRUCache[tuple[str, Hashable], _Entry] = LRUCache(LIMIT, getsizeof=lambda entry: entry.nbytes)


def info() -> CacheInfo:
    """Return what is kept, by kind.

    Examples
    --------
    >>> from contactstudy import cache
    >>> cache.clear()
    >>> cache.info().nbytes
    0
    """
    with _lock:
        kinds = {
            kind: Kept(
                values=sum(1 for owner, _ in _store if owner == kind),
                nbytes=sum(entry.nbytes for (owner, _), entry in _store.items() if owner == kind),
                reused=reused,
                made=made,
            )
            for kind, (reused, made) in sorted(_counts.items())
        }
        return CacheInfo(int(_store.maxsize), int(_store.currsize), kinds)


def clear() -> None:
    """Drop all that is kept, and start counting anew."""
    with _lock:
        _store.clear()
        for counts in _counts.values():
            counts[:] = [0, 0]


def limit(nbytes: int) -> None:
    """Bound what is kept; the least recently used values are dropped first.

    Parameters
    ----------
    nbytes : int
        Bytes that all kept values together may take; 0 keeps nothing. A single value larger than this is not kept.

    Raises
    ------
    InvalidInputError
        If it is not a whole number, or below zero.

    Examples
    --------
    >>> from contactstudy import cache
    >>> cache.limit(2**28)
    >>> cache.info().limit == 2**28
    True
    >>> cache.limit(cache.LIMIT)
    """
    global _store
    bound = checks.count("nbytes", nbytes, least=0)
    with _lock:
        smaller: LRUCache[tuple[str, Hashable], _Entry] = LRUCache(bound, getsizeof=lambda entry: entry.nbytes)
        while _store:
            key, entry = _store.popitem()  # the least recently used first, so that the others stay the more recent
            if entry.nbytes <= bound:
                smaller[key] = entry
        _store = smaller


def kept(kind: str, nbytes: Callable[[Any], int]) -> Callable[[Callable[[Request], Value]], Callable[[Request], Value]]:
    """Make a function of one hashable request keep what it returns.

    The request is all that the function sees, so nothing that decides the value can be missing from its key. Values are
    shared by all threads and must not be changed.

    Parameters
    ----------
    kind : str
        Name of these values in `info`.
    nbytes : callable
        Bytes that a value takes.

    Examples
    --------
    >>> made = []
    >>> @kept("squares", lambda value: 8)
    ... def square(number: int) -> int:
    ...     made.append(number)
    ...     return number**2
    >>> square(3), square(3), made
    (9, 9, [3])
    """

    def decorated(make: Callable[[Request], Value]) -> Callable[[Request], Value]:
        counts = _counts.setdefault(kind, [0, 0])

        @wraps(make)
        def look_up(request: Request) -> Value:
            key = (kind, request)
            with _lock:
                found = _store.get(key)
                counts[0 if found else 1] += 1
            if found:
                value: Value = found.value
                return value
            value = make(request)
            entry = _Entry(value, nbytes(value))
            with _lock:
                if entry.nbytes <= _store.maxsize:
                    # Of two threads that made the same value, the first one's is kept.
                    value = _store.setdefault(key, entry).value
            return value

        return look_up

    return decorated


class ArrayKey:
    """An array compared by its values, as a part of a request.

    Attributes
    ----------
    values : array
        The array; a copy that cannot be changed.

    Examples
    --------
    >>> ArrayKey(np.zeros(3)) == ArrayKey(np.zeros(3)), ArrayKey(np.zeros(3)) == ArrayKey(np.ones(3))
    (True, False)
    """

    def __init__(self, values: FloatArray) -> None:
        self.values: FloatArray = np.array(values)
        self.values.flags.writeable = False
        found = hashlib.blake2b(digest_size=16)
        found.update(f"{self.values.dtype} {self.values.shape}".encode())
        found.update(np.ascontiguousarray(self.values).tobytes())
        self._digest = found.digest()

    def __eq__(self, other: object) -> bool:
        """Whether the other is an array of the same values."""
        return isinstance(other, ArrayKey) and self._digest == other._digest

    def __hash__(self) -> int:
        """Hash of the values."""
        return hash(self._digest)
