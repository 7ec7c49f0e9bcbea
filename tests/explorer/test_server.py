"""Server: imports, invalid folders, access by host, origin and token."""

from __future__ import annotations

import gc
import http.client
import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from contactstudy import ContactStudyError, InvalidInputError
from contactstudy.explorer import serve
from contactstudy.study import StudyFileError
from tests.explorer.conftest import find_free_port, needs_panel

pytestmark = needs_panel

IMPORT_SCRIPT = """
import sys
import contactstudy.cli, contactstudy.explorer
slow = {"numpy", "pandas", "xarray", "panel"} & set(sys.modules)
assert slow <= {"numpy"}, slow
"""

SCRIPT_WITHOUT_DASK = """
import sys
sys.modules["dask"] = None
from contactstudy.explorer.cases import open_cases
from contactstudy.explorer.page import Page
page = Page(open_cases(sys.argv[1]))
page.choices[0]["max_pressure"].value = 2
assert ">1.5 GPa<" in page.table.object
page.view()
assert "distributed" not in sys.modules
"""


@pytest.mark.system
def test_page_works_without_dask(folder: Path) -> None:
    subprocess.run([sys.executable, "-c", SCRIPT_WITHOUT_DASK, str(folder)], check=True)


def test_server_imports_no_slow_package() -> None:
    subprocess.run([sys.executable, "-c", IMPORT_SCRIPT], check=True)


def test_folder_without_study_raises(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(StudyFileError, match=r"study\.json"):
        serve(tmp_path, show=False)
    with pytest.raises(StudyFileError, match="nowhere"):
        serve(tmp_path / "nowhere", show=False)
    with pytest.raises(InvalidInputError, match="folder"):
        serve(3, show=False)  # type: ignore[arg-type]
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("content", ["{", "[" * 100_000, json.dumps({"name": "wrong", "base": {"no_such": 1}})])
def test_unreadable_study_raises(tmp_path: Path, content: str) -> None:
    (tmp_path / "study.json").write_text(content)
    with pytest.raises(ContactStudyError, match=r"study\.json"):
        serve(tmp_path, show=False)
    assert gc.isenabled()


@pytest.fixture(scope="module")
def server_port(folder: Path) -> Iterator[tuple[int, str]]:
    """Port and token of a server."""
    port = find_free_port()
    command = [sys.executable, "-m", "contactstudy.cli", "explore", str(folder), "--no-browser"]
    command += ["--port", str(port), "--host", "proxy.example"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            assert server.stdout is not None
            address = urlsplit(server.stdout.readline().split()[0])
            assert address.port == port
            yield port, address.query.removeprefix("token=")
        finally:
            server.terminate()


def send_request(port: int, path: str, **headers: str) -> http.client.HTTPResponse:
    with closing(http.client.HTTPConnection("localhost", port, timeout=200)) as connection:
        connection.request("GET", path, headers=headers)
        response = connection.getresponse()
        response.body = b"" if response.status == 101 else response.read()  # type: ignore[attr-defined]
        return response


WEBSOCKET_HEADERS = {
    "Upgrade": "websocket",
    "Connection": "Upgrade",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "A" * 22 + "==",
}


@pytest.mark.system
def test_server_requires_known_host_and_token(server_port: tuple[int, str]) -> None:
    port, token = server_port
    cookie = {"Cookie": f"contactstudy-{port}={token}"}
    allowed_hosts = (f"localhost:{port}", "localhost:9999", "127.0.0.1:1", "[::1]:5006", "LOCALHOST", "proxy.example")
    for host in allowed_hosts:
        assert send_request(port, "/", Host=host, **cookie).status == 200, host
    for host in ("rebound.example", f"rebound.example:{port}", "localhost.example", "192.168.0.7", "", "[::1"):
        for path in ("/", f"/?token={token}", "/ws"):
            assert send_request(port, path, Host=host, **cookie).status == 403, (host, path)
    for headers in ({}, {"Cookie": f"contactstudy-{port}=wrong"}, {"Cookie": "other=1"}):
        for path in ("/", "/?token=wrong", "/ws", "/static/js/bokeh.min.js"):
            assert send_request(port, path, Host=f"localhost:{port}", **headers).status == 403, (headers, path)
    response = send_request(port, f"/?token={token}", Host=f"localhost:{port}")
    assert (response.status, response.headers["Location"]) == (302, "/")
    assert response.headers["Set-Cookie"].startswith(cookie["Cookie"])
    assert "HttpOnly" in response.headers["Set-Cookie"]


@pytest.mark.system
def test_websocket_requires_same_origin(server_port: tuple[int, str]) -> None:
    port, token = server_port
    cookie = {"Cookie": f"contactstudy-{port}={token}"}
    for host, origin in (("localhost:9999", "http://rebound.example"), ("rebound.example", "http://rebound.example")):
        assert send_request(port, "/ws", Host=host, Origin=origin, **cookie, **WEBSOCKET_HEADERS).status == 403
    forwarded_headers = {"Host": "localhost:9999", **cookie}
    page = send_request(port, "/", **forwarded_headers).body.decode()  # type: ignore[attr-defined]
    session = page.partition('"token":"')[2].partition('"')[0]
    protocol = {"Origin": "http://localhost:9999", "Sec-WebSocket-Protocol": f"bokeh, {session}"}
    assert send_request(port, "/ws", **forwarded_headers, **protocol, **WEBSOCKET_HEADERS).status == 101
    assert send_request(port, "/ws", Host="localhost:9999", **protocol, **WEBSOCKET_HEADERS).status == 403
