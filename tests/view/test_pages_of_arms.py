"""Pages of real arms in a browser: every link is there, moves, and nothing is fetched."""

from __future__ import annotations

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.view.visuals import visuals_of

pytestmark = pytest.mark.browser

MANY = [pytest.param(name, marks=pytest.mark.long) for name in ("ur5", "kinova", "z1", "baxter")]
ARMS = ["two_link_true", "panda", "so101", *MANY]

# Smaller visuals may lie wholly inside others.
SMALL = 0.03

# Hides one link after the other, from several sides until the picture changes.
UNSEEN = """([links, views]) => {
  fotsmc.setShadows(false);
  const select = document.querySelector("[data-part=view-select]");
  for (const view of views) {
    if (links.length === 0) break;
    select.value = view;
    select.dispatchEvent(new Event("change"));
    const whole = fotsmc.capture();
    links = links.filter((visuals) => {
      visuals.forEach((visual) => fotsmc.showLink(visual, false));
      const same = fotsmc.capture() === whole;
      visuals.forEach((visual) => fotsmc.showLink(visual, true));
      return same;
    });
  }
  return links;
}"""


def links_of(arm: fp.Arm) -> list[list[str]]:
    """Return the names of the visuals of each link that is not small."""
    links: dict[str, list[str]] = {}
    sizes: dict[str, float] = {}
    for visual in visuals_of(arm):
        link = visual.name.rpartition("_")[0]
        low, high = visual.mesh.box
        links.setdefault(link, []).append(visual.name)
        sizes[link] = max(sizes.get(link, 0.0), float(np.linalg.norm(high - low)))
    return [visuals for link, visuals in links.items() if sizes[link] > SMALL]


@pytest.mark.parametrize("name", ARMS)
def test_every_link_shows_and_the_arm_moves(name, make_recording, open_page, output):
    recording = make_recording(fp.load_arm(name), duration=2.0)
    path = fp.export_html(recording, output / f"{name}.html", ghost=False, play=False)
    page = open_page(path, viewport={"width": 420, "height": 400})
    links = links_of(recording.arm)
    assert len(links) >= min(recording.arm.nv, 5)
    assert page.run(UNSEEN, [links, ["three", "front", "side", "top"]]) == []
    assert page.run("fotsmc.seek(0), fotsmc.capture()") != page.run(
        "fotsmc.seek(1.5), fotsmc.capture()"
    )
    page.page.screenshot(path=output / f"{name}.png")
    assert page.complaints == []
    assert page.requests == [path.as_uri()]
