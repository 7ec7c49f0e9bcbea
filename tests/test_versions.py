"""Versions are those that are installed."""

from __future__ import annotations

import platform
from importlib.metadata import version

from contactstudy import show_versions
from contactstudy.versions import versions


def test_versions_are_shown(capsys) -> None:
    show_versions()
    shown = dict(line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines())
    assert shown["numpy"] == versions()["numpy"] == version("numpy")
    assert shown["python"] == platform.python_version()
    assert shown["dask"] == version("dask")
