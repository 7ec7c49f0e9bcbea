"""Headless Chromium without a network, for the explorer's pages."""

from __future__ import annotations

import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

BROWSER_OPTIONS = (
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync"),
)

SECONDS = 200
"""Longest wait for a page, also on a busy machine."""


def find_chromium() -> str | None:
    """Path of Chromium; None if it is not installed."""
    return shutil.which("chromium") or shutil.which("chromium-browser")


def open_served(page: Any, address: str) -> None:
    """Open the page of a server, and wait for its figures."""
    deadline = time.monotonic() + SECONDS
    while time.monotonic() < deadline:
        with suppress(Exception):
            page.goto(address)
            break
        time.sleep(0.1)
    page.wait_for_selector("canvas")


@contextmanager
def browser(width: int, height: int, *, local_only: bool = True) -> Iterator[Any]:
    """Page of a new browser; requests to other hosts are refused, and listed in `page.refused`."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as profile:
        context = playwright.chromium.launch_persistent_context(
            profile,
            executable_path=find_chromium(),
            headless=True,
            args=list(BROWSER_OPTIONS),
            viewport={"width": width, "height": height},
        )
        page = context.new_page()
        page.set_default_timeout(SECONDS * 1000)
        page.refused = []

        def filter_request(route: Any) -> None:
            address = route.request.url
            if address.startswith(("http://localhost", "http://127.0.0.1", "file:", "data:", "blob:")):
                route.continue_()
            else:
                page.refused.append(address)
                route.abort()

        if local_only:
            page.route("**/*", filter_request)
        try:
            yield page
        finally:
            context.close()
