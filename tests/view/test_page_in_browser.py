"""The page at work: its numbers are the recording's, and mouse and keyboard can use it."""

from __future__ import annotations

import math
import time
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp

pytestmark = pytest.mark.browser

AXE = Path(__file__).parent / "assets" / "axe.min.js"


@pytest.fixture(scope="module")
def page_file(two_link, output) -> Path:
    return fp.export_html(two_link, output / "page.html", play=False)


@pytest.fixture(scope="module")
def opened(chromium, page_file, opened_page):
    page = opened_page(chromium, page_file)
    yield page
    page.context.close()


@pytest.fixture
def page(opened):
    """One page for many tests, stopped at its start with the focus on nothing."""
    opened.run("fotsmc.pause(), fotsmc.seek(0), document.activeElement.blur()")
    yield opened
    assert opened.complaints == []


def heads_of(page) -> list[float]:
    """Return where the plots' playheads stand, from the left edges of the plots [px]."""
    return page.run(
        "[...document.querySelectorAll('.playhead')].map(e => e.getBoundingClientRect().x"
        " + 1 - e.parentElement.getBoundingClientRect().x)"
    )


def joint_pose(recording: fp.Recording, q: np.ndarray, name: str) -> pin.SE3:
    model = recording.arm.model
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    return data.oMi[model.getJointId(name)].copy()


