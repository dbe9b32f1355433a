"""Two laws that share a torque: each takes in what the other adds, and neither works against it."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control.robust_rows import State, Work
from fotsmc_pin.control.rows import named_rows
from fotsmc_pin.control.shared_torque import accelerated


def memory(n):
    state = named_rows(np.zeros((len(State._fields), n)), State)
    return state, named_rows(np.zeros((len(Work._fields), n)), Work)


@pytest.mark.parametrize("n", [1, 3, 7])
def test_an_added_torque_accelerates_what_the_law_turns_changes_into_torque_with(n):
    """`(M0 + J + δ)⁻¹ τ`, to a thousandth, where a direction weighs ten thousand times less too."""
    rng = np.random.default_rng(n)
    for _ in range(20):
        m, w = memory(n)
        A = rng.normal(size=(n, n))
        M0 = A @ A.T + np.diag(np.logspace(-4, 0, n))
        m.J[:], m.delta[:] = rng.uniform(0.0, 2.0, n), rng.uniform(0.0, 0.5, n)
        tau = rng.normal(size=n)
        accelerated(M0, tau, m, w)
        M = M0 + np.diag(m.J + m.delta)
        assert np.linalg.norm(M @ w.more - tau) < 1e-3 * np.linalg.norm(tau) + 1e-12


def test_a_joint_that_friction_holds_takes_no_part():
    rng = np.random.default_rng(0)
    A = rng.normal(size=(4, 4))
    M0, (m, w) = A @ A.T + np.eye(4), memory(4)
    m.rest[:], m.held[2] = 1.0, 1.0
    tau, free = rng.normal(size=4), [0, 1, 3]
    accelerated(M0, tau, m, w)
    assert w.more[2] == 0.0
    np.testing.assert_allclose(w.more[free], np.linalg.solve(M0[np.ix_(free, free)], tau[free]))


def test_a_law_beside_another_does_not_wind_up_against_it():
    """The other holds the arm, this one wants to move it: told of that, it sees no disturbance."""
    arm = fp.load_arm("two_link", effort_limit=[1e5, 1e5])
    q, rest, speed = np.array([0.5, 0.7]), np.zeros(2), np.array([0.3, 0.3])
    found = {}
    for is_told in (True, False):
        law = fp.RobustFONFTSM(arm, 1e-3)
        for _ in range(2000):
            asked = law.update(q, rest, q + 0.01, speed, rest)
            if is_told:
                acts = arm.gravity(q)
                law.joints.tau_extra[:], law.joints.tau[:] = acts - asked, acts
        found[is_told] = np.abs(law.state.b).max()
    assert found[True] < 1e-9
    assert found[False] > 100.0
