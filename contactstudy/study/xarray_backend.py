"""``xarray.open_dataset`` for the folder of a study, and ``dataset.contact`` for every file that xarray opens.

Before opening a file, xarray imports all modules of the group ``xarray.backends`` in pyproject.toml. This module is
light, because every program of an environment with contactstudy imports the module.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from xarray.backends import BackendEntrypoint

import_module("contactstudy.accessor")  # registers `dataset.contact`; by name, because the accessor imports the study

if TYPE_CHECKING:
    import xarray as xr


class StudyBackend(BackendEntrypoint):
    """Opens the folder of a study as :func:`contactstudy.open_study` does; xarray's engines open files."""

    description = "Open the folder of a study of contactstudy"
    open_dataset_parameters = ("filename_or_obj", "drop_variables", "cells")

    def guess_can_open(self, filename_or_obj: Any) -> bool:
        """Whether the argument is a folder with a study."""
        return isinstance(filename_or_obj, (str, Path)) and (Path(filename_or_obj) / "study.json").is_file()

    def open_dataset(  # type: ignore[override]  # xarray's engines name their arguments, too
        self, filename_or_obj: Any, *, drop_variables: str | list[str] | None = None, cells: str = "common"
    ) -> xr.Dataset:
        """Open a study; for `cells` see :func:`contactstudy.open_study`."""
        from contactstudy.study.dataset import study_dataset

        dataset = study_dataset(filename_or_obj, cells=cells)
        return dataset if drop_variables is None else dataset.drop_vars(drop_variables, errors="ignore")
