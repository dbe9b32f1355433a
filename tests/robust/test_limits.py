"""Limits hold against wild laws; where nothing is near, nothing is changed."""

import copy

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import Hold, Sinusoid
from tests.robust.adversarial import DT, KINDS, Wild, attack, run


@pytest.mark.parametrize(("name", "seed"), [("panda", 5), ("panda", 2), ("ur5", 3), ("kinova", 7)])
def test_no_joint_passes_its_end_or_its_speed(name, seed):
    arm = fp.load_arm(name)
    beyond, speed, guard, rec = run(arm, seed, seconds=0.8)
    assert beyond < 0.0
    assert speed <= 1.02
    assert guard.stopped is None
    assert np.abs(rec.signals["limit_torque"]).max() > 1.0  # they were at work


@pytest.mark.parametrize(
    ("name", "seed"), [("panda", 1), ("kinova", 2), ("panda", 4 * 2 + 3), ("kinova", 45)]
)
def test_no_attack_passes_the_limits(name, seed):
    """Targets that jump, readings that are no numbers, live targets that go stale.

    In the last a torque that acts late meets Coriolis torque by which a light joint is lost.
    """
    outcome = attack(fp.load_arm(name), seed, seconds=0.7)
    assert outcome.kind == KINDS[seed % 4]
    assert outcome.beyond < 0.0
    assert outcome.speed <= 1.02
    assert (outcome.stopped is not None) == (outcome.kind == "no numbers")


def test_without_limits_the_same_law_passes_them():
    arm = fp.load_arm("panda")
    guard = fp.Safeguard(Wild(arm, 3), soft_start=0.0, speed_margin=1e6)
    rec = fp.simulate(arm, guard, Hold(arm, arm.neutral), 0.5, end_stops=True, substeps=2)
    assert (np.abs(rec.v) / arm.velocity_limit).max() > 5.0


def test_a_torque_that_is_no_number_begins_a_stop_within_the_limits():
    arm = fp.load_arm("panda")
    beyond, speed, guard, rec = run(arm, 3, seconds=1.5, nan_from=400)
    assert "torque" in guard.stopped
    assert beyond < 0.0
    assert speed <= 1.02
    assert np.isfinite(rec.tau).all()


def test_inside_all_limits_the_torque_is_the_laws_bit_for_bit():
    arm = fp.load_arm("panda")
    reference = Sinusoid.inside_limits(arm, amplitude=0.2, fraction=0.3)
    runs = [
        fp.simulate(
            arm,
            fp.Safeguard(fp.RobustFONFTSM(arm, DT), soft_start=0.0, limits=limits),
            reference,
            0.5,
        )
        for limits in (None, fp.Limits(arm))
    ]
    np.testing.assert_array_equal(runs[0].tau, runs[1].tau)
    assert (runs[1].signals["limit_torque"] == 0.0).all()


def test_a_start_beyond_the_limits_names_the_joint():
    arm = fp.load_arm("panda")
    q = np.array(arm.neutral)
    q[3] = arm.upper_position_limit[3] + 0.01
    guard = fp.Safeguard(fp.ComputedTorque(arm, DT), limits=fp.Limits(arm))
    still = np.zeros(7)
    with pytest.raises(ArgumentError, match="panda_joint4"):
        guard.update(q, still, q, still, still)
    with pytest.raises(ArgumentError, match="panda_joint2"):
        guard.update(arm.neutral, 4.0 * np.eye(7)[1], q, still, still)


def test_a_start_within_the_margin_is_held_there():
    arm = fp.load_arm("two_link")
    limits = fp.Limits(arm, lower=arm.neutral - 0.5, upper=arm.neutral + 0.005, margin=0.02)
    guard = fp.Safeguard(fp.ComputedTorque(arm, DT), soft_start=0.0, limits=limits)
    rec = fp.simulate(arm, guard, Hold(arm, arm.neutral), 0.5)
    assert np.abs(rec.e).max() < 1e-6


def test_targets_far_outside_end_before_the_ends():
    arm = fp.load_arm("panda")
    guard = fp.Safeguard(fp.ComputedTorque(arm, DT), soft_start=0.2, limits=fp.Limits(arm))
    rec = fp.simulate(arm, guard, Hold(arm, np.full(7, 9.0)), 2.0, q0=arm.neutral, end_stops=True)
    assert (rec.q < arm.upper_position_limit).all()
    assert (np.abs(rec.v) <= 1.02 * arm.velocity_limit).all()
    assert (rec.q[-1] > arm.upper_position_limit - 0.6).any()


def test_the_tool_stays_in_its_box():
    arm = fp.load_arm("panda")
    start = arm.integrate(arm.neutral, [0.0, 0.3, 0.0, -0.8, 0.0, 1.6, 0.4])
    place = arm.tool_pose(start).translation
    box = np.array([place - 0.1, place + 0.1])
    goal = arm.integrate(start, [0.8, 0.4, 0.0, 0.3, 0.0, 0.0, 0.0])
    guard = fp.Safeguard(fp.ComputedTorque(arm, DT), soft_start=0.5, limits=fp.Limits(arm, box=box))
    rec = fp.simulate(arm, guard, Hold(arm, goal), 1.5, q0=start)
    way = np.array([arm.tool_pose(q).translation for q in rec.q])
    assert (way > box[0] - 0.01).all()
    assert (way < box[1] + 0.01).all()
    outside = fp.Limits(arm, box=box + 1.0)
    with pytest.raises(ArgumentError, match="outside the box"):
        fp.simulate(
            arm, fp.Safeguard(fp.ComputedTorque(arm, DT), limits=outside), Hold(arm, start), 0.1
        )


def test_links_stay_apart():
    arm = fp.load_arm("ur5")
    _, _, guard, rec = run(arm, 1, seconds=0.5, clearance=0.03)
    apart = guard._limits._separation
    least = min(apart.gaps(q).min() for q in rec.q[::10])
    assert least > -2e-3


def test_saved_and_copied_it_goes_on_bit_for_bit():
    arm = fp.load_arm("two_link")
    guard = fp.Safeguard(Wild(arm, 1), soft_start=0.0, limits=fp.Limits(arm))
    q, v = np.array(arm.neutral), np.full(2, 2.0)
    for _ in range(20):
        guard.update(q, v, q, v, v)
    twin = copy.deepcopy(guard)
    other = copy.deepcopy(guard)
    other.restore_state(guard.save_state())
    for one in (twin, other):
        here = copy.deepcopy(guard)
        for _ in range(40):
            np.testing.assert_array_equal(here.update(q, v, q, v, v), one.update(q, v, q, v, v))


@pytest.mark.parametrize(
    ("name", "value"),
    [("margin", -0.1), ("delay", -1), ("torque_share", 1.5), ("braking", 0.0), ("box", [1, 2])],
)
def test_unusable_limits_are_refused(name, value):
    with pytest.raises(ArgumentError, match=name):
        fp.Limits(fp.load_arm("two_link"), **{name: value})


def test_an_arm_that_cannot_brake_is_told():
    with pytest.raises(ArgumentError, match="braking"):
        fp.Limits(fp.load_arm("talos_arm"))
