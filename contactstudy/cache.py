"""One cache for the process, bounded in bytes.

The cases of a sweep share operators, kernels and fields through it. A value depends only on the
arguments of its function, so results are bit for bit the same with and without the cache.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Hashable, Mapping
from functools import wraps
from threading import RLock
from typing import Any, NamedTuple, ParamSpec, TypeVar

import numpy as np
from cachetools import LRUCache

from contactstudy import checks
from contactstudy.checks import FloatArray

LIMIT = 2**30  # Default bound of all cached values, bytes. Speed.
Arguments = ParamSpec("Arguments")
Value = TypeVar("Value")


class KindInfo(NamedTuple):
    """Cached values of one kind: their number and bytes, and how many were reused and computed in this process."""

    values: int
    nbytes: int
    reused: int
    computed: int


class CacheInfo(NamedTuple):
    """State of the cache: its limit and the size of its values in bytes, also by kind."""

    limit: int
    nbytes: int
    kinds: dict[str, KindInfo]

    def __str__(self) -> str:
        """Return a table."""
        rows = [f"{self.nbytes / 2**20:.1f} of {self.limit / 2**20:.0f} MiB"]
        rows += [
            f"  {kind}: {values.values} in {values.nbytes / 2**20:.1f} MiB, "
            f"computed {values.computed}, reused {values.reused}"
            for kind, values in self.kinds.items()
        ]
        return "\n".join(rows)


Store = LRUCache[tuple[str, Hashable], tuple[Any, int]]  # value and bytes, by kind and key


def _empty_store(nbytes: int) -> Store:
    return LRUCache(nbytes, getsizeof=lambda entry: entry[1])


_lock = RLock()
_counts: dict[str, list[int]] = {}
_store = _empty_store(LIMIT)


def info() -> CacheInfo:
    """Return the state of the cache, by kind.

    Examples
    --------
    >>> from contactstudy import cache
    >>> cache.clear()
    >>> cache.info().nbytes
    0
    """
    with _lock:
        kinds = {
            kind: KindInfo(
                values=sum(1 for entry_kind, _ in _store if entry_kind == kind),
                nbytes=sum(nbytes for (entry_kind, _), (_, nbytes) in _store.items() if entry_kind == kind),
                reused=reused,
                computed=computed,
            )
            for kind, (reused, computed) in sorted(_counts.items())
        }
        return CacheInfo(int(_store.maxsize), int(_store.currsize), kinds)


def clear() -> None:
    """Drop all values and reset the counts."""
    with _lock:
        _store.clear()
        for counts in _counts.values():
            counts[:] = [0, 0]


def limit(nbytes: int) -> None:
    """Bound the cache; the least recently used values are dropped first.

    Parameters
    ----------
    nbytes : int
        Largest total size of the values; 0 for an empty cache. A single larger value is not cached.

    Raises
    ------
    InvalidInputError
        If `nbytes` is not a whole number, or below zero.

    Examples
    --------
    >>> from contactstudy import cache
    >>> cache.limit(2**28)
    >>> cache.info().limit == 2**28
    True
    >>> cache.limit(cache.LIMIT)
    """
    global _store
    bound = checks.count("nbytes", nbytes, minimum=0)
    with _lock:
        bounded_store = _empty_store(bound)
        while _store:
            key, entry = _store.popitem()  # the least recently used first: the order is preserved
            if entry[1] <= bound:
                bounded_store[key] = entry
        _store = bounded_store


def recall(kind: str, key: Hashable) -> Any | None:
    """Return the cached value of a key, or None, and count the reuse or the miss."""
    with _lock:
        entry = _store.get((kind, key))
        _counts.setdefault(kind, [0, 0])[0 if entry else 1] += 1
    return entry[0] if entry else None


def retain(kind: str, key: Hashable, value: Value, *, replace: bool = False) -> Value:
    """Cache a value with read-only arrays; return the first cached value of the key, or with `replace` this one."""
    nbytes = _protect(value)
    with _lock:
        if replace:
            _store.pop((kind, key), None)
        if nbytes <= _store.maxsize:
            value = _store.setdefault((kind, key), (value, nbytes))[0]
    return value


def cached(kind: str) -> Callable[[Callable[Arguments, Value]], Callable[Arguments, Value]]:
    """Cache the values of a function by its hashable arguments."""

    def decorator(compute: Callable[Arguments, Value]) -> Callable[Arguments, Value]:
        @wraps(compute)
        def look_up(*arguments: Arguments.args, **keywords: Arguments.kwargs) -> Value:
            key = (arguments, tuple(keywords.items()))
            value: Value | None = recall(kind, key)
            if value is None:
                value = retain(kind, key, compute(*arguments, **keywords))
            return value

        return look_up

    return decorator


def _protect(value: object) -> int:
    """Make the arrays of a value read-only; return its bytes, plus the `added_nbytes` of its later use."""
    nbytes, visited, pending_items = 0, set[int](), [value]
    while pending_items:
        item = pending_items.pop()
        if id(item) in visited:
            continue
        visited.add(id(item))
        if isinstance(item, np.ndarray):
            item.flags.writeable = False
            nbytes += item.nbytes
        elif isinstance(item, (list, tuple)):
            pending_items += item
        elif isinstance(item, Mapping):
            pending_items += item.values()
        elif type(item).__module__.startswith("contactstudy."):
            pending_items += vars(item).values()
            nbytes += getattr(item, "added_nbytes", 0)
    return nbytes


class ArrayKey:
    """An array compared by its values, as an argument of a cached function; `values` is a read-only copy."""

    def __init__(self, values: FloatArray) -> None:
        self.values: FloatArray = np.array(values)
        self.values.flags.writeable = False
        content = f"{self.values.dtype} {self.values.shape}".encode() + self.values.tobytes()
        self._digest = hashlib.blake2b(content, digest_size=16).digest()

    def __eq__(self, other: object) -> bool:
        """Whether the other is an array of the same values."""
        return isinstance(other, ArrayKey) and self._digest == other._digest

    def __hash__(self) -> int:
        """Hash of the values."""
        return hash(self._digest)
