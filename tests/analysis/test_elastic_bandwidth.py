"""`largest_bandwidth` against simulation of whole arms with springs in their joints."""

import warnings

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.analysis import BandwidthWarning, largest_bandwidth, warn_of_soft_joints
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import TickDelay, simulate

DT = 1e-3


@pytest.fixture(scope="module")
def arms():
    """A UR5 without friction, and the same with springs of effort limit × 200 per rad."""
    arm = fp.load_arm("ur5", armature="rotors", friction=0.0, damping=0.0)
    inertia = np.diag(arm.mass_matrix(arm.neutral))
    k = 200.0 * arm.effort_limit
    damping = 2.0 * 0.02 * np.sqrt(k * arm.armature * (1.0 - arm.armature / inertia))
    return arm, fp.perturb(arm, joint_stiffness=k, joint_damping=damping)


def law(arm, bandwidth):
    """The linear loop: what adapts is off."""
    return fp.RobustFONFTSM(arm, DT, bandwidth=bandwidth, rotor_limit=0.0, floor_share=0.0)


def last_speeds(arms, bandwidth, side):
    """Largest measured speed in the second and in the last quarter of a hold [rad/s]."""
    arm, true = arms
    start = arm.integrate(arm.neutral, np.full(arm.nv, 1e-4))
    rec = simulate(
        true,
        law(arm, bandwidth),
        Hold(arm),
        5.0,
        q0=start,
        substeps=2,
        encoder=side,
        actuator=TickDelay(1),
    )
    v = np.abs(rec.v if side == "link" else rec.v_motor)
    n = len(rec.t) // 4
    return v[n : 2 * n].max(), v[-n:].max()


@pytest.mark.parametrize("side", ["link", "motor"])
def test_a_whole_arm_rests_below_and_swings_above(arms, side):
    arm, true = arms
    edge = largest_bandwidth(law(arm, 1.0), true.joint_stiffness, rotor=arm.armature, encoder=side)
    earlier, last = last_speeds(arms, 0.8 * edge, side)
    assert last < 0.5 * earlier
    assert last_speeds(arms, 1.25 * edge, side)[1] > 0.1


def test_the_run_is_warned_of_before_it_is_lost(arms):
    arm, true = arms
    with pytest.warns(BandwidthWarning, match="link side"):
        warn_of_soft_joints(law(arm, 1.0), true, encoder="link")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_soft_joints(law(arm, 0.05), true, encoder="link")
        warn_of_soft_joints(law(arm, 1.0), arm, encoder="link")


def test_a_rigid_joint_bounds_nothing(arms):
    arm, true = arms
    k = np.where(np.arange(arm.nv) == 2, true.joint_stiffness, np.inf)
    one = largest_bandwidth(law(arm, 1.0), k, rotor=arm.armature)
    rigid = largest_bandwidth(law(arm, 1.0), np.inf, rotor=arm.armature)
    assert one < 0.2 < rigid
