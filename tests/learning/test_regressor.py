"""The columns of a row are the derivatives of the torque, and what is written is a possible arm."""

import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.learning.estimates import Estimates, learned_arm
from fotsmc_pin.learning.parameters import Beliefs, Layout, Prior, first_beliefs
from fotsmc_pin.learning.tool import tool_link, unit_bodies
from fotsmc_pin.learning.trust import body


def written(arm, used):
    """The model that `used` makes of an arm."""
    model, dynamic = arm.model.copy(), np.zeros(10)
    for link in range(arm.nv):
        body(link, arm.nv, tool_link(arm), unit_bodies(arm), used, dynamic)
        model.inertias[link + 1] = pin.Inertia.FromDynamicParameters(dynamic)
    return model


def nominal_use(arm):
    layout = Layout(arm.nv, stribeck=False)
    return layout, Beliefs(*first_beliefs(arm, Prior(), layout)).mean.copy()


def state(arm, rng):
    return arm.random_configuration(rng), rng.normal(size=arm.nv), rng.normal(size=arm.nv)


@pytest.mark.parametrize("name", ["panda", "kinova", "two_link"])
def test_nothing_learnt_is_the_nominal_arm(name):
    arm = fp.load_arm(name)
    _, used = nominal_use(arm)
    model = written(arm, used)
    q, v, a = state(arm, np.random.default_rng(0))
    torque = pin.rnea(model, model.createData(), q, v, a)
    assert torque == pytest.approx(arm.inverse_dynamics(q, v, a), rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("name", ["panda", "kinova", "two_link"])
def test_columns_are_the_derivatives_of_the_torque(name):
    arm, rng, step = fp.load_arm(name), np.random.default_rng(1), 1e-5
    n = arm.nv
    layout, used = nominal_use(arm)
    used[layout.groups["payload"].start] = 1.0  # where the moments of a payload mean something
    q, v, a = state(arm, rng)
    model, data = arm.model, arm.model.createData()
    regressor = pin.computeJointTorqueRegressor(model, data, q, v, a).copy()
    bodies = unit_bodies(arm)[:-1]
    for column, unit in enumerate(bodies):
        link = column if column < n else tool_link(arm) if column < n + 4 else (column - n - 4) // 3
        expected = regressor[:, 10 * link : 10 * link + 10] @ unit
        torques = []
        for sign in (1.0, -1.0):
            moved = used.copy()
            moved[column] += sign * step
            shifted = written(arm, moved)
            torques.append(pin.rnea(shifted, shifted.createData(), q, v, a))
        found = (torques[0] - torques[1]) / (2.0 * step)
        assert found == pytest.approx(expected, rel=1e-4, abs=1e-4), column


@pytest.mark.parametrize("name", ["panda", "z1"])
def test_whatever_is_used_is_a_possible_arm(name):
    arm, rng = fp.load_arm(name), np.random.default_rng(2)
    layout, used = nominal_use(arm)
    beliefs = Beliefs(*first_beliefs(arm, Prior(), layout))
    for _ in range(50):
        used[:] = rng.uniform(beliefs.lowest, beliefs.highest)
        model = written(arm, used)
        for inertia, nominal in zip([*model.inertias][1:], [*arm.model.inertias][1:], strict=True):
            least = np.linalg.eigvalsh(inertia.toPseudoInertia().toMatrix()).min()
            of_file = np.linalg.eigvalsh(nominal.toPseudoInertia().toMatrix()).min()
            assert inertia.mass > 0.0
            assert least > min(0.0, 5.0 * of_file) - 1e-9  # no worse than the file itself
        M = pin.crba(model, model.createData(), arm.random_configuration(rng))
        assert np.linalg.eigvalsh(M + np.diag(arm.armature)).min() > 0.0


@pytest.mark.parametrize("name", ["panda", "ur5", "two_link"])
def test_the_learned_arm_is_the_model_that_the_law_has(name):
    arm, rng = fp.load_arm(name), np.random.default_rng(3)
    layout, _ = nominal_use(arm)
    table = first_beliefs(arm, Prior(), layout)
    beliefs = Beliefs(*table)
    spread = 0.5 * beliefs.deviation
    beliefs.estimate[:] = np.clip(
        beliefs.mean + spread * rng.normal(size=layout.size), beliefs.lowest, beliefs.highest
    )
    beliefs.estimate[layout.groups["payload"].start] = 1.0
    learnt = learned_arm(arm, Estimates.of(arm, layout, beliefs))
    model = written(arm, beliefs.estimate)
    model.armature = beliefs.estimate[layout.groups["armature"]]
    q, v, a = state(arm, rng)
    expected = pin.rnea(model, model.createData(), q, v, a)
    assert learnt.inverse_dynamics(q, v, a) == pytest.approx(expected, rel=1e-6, abs=1e-6)
    assert learnt.friction == pytest.approx(beliefs.estimate[layout.groups["friction"]])
