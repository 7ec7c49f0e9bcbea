"""Locks, damaged files and joined batches of the folder of a study."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from contactstudy.checks import TEMPORARY_SUFFIX, writing
from contactstudy.errors import InvalidInputError
from contactstudy.study import LockedError, StoreError, StudyFileError, load_case, open_study, run_study
from contactstudy.study import folder as module
from contactstudy.study.batches import batch_paths, find_damage, join_batches, read_batch, write_batch
from contactstudy.study.files import write_text
from contactstudy.study.folder import Folder, Share, select_latest
from contactstudy.study.settings import RunSettings
from contactstudy.study.worker import Task, batch_of_case
from tests.small_study import identity, small_study
from tests.stand_in_solver import solve_fake
from tests.study.conftest import ROOT, make_planned_case


def run(study, folder, **options):
    return run_study(study, folder, **({"workers": 0, "solver": solve_fake, "progress": False} | options))


def make_failed_batch(index, parameters, *, run=1, message="WindowError: narrow", warnings=()):
    """Batch of a case without results."""
    case = make_planned_case(index, parameters)
    return batch_of_case(Task(cases=(), folder="", run=run), case, "failed", message, warnings_of_case=warnings)


def make_batch(count, **options):
    """Batch of cases without results."""
    return join_batches([make_failed_batch(index, {"friction": 0.1}, **options) for index in range(count)])


def test_lock_error_contains_holder(tmp_path):
    folder = Folder(tmp_path)
    with folder.locked():
        with pytest.raises(LockedError, match=f"process {os.getpid()} on "), folder.locked():
            pass
        assert [f"process {os.getpid()}" in holder for holder in folder.holders] == [True]
    assert folder.holders == []
    with folder.locked():
        pass


def test_share_lock_excludes_run_and_same_share(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "RUN", RunSettings(share_seconds=0.1))
    whole_folder, first_share, second_share, third_share = (
        Folder(tmp_path),
        *(Folder(tmp_path, Share(number, 3)) for number in (1, 2, 3)),
    )
    with first_share.locked(), second_share.locked():
        for folder in (first_share, whole_folder):
            with pytest.raises(LockedError), folder.locked():
                pass
    with whole_folder.locked(), pytest.raises(LockedError), third_share.locked():
        pass


def test_killed_process_releases_lock(tmp_path):
    code = (
        "import os, signal, sys\n"
        "from contactstudy.study.folder import Folder\n"
        "with Folder(sys.argv[1]).locked():\n    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path)], cwd=ROOT, check=False)
    assert (tmp_path / "run.lock").exists()
    with Folder(tmp_path).locked():
        pass


def test_pipe_as_lock_raises(tmp_path):
    os.mkfifo(tmp_path / "run.lock")
    with pytest.raises(LockedError, match="not a regular file"), Folder(tmp_path).locked():
        pass


def test_batch_round_trip(tmp_path):
    write_batch(tmp_path, "a", make_batch(3, message="Größe", warnings=["one"]))
    (path,) = batch_paths(tmp_path)
    assert find_damage(path) == ""
    cases = read_batch(path, parameters=True).cases
    assert cases.index.tolist() == [f"{index:064x}" for index in range(3)]
    assert cases["message"].tolist() == ["Größe"] * 3
    assert cases["warnings"].tolist() == ['["one"]'] * 3
    assert cases["parameters"].tolist() == ['{"friction": 0.1}'] * 3


def test_batch_stores_parameter_tables_once(tmp_path):
    profiles = [{"kind": "measured", "drops": [1e-6] * 1000}, {"kind": "cylinder"}]
    parameters = [{"young": 1.0, "profile": profiles[index % 2], "friction": 0.1 * index} for index in range(40)]
    batch = join_batches([make_failed_batch(index, entry) for index, entry in enumerate(parameters)])
    write_batch(tmp_path, "a", batch)
    (path,) = batch_paths(tmp_path)
    assert read_batch(path, parameters=True).cases["parameters"].equals(batch.cases["parameters"])
    assert path.stat().st_size < 60_000


@pytest.mark.parametrize("change", [lambda data: data[:-10], lambda data: b"", lambda data: b"x" + data[1:]])
def test_damage_is_detected(tmp_path, change):
    write_batch(tmp_path, "a", make_batch(2))
    (path,) = batch_paths(tmp_path)
    path.write_bytes(change(path.read_bytes()))
    assert "checksum" in find_damage(path)


def test_small_batches_are_joined(tmp_path):
    folder = Folder(tmp_path)
    folder.create()
    for index in range(20):
        write_batch(folder.batches, f"a{index}", make_failed_batch(index, {}))
        folder.compact()
    assert len(batch_paths(folder.batches)) < 10
    folder.compact(at_end=True)
    (path,) = batch_paths(folder.batches)
    assert len(folder.results().cases) == len(read_batch(path)) == 20


def test_latest_run_replaces_results(tmp_path):
    batch = join_batches([make_batch(2), make_batch(2, run=3, message="later"), make_batch(2, run=2)])
    assert select_latest(batch).cases["message"].tolist() == ["later"] * 2
    assert select_latest(batch).cases["run"].tolist() == [3, 3]


@pytest.mark.parametrize("statuses", [("ok", "failed"), ("failed", "ok")])
def test_failed_group_replaces_films_of_the_same_run(statuses):
    batches = [make_batch(1) for _ in statuses]
    for batch, status in zip(batches, statuses, strict=True):
        batch.cases["status"] = status
    assert select_latest(join_batches(batches)).cases["status"].tolist() == ["failed"]


def test_joined_batches_have_equal_results(tmp_path, monkeypatch):
    study = small_study(sweep={"e_over_a": [0.0, 1.0, 2.0], "friction": [0.0, 0.1]})
    for name, batch_cases in (("one", 2**13), ("many", 1)):
        monkeypatch.setattr(module, "RUN", RunSettings(batch_cases=batch_cases))
        for index in (1, 2, 3):
            run(study, tmp_path / name, share=(index, 3))
        run(study, tmp_path / name)
    single_batch, many_batches = (open_study(tmp_path / name).drop_vars("seconds").load() for name in ("one", "many"))
    assert len(batch_paths(tmp_path / "one" / "batches")) == 1 < len(batch_paths(tmp_path / "many" / "batches"))
    assert single_batch.identical(many_batches)


@pytest.mark.parametrize("schema", [1, None])
def test_folder_of_other_schema_raises(study, tmp_path, schema):
    run(study, tmp_path)
    content = json.loads((tmp_path / "study.json").read_text())
    (tmp_path / "study.json").write_text(json.dumps(content | {"schema": schema}))
    with pytest.raises(StudyFileError, match=f"schema = {schema}: must be 2"):
        open_study(tmp_path)


def test_failed_write_keeps_previous_file(tmp_path):
    path = tmp_path / "a.txt"
    write_text(path, "before")

    def write_and_fail():
        with writing(path) as temporary_path:
            temporary_path.write_text("half")
            raise OSError("no space")

    with pytest.raises(StoreError, match="no space"):
        write_and_fail()
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_pipe_without_reader_raises(tmp_path):
    os.mkfifo(tmp_path / "report.html")
    with pytest.raises(StoreError, match=r"report\.html"), writing(tmp_path / "report.html"):
        pass


def test_cleaning_removes_only_unfinished_files(study, tmp_path):
    run(study, tmp_path)
    unfinished_path = tmp_path / "batches" / f"ab.0123456789ab{TEMPORARY_SUFFIX}"
    unfinished_path.write_text("half")
    foreign_path = tmp_path / f"download{TEMPORARY_SUFFIX}"
    foreign_path.write_text("mine")
    run(study, tmp_path)
    assert not unfinished_path.exists()
    assert foreign_path.exists()


def test_loaded_case_equals_solver_result(study, tmp_path):
    run(study, tmp_path)
    case = load_case(tmp_path, identity(e_over_a=1.0, friction=0.1))
    assert case["pressure"].dims == ("x", "y")
    assert np.isscalar(case["peak_pressure"].item())
    with pytest.raises(InvalidInputError, match="case_id = 'none'"):
        load_case(tmp_path, "none")
