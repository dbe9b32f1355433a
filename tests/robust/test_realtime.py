"""The loop in wall-clock time: its rate, its account of itself, and how it ends."""

import os
import signal
import time

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import Safeguard
from fotsmc_pin.references import Hold

DT = 5e-3


class FrozenRobot:
    """A robot whose brakes are on; notes what it is told, and may fail or be slow."""

    compensates, paced = (), False

    def __init__(self, arm, *, fails_at=None, slow_at=None):
        self.arm, self.torques = arm, []
        self.fails_at, self.slow_at, self.reads = fails_at, slow_at, 0

    def read(self):
        self.reads += 1
        if self.reads == self.fails_at:
            raise OSError("the cable is off")
        if self.reads == self.slow_at:
            time.sleep(4.5 * DT)
        return np.array(self.arm.neutral), np.zeros(self.arm.nv)

    def write(self, tau):
        self.torques.append(tau)


@pytest.fixture(scope="module")
def arm():
    return fp.load_arm("two_link")


def guarded(arm):
    return Safeguard(fp.RobustFONFTSM(arm, DT), soft_start=0.0, watchdog=1.0)


def test_the_rate_is_kept_and_accounted_for(arm):
    robot = FrozenRobot(arm)
    timing = fp.run_realtime(guarded(arm), robot, Hold(arm), 0.4, stop_time=0.1).timing
    assert timing.ticks == len(robot.torques)
    # A busy machine may lose ticks, but the loop never runs ahead of the clock.
    assert timing.period > 0.99 * DT
    assert timing.ticks <= 102
    assert list(timing.latency) == sorted(timing.latency)
    assert timing.latency[-1] > timing.compute[0] > 0.0
    assert timing.stopped == "the end of the run"
    assert "deadlines missed" in str(timing)
    np.testing.assert_allclose(robot.torques[-1], arm.gravity(arm.neutral), atol=1e-6)


def test_a_late_tick_is_counted_and_its_successors_are_not_rushed(arm):
    robot, times = FrozenRobot(arm, slow_at=5), []
    timing = fp.run_realtime(
        guarded(arm), robot, Hold(arm), 0.3, stop_time=0.0, observe=lambda t, *_: times.append(t)
    ).timing
    assert timing.missed >= 1
    late = np.diff(times)[4]
    assert late >= 4.5 * DT - 1e-3
    assert timing.latency[-1] >= 4.5 * DT


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_stops_safely(arm, number):
    robot, before = FrozenRobot(arm), signal.getsignal(number)

    def interrupt(t, *_):
        if len(robot.torques) == 10:
            os.kill(os.getpid(), number)

    run = fp.run_realtime(guarded(arm), robot, Hold(arm), 60.0, stop_time=0.5, observe=interrupt)
    timing = run.timing
    assert timing.stopped == number.name
    assert timing.ticks <= 10 + 0.5 / DT + 2
    np.testing.assert_allclose(robot.torques[-1], arm.gravity(arm.neutral), atol=1e-6)
    assert signal.getsignal(number) is before


def test_a_failing_robot_is_stopped_before_the_error_is_raised(arm):
    robot, controller = FrozenRobot(arm, fails_at=10), guarded(arm)
    with pytest.raises(OSError, match="cable"):
        fp.run_realtime(controller, robot, Hold(arm), 10.0, stop_time=0.4)
    assert "cable" in controller.stopped
    np.testing.assert_allclose(robot.torques[-1], arm.gravity(arm.neutral), atol=1e-6)
