"""The pages that people get from the main job and from the Panda, opened from disk, offline."""

import pytest

import fotsmc_pin as fp
from fotsmc_pin.paper import two_link
from fotsmc_pin.references import Sinusoid

pytestmark = pytest.mark.browser


def panda_run():
    arm = fp.load_arm("panda")
    controller = fp.AdaptiveFONFTSM(arm, dt=1e-3, preset="practical")
    reference = Sinusoid.inside_limits(arm)
    return fp.simulate(fp.perturb(arm, mass_scale=1.1), controller, reference, 2.0)


@pytest.mark.parametrize("make", [two_link.run, panda_run], ids=["two_link", "panda"])
def test_the_page_renders_moves_and_asks_for_nothing(make, tmp_path, open_page):
    path = fp.export_html(make(), tmp_path / "run.html")
    page = open_page(path)
    page.run("fotsmc.pause()")
    pictures = []
    for time in (0.0, 1.0):
        page.run("time => fotsmc.seek(time)", time)
        page.page.wait_for_timeout(300)
        pictures.append(page.page.screenshot())
    assert pictures[0] != pictures[1]
    assert page.complaints == []
    assert page.requests == [path.as_uri()]
