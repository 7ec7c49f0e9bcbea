"""Reported versions equal the installed versions."""

from __future__ import annotations

import platform
from importlib.metadata import version

from contactstudy import show_versions
from contactstudy.versions import versions


def test_versions_are_shown(capsys) -> None:
    show_versions()
    printed_versions = dict(line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines())
    assert printed_versions["numpy"] == versions()["numpy"] == version("numpy")
    assert printed_versions["python"] == platform.python_version()
    assert printed_versions["dask"] == version("dask")
