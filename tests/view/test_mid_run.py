"""Events and wrenches in pages, figures and reports: when they are seen, and where."""

from __future__ import annotations

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.arms import Payload
from fotsmc_pin.view import figures, write_report
from fotsmc_pin.view.document import shots_of
from fotsmc_pin.view.marks import marks_of
from fotsmc_pin.view.mid_run import arrow_tips, pushes_of, with_payloads
from fotsmc_pin.view.motion import motion
from fotsmc_pin.view.visuals import visuals_of

LAPTOP = {"width": 1366, "height": 768}


def changed(arm, time, words, **done):
    return fp.PlantChange(time=time, arm=fp.perturb(arm, **done) if done else arm, words=words)


@pytest.fixture(scope="module")
def eventful(make_recording):
    """A Panda that picks up 2 kg at 1 s and puts them down at 2 s, pushed twice after that."""
    arm = fp.load_arm("panda")
    return make_recording(
        arm,
        duration=4.0,
        events=(
            changed(arm, 1.0, "payload 2 kg", payload=2.0),
            changed(arm, 2.0, "no payload"),
        ),
        wrenches=(
            fp.Wrench(start=2.5, duration=0.5, force=(0.0, 40.0, 30.0), rise=0.1),
            fp.Wrench(
                start=3.25, duration=0.5, force=(0.0, 0.0, 25.0), torque=(3.0, 0, 0), axes="local"
            ),
        ),
    )


def test_what_happens_is_told_once_and_in_order(eventful):
    told = [mark.told for mark in marks_of([eventful, eventful])]
    assert told == [
        "1 s: payload 2 kg",
        "2 s: no payload",
        "2.5 s to 3 s: 50 N at the tool",
        "3.25 s to 3.75 s: 25 N and 3 N·m at the tool",
    ]


def test_a_ball_hangs_there_while_its_payload_does(make_recording):
    arm = fp.load_arm("two_link")
    begins = fp.perturb(arm, payload=1.0)
    both = [Payload(mass=1.0), Payload(mass=0.5, frame="link1", com=(0.2, 0.0, 0.0))]
    rec = make_recording(
        begins,
        events=(
            changed(arm, 1.0, "no payload"),
            changed(arm, 2.0, "payload 1.5 kg", payload=both),
        ),
    )
    visuals = with_payloads(visuals_of(begins), rec)
    passing = {v.joint: v for v in visuals if v.spans}
    assert passing[2].spans == ((0.0, 1.0), (2.0, None))
    assert passing[1].spans == ((2.0, None),)
    assert passing[1].mesh.vertices.mean(axis=0) == pytest.approx([0.2, 0.0, 0.0], abs=1e-9)
    own = {v.name: v for v in visuals_of(begins)}["payload_1_0"]
    ours = passing[2].mesh
    np.testing.assert_allclose(ours.box, own.mesh.box, atol=1e-9)
    assert ours.paint[0][0] == pytest.approx(own.mesh.paint[0][0], abs=0.01)
    assert len(visuals) == len(visuals_of(begins)) + 1


def test_arrows_begin_at_the_frame_and_show_the_forces_directions(eventful):
    arm, t = eventful.arm, np.array([1.0, 2.75, 3.5])
    q = eventful.q[[1000, 2750, 3500]]
    tips = arrow_tips(eventful, motion(arm, q), t)
    assert len(tips) == 2, "none acts at 1 s"
    for tip, configuration, wrench in zip(tips, q[1:], eventful.wrenches, strict=True):
        pose = arm.tool_pose(configuration)
        force = np.array(wrench.force)
        direction = pose.rotation @ force if wrench.axes == "local" else force
        arrow = tip - pose.translation
        np.testing.assert_allclose(
            arrow / np.linalg.norm(arrow), direction / np.linalg.norm(force), atol=1e-9
        )
    lengths = [np.linalg.norm(push["force"]) for push in pushes_of(eventful)]
    assert lengths[1] / lengths[0] == pytest.approx(0.5)
    (shot,) = shots_of({"a": eventful}, rate=60.0, quality="compact", side_by_side=False)
    reached = np.max(tips, axis=0)
    assert (shot.framing.high >= reached - 1e-9).all(), "the camera takes them in"


