"""What is kept, what is dropped first, and what threads share."""

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
def fresh() -> Iterator[None]:
    cache.clear()
    yield
    cache.limit(cache.LIMIT)
    cache.clear()


def recorded(kind: str) -> tuple[Callable[[str], FloatArray], list[str]]:
    """Return a maker that keeps as many bytes as names are long, and the list of what it has made."""
    made: list[str] = []

    @cached(kind)
    def make(name: str) -> FloatArray:
        made.append(name)
        return np.frombuffer(name.encode(), np.uint8)

    return make, made


def test_least_recently_used_value_is_dropped() -> None:
    cache.limit(10)
    make, made = recorded("letters")
    for name in ("aaaa", "bbbb", "aaaa", "cccc"):
        assert make(name).tobytes().decode() == name
    assert made == ["aaaa", "bbbb", "cccc"]
    make("aaaa")
    assert made == ["aaaa", "bbbb", "cccc"]
    make("bbbb")
    assert made[-1] == "bbbb"


def test_value_larger_than_limit_is_not_cached() -> None:
    cache.limit(5)
    make, made = recorded("letters")
    make("aaaa")
    make("larger than all")
    make("larger than all")
    make("aaaa")
    assert made == ["aaaa", "larger than all", "larger than all"]


def test_keyword_arguments_are_part_of_key() -> None:
    @cached("products")
    def multiply(number: int, factor: int = 1) -> int:
        return number * factor

    assert [multiply(2, factor=factor) for factor in (3, 4, 3)] == [6, 8, 6]
    assert cache.info().kinds["products"].computed == 2


def test_kinds_have_separate_keys() -> None:
    first, _ = recorded("first")
    second, made = recorded("second")
    first("same")
    second("same")
    assert made == ["same"]
    kinds = cache.info().kinds
    assert (kinds["first"].values, kinds["second"].values) == (1, 1)


def test_info_counts_computed_and_reused_values() -> None:
    make, _ = recorded("counted")
    for name in ("aa", "aa", "bbb"):
        make(name)
    found = cache.info().kinds["counted"]
    assert (found.values, found.nbytes, found.computed, found.reused) == (2, 5, 2, 1)
    assert "counted: 2 in" in str(cache.info())


def test_smaller_limit_keeps_most_recent_values() -> None:
    make, made = recorded("letters")
    for name in ("aaaa", "bbbb", "cccc"):
        make(name)
    cache.limit(8)
    assert cache.info().nbytes == 8
    make("cccc")
    make("bbbb")
    assert made == ["aaaa", "bbbb", "cccc"]
    cache.limit(0)
    assert cache.info().nbytes == 0


@pytest.mark.parametrize("bound", [-1, 1.5, "1 GB"])
def test_invalid_limit_raises_error(bound: object) -> None:
    with pytest.raises(InvalidInputError, match="nbytes"):
        cache.limit(bound)  # type: ignore[arg-type]


def test_threads_share_one_value() -> None:
    barrier, found = Barrier(4), []

    @cached("shared")
    def make(size: int) -> np.ndarray:
        barrier.wait()  # all four have missed
        return np.zeros(size)

    threads = [Thread(target=lambda: found.append(make(8))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(value is found[0] for value in found)
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
    def factors(size: int) -> Factors:
        return Factors(np.ones(size), {"upper": [np.ones(size)]})

    value = factors(3)
    assert not value.lower.flags.writeable
    assert not value.by_name["upper"][0].flags.writeable
    assert cache.info().nbytes == cache.nbytes_of(value) == 48
