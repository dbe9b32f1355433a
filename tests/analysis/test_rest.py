"""Metrics of rest and of the tool: against motions whose answers are known in closed form."""

from types import SimpleNamespace

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.analysis import (
    reference_stop,
    summarize,
    summarize_by_unit,
    swings,
    time_to_rest,
    tool_errors,
    units,
)
from fotsmc_pin.analysis.metrics import UNITS

T = np.arange(10_001) * 1e-3


def run_of(e, stop=None):
    """A run of errors (N, nv) under a reference that moves until `stop`; None: to the end."""
    v_d = np.ones_like(e)
    if stop is not None:
        v_d[stop - 1e-9 <= T] = 0.0
    return SimpleNamespace(t=T, e=e, v_d=v_d)


def test_the_stop_is_when_the_reference_moves_no_more():
    assert reference_stop(run_of(np.zeros((10_001, 2)), 4.0)) == pytest.approx(4.0)
    assert reference_stop(run_of(np.zeros((10_001, 2)), 0.0)) == 0.0
    assert reference_stop(run_of(np.zeros((10_001, 2)))) is None


def test_the_swing_is_that_of_each_joint_in_the_last_half_of_the_rest():
    e = np.zeros((10_001, 2))
    e[:, 0] = 0.3 + 2e-3 * np.sin(2 * np.pi * T)  # An offset is no swing.
    e[T < 6.9, 1] = 5.0  # Before the last half of the time from 4 s to 10 s.
    assert swings(run_of(e, 4.0)) == pytest.approx([4e-3, 0.0])
    moving = swings(run_of(e))
    assert moving == pytest.approx([4e-3, 5.0])


def test_a_decaying_swing_comes_to_rest_when_less_than_the_bound_is_left():
    e = np.zeros((10_001, 2))
    late = np.maximum(T - 4.0, 0.0)
    e[:, 1] = 0.01 * np.exp(-2.0 * late) * (T >= 4.0)
    expected = np.log(0.01 / 1.5e-4) / 2.0
    assert time_to_rest(run_of(e, 4.0)) == pytest.approx(expected, abs=2e-3)


def test_an_arm_that_hunts_never_comes_to_rest():
    e = np.zeros((10_001, 1))
    e[:, 0] = 1e-3 * (np.floor(T / 3.0) % 2)  # It slips every three seconds, and sticks between.
    assert time_to_rest(run_of(e[:, :], 2.0)) > 5.0
    e[:, 0] = 2e-4 * np.sin(40.0 * T)
    assert time_to_rest(run_of(e, 2.0)) == np.inf
    assert time_to_rest(run_of(np.zeros((10_001, 1)))) == np.inf


def test_rest_has_to_be_seen_for_half_a_second():
    e = np.zeros((10_001, 1))
    e[T < 9.6, 0] = 0.01
    assert time_to_rest(run_of(e, 4.0)) == np.inf
    e[T > 9.4, 0] = 0.0
    assert time_to_rest(run_of(e, 4.0)) == pytest.approx(5.4, abs=2e-3)


@pytest.fixture(scope="module")
def mixed(tmp_path_factory):
    text = """<robot name="mixed"><link name="base"/>
    <link name="cart"><inertial><mass value="2"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01"
      iyz="0" izz="0.01"/></inertial></link>
    <joint name="slide" type="prismatic"><parent link="base"/><child link="cart"/>
      <axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="50" velocity="2"/></joint>
    <link name="rod"><inertial><origin xyz="0 0 -0.2"/><mass value="1"/><inertia ixx="0.02" ixy="0"
      ixz="0" iyy="0.02" iyz="0" izz="0.001"/></inertial></link>
    <joint name="hinge" type="revolute"><parent link="cart"/><child link="rod"/>
      <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="30" velocity="5"/></joint></robot>"""
    path = tmp_path_factory.mktemp("mixed") / "mixed.urdf"
    path.write_text(text)
    arm = fp.load_arm(path)
    reference = fp.references.Sinusoid.inside_limits(arm)
    true = fp.perturb(arm, mass_scale=1.3)
    return fp.simulate(true, fp.ComputedTorque(arm, 1e-3), reference, 2.0)


def test_each_kind_of_joint_is_judged_by_itself(mixed):
    parts = summarize_by_unit(mixed)
    assert list(parts) == ["rad", "m"]
    slide = mixed.arm.joint_names.index("slide")
    assert parts["m"].max_error == np.abs(mixed.e[:, slide]).max()
    assert parts["rad"].max_error == np.abs(mixed.e[:, 1 - slide]).max()
    assert parts["m"].peak_torque == np.abs(mixed.tau[:, slide]).max()
    assert parts["m"].energy + parts["rad"].energy == pytest.approx(summarize(mixed).energy)


def test_an_arm_of_one_kind_is_judged_as_ever():
    arm = fp.load_arm("two_link")
    rec = fp.simulate(arm, fp.ComputedTorque(arm, 1e-3), fp.references.Hold(arm), 0.5)
    assert summarize_by_unit(rec) == {"rad": summarize(rec)}


def test_every_metric_has_a_unit_for_both_kinds():
    names = set(fp.Summary.__dataclass_fields__) - {"position_unit"}
    assert set(UNITS) == set(units("rad")) == set(units("m")) == names
    assert units("m")["peak_torque"] == "N"
    assert units("m")["ise"] == "m²·s"
    assert units("m")["tail_torque_variation"] == "N/s"
    assert not any("rad" in unit for unit in units("m").values())


def test_the_tools_error_is_the_distance_between_two_poses(mixed):
    tool = tool_errors(mixed)
    last = [mixed.arm.tool_pose(q).translation for q in (mixed.q[-1], mixed.q_d[-1])]
    assert tool[-1] == pytest.approx(np.linalg.norm(last[0] - last[1]))
    assert 0.0 < tool.max() < 0.5
    shifted = SimpleNamespace(t=mixed.t, q=mixed.q_d, q_d=mixed.q_d, arm=mixed.arm)
    assert not tool_errors(shifted).any()
