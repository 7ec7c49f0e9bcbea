"""Files of instruments: x3p, rotation, invalid files."""

import zipfile
from pathlib import Path

import numpy as np
import pytest
import x3pio

from contactstudy import ContactStudyError, InvalidInputError
from contactstudy.profiles import measurement_files
from contactstudy.profiles.measurement_files import Heights, read_heights, read_measurement, rotate_heights

X, Y = 2e-6 * np.arange(5), 3e-6 * np.arange(4)
HEIGHTS = 1e-6 * np.random.default_rng(0).normal(size=(5, 4))


def assert_heights(measured_heights: Heights, x=X, y=Y, heights=HEIGHTS) -> None:
    np.testing.assert_allclose(measured_heights.x, x, rtol=1e-12, atol=1e-20)
    np.testing.assert_allclose(measured_heights.y, y, rtol=1e-12, atol=1e-20)
    np.testing.assert_allclose(measured_heights.heights, heights, rtol=1e-12)


def test_x3p_surface_has_heights_of_file(tmp_path: Path) -> None:
    values = HEIGHTS.copy()
    values[2, 1] = np.nan
    x3pio.write(tmp_path / "map.x3p", values.T, x_scale=2e-6, y_scale=3e-6)
    assert_heights(read_heights(tmp_path / "map.x3p"), heights=values)
    x3pio.write(tmp_path / "line.x3p", HEIGHTS[:, :1].T, x_scale=2e-6, y_scale=3e-6)
    is_line = read_heights(tmp_path / "line.x3p")
    assert is_line.y is None
    np.testing.assert_allclose(is_line.heights, HEIGHTS[:, 0])


def test_x3p_profile_contains_even_and_uneven_points(tmp_path: Path) -> None:
    x3pio.Profile.from_array(HEIGHTS[:, 0], x_scale=2e-6).save(tmp_path / "even.x3p")
    uneven_x = np.array([0.0, 1.0, 3.0, 4.0, 6.0]) * 1e-6
    points = np.stack([uneven_x, np.zeros(5), HEIGHTS[:, 0]], axis=1)
    x3pio.Profile.from_points(points).save(tmp_path / "uneven.x3p")
    for name, x in (("even", X), ("uneven", uneven_x)):
        measured_heights = read_heights(tmp_path / f"{name}.x3p")
        assert measured_heights.y is None
        np.testing.assert_allclose(measured_heights.x, x, atol=1e-20)
        np.testing.assert_allclose(measured_heights.heights, HEIGHTS[:, 0])


def test_rotation_moves_heights_with_their_points() -> None:
    """A point at (x, y) moves to its rotated position with its height."""
    measured_heights = Heights(X, Y, HEIGHTS)
    for turn in (0, 90, 180, 270):
        rotated_heights = rotate_heights(measured_heights, turn)
        angle = np.deg2rad(turn)
        for i, j in ((0, 0), (1, 3), (4, 2)):
            x, y = X[i] - X.mean(), Y[j] - Y.mean()
            position = np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y
            nearest_heights = [
                np.abs(axis - axis.mean() - coordinate).argmin()
                for axis, coordinate in zip(rotated_heights[:2], position, strict=True)
            ]
            assert rotated_heights.heights[tuple(nearest_heights)] == HEIGHTS[i, j]
        assert (np.diff(rotated_heights.x) > 0).all()
        assert (np.diff(rotated_heights.y) > 0).all()
    assert_heights(rotate_heights(rotate_heights(measured_heights, 90, mirror=True), 90, mirror=True))


@pytest.mark.parametrize(("turn", "is_line"), [(45, False), (True, False), ("90", False), (90, True)])
def test_invalid_angles_are_rejected(turn: object, is_line: bool) -> None:
    with pytest.raises(InvalidInputError, match="turn = "):
        rotate_heights(Heights(X, None, HEIGHTS[:, 0]) if is_line else Heights(X, Y, HEIGHTS), turn)


def test_unreadable_file_raises(tmp_path: Path) -> None:
    (tmp_path / "broken.x3p").write_bytes(b"PK\x03\x04 no such file")
    with pytest.raises(InvalidInputError, match=r"path = .*broken.x3p"):
        read_heights(tmp_path / "broken.x3p")
    x3pio.write(tmp_path / "later.x3p", HEIGHTS.T, x_scale=2e-6, y_scale=3e-6)
    data = (tmp_path / "later.x3p").read_bytes()
    for name in ("later.x3p", "later.csv"):  # the entries need version 8.4 of the archive's format
        (tmp_path / name).write_bytes(data.replace(b"PK\x01\x02\x14\x03\x14", b"PK\x01\x02\x14\x03\x54"))
        with pytest.raises(InvalidInputError, match=rf"path = .*{name}"):
            read_measurement(tmp_path / name, ("x",), ("height",))
    with pytest.raises(InvalidInputError, match=r"missing.x3p.*can be read"):
        read_heights(tmp_path / "missing.x3p")
    (tmp_path / "pipe.x3p").mkdir()
    with pytest.raises(InvalidInputError, match="not a folder"):
        read_heights(tmp_path / "pipe.x3p")


def test_large_xml_is_rejected_before_unpacking(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(measurement_files, "MAX_XML", 100_000)
    path = tmp_path / "bomb.x3p"
    x3pio.write(path, HEIGHTS.T, x_scale=2e-6, y_scale=3e-6)
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("other.xml", b" " * (measurement_files.MAX_XML + 1))
    monkeypatch.setattr(x3pio, "read", lambda path: pytest.fail("the file is unpacked"))
    with pytest.raises(InvalidInputError, match=rf"other.xml.*{measurement_files.MAX_XML + 1}"):
        read_heights(path)


def test_x3p_without_extra_raises_with_command(tmp_path: Path, monkeypatch) -> None:
    path = tmp_path / "flank.x3p"
    x3pio.write(path, HEIGHTS.T, x_scale=2e-6, y_scale=3e-6)
    monkeypatch.setattr(measurement_files, "find_spec", lambda name: None)
    with pytest.raises(ContactStudyError, match=r'pip install "contactstudy\[measured\]"'):
        read_heights(path)


def test_clouds_and_layers_are_rejected(tmp_path: Path) -> None:
    x3pio.write_points(tmp_path / "cloud.x3p", np.random.default_rng(0).normal(size=(9, 3)))
    with pytest.raises(InvalidInputError, match="cloud of points"):
        read_heights(tmp_path / "cloud.x3p")
    x3pio.write(tmp_path / "two.x3p", np.stack([HEIGHTS.T, HEIGHTS.T]), x_scale=2e-6, y_scale=3e-6)
    with pytest.raises(InvalidInputError, match=r"one layer.*it has 2"):
        read_heights(tmp_path / "two.x3p")


@pytest.mark.parametrize(("name", "package"), [("a.x3p", "x3pio"), ("a.gwy", "SurfaceTopography")])
def test_missing_package_raises_with_command(tmp_path: Path, monkeypatch, name: str, package: str) -> None:
    monkeypatch.setattr(measurement_files, "find_spec", lambda name: None)
    with pytest.raises(ContactStudyError, match=rf'{package}.*pip install "contactstudy\[measured\]"'):
        read_heights(tmp_path / name)
