"""Takes the gallery's pictures, and the moving one, from the pages of a site that was built.

They are kept with the source, so that building the site needs no browser. When their look changes:

mkdocs build && python -m docs.hooks.pictures

Names of examples take the pictures of these only; `moving` takes the moving one, for the README.
"""

from __future__ import annotations

import io
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from PIL import Image

from tests.chromium import chromium

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

ROOT = Path(__file__).parents[2]
SHOTS = {
    "quickstart/run.html": 1.6,
    "two_link/two_link.html": 0.4,
    "own_urdf/own_urdf.html": 2.0,
    "own_controller/own_controller.html": 3.5,
    "compare/compare.html": 5.0,
    "panda_payload/panda_payload.html": 4.0,
    "pick_and_drop/pick_and_drop.html": 4.5,
    "hold_still/hold_still.html": 4.8,
    "tilted_circle/tilted_circle.html": 5.0,
    "identify_arm/motion.html": 2.0,
    "rehearsal/rehearsal.html": 3.0,
    "c_in_the_loop/c_in_the_loop.html": 2.0,
}
"""Pages, and the times at which they are pictured [s]."""

PATIENCE = 180_000
"""A machine without a graphics card draws slowly [ms]."""

MOVING = "compare/compare.html"
SPAN, RATE = (0.0, 5.0), 8.0
"""What the moving picture shows of its run [s], and its frames per second of the run."""
SIZE = (1000, 560)
"""Of the page that is pictured [px]."""
SHOWN = 464
"""Of its height, without the controls [px]."""


def main() -> None:
    """Write a picture per example into docs/assets/gallery, and the moving one."""
    wanted = sys.argv[1:] or ["moving", *(address.partition("/")[0] for address in SHOTS)]
    with chromium() as browser:
        for address, time in SHOTS.items():
            name = address.partition("/")[0]
            if name in wanted:
                page = opened(browser, address, 1200, 640)
                page.evaluate(f"fotsmc.seek({time})")
                page.wait_for_timeout(1000)
                page.screenshot(path=ROOT / f"docs/assets/gallery/{name}.jpg", quality=80)
                page.close()
        if "moving" in wanted:
            write_moving(browser, ROOT / "docs/images/moving.webp")


def opened(browser: Browser, address: str, width: int, height: int) -> Page:
    """Return the page, drawn and at rest."""
    page = browser.new_page(viewport={"width": width, "height": height}, reduced_motion="reduce")
    page.set_default_timeout(PATIENCE)
    page.goto((ROOT / "site/gallery" / address).as_uri())
    page.locator("html[data-ready=true]").wait_for(state="attached")
    return page


def write_moving(browser: Browser, path: Path) -> None:
    """Write the arms and their errors as a picture that moves, over and over."""
    page = opened(browser, MOVING, *SIZE)
    frames = []
    for k in range(round((SPAN[1] - SPAN[0]) * RATE)):
        page.evaluate(f"fotsmc.seek({SPAN[0] + k / RATE})")
        page.evaluate("new Promise((done) => requestAnimationFrame(() => setTimeout(done, 30)))")
        shot = page.screenshot(clip={"x": 0, "y": 0, "width": SIZE[0], "height": SHOWN})
        frames.append(Image.open(io.BytesIO(shot)).convert("RGB"))
    first, *others = frames
    options = {"quality": 62, "method": 6, "duration": round(1000 / RATE), "loop": 0}
    first.save(path, save_all=True, append_images=others, **options)


if __name__ == "__main__":
    main()
