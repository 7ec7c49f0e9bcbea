"""What stands in folders, files and studies by mistake or malice ends in an error with a name, or does no harm."""

import json
import os
import subprocess
import sys

import pytest

from contactstudy.cli import main
from contactstudy.errors import ContactStudyError, InvalidInputError
from contactstudy.study import LockedError, Study, StudyFileError, open_study, run_study
from contactstudy.study.folder import Folder
from contactstudy.study.identity import case_id
from contactstudy.study.lock import LOCK_NAME, locked
from contactstudy.study.manifest import Manifest, as_line
from contactstudy.study.process import alive, birth
from contactstudy.study.setup import build_setup
from tests.small_study import BASE, as_toml, identity, small_study
from tests.stand_in_solver import solve_fake


def run(study, folder):
    return run_study(study, folder, workers=0, solver=solve_fake, progress=False)


ENTRY = {"name": "", "size": 1, "changed": 1, "id": "x", "run": {}, "scalars": {}}


@pytest.mark.parametrize(
    "change",
    [
        "text",
        None,
        [],
        {"id": None},
        {"run": None},
        {"run": []},
        {"scalars": {"peak_pressure": "high"}},
        {"size": "large"},
        {"name": 3},
        {"run": {"level": "everything"}},
    ],
)
def test_wrong_entries_of_the_manifest_do_no_harm(study, tmp_path, change):
    run(study, tmp_path)
    path = Folder(tmp_path).case_path(identity(e_over_a=1, friction=0.1))
    state = path.stat()
    entry = change
    if isinstance(change, dict):
        entry = ENTRY | {"name": path.name, "size": state.st_size, "changed": state.st_mtime_ns} | change
    with open(tmp_path / "manifest.jsonl", "a") as file:
        file.write("\n" + as_line(entry))
    if change == {"run": {"level": "everything"}}:  # sound, but of another case
        assert run(study, tmp_path).solved == 1
    else:
        assert run(study, tmp_path).counts == {"ok": 4}
    assert open_study(tmp_path)["peak_pressure"].min() > 0


def test_a_digit_of_the_manifest_that_changes_changes_no_number(study, tmp_path):
    """It was taken for what the case's file says."""
    run(study, tmp_path)
    whole = open_study(tmp_path).load()
    path = tmp_path / "manifest.jsonl"
    data = path.read_bytes()
    at = data.index(b'"peak_pressure": ') + len(b'"peak_pressure": ')
    path.write_bytes(data[:at] + (b"2" if data[at : at + 1] != b"2" else b"3") + data[at + 1 :])
    assert open_study(tmp_path).load().identical(whole)
    assert run(study, tmp_path).counts == {"ok": 4}
    assert open_study(tmp_path).load().identical(whole)


def test_the_manifest_grows_by_what_is_new(tmp_path):
    path = tmp_path / "manifest.jsonl"
    first = Manifest(path)
    first.put("a.nc", 1, 2, "a", {"level": "fields"}, {"load": 1.0})
    first.save()
    before = path.read_bytes()
    second = Manifest(path)
    second.put("b.nc", 1, 2, "b", {}, {})
    second.save()
    assert path.read_bytes().startswith(before)
    assert len(path.read_bytes()) < len(before) + 150
    assert (Manifest(path).get("a.nc")["id"], Manifest(path).get("b.nc")["id"]) == ("a", "b")


def test_the_manifest_forgets_what_is_outdated_and_outlives_a_torn_line(tmp_path):
    path = tmp_path / "manifest.jsonl"
    manifest = Manifest(path)
    for number in range(300):
        manifest.put("a.nc", number, 2, "a", {}, {})
        manifest.save()
    assert path.read_text().count("\n") < 120
    with open(path, "a") as file:
        file.write('\n{"name": "torn')
    manifest = Manifest(path)
    manifest.put("b.nc", 1, 2, "b", {}, {})
    manifest.save()
    assert Manifest(path).get("a.nc")["size"] == 299
    assert Manifest(path).get("b.nc")["id"] == "b"


def test_dangling_links_pipes_and_folders_among_the_cases_are_set_aside(study, tmp_path):
    run(study, tmp_path)
    (tmp_path / "cases" / "link.nc").symlink_to(tmp_path / "nowhere")
    os.mkfifo(tmp_path / "cases" / "pipe.nc")
    known = Folder(tmp_path).case_path(identity(e_over_a=1, friction=0.1))
    known.unlink()
    known.symlink_to(tmp_path / "nowhere")
    place = Folder(tmp_path).case_path(identity(e_over_a=0, friction=0.1))
    place.unlink()
    place.mkdir()
    assert run(study, tmp_path).solved == 2
    aside = {path.name for path in (tmp_path / "set-aside").iterdir()}
    assert aside == {"link.nc", "pipe.nc", known.name, place.name}


@pytest.mark.parametrize("content", ["[]", "3", '{"name": 3}', '{"nmae": "a"}', "[" * 100_000, "1" * 5000])
def test_a_study_json_that_is_no_study(tmp_path, content):
    (tmp_path / "study.json").write_text(content)
    with pytest.raises(StudyFileError, match=r"study\.json"):
        open_study(tmp_path)


