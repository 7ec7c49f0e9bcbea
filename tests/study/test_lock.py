import json
import os
import socket
import subprocess
import sys

import pytest

from contactstudy.study.errors import LockedError, StoreError
from contactstudy.study.lock import LOCK_NAME, locked, read_lock
from contactstudy.study.process import birth, boot, system


def test_a_second_holder_is_refused_and_told_who(tmp_path):
    who = f"process {os.getpid()} on {socket.gethostname()} since"
    with locked(tmp_path), pytest.raises(LockedError, match=who), locked(tmp_path):
        pass
    assert read_lock(tmp_path) is None


def holder(**changes):
    return {
        "process": os.getpid(),
        "host": socket.gethostname(),
        "system": system(),
        "time": "then",
        "token": "other",
        "boot": boot(),
        "birth": birth(os.getpid()),
    } | changes


def dead_process():
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    return gone.pid


@pytest.mark.parametrize("changes", ["dead", {"birth": "1 ticks"}, {"boot": "another"}])
def test_the_lock_of_a_dead_process_is_taken_over(tmp_path, changes):
    content = holder(**({"process": dead_process()} if changes == "dead" else changes))
    (tmp_path / LOCK_NAME).write_text(json.dumps(content))
    with locked(tmp_path) as message:
        assert "dead run" in message
        assert read_lock(tmp_path)["process"] == os.getpid()
    assert read_lock(tmp_path) is None


@pytest.mark.parametrize(
    "content",
    [
        holder(host="elsewhere", process=1),
        holder(system="another machine or container of the same name", process=2**30, boot="another"),
        holder(),
        "gibberish",
    ],
)
def test_a_lock_that_may_be_alive_is_respected(tmp_path, content):
    (tmp_path / LOCK_NAME).write_text(json.dumps(content))
    with pytest.raises(LockedError, match=r"delete .*run\.lock"), locked(tmp_path):
        pass
    assert (tmp_path / LOCK_NAME).exists()


def test_the_lock_is_released_after_an_error(tmp_path):
    with pytest.raises(ZeroDivisionError), locked(tmp_path):
        raise ZeroDivisionError
    assert read_lock(tmp_path) is None


def test_a_folder_that_is_not_there(tmp_path):
    with pytest.raises(StoreError), locked(tmp_path / "missing"):
        pass
