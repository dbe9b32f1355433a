"""Pages opened from disk in a headless browser without network."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import pytest

from tests.chromium import NAMES, found
from tests.chromium import chromium as started

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    if found() is None:
        pytest.skip(f"NO BROWSER: none of {', '.join(NAMES)} is installed, pages stay unseen")
    pytest.importorskip("playwright.sync_api", reason="NO PLAYWRIGHT: pages unseen")
    with started() as browser:
        yield browser


class Page:
    """A page opened from disk with the network off, and everything it complained about or asked."""

    def __init__(self, browser: Any, path: Path, **context: Any) -> None:
        self.context = browser.new_context(
            offline=True, **({"viewport": {"width": 900, "height": 520}} | context)
        )
        self.page = self.context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("websocket", lambda socket: self.requests.append(socket.url))
        self.page.on("console", self._listen)
        self.page.goto(path.as_uri())
        self.page.locator("html[data-ready]").wait_for(state="attached", timeout=60_000)

    def _listen(self, message: Any) -> None:
        # Chromium's own note that software rendering reads pixels slowly is not the page's.
        if message.type in ("error", "warning") and "GPU stall" not in message.text:
            self.complaints.append(message.text)

    def wait_for(self, condition: str, seconds: float = 20.0) -> None:
        """Poll from outside: the page's policy forbids the evaluation of text inside it."""
        end = time.monotonic() + seconds
        while not self.run(condition):
            assert time.monotonic() < end, f"never came: {condition}"
            self.page.wait_for_timeout(30)

    def run(self, script: str, argument: Any = None) -> Any:
        return self.page.evaluate(script, argument)


@pytest.fixture(scope="session")
def opened_page() -> type[Page]:
    return Page


@pytest.fixture
def open_page(chromium: Any) -> Iterator[Callable[..., Page]]:
    opened: list[Page] = []

    def open_it(path: Path, **context: Any) -> Page:
        opened.append(Page(chromium, path, **context))
        return opened[-1]

    yield open_it
    for page in opened:
        page.context.close()