@pytest.mark.parametrize("content", ["[sweep]\nfriction = [%s]", "[base]\nradius = %s"])
@pytest.mark.parametrize("number", ["1" * 400, "1" * 5000, "1e-300", "1e300"])
def test_numbers_beyond_arithmetic(tmp_path, content, number):
    path = tmp_path / "s.toml"
    path.write_text(content % number)
    with pytest.raises(ContactStudyError, match=r"s\.toml|friction|radius"):
        Study.from_toml(path)


def test_nesting_beyond_sense(tmp_path):
    deep = "{kind='sum',terms=[" * 400 + "'cylinder'" + "]}" * 400
    path = tmp_path / "s.toml"
    path.write_text(f"[base]\nprofile = {deep}")
    with pytest.raises(ContactStudyError, match="nested"):
        Study.from_toml(path)
    profile = "cylinder"
    for _ in range(30):
        profile = {"kind": "sum", "terms": [profile]}
    with pytest.raises(InvalidInputError, match="nested less deeply"):
        case_id({"profile": profile})


def test_points_beyond_counting():
    with pytest.raises(InvalidInputError, match="at most 100000"):
        case_id({"field_x_over_a": {"start": 0, "stop": 1, "count": 10**9}})


@pytest.mark.parametrize("changes", [{"max_pressure": 1e-49}, {"load": 1e49, "max_pressure": None}, {"young": 1e-49}])
def test_extreme_cases_are_skipped_and_stop_no_plan(changes):
    base = {name: value for name, value in (BASE | {"e_over_a": 1.0} | changes).items() if value is not None}
    plan = small_study(base=base, sweep={"friction": [0.0]}).plan()
    assert [bool(case.reason) for case in plan.cases] == [True]


def test_a_missing_one_of_two_is_said_in_words():
    with pytest.raises(InvalidInputError, match=r"e_over_a, end_distance = 'none': must be given as one of the two"):
        build_setup(BASE)


@pytest.mark.parametrize("call", [run_study, Study.from_mapping])
@pytest.mark.parametrize("wrong", ["x", None, 3])
def test_what_is_no_study(call, wrong):
    with pytest.raises(InvalidInputError, match="study"):
        call(wrong)


def test_what_is_no_folder():
    with pytest.raises(InvalidInputError, match="folder = None"):
        open_study(None)


@pytest.mark.parametrize("arguments", [("collect",), ("export",)])
def test_a_folder_in_place_of_a_file(study, tmp_path, arguments, capsys):
    run(study, tmp_path)
    assert main([*arguments, str(tmp_path), "--out", str(tmp_path)]) == 2
    assert "it is a folder" in capsys.readouterr().err


@pytest.mark.parametrize(
    "content",
    ["[]", "{}", '{"process": "1", "host": 3}', '{"process": -1}', '{"process": 1e999}', "[" * 100_000, "1" * 5000],
)
def test_odd_locks_are_respected(tmp_path, content):
    (tmp_path / LOCK_NAME).write_text(content)
    with pytest.raises(LockedError), locked(tmp_path):
        pass


def test_a_pipe_as_lock(tmp_path):
    os.mkfifo(tmp_path / LOCK_NAME)
    with pytest.raises(LockedError), locked(tmp_path):
        pass


def test_the_holder_of_a_lock_is_not_known_by_the_clock(tmp_path, monkeypatch):
    """A step of the clock, which moves every start time that is counted from it, does not make a living run dead."""
    import psutil

    with locked(tmp_path):
        monkeypatch.setattr(psutil.Process, "create_time", lambda self: 30.0)
        with pytest.raises(LockedError), locked(tmp_path):
            pass


def test_a_zombie_holds_no_lock(tmp_path):
    process = subprocess.Popen([sys.executable, "-c", ""])
    os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)  # ended, but not waited for
    assert not alive(process.pid)
    with locked(tmp_path):
        content = json.loads((tmp_path / LOCK_NAME).read_text())
    (tmp_path / LOCK_NAME).write_text(json.dumps(content | {"process": process.pid}))
    with locked(tmp_path) as message:
        assert "dead run" in message
    process.wait()


@pytest.mark.parametrize("pid", [-1, 0, 2**30, 10**400])
def test_numbers_that_are_no_process(pid):
    assert birth(pid) is None


@pytest.mark.parametrize("name", ["pipe.csv", "pipe.nc"])
def test_a_measured_profile_from_a_pipe(tmp_path, name):
    os.mkfifo(tmp_path / name)
    with pytest.raises(InvalidInputError, match="a regular file"):
        case_id({"profile": {"kind": "measured", "file": str(tmp_path / name)}})


def test_a_measured_profile_of_more_points_than_results_can_keep():
    points = [1e-8 * number for number in range(50_001)]
    with pytest.raises(InvalidInputError, match="no more than 50000 points"):
        case_id({"profile": {"kind": "measured", "positions": points, "drops": points}})


def test_a_byte_order_mark(tmp_path):
    path = tmp_path / "marked.toml"
    path.write_text("\ufeff" + as_toml(small_study()), encoding="utf-8")
    assert len(Study.from_toml(path).plan().cases) == 4
