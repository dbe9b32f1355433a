"""Pictures for the eye: pages and reports on a laptop and a phone, in the dark, of four runs."""

from __future__ import annotations

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.view import write_report

pytestmark = pytest.mark.browser

LAPTOP = {"width": 1366, "height": 768}
PHONE = {"width": 390, "height": 844}


@pytest.fixture(scope="module")
def panda(make_recording):
    arm = fp.perturb(fp.load_arm("panda"), mass_scale=1.2, payload=1.5)
    return make_recording(arm, duration=4.0)


@pytest.fixture(scope="module")
def four_runs(panda):
    """Runs of one arm that differ by less than a pixel, and one that does not."""
    made = {}
    for number, off in enumerate((0.0, 1e-4, 3e-4, 0.2)):
        e = panda.e + off * np.cos(panda.t)[:, None]
        q = panda.q_d + e
        made[f"run {number + 1}"] = fp.Recording(**(vars(panda) | {"q": q, "e": e}))
    return {name: fp.Recording(**_fields(rec)) for name, rec in made.items()}


def _fields(rec):
    return {name: value for name, value in vars(rec).items() if name != "error_norm"}


def take(page, path):
    page.run("fotsmc.pause(), fotsmc.seek(1.5)")
    page.page.wait_for_timeout(200)
    page.page.screenshot(path=path, timeout=120_000.0)


@pytest.mark.long
@pytest.mark.parametrize("shade", ["light", "dark"])
@pytest.mark.parametrize("screen", ["laptop", "phone"])
def test_a_page(panda, open_page, output, screen, shade):
    size = {"laptop": LAPTOP, "phone": PHONE}[screen]
    file = fp.export_html(panda, output / "panda.html", play=False)
    page = open_page(file, viewport=size, color_scheme=shade)
    take(page, output / f"screen-page-{screen}-{shade}.png")
    page.page.locator("details").first.evaluate("e => { e.open = true; e.scrollIntoView(); }")
    page.page.screenshot(path=output / f"screen-page-{screen}-{shade}-about.png")
    assert page.complaints == []
    assert page.run("document.documentElement.scrollWidth") <= size["width"]
    assert page.page.locator(".u-axis").count() > 0
    assert "payload 1.5 kg" in page.page.locator(".key").inner_text()
    assert "moved panda_perturbed" in page.page.locator("details").first.inner_text()


@pytest.mark.long
@pytest.mark.parametrize("layout", ["overlay", "auto"])
def test_four_runs(four_runs, open_page, output, layout):
    file = fp.export_html(four_runs, output / f"four-{layout}.html", play=False, layout=layout)
    page = open_page(file, viewport=LAPTOP)
    take(page, output / f"screen-four-runs-{layout}.png")
    assert page.complaints == []


def speckles(page, region):
    """Return how often neighbouring pixels of a picture change between two runs' colours."""
    script = """async ([x0, y0, x1, y1]) => {
      const image = new Image();
      image.src = fotsmc.capture();
      await image.decode();
      const canvas = document.createElement("canvas");
      [canvas.width, canvas.height] = [image.width, image.height];
      const drawing = canvas.getContext("2d");
      drawing.drawImage(image, 0, 0);
      const { data } = drawing.getImageData(0, 0, image.width, image.height);
      let changes = 0;
      const green = (x, y) => {
        const k = 4 * (y * image.width + x);
        return data[k + 3] > 200 && data[k + 1] > data[k] + 12;
      };
      for (let y = Math.floor(y0 * image.height); y < y1 * image.height; y++)
        for (let x = Math.floor(x0 * image.width) + 1; x < x1 * image.width; x++)
          if (green(x, y) !== green(x - 1, y)) changes++;
      return changes / image.height;
    }"""
    return page.run(script, region)


def test_coincident_arms_do_not_fight_for_the_same_place(panda, open_page, tmp_path):
    """Of two runs that are one, the first one's colour, orange, is seen and the other's is not."""
    runs = {"first": panda, "second": fp.Recording(**_fields(panda))}
    file = fp.export_html(runs, tmp_path / "a.html", play=False, ghost=False, paths="off")
    page = open_page(file, viewport=LAPTOP)
    page.run("fotsmc.seek(1.5)")
    assert speckles(page, [0, 0, 1, 1]) < 0.05


def test_an_arm_with_a_prismatic_joint_has_a_plot_for_each_unit(gantry, open_page, output):
    file = fp.export_html(gantry, output / "gantry.html", play=False)
    page = open_page(file, viewport=LAPTOP)
    take(page, output / "screen-gantry.png")
    captions = page.page.locator("figcaption").all_text_contents()
    assert captions[:2] == ["Tracking error [m]", "Tracking error [rad]"]
    assert captions[2].startswith("Force [N]")
    assert captions[3].startswith("Torque [N·m]")
    cells = page.page.locator("tbody tr").first.locator("td").all_text_contents()
    assert cells[0].endswith(" m")
    assert cells[1].endswith(" N")


@pytest.mark.long
@pytest.mark.parametrize("shade", ["light", "dark"])
@pytest.mark.parametrize("screen", ["laptop", "phone"])
def test_a_report(panda, gantry, chromium, output, tmp_path, screen, shade):
    size = {"laptop": LAPTOP, "phone": PHONE}[screen]
    lost = fp.Recording(
        **(_fields(gantry) | {"metadata": {"controller": "Lost"}}),
    )
    fp.errors.DivergenceError("diverged", 1.25, "slide", lost)
    panda.save(tmp_path / "panda.npz")
    lost.save(tmp_path / "gantry.npz")
    file = write_report(tmp_path)
    context = chromium.new_context(offline=True, viewport=size, color_scheme=shade)
    page = context.new_page()
    page.goto(file.as_uri())
    page.frame_locator("iframe").locator("html[data-ready=true]").wait_for(timeout=60_000)
    page.screenshot(path=output / f"screen-report-{screen}-{shade}.png", full_page=True)
    assert page.evaluate("document.documentElement.scrollWidth") <= size["width"]
    tables = page.locator(".wide:has(table)")
    assert tables.count() == 2
    if screen == "phone":
        assert all(t.evaluate("e => e.scrollWidth > e.clientWidth") for t in tables.all())
    context.close()
