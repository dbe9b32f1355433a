"""Figures for papers: units on the axes, the right curves, and files that do not change."""

from __future__ import annotations

import re

import numpy as np
import pytest
from PIL import Image

import fotsmc_pin as fp
from fotsmc_pin import view
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.view import palette
from fotsmc_pin.view.style import WIDTHS

FIGURES = {
    "overview": view.overview_figure,
    "tracking": view.tracking_figure,
    "velocity": view.velocity_figure,
    "torque": view.torque_figure,
    "signal": view.signal_figure,
    "comparison": lambda rec: view.comparison_figure({"one": rec, "two": rec}),
}


@pytest.mark.parametrize("kind", FIGURES)
def test_every_axis_carries_its_unit(kind, two_link):
    figure = FIGURES[kind](two_link)
    for axes in figure.axes:
        assert re.search(r"\[.+\]$", axes.get_ylabel()), axes.get_ylabel()
        if axes.get_xlabel():
            assert axes.get_xlabel() == "time [s]"
    assert any(axes.get_xlabel() for axes in figure.axes)


@pytest.mark.parametrize("kind", FIGURES)
def test_figures_fit_the_columns_of_a_journal(kind, two_link):
    assert FIGURES[kind](two_link).get_size_inches()[0] in WIDTHS.values()


@pytest.mark.parametrize(
    "figure",
    [
        lambda panda: view.overview_figure(panda),
        lambda panda: view.comparison_figure(
            dict.fromkeys((f"the controller number {k} of many" for k in range(5)), panda)
        ),
        lambda _: view.distribution_figure(
            {f"group {k}" * 2: [1.0, 2.0] for k in range(4)}, "a", "s"
        ),
    ],
    ids=["overview", "comparison", "distribution"],
)
def test_a_legend_stays_inside_its_figure(figure, make_recording):
    figure = figure(make_recording(fp.load_arm("panda")))
    figure.draw_without_rendering()
    (legend,) = figure.legends
    box = legend.get_window_extent()
    assert box.x0 >= 0.0
    assert box.x1 <= figure.bbox.width
    assert box.y1 <= figure.bbox.height
    assert box.y0 >= max(axes.bbox.y1 for axes in figure.axes)


def test_a_front_is_drawn_in_the_order_of_its_errors_on_scales_that_fit_it():
    (axes,) = view.front_figure([(0.5, 10.0), (0.005, 12.0), (0.05, 11.0)], "error [rad]").axes
    (line,) = axes.lines
    assert line.get_ydata().tolist() == [0.005, 0.05, 0.5]
    assert line.get_xdata().tolist() == [12.0, 11.0, 10.0]
    assert (axes.get_xscale(), axes.get_yscale()) == ("linear", "log")
    assert axes.get_ylabel() == "error [rad]"


@pytest.mark.parametrize(
    ("kind", "ending"), [("tracking", "svg"), ("torque", "png"), ("overview", "pdf")]
)
def test_same_run_gives_the_same_bytes(kind, ending, two_link, tmp_path):
    files = [tmp_path / f"{name}.{ending}" for name in "ab"]
    for file in files:
        assert fp.plot(two_link, file, kind=kind) == [file]
    assert files[0].read_bytes() == files[1].read_bytes()


def test_a_saved_run_is_enough(two_link, tmp_path):
    two_link.save(tmp_path / "run.npz")
    fp.plot(two_link, tmp_path / "a.png")
    fp.plot(tmp_path / "run.npz", tmp_path / "b.png")
    a, b = (np.asarray(Image.open(tmp_path / f"{name}.png")) for name in "ab")
    np.testing.assert_array_equal(a, b)
    assert np.ptp(a) > 0


def test_a_name_without_ending_gives_vectors_and_pixels(two_link, tmp_path):
    files = fp.plot([two_link, two_link], tmp_path / "new" / "v1.2")
    assert [file.name for file in files] == ["v1.2.svg", "v1.2.png"]
    assert all(file.stat().st_size > 0 for file in files)


