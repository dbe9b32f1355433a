"""What radians and metres, a divergence, and a notebook make of a run's words."""

from __future__ import annotations

import html
import re

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.analysis import summarize_by_unit, units
from fotsmc_pin.view import overview_figure, write_report
from fotsmc_pin.view.figures import LIMIT
from fotsmc_pin.view.palette import COLORS, RUN_COLORS


def own_markup(page):
    """Return a report without the page in its frame."""
    return re.sub(r'srcdoc="[^"]*"', "", page)


def test_metrics_of_revolute_and_prismatic_joints_are_those_of_their_columns(gantry):
    kinds = summarize_by_unit(gantry)
    assert [*kinds] == ["rad", "m"]
    assert kinds["m"].max_error == pytest.approx(np.abs(gantry.e[:, 0]).max())
    assert kinds["rad"].max_error == pytest.approx(np.abs(gantry.e[:, 1]).max())
    assert kinds["m"].peak_torque == pytest.approx(np.abs(gantry.tau[:, 0]).max())
    assert units("m")["peak_torque"] == "N"
    assert units("m")["torque_variation"] == "N/s"
    assert units("m")["ise"] == "m²·s"


def test_one_kind_of_joint_has_one_summary(two_link):
    assert summarize_by_unit(two_link) == {"rad": fp.summarize(two_link)}


def test_a_summary_prints_each_metric_with_its_unit(gantry, two_link):
    printed = str(summarize_by_unit(gantry)["m"])
    assert re.search(r"^max_error +0\.3 m$", printed, re.MULTILINE)
    assert re.search(r"^energy +\S+ J$", printed, re.MULTILINE)
    assert re.search(r"^max_error +\S+ rad$", str(fp.summarize(two_link)), re.MULTILINE)
    assert re.search(r"^max_error +\S+ m \+ rad$", str(fp.summarize(gantry)), re.MULTILINE)
    assert "settling_time_0_1_mrad  never" in printed
    assert "position_unit" not in fp.summarize(gantry).as_dict()


def test_the_report_has_rows_for_each_unit(gantry, tmp_path, text_of):
    gantry.save(tmp_path / "run.npz")
    text = text_of(write_report(tmp_path).read_text("utf-8"))
    kinds = summarize_by_unit(gantry)
    assert text.index("Revolute joints") < text.index("Prismatic joints")
    for word in ("RMS error, last half [mm]", "peak force [N]", "peak torque [N·m]"):
        assert word in text
    assert f"{kinds['m'].peak_torque:.3g}" in text
    assert f"{kinds['rad'].peak_torque:.3g}" in text


def test_no_axis_of_the_overview_bears_two_units(gantry):
    labels = [axes.get_ylabel() for axes in overview_figure(gantry).axes]
    assert labels == ["error [m]", "error [rad]", "force [N]", "torque [N·m]", "s [–]"]
    drawn = [len(axes.lines) for axes in overview_figure(gantry).axes]
    assert drawn == [1, 1, 1, 1, 2]


def test_limits_have_the_colour_of_no_run():
    assert LIMIT["color"] not in {*COLORS, *RUN_COLORS}


class Pusher:
    """A controller that lets the first joint go."""

    dt = 1e-3

    def __init__(self, arm):
        self.arm = arm

    def update(self, q, v, q_d, v_d, a_d, dt=None):
        return 1e6 * (v + 1e-3)

    def reset(self):
        pass


@pytest.fixture(scope="module")
def lost():
    arm = fp.load_arm("two_link", effort_limit=1e9)
    with pytest.raises(fp.errors.DivergenceError) as caught:
        fp.simulate(arm, Pusher(arm), fp.references.Hold(arm, arm.neutral), 5.0)
    return caught.value


def test_the_recording_of_a_divergence_carries_time_and_joint_through_its_file(lost, tmp_path):
    lost.recording.save(tmp_path / "run.npz")
    again = fp.Recording.load(tmp_path / "run.npz")
    assert again.divergence == {"time": lost.time, "joint": lost.joint}
    assert "diverged" in repr(again)


def test_report_and_page_say_first_that_the_run_diverged(lost, tmp_path, text_of):
    lost.recording.save(tmp_path / "run.npz")
    page = own_markup(write_report(tmp_path).read_text("utf-8"))
    words = f"diverged at t = {lost.time:.4g} s: joint {lost.joint} left first"
    assert words in text_of(page)
    assert page.index(words) < page.index("<section")
    assert page.index(words) < page.index("<nav")
    html_page = fp.export_html(lost.recording, tmp_path / "page.html").read_text("utf-8")
    assert html_page.index(words) < html_page.index("<main>")


def test_a_run_that_went_to_its_end_says_nothing_of_divergence(two_link, tmp_path):
    two_link.save(tmp_path / "run.npz")
    assert two_link.divergence is None
    assert 'role="alert"' not in own_markup(write_report(tmp_path).read_text("utf-8"))


def test_a_recording_is_one_line(two_link):
    assert repr(two_link) == (
        "<Recording of MadeUp on two_link_true: 4001 rows over 4 s, 2 joints>"
    )


def test_a_notebook_shows_a_recording_as_its_page_without_rights(two_link):
    shown = two_link._repr_html_()
    assert 'sandbox="allow-scripts"' in shown
    assert "fotsmc-arrays" in html.unescape(shown)
    assert "MadeUp moved two_link_true for 4 s" in shown
    assert "http" not in re.sub(r'srcdoc="[^"]*"', "", shown)


def test_a_notebook_shows_arms_controllers_and_summaries_as_tables(gantry):
    arm = fp.perturb(gantry.arm, payload=2.5)
    shown = arm._repr_html_()
    assert "slide</th><td>prismatic</td><td>-1 m … 1 m</td><td>1 m/s</td><td>400 N</td>" in shown
    assert "2.5 kg" in shown
    gains = fp.LinearSMC(gantry.arm, 1e-3)._repr_html_()
    assert "boundary_layer</th><td>0.1</td><td>rad/s</td>" in gains
    summary = summarize_by_unit(gantry)["m"]._repr_html_()
    assert "max_error</th><td>0.3 m</td>" in summary


def test_names_in_a_notebook_are_escaped(gantry):
    hostile = fp.Arm(**(gantry.arm.to_dict() | {"name": "<b>", "changes": ("<script>",)}))
    shown = hostile._repr_html_()
    assert "<b>" not in shown
    assert "<script>" not in shown
