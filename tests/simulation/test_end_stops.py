"""End stops: no effect inside the range, and a joint that is pushed against one stays there."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.references import Hold

DT = 1e-3


class Constant:
    """A constant torque, beside the one that holds the start."""

    dt = DT

    def __init__(self, arm, push):
        self.tau = arm.gravity(arm.neutral) + push

    def update(self, q, v, q_d, v_d, a_d, dt=None):
        return self.tau

    def reset(self):
        pass


def pushed(arm, push, **options):
    return fp.simulate(arm, Constant(arm, push), Hold(arm), 1.5, **options)


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_joint_comes_to_rest_on_its_stop(friction):
    arm = fp.perturb(fp.load_arm("panda"), friction=friction, damping=5.0)
    push = np.array([30.0, 0, 0, 0, 0, 0, 0])
    free, stopped = pushed(arm, push), pushed(arm, push, end_stops=True)
    end = arm.upper_position_limit[0]
    assert free.q[-1, 0] > end + 1.0
    assert stopped.q[:, 0].max() < end + 0.05
    assert abs(stopped.v[-1, 0]) < 0.2 * np.abs(stopped.v[:, 0]).max()
    shown = stopped.signals["end_stop"]
    assert (shown[stopped.q[:, 0] < end - 0.1, 0] == 0.0).all()
    assert shown[:, 0].min() < -30.0
    assert shown[:, 0].max() <= 0.0


def test_inside_the_range_a_run_is_the_same_bit_for_bit():
    arm = fp.load_arm("two_link")
    push = np.array([1.0, 0.0])
    np.testing.assert_array_equal(pushed(arm, push).q, pushed(arm, push, end_stops=True).q)
