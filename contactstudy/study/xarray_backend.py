"""``xarray.open_dataset`` for the folder of a study, and ``dataset.contact`` for every file that xarray opens.

Before it opens anything, xarray imports what pyproject.toml lists in the group ``xarray.backends``: this module. It is
light, because that is so in every program of an environment with contactstudy.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from xarray.backends import BackendEntrypoint

import contactstudy.analysis.accessor  # noqa: F401  # registers `dataset.contact`

if TYPE_CHECKING:
    import xarray as xr


class StudyBackend(BackendEntrypoint):
    """Opens the folder of a study as :func:`contactstudy.open_study` does; files are opened by xarray's own engines."""

    description = "Open the folder of a study of contactstudy"
    open_dataset_parameters = ("filename_or_obj", "drop_variables", "cells")

    def guess_can_open(self, filename_or_obj: Any) -> bool:
        """Whether it is a folder with a study."""
        return isinstance(filename_or_obj, (str, Path)) and (Path(filename_or_obj) / "study.json").is_file()

    def open_dataset(  # type: ignore[override]  # xarray's own engines name their arguments, too
        self, filename_or_obj: Any, *, drop_variables: str | list[str] | None = None, cells: str = "common"
    ) -> xr.Dataset:
        """Open a study; `cells` is that of :func:`contactstudy.open_study`."""
        from contactstudy.study.opened import open_study

        opened = open_study(filename_or_obj, cells=cells)
        return opened if drop_variables is None else opened.drop_vars(drop_variables, errors="ignore")
