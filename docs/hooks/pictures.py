"""Takes the gallery's pictures from the pages of a site that was built.

They are kept with the source, so that building the site needs no browser. When their look changes:

mkdocs build && python docs/hooks/pictures.py
"""

from __future__ import annotations

import shutil
from pathlib import Path

from playwright.sync_api import sync_playwright

ROOT = Path(__file__).parents[2]
SHOTS = {
    "quickstart/run.html": 1.6,
    "two_link/two_link.html": 0.4,
    "own_urdf/own_urdf.html": 2.0,
    "own_controller/own_controller.html": 3.5,
    "compare/compare.html": 5.0,
    "panda_payload/panda_payload.html": 4.0,
    "pick_and_drop/pick_and_drop.html": 4.5,
}
"""Pages, and the times at which they are pictured [s]."""

FLAGS = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"]


def main() -> None:
    """Write a picture per example into docs/assets/gallery."""
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        for address, time in SHOTS.items():
            page = browser.new_page(
                viewport={"width": 1200, "height": 640}, reduced_motion="reduce"
            )
            page.goto((ROOT / "site/gallery" / address).as_uri())
            page.locator("html[data-ready=true]").wait_for()
            page.evaluate(f"fotsmc.seek({time})")
            page.wait_for_timeout(500)
            name = address.partition("/")[0]
            page.screenshot(path=ROOT / f"docs/assets/gallery/{name}.jpg", quality=80)
            page.close()
        browser.close()


if __name__ == "__main__":
    main()
