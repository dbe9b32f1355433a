"""Live targets: limits kept to rounding, losses and late targets borne, bad ones refused."""

import threading
from itertools import pairwise

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.errors import ArgumentError, MissingDependencyError
from fotsmc_pin.references import LiveTarget

DT = 1e-3


@pytest.fixture(scope="module", params=["two_link", "panda", "kinova"])
def arm(request):
    return fp.load_arm(request.param)


def lossy(live, rng, last, every=20):
    """A reference that sets far targets at 50 Hz until `last` and loses a fifth of them."""
    arm, place = live.arm, {"q": live.arm.neutral}

    def reference(t):
        tick = round(t / DT)
        if tick % every == 0 and t < last:
            if tick % 400 == 0:
                place["q"] = arm.random_configuration(rng)
            if rng.uniform() > 0.2:
                live.set_q(place["q"])
        return live(t)

    reference.is_live = True
    return reference


def test_limits_are_kept_to_rounding(arm):
    live = LiveTarget(arm)
    reference = lossy(live, np.random.default_rng(1), np.inf)
    rows = [reference(k * DT) for k in range(6000)]
    _, v, a = (np.array(part) for part in zip(*rows, strict=True))
    x = np.cumsum([arm.difference(one[0], two[0]) for one, two in pairwise(rows)], axis=0)
    assert (np.abs(v) <= live.velocity * (1.0 + 1e-9)).all()
    assert (np.abs(a) <= live.acceleration * (1.0 + 1e-9)).all()
    assert (np.abs(np.diff(a, axis=0)) <= live.jerk * DT * (1.0 + 1e-6)).all()
    assert np.abs(v).max(axis=0) == pytest.approx(live.velocity, rel=0.5)  # they were at work
    # Position, velocity and acceleration belong together, to the jerk within a tick.
    np.testing.assert_allclose(np.diff(x, axis=0), DT * 0.5 * (v[1:-1] + v[2:]), atol=1e-5)
    np.testing.assert_allclose(
        np.diff(v, axis=0), 0.5 * DT * (a[1:] + a[:-1]), atol=live.jerk.max() * DT**2
    )


def test_a_law_settles_on_a_stream_with_losses():
    arm = fp.load_arm("panda")
    live = LiveTarget(arm)
    reference = lossy(live, np.random.default_rng(0), 1.5)
    rec = fp.simulate(arm, fp.RobustFONFTSM(arm, DT), reference, 4.0)
    assert np.abs(rec.e[-500:]).max() < 1e-3
    assert np.abs(rec.v[-1]).max() < 1e-3
    assert np.abs(rec.q_d[-1] - rec.q_d[0]).max() > 0.3


def test_a_stale_target_ends_in_a_hold(arm):
    live = LiveTarget(arm, timeout=0.2)
    live.set_q(arm.integrate(arm.neutral, np.full(arm.nv, 1.0)))
    moving = [live(k * DT) for k in range(200)][-1]
    assert np.abs(moving[1]).max() > 0.1
    held = [live(k * DT) for k in range(200, 2000)]
    assert live.is_stale
    assert np.abs(held[-1][1]).max() == 0.0
    assert np.abs(arm.difference(held[-1][0], held[-400][0])).max() == 0.0
    live.set_q(arm.neutral)
    after = [live(2.0 + k * DT) for k in range(3000)]
    assert not live.is_stale or np.abs(after[-1][1]).max() == 0.0
    assert np.abs(after[150][1]).max() > 0.01


def test_far_targets_stay_within_the_position_limits():
    arm = fp.load_arm("panda")
    live = LiveTarget(arm, margin=0.05, timeout=np.inf)
    live.set_q(np.full(7, 100.0))
    rows = np.array([live(k * DT)[0] for k in range(8000)])
    assert (rows <= arm.upper_position_limit - 0.05 + 1e-9).all()
    np.testing.assert_allclose(rows[-1], arm.upper_position_limit - 0.05, atol=1e-9)


def test_what_is_not_usable_is_refused_and_changes_nothing(arm):
    live, twin = LiveTarget(arm), LiveTarget(arm)
    goal = arm.integrate(arm.neutral, np.full(arm.nv, 0.3))
    for one in (live, twin):
        one.set_q(goal)
    with pytest.raises(ArgumentError, match="q"):
        live.set_q(np.full(arm.nq, np.nan))
    with pytest.raises(ArgumentError, match="pose"):
        live.set_pose(np.full((4, 4), np.nan))
    with pytest.raises(ArgumentError, match="rotation"):
        live.set_pose(np.diag([2.0, 1.0, 1.0, 1.0]))
    with pytest.raises(ArgumentError, match="jerk"):
        LiveTarget(arm, jerk=0.0)
    for k in range(100):
        np.testing.assert_array_equal(live(k * DT)[0], twin(k * DT)[0])


def test_a_pose_is_reached_and_one_out_of_reach_approached():
    arm = fp.load_arm("panda")
    start = arm.integrate(arm.neutral, [0.0, 0.3, 0.0, -0.8, 0.0, 1.2, 0.4])
    live = LiveTarget(arm, q0=start, timeout=np.inf)
    pose = arm.tool_pose(start)
    pose.translation = pose.translation + np.array([0.05, -0.1, 0.05])
    assert live.set_pose(pose) < 1e-5
    q = [live(k * DT) for k in range(4000)][-1][0]
    assert np.abs((arm.tool_pose(q).inverse() * pose).homogeneous - np.eye(4)).max() < 1e-5
    assert live.set_pose(np.array([3.0, 0.0, 0.3])) == pytest.approx(2.1, abs=0.3)


def test_the_run_begins_anew_when_time_goes_back(arm):
    live = LiveTarget(arm)
    live.set_q(arm.integrate(arm.neutral, np.full(arm.nv, 0.3)))
    first = [live(k * DT)[0] for k in range(300)]
    assert np.abs(arm.difference(first[0], first[-1])).max() > 0.01
    np.testing.assert_allclose(arm.difference(live(0.0)[0], arm.neutral), 0.0, atol=1e-15)


def test_targets_may_come_from_another_thread():
    arm = fp.load_arm("two_link")
    live, done = LiveTarget(arm, timeout=np.inf), threading.Event()

    def stream():
        for k in range(2000):
            live.set_q(arm.neutral + 0.1 * np.sin(0.01 * k + np.arange(2)))
        done.set()

    threading.Thread(target=stream, daemon=True).start()
    k = 0
    while not done.is_set() or k < 1000:
        assert np.isfinite(live(k * DT)[0]).all()
        k += 1
    final = [live((k + i) * DT)[0] for i in range(2000)][-1]
    np.testing.assert_allclose(final, arm.neutral + 0.1 * np.sin(19.99 + np.arange(2)), atol=1e-9)


def test_without_ruckig_the_remedy_is_named(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "ruckig", None)
    with pytest.raises(MissingDependencyError, match="pip install"):
        LiveTarget(fp.load_arm("two_link"))
