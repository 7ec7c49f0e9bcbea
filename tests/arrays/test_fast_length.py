"""The same lengths as those of the library that takes the transforms."""

from __future__ import annotations

import pytest
from scipy.fft import next_fast_len

from contactstudy.arrays.fast_length import fast_length


@pytest.mark.parametrize("real", [False, True])
def test_lengths_are_those_of_the_transforms(real: bool) -> None:
    for least in (*range(1, 3000), 65_537, 99_991, 1_000_003):
        assert fast_length(least, real=real) == next_fast_len(least, real=real)
