"""Runs made up in a moment, and pages opened in a headless browser without network."""

from __future__ import annotations

import shutil
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import fotsmc_pin as fp

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

OUTPUT = Path(__file__).parents[2] / "test-output" / "view"
FLAGS = [
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--no-sandbox",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]


def made_up(arm: fp.Arm, *, duration: float = 4.0, dt: float = 1e-3, **parts: Any) -> fp.Recording:
    """Return a recording in which `arm` swings on and its error dies out; no simulation is run."""
    t = np.arange(round(duration / dt) + 1) * dt
    rate = 0.8 + 0.2 * np.arange(arm.nv)
    swing = 0.35 * np.sin(np.outer(t, rate))
    error = 0.3 * np.exp(-2.0 * t)[:, None] * np.cos(np.arange(arm.nv))
    start = arm.to_joint_positions(arm.neutral)
    limit = np.where(np.isfinite(arm.effort_limit), arm.effort_limit, 50.0)
    made = {
        "t": t,
        "q": np.array([arm.from_joint_positions(p) for p in start + swing + error]),
        "v": rate * 0.35 * np.cos(np.outer(t, rate)),
        "q_d": np.array([arm.from_joint_positions(p) for p in start + swing]),
        "v_d": rate * 0.35 * np.cos(np.outer(t, rate)),
        "e": error,
        "ed": -2.0 * error,
        "tau": 0.6 * limit * np.cos(np.outer(t, rate)),
        "signals": {"s": 10.0 * error, "b_hat": np.outer(t, np.ones(2))},
        "arm": arm,
        "metadata": {"controller": "MadeUp", "dt": dt},
    }
    return fp.Recording(**(made | parts))


@pytest.fixture(scope="session")
def make_recording() -> Callable[..., fp.Recording]:
    return made_up


@pytest.fixture(scope="session")
def two_link() -> fp.Recording:
    return made_up(fp.load_arm("two_link_true"))


@pytest.fixture(scope="session")
def output() -> Path:
    """Folder in which pages and pictures are kept for the eye."""
    OUTPUT.mkdir(parents=True, exist_ok=True)
    return OUTPUT


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    names = ("chromium", "chromium-browser", "google-chrome")
    found = next((path for name in names if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip(f"NO BROWSER: none of {', '.join(names)} is installed, pages stay unseen")
    playwright = pytest.importorskip("playwright.sync_api", reason="NO PLAYWRIGHT: pages unseen")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=found, args=FLAGS)
        yield browser
        browser.close()


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
