"""The backend of xarray opens the folder of a study as `open_study` does, and no files."""

from __future__ import annotations

from pathlib import Path

import pytest
import xarray as xr

from contactstudy import InvalidInputError, open_study
from contactstudy.study import run_study
from tests.small_study import small_study
from tests.stand_in_solver import solve_fake


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("study")
    run_study(small_study(), path, workers=0, solver=solve_fake, progress=False)
    return path


@pytest.mark.parametrize("chunks", [None, {}])
def test_open_dataset_equals_open_study(folder: Path, chunks: dict[str, int] | None) -> None:
    xr.testing.assert_identical(xr.open_dataset(folder, chunks=chunks).load(), open_study(folder).load())


def test_backend_arguments_match_open_study(folder: Path) -> None:
    study_dataset = xr.open_dataset(str(folder), engine="contactstudy", cells="original", drop_variables="von_mises")
    assert "x_index" in study_dataset.dims
    assert "von_mises" not in study_dataset
    with pytest.raises(InvalidInputError, match="cells"):
        xr.open_dataset(folder, cells="each")


def test_backend_ignores_files_and_other_folders(folder: Path, tmp_path: Path) -> None:
    case = next((folder / "batches").glob("*.nc"))
    with xr.open_dataset(case) as dataset:
        assert Path(dataset.encoding["source"]) == case
        assert dataset.sizes["case"] == 4
    with pytest.raises((OSError, ValueError)):
        xr.open_dataset(tmp_path)
