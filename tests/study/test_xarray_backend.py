"""xarray opens the folder of a study as contactstudy does, and leaves files to its own engines."""

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
    place = tmp_path_factory.mktemp("study")
    run_study(small_study(), place, workers=0, solver=solve_fake, progress=False)
    return place


@pytest.mark.parametrize("chunks", [None, {}])
def test_a_folder_opens_as_a_study(folder: Path, chunks: dict[str, int] | None) -> None:
    xr.testing.assert_identical(xr.open_dataset(folder, chunks=chunks).load(), open_study(folder).load())


def test_backend_arguments_match_open_study(folder: Path) -> None:
    own = xr.open_dataset(str(folder), engine="contactstudy", cells="original", drop_variables="von_mises")
    assert "x_index" in own.dims
    assert "von_mises" not in own
    with pytest.raises(InvalidInputError, match="cells"):
        xr.open_dataset(folder, cells="each")


def test_backend_ignores_files_and_other_folders(folder: Path, tmp_path: Path) -> None:
    case = next((folder / "batches").glob("*.nc"))
    with xr.open_dataset(case) as opened:
        assert Path(opened.encoding["source"]) == case
        assert opened.sizes["case"] == 4
    with pytest.raises((OSError, ValueError)):
        xr.open_dataset(tmp_path)