def test_tracking_draws_position_reference_and_error(two_link):
    left, right = view.tracking_figure(two_link, joints=[1]).axes[:2]
    arm, reference = left.get_lines()
    np.testing.assert_allclose(arm.get_ydata()[-1], two_link.q[-1, 1])
    np.testing.assert_allclose(reference.get_ydata()[0], two_link.q_d[0, 1])
    assert reference.get_linestyle() != "-"
    np.testing.assert_allclose(
        np.abs(right.get_lines()[0].get_ydata()).max(), abs(two_link.e[0, 1])
    )
    (inset,) = right.child_axes
    tail = two_link.t >= 0.5 * two_link.t[-1]
    shown = np.abs(inset.get_lines()[0].get_ydata()).max()
    assert shown == pytest.approx(1e3 * np.abs(two_link.e[tail, 1]).max(), rel=1e-2)


def test_a_continuous_joint_that_turns_on_is_drawn_without_jumps(make_recording):
    arm = fp.load_arm("kinova")
    t = np.arange(1000) * 1e-2
    angle = np.outer(t, np.where(np.array(arm.joint_names) == arm.joint_names[0], 2.0, 0.0))
    angle += arm.to_joint_positions(arm.neutral)
    q = np.array([arm.from_joint_positions(a) for a in angle])
    zero = np.zeros((len(t), arm.nv))
    run = make_recording(
        arm, t=t, q=q, q_d=q, e=zero, e_dot=zero, v=zero, v_d=zero, tau=zero, signals={}
    )
    line = view.tracking_figure(run, joints=[0]).axes[0].get_lines()[0]
    assert np.ptp(line.get_ydata()) == pytest.approx(2.0 * t[-1], rel=1e-6)
    assert np.abs(np.diff(line.get_ydata())).max() < 0.1


def test_limits_near_the_torque_are_drawn_and_all_are_told(make_recording):
    run = make_recording(fp.load_arm("two_link_true"))
    near = view.torque_figure(run, joints=[0]).axes[0]
    limit = run.arm.effort_limit[0]
    assert {line.get_ydata()[0] for line in near.get_lines()[1:]} == {limit, -limit}
    quiet = make_recording(run.arm, tau=1e-3 * run.tau)
    far = view.torque_figure(quiet, joints=[0]).axes[0]
    assert len(far.get_lines()) == 1
    assert f"{limit:g}" in far.get_title(loc="right")


def test_settings_of_the_user_are_left_alone(two_link, tmp_path):
    import matplotlib as mpl

    before = dict(mpl.rcParams)
    fp.plot(two_link, tmp_path / "a.svg")
    assert dict(mpl.rcParams) == before


def seen_by_the_colour_blind(rgb: np.ndarray, kind: str) -> np.ndarray:
    """Colours after Machado, Oliveira and Fernandes (2009), full severity, on linear sRGB."""
    protan = [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ]
    deutan = [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ]
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    seen = np.clip(linear @ np.array({"protan": protan, "deutan": deutan}[kind]).T, 0, 1)
    return np.where(seen <= 0.0031308, 12.92 * seen, 1.055 * seen ** (1 / 2.4) - 0.055)


@pytest.mark.parametrize("kind", ["protan", "deutan"])
def test_colours_stay_apart_for_the_colour_blind(kind):
    rgb = np.array([[int(c[k : k + 2], 16) / 255 for k in (1, 3, 5)] for c in palette.COLORS[:4]])
    seen = seen_by_the_colour_blind(rgb, kind)
    distance = np.linalg.norm(seen[:, None] - seen[None], axis=-1)
    assert distance[np.triu_indices(len(seen), 1)].min() > 0.15


@pytest.mark.parametrize(
    ("options", "argument"),
    [
        ({"kind": "pie"}, "kind"),
        ({"joints": [2]}, "joints"),
        ({"joints": [-1]}, "joints"),
        ({"kind": "signal", "signal": "nothing"}, "signal"),
    ],
)
def test_unusable_options_are_named(two_link, tmp_path, options, argument):
    with pytest.raises(ArgumentError) as caught:
        fp.plot(two_link, tmp_path / "a.png", **options)
    assert caught.value.argument == argument


def test_an_unknown_ending_is_refused(two_link, tmp_path):
    with pytest.raises(ArgumentError, match=r"\.svg, \.png or \.pdf"):
        fp.plot(two_link, tmp_path / "a.gif")


def test_several_runs_can_only_be_compared(two_link, tmp_path):
    with pytest.raises(ArgumentError, match="compared"):
        fp.plot([two_link, two_link], tmp_path / "a.png", kind="torque")
