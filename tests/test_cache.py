"""Cached values: limits, order of removal, and threads."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from threading import Barrier, Thread

import numpy as np
import pytest

from contactstudy import InvalidInputError, cache
from contactstudy.cache import ArrayKey, cached
from contactstudy.checks import FloatArray


@pytest.fixture(autouse=True)
def empty_cache() -> Iterator[None]:
    cache.clear()
    yield
    cache.limit(cache.LIMIT)
    cache.clear()


def make_recording_function(kind: str) -> tuple[Callable[[str], FloatArray], list[str]]:
    """Return a cached function of values as long as their names, and the list of its calls."""
    call_list: list[str] = []

    @cached(kind)
    def encode(name: str) -> FloatArray:
        call_list.append(name)
        return np.frombuffer(name.encode(), np.uint8)

    return encode, call_list


def test_cache_drops_least_recently_used_value() -> None:
    cache.limit(10)
    encode, calls = make_recording_function("letters")
    for name in ("aaaa", "bbbb", "aaaa", "cccc"):
        assert encode(name).tobytes().decode() == name
    assert calls == ["aaaa", "bbbb", "cccc"]
    encode("aaaa")
    assert calls == ["aaaa", "bbbb", "cccc"]
    encode("bbbb")
    assert calls[-1] == "bbbb"


def test_oversized_value_is_not_cached() -> None:
    cache.limit(5)
    encode, calls = make_recording_function("letters")
    encode("aaaa")
    encode("larger than all")
    encode("larger than all")
    encode("aaaa")
    assert calls == ["aaaa", "larger than all", "larger than all"]


def test_keyword_arguments_belong_to_key() -> None:
    @cached("products")
    def multiply(value: int, factor: int = 1) -> int:
        return value * factor

    assert [multiply(2, factor=factor) for factor in (3, 4, 3)] == [6, 8, 6]
    assert cache.info().kinds["products"].computed == 2


def test_kinds_have_separate_keys() -> None:
    first_function, _ = make_recording_function("first")
    second_function, calls = make_recording_function("second")
    first_function("same")
    second_function("same")
    assert calls == ["same"]
    kinds = cache.info().kinds
    assert (kinds["first"].values, kinds["second"].values) == (1, 1)


def test_cache_info_counts_reuse() -> None:
    encode, _ = make_recording_function("counted")
    for name in ("aa", "aa", "bbb"):
        encode(name)
    info = cache.info().kinds["counted"]
    assert (info.values, info.nbytes, info.computed, info.reused) == (2, 5, 2, 1)
    assert "counted: 2 in" in str(cache.info())


def test_smaller_limit_drops_oldest_values() -> None:
    encode, calls = make_recording_function("letters")
    for name in ("aaaa", "bbbb", "cccc"):
        encode(name)
    cache.limit(8)
    assert cache.info().nbytes == 8
    encode("cccc")
    encode("bbbb")
    assert calls == ["aaaa", "bbbb", "cccc"]
    cache.limit(0)
    assert cache.info().nbytes == 0


@pytest.mark.parametrize("bound", [-1, 1.5, "1 GB"])
def test_invalid_cache_limit_raises(bound: object) -> None:
    with pytest.raises(InvalidInputError, match="nbytes"):
        cache.limit(bound)  # type: ignore[arg-type]


def test_threads_share_cached_value() -> None:
    barrier, shared_arrays = Barrier(4), []

    @cached("shared")
    def encode(size: int) -> np.ndarray:
        barrier.wait()  # all four threads have missed
        return np.zeros(size)

    threads = [Thread(target=lambda: shared_arrays.append(encode(8))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(array is shared_arrays[0] for array in shared_arrays)
    assert cache.info().nbytes == 64


def test_arrays_are_compared_by_values_shape_and_type() -> None:
    key = ArrayKey(np.zeros((2, 3)))
    assert key == ArrayKey(np.zeros((3, 2)).T)
    assert key != ArrayKey(np.zeros((3, 2)))
    assert key != ArrayKey(np.zeros((2, 3), np.float32))
    with pytest.raises(ValueError, match="read-only"):
        key.values[0] = 1.0


def test_arrays_of_values_are_read_only() -> None:
    @dataclass
    class Factors:
        lower: FloatArray
        by_name: dict[str, list[FloatArray]]

    Factors.__module__ = "contactstudy.tests"

    @cached("read-only")
    def make_factors(size: int) -> Factors:
        return Factors(np.ones(size), {"upper": [np.ones(size)]})

    factors = make_factors(3)
    assert not factors.lower.flags.writeable
    assert not factors.by_name["upper"][0].flags.writeable
    assert cache.info().nbytes == 48