def test_numbers_of_the_page_are_those_of_the_recording(page, two_link):
    times = np.array(page.run("fotsmc.times()"))
    rows = np.searchsorted(two_link.t, times - 1e-5)
    np.testing.assert_allclose(two_link.t[rows], times, atol=1e-6)
    for frame in (0, 17, len(times) // 2, len(times) - 1):
        row = rows[frame]
        page.run("t => fotsmc.seek(t)", times[frame])
        assert page.run("fotsmc.time") == pytest.approx(times[frame])
        for which, q in (("arm", two_link.q[row]), ("ghost", two_link.q_d[row])):
            expected = joint_pose(two_link, q, "joint2")
            shown = page.run("which => fotsmc.pose('joint2', undefined, which)", which)
            np.testing.assert_allclose(shown["position"], expected.translation, atol=1e-6)
            turned = pin.Quaternion(np.array(shown["quaternion"])).toRotationMatrix()
            np.testing.assert_allclose(turned, expected.rotation, atol=1e-6)
        for asked, table in (("error", two_link.e), ("torque", two_link.tau)):
            shown = page.run(f"t => fotsmc.{asked}(t)", times[frame])
            np.testing.assert_allclose(shown, table[row], rtol=1e-6, atol=1e-6)


def test_between_frames_the_arm_is_between(page, two_link):
    page.run("fotsmc.seek(1.2345)")
    q = np.array([np.interp(1.2345, two_link.t, column) for column in two_link.q.T])
    expected = joint_pose(two_link, q, "joint2")
    shown = page.run("fotsmc.pose('joint2')")
    np.testing.assert_allclose(shown["position"], expected.translation, atol=2e-4)


def test_plot_and_arm_follow_each_other(page, two_link):
    before = page.run("fotsmc.pose('joint2').position")
    plot = page.page.locator(".u-over").first.bounding_box()
    page.page.mouse.move(plot["x"] + 0.2 * plot["width"], plot["y"] + 20)
    page.page.mouse.down()
    page.page.mouse.move(plot["x"] + 0.5 * plot["width"], plot["y"] + 30, steps=4)
    page.page.mouse.up()
    middle = 0.5 * two_link.t[-1]
    assert page.run("fotsmc.time") == pytest.approx(middle, abs=0.02 * two_link.t[-1])
    assert np.linalg.norm(np.subtract(page.run("fotsmc.pose('joint2').position"), before)) > 0.01
    page.run("fotsmc.seek(1.0)")
    heads = heads_of(page)
    assert len(heads) == 3
    np.testing.assert_allclose(heads, 0.25 * plot["width"], atol=1.5)


def test_keys_play_step_and_jump(page, two_link):
    press = page.page.keyboard.press
    step = np.diff(page.run("fotsmc.times()"))[0]
    press("ArrowRight")
    assert page.run("fotsmc.time") == pytest.approx(step, rel=1e-3)
    press("Shift+ArrowRight")
    assert page.run("fotsmc.time") == pytest.approx(1 + step, rel=1e-3)
    press("End")
    assert page.run("fotsmc.time") == pytest.approx(two_link.t[-1])
    press("Home")
    press("Space")
    assert page.run("fotsmc.playing")
    page.wait_for("fotsmc.time > 0.2")
    press("Space")
    assert not page.run("fotsmc.playing")


def test_time_line_works_from_the_keyboard_and_tells_seconds(page):
    scrubber = page.page.get_by_role("slider", name="Time")
    scrubber.focus()
    page.page.keyboard.press("Shift+ArrowRight")
    assert scrubber.get_attribute("aria-valuetext") == "1.00 seconds"


def test_loop_starts_again_and_without_it_the_end_stays(page, two_link):
    end = float(two_link.t[-1])
    page.run("t => { fotsmc.seek(t); fotsmc.play(); }", end - 0.1)
    page.wait_for(f"fotsmc.time < {end} - 0.2")
    page.page.keyboard.press("l")
    page.run("t => { fotsmc.seek(t); fotsmc.play(); }", end - 0.1)
    page.wait_for("!fotsmc.playing")
    page.page.keyboard.press("l")
    assert page.run("fotsmc.time") == pytest.approx(end)


@pytest.mark.parametrize("shade", ["light", "dark"])
@pytest.mark.parametrize("size", [(1280, 800), (390, 844)], ids=["laptop", "phone"])
def test_checker_of_accessibility_finds_nothing_serious(page_file, open_page, output, shade, size):
    viewport = {"width": size[0], "height": size[1]}
    page = open_page(page_file, color_scheme=shade, viewport=viewport)
    page.run("fotsmc.seek(0.4)")
    page.run("document.querySelectorAll('details').forEach(d => d.open = true)")
    page.run(AXE.read_text("utf-8"))
    found = page.run("axe.run(document, { resultTypes: ['violations'] })")["violations"]
    page.page.screenshot(path=output / f"page-{shade}-{size[0]}.png")
    serious = [
        (f["id"], f["nodes"][0]["html"]) for f in found if f["impact"] in ("serious", "critical")
    ]
    assert serious == []
    wide = page.run("document.documentElement.scrollWidth")
    assert wide <= size[0]


def test_several_runs_are_named_and_can_be_hidden(two_link, make_recording, open_page, output):
    other = make_recording(two_link.arm, duration=3.0, dt=2e-3)
    path = output / "several.html"
    fp.export_html({"fast <i>": two_link, "slow": other}, path, play=False)
    page = open_page(path)
    assert page.run("fotsmc.runs") == ["fast <i>", "slow"]
    shown = page.run("fotsmc.seek(0.1), fotsmc.capture()")
    page.page.get_by_role("button", name="fast <i>").click()
    assert page.run("fotsmc.capture()") != shown
    np.testing.assert_allclose(page.run("fotsmc.error(1.0, 'slow')"), other.e[500], rtol=1e-5)
    # The shorter run waits at its end.
    page.run("fotsmc.seek(4.0)")
    last = joint_pose(other, other.q[-1], "joint2").translation
    np.testing.assert_allclose(page.run("fotsmc.pose('joint2', 'slow').position"), last, atol=1e-6)
    assert page.complaints == []


def test_text_of_others_is_text_and_never_code(two_link, open_page, output):
    bad = '</script><script>window.broken = 1</script><img src=x onerror="window.broken = 1">'
    path = fp.export_html(
        {bad: two_link, "{{arrays}}": two_link}, output / "bad.html", title=bad, play=False
    )
    page = open_page(path)
    assert page.run("window.broken") is None
    assert page.page.title() == bad
    assert page.run("fotsmc.runs")[1] == "{{arrays}}"
    assert page.requests == [path.as_uri()]
    assert page.complaints == []


def test_choices_of_the_page_redraw_the_plots(page_file, two_link, open_page):
    page = open_page(page_file)
    captions = page.page.locator("figcaption")
    page.run("fotsmc.seek(2.0)")
    heads = heads_of(page)
    page.page.get_by_label("Show").select_option(label="joint2")
    page.page.get_by_role("button", name="Log error").click()
    page.page.get_by_role("button", name="Dark colours").click()
    limit = two_link.arm.effort_limit[1]
    page.run("new Promise(requestAnimationFrame)")
    assert heads_of(page) == pytest.approx(heads)
    assert captions.all_text_contents() == [
        "Tracking error [rad]",
        f"Torque [N·m], limit ±{limit:g}",
        "Sliding variable s [–]",
    ]
    assert page.page.locator("html").get_attribute("data-shade") == "dark"
    assert page.complaints == []


def slowdown() -> float:
    """Return how much longer than its processor time a computation takes on this machine now."""
    wall, cpu = time.perf_counter(), time.process_time()
    while time.process_time() - cpu < 0.3:
        pass
    return (time.perf_counter() - wall) / 0.3


def test_two_link_page_is_ready_within_three_seconds(page_file, open_page):
    """Of a machine that has nothing else to do; the best of some, as others may share it."""
    took = [math.inf]
    while min(took) >= 3.0 and len(took) < 8:
        before = slowdown()
        seconds = open_page(page_file).run("fotsmc.readyAfter")
        took.append(seconds / max(before, slowdown()))
    assert min(took) < 3.0


def test_a_page_starts_as_it_was_asked_to(two_link, open_page, tmp_path):
    path = fp.export_html(
        [two_link, two_link],
        tmp_path / "a.html",
        theme="dark",
        ghost=False,
        paths="whole",
        speed=0.3,
        loop=False,
        layout="side by side",
        signals=["s", "b_hat"],
    )
    page = open_page(path)
    assert page.run("fotsmc.playing")
    assert page.page.locator("html").get_attribute("data-shade") == "dark"
    assert page.page.get_by_label("Speed").input_value() == "0.3"
    assert page.page.get_by_label("Paths").input_value() == "whole"
    for name in ("Loop", "Reference"):
        assert page.page.get_by_role("button", name=name).get_attribute("aria-pressed") == "false"
    page.page.get_by_label("Signal").select_option("b_hat")
    assert page.page.locator("figcaption").last.text_content() == "Norm of the signal b_hat [–]"
    assert page.complaints == []


def test_reduced_motion_waits_for_the_reader(two_link, open_page, tmp_path):
    path = fp.export_html(two_link, tmp_path / "a.html")
    assert not open_page(path, reduced_motion="reduce").run("fotsmc.playing")


BARE = """<robot name="bare">
<link name="a"/><link name="b">{body}</link><link name="c">{body}</link>
<joint name="turn" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
<joint name="slide" type="prismatic"><parent link="b"/><child link="c"/><axis xyz="1 0 0"/>
<origin xyz="0.4 0 0.2"/><limit lower="0" upper="0.3" effort="9" velocity="1"/></joint>
</robot>"""
BODY = """<inertial><mass value="1"/>
<inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>"""


def test_an_arm_without_visuals_shows_something(make_recording, open_page, output, tmp_path):
    file = tmp_path / "bare.urdf"
    file.write_text(BARE.format(body=BODY))
    path = fp.export_html(
        make_recording(fp.load_arm(file), duration=1.0), output / "bare.html", play=False
    )
    page = open_page(path)
    whole = page.run("fotsmc.capture()")
    page.run("fotsmc.links().forEach(link => fotsmc.showLink(link, false))")
    assert page.run("fotsmc.capture()") != whole
    assert page.complaints == []


def test_arms_of_different_kinds_are_compared_joint_by_joint(
    two_link, make_recording, open_page, tmp_path
):
    other = make_recording(fp.load_arm("ur5"), duration=0.5)
    page = open_page(fp.export_html([two_link, other], tmp_path / "a.html", play=False))
    choice = page.page.get_by_label("Show")
    assert choice.locator("option").all_text_contents() == [
        "All joints (norm)",
        "Joint 1",
        "Joint 2",
    ]
    choice.select_option("Joint 2")
    page.run("fotsmc.seek(0.25)")
    cells = page.page.locator("tbody td:first-of-type").all_text_contents()
    expected = [two_link.e[250, 1], other.e[250, 1]]
    np.testing.assert_allclose([float(cell) for cell in cells], expected, rtol=1e-2)
    assert page.complaints == []


def test_a_long_run_tells_exact_numbers_at_its_frames(make_recording, open_page, tmp_path):
    run = make_recording(fp.load_arm("two_link"), duration=30.0)
    page = open_page(fp.export_html(run, tmp_path / "a.html", play=False))
    times = page.run("fotsmc.times()")
    for frame in (3, len(times) // 2, len(times) - 1):
        row = np.argmin(np.abs(run.t - times[frame]))
        shown = page.run("t => fotsmc.torque(t)", times[frame])
        np.testing.assert_allclose(shown, run.tau[row], rtol=1e-5, atol=1e-5)
