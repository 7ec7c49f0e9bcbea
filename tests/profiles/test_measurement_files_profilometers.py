"""Files of profilometers, written by SurfaceTopography."""

import logging
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from contactstudy import InvalidInputError
from contactstudy.profiles.measurement_files import read_heights
from tests.profiles.test_measurement_files_columns import FOREIGN_FILES

X, Y = 2e-6 * np.arange(5), 3e-6 * np.arange(4)
HEIGHTS = 1e-6 * np.random.default_rng(0).normal(size=(5, 4))


@pytest.fixture(scope="module", autouse=True)
def package() -> ModuleType:
    """SurfaceTopography, which takes seconds to import: only the process of these tests imports it."""
    return pytest.importorskip("SurfaceTopography", reason="the extra `measured` is not installed")


@pytest.mark.parametrize(("unit", "metres"), [("um", 1e-6), ("mm", 1e-3), ("nm", 1e-9)])
def test_profilometer_map_in_any_unit_equals_heights(
    package: ModuleType, tmp_path: Path, unit: str, metres: float
) -> None:
    """GWY files contain metres; the text of `to_matrix` contains the given unit."""
    sizes = (X.size * 2e-6 / metres, Y.size * 3e-6 / metres)
    topography = package.Topography(HEIGHTS / metres, sizes, unit=unit)
    for name in ("map.gwy", "map.asc"):
        write = topography.to_gwy if name.endswith("gwy") else topography.to_matrix
        write(str(tmp_path / name))
        measured_heights = read_heights(tmp_path / name)
        for values, expected in zip(measured_heights, (X, Y, HEIGHTS), strict=True):
            np.testing.assert_allclose(values, expected, rtol=1e-12, atol=1e-20)


def test_missing_points_are_nan(package: ModuleType, tmp_path: Path) -> None:
    values = np.ma.masked_array(HEIGHTS, mask=False)
    values.mask[1, 2] = True
    package.Topography(values, (10e-6, 12e-6), unit="m").to_gwy(str(tmp_path / "map.gwy"))
    measured_heights = read_heights(tmp_path / "map.gwy").heights
    assert np.argwhere(np.isnan(measured_heights)).tolist() == [[1, 2]]


def test_line_scan_requires_unit(package: ModuleType, tmp_path: Path) -> None:
    lines = [f"{1e6 * x:.3f} {1e6 * height:.9f}" for x, height in zip(X, HEIGHTS[:, 0], strict=True)]
    (tmp_path / "scan.xyz").write_text("\n".join(lines))
    with pytest.raises(InvalidInputError, match=r"unit of .*scan.xyz = None"):
        read_heights(tmp_path / "scan.xyz")
    package.NonuniformLineScan(1e6 * X, 1e6 * HEIGHTS[:, 0], unit="um").to_netcdf(str(tmp_path / "scan.cdf"))
    measured_heights = read_heights(tmp_path / "scan.cdf")
    assert measured_heights.y is None
    np.testing.assert_allclose(measured_heights.x, X, atol=1e-18)
    np.testing.assert_allclose(measured_heights.heights, HEIGHTS[:, 0], rtol=1e-9)


@pytest.mark.parametrize("name", ["broken.plux", "broken.sur", "broken.opd"])
def test_unreadable_file_raises(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"PK\x03\x04 no such file")
    with pytest.raises(InvalidInputError, match=f"path = .*{name}"):
        read_heights(tmp_path / name)


def test_file_without_a_unit_is_rejected(package: ModuleType, tmp_path: Path) -> None:
    package.Topography(HEIGHTS, (1.0, 1.0)).to_matrix(str(tmp_path / "map.asc"))
    with pytest.raises(InvalidInputError, match=r"unit of .*map.asc = None: must be a unit of length"):
        read_heights(tmp_path / "map.asc")


@pytest.mark.parametrize(
    ("name", "kind", "message"),
    [
        ("a.png", "picture", "a picture"),
        ("a.prf", "unknown", "its format is unknown: export it as x3p"),
    ],
)
def test_unknown_format_is_rejected(tmp_path: Path, capsys, name: str, kind: str, message: str) -> None:
    (tmp_path / name).write_bytes(10 * FOREIGN_FILES[kind][0])
    with pytest.raises(InvalidInputError, match=rf"columns as text.*formats of SurfaceTopography; .*{message}"):
        read_heights(tmp_path / name)
    assert logging.getLogger("igor2").hasHandlers()
    assert capsys.readouterr().err == ""
