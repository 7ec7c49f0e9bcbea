"""What is kept, and what is dropped first."""

from __future__ import annotations

from contactstudy.cache import BoundedCache


def test_the_least_recently_used_is_dropped_first():
    made = []

    def make(name: str) -> str:
        made.append(name)
        return name

    cache = BoundedCache(10, len)
    for name in ("aaaa", "bbbb", "aaaa", "cccc"):
        assert cache.get(name, lambda name=name: make(name)) == name
    assert made == ["aaaa", "bbbb", "cccc"]
    cache.get("aaaa", lambda: make("aaaa"))
    assert made == ["aaaa", "bbbb", "cccc"]
    cache.get("bbbb", lambda: make("bbbb"))
    assert made[-1] == "bbbb"


def test_the_newest_is_kept_however_large():
    cache = BoundedCache(3, len)
    first = cache.get(1, lambda: "larger than all")
    assert cache.get(1, lambda: "never made") is first
    cache.get(2, lambda: "also larger")
    assert cache.get(1, lambda: "made again") == "made again"