@pytest.mark.parametrize("kind", ["overview", "tracking", "velocity", "torque", "signal"])
def test_every_panel_of_a_figure_has_the_marks(eventful, kind):
    figure = getattr(figures, f"{kind}_figure")(eventful)
    for panel in figure.axes:
        lines = {float(line.get_xdata()[0]) for line in panel.lines if len(line.get_xdata()) == 2}
        assert {1.0, 2.0} <= lines
        shades = sorted(round(float(patch.get_x()), 6) for patch in panel.patches)
        assert shades == [2.5, 3.25]
    words = [text.get_text() for text in figure.axes[0].texts]
    assert words == [mark.words for mark in marks_of([eventful])]


def test_words_of_events_close_together_stand_on_lines_of_their_own(make_recording):
    arm = fp.load_arm("two_link")
    times = (1.0, 1.05, 1.1, 3.9)
    rec = make_recording(arm, events=tuple(changed(arm, t, "payload 12 kg") for t in times))
    figure = figures.overview_figure(rec)
    figure.canvas.draw()
    boxes = [text.get_window_extent() for text in figure.axes[0].texts]
    assert len(boxes) == 4
    assert not any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[:k])
    assert all(box.x0 >= 0 and box.x1 <= figure.bbox.width for box in boxes)


def test_a_figure_of_a_run_without_events_has_no_marks(two_link):
    figure = figures.overview_figure(two_link)
    assert not any(panel.patches or panel.texts for panel in figure.axes)


def test_a_report_tells_what_happened(eventful, tmp_path, text_of):
    eventful.save(tmp_path / "run.npz")
    told = text_of(write_report(tmp_path).read_text("utf-8"))
    assert "1 s: payload 2 kg" in told
    assert "2.5 s to 3 s: 50 N at the tool" in told


@pytest.mark.browser
def test_the_page_shows_payloads_and_pushes_while_they_are_there(eventful, open_page, tmp_path):
    page = open_page(fp.export_html(eventful, tmp_path / "a.html", play=False), viewport=LAPTOP)
    key = page.page.locator(".key").inner_text()
    assert all(mark.told in key for mark in marks_of([eventful]))
    shown = {}
    for time in (0.5, 0.999, 1.0, 1.5, 2.01):
        page.run("t => fotsmc.seek(t)", time)
        shown[time] = len(page.run("fotsmc.payloads()"))
    assert shown == {0.5: 0, 0.999: 0, 1.0: 1, 1.5: 1, 2.01: 0}
    for time in (2.4, 2.53, 2.75, 2.97, 3.0, 3.5, 3.9):
        page.run("t => fotsmc.seek(t)", time)
        pushes = page.run("fotsmc.pushes()")
        expected = [wrench.share(time) for wrench in eventful.wrenches]
        assert [push["share"] for push in pushes] == pytest.approx(expected, abs=1e-6)
    page.run("fotsmc.seek(2.75)")
    tool = eventful.arm.tool_pose(eventful.q[2750]).translation
    assert page.run("fotsmc.pushes()[0].position") == pytest.approx(tool, abs=1e-3)
    assert page.complaints == []


@pytest.mark.long
@pytest.mark.browser
@pytest.mark.parametrize("shade", ["light", "dark"])
def test_pictures_for_the_eye(eventful, open_page, output, shade):
    file = fp.export_html(eventful, output / "events.html", play=False)
    page = open_page(file, viewport=LAPTOP, color_scheme=shade)
    for time in (1.5, 2.75, 3.5):
        page.run("t => (fotsmc.pause(), fotsmc.seek(t))", time)
        page.page.wait_for_timeout(200)
        picture = output / f"screen-events-{time:g}-{shade}.png"
        page.page.screenshot(path=picture, timeout=120_000.0)
    assert page.complaints == []
