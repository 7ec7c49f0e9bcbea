"""Invalid or malicious content of folders, files and studies raises a package error or has no effect."""

import json
import os

import pytest

from contactstudy import checks
from contactstudy.cli import main
from contactstudy.errors import ContactStudyError, InvalidInputError
from contactstudy.study import Study, StudyFileError, open_study, run_study
from contactstudy.study.case_setup import build_setup
from tests.small_study import BASE, case_id, format_toml, small_study
from tests.stand_in_solver import solve_fake


def run(study, folder):
    return run_study(study, folder, workers=0, solver=solve_fake, progress=False)


@pytest.mark.parametrize("content", ["[]", "3", '{"name": 3}', '{"nmae": "a"}', "[" * 100_000, "1" * 5000])
def test_invalid_study_json_raises(tmp_path, content):
    (tmp_path / "study.json").write_text(content)
    with pytest.raises(StudyFileError, match=r"study\.json"):
        open_study(tmp_path)


@pytest.mark.parametrize("content", ["[sweep]\nfriction = [%s]", "[base]\nradius = %s"])
@pytest.mark.parametrize("number", ["1" * 400, "1" * 5000, "1e-300", "1e300"])
def test_numbers_out_of_range_raise(tmp_path, content, number):
    path = tmp_path / "s.toml"
    path.write_text(content % number)
    with pytest.raises(ContactStudyError, match=r"s\.toml|friction|radius"):
        Study.from_toml(path)


def test_deep_nesting_raises(tmp_path):
    nested_table = "{kind='sum',terms=[" * 400 + "'cylinder'" + "]}" * 400
    path = tmp_path / "s.toml"
    path.write_text(f"[base]\nprofile = {nested_table}")
    with pytest.raises(ContactStudyError, match="nested"):
        Study.from_toml(path)
    profile = "cylinder"
    for _ in range(30):
        profile = {"kind": "sum", "terms": [profile]}
    with pytest.raises(InvalidInputError, match="nested less deeply"):
        case_id({"profile": profile})


def test_text_above_largest_size_raises(study, tmp_path, monkeypatch):
    path = tmp_path / "s.toml"
    path.write_text(format_toml(study))
    run(study, tmp_path)
    monkeypatch.setattr(checks, "MAX_TEXT", 100)
    for read in (lambda: Study.from_toml(path), lambda: open_study(tmp_path)):
        with pytest.raises(StudyFileError, match="more than"):
            read()


def test_too_many_points_raise():
    with pytest.raises(InvalidInputError, match="at most 100000"):
        case_id({"field_x_over_a": {"start": 0, "stop": 1, "count": 10**9}})


@pytest.mark.parametrize("changes", [{"max_pressure": 1e-49}, {"load": 1e49, "max_pressure": None}, {"young": 1e-49}])
def test_extreme_case_is_skipped(changes):
    base = {name: value for name, value in (BASE | {"e_over_a": 1.0} | changes).items() if value is not None}
    plan = small_study(base=base, sweep={"friction": [0.0]}).plan()
    assert [bool(case.reason) for case in plan] == [True]


def test_message_contains_missing_alternatives():
    with pytest.raises(InvalidInputError, match=r"e_over_a, end_distance = 'none': must be given as one of the two"):
        build_setup(BASE)


@pytest.mark.parametrize("call", [run_study, Study.from_mapping])
@pytest.mark.parametrize("argument", ["x", None, 3])
def test_invalid_study_arguments_raise(call, argument):
    with pytest.raises(InvalidInputError, match="study"):
        call(argument)


def test_invalid_folder_raises():
    with pytest.raises(InvalidInputError, match="folder = None"):
        open_study(None)


@pytest.mark.parametrize("arguments", [("collect",), ("export",)])
def test_folder_as_study_file_raises(study, tmp_path, arguments, capsys):
    run(study, tmp_path)
    assert main([*arguments, str(tmp_path), "--out", str(tmp_path)]) == 2
    assert "it is a folder" in capsys.readouterr().err


def test_pipe_as_study_raises(tmp_path):
    os.mkfifo(tmp_path / "study.json")
    with pytest.raises(StudyFileError, match="not a regular file"):
        open_study(tmp_path)


def test_stored_study_with_file_raises(study, tmp_path):
    run(study, tmp_path)
    content = json.loads((tmp_path / "study.json").read_text())
    content["base"]["profile"] = {"kind": "sum", "terms": [{"kind": "measured", "file": "/etc/passwd"}]}
    (tmp_path / "study.json").write_text(json.dumps(content))
    with pytest.raises(StudyFileError, match=r"profile\.file = '/etc/passwd'"):
        open_study(tmp_path)


@pytest.mark.parametrize("name", ["run.log", "run.lock", "batches"])
def test_links_in_foreign_folder_raise(study, tmp_path, name):
    folder, target = tmp_path / "out", tmp_path / "target"
    folder.mkdir()
    if name == "batches":
        target.mkdir()
    (folder / name).symlink_to(target)
    with pytest.raises(ContactStudyError, match=name.replace(".", r"\.")):
        run(study, folder)
    assert not target.exists() or not list(target.iterdir())


def test_written_files_replace_links(tmp_path):
    folder, target, names = tmp_path / "out", tmp_path / "target", ("summary.nc", "edge_effect.png", "study.json")
    folder.mkdir()
    for name in names:
        (folder / name).symlink_to(target)
    path = tmp_path / "small.toml"
    path.write_text(format_toml(small_study()))
    assert main(["run", str(path), "--out", str(folder), "--workers", "0"], solver=solve_fake) == 0
    assert not target.exists()
    assert not any((folder / name).is_symlink() for name in names)


@pytest.mark.parametrize("name", ["pipe.csv", "pipe.nc"])
def test_measured_profile_from_pipe_raises(tmp_path, name):
    os.mkfifo(tmp_path / name)
    with pytest.raises(InvalidInputError, match="a regular file"):
        case_id({"profile": {"kind": "measured", "file": str(tmp_path / name)}})


def test_measured_profile_of_too_many_points_raises():
    points = [1e-8 * index for index in range(50_001)]
    with pytest.raises(InvalidInputError, match="at most 50000 points"):
        case_id({"profile": {"kind": "measured", "positions": points, "drops": points}})


def test_byte_order_mark_is_accepted(tmp_path):
    path = tmp_path / "marked.toml"
    path.write_text("\ufeff" + format_toml(small_study()), encoding="utf-8")
    assert len(Study.from_toml(path).plan()) == 4
