"""A controller that learns has the face of a controller, and its memory is that of one."""

import copy
import pickle

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.errors import ArgumentError, MeasurementError
from fotsmc_pin.learning import Prior

DT = 1e-3


def ticks(arm, count, seed=0):
    """Arguments of `update`, a wavy motion with small errors."""
    rng = np.random.default_rng(seed)
    middle, rates = arm.random_configuration(rng), np.linspace(2.0, 6.0, arm.nv)
    for k in range(count):
        t = k * DT
        q_d = arm.integrate(middle, 0.2 * np.sin(rates * t))
        v_d, a_d = 0.2 * rates * np.cos(rates * t), -0.2 * rates**2 * np.sin(rates * t)
        q = arm.integrate(q_d, 1e-4 * rng.normal(size=arm.nv))
        yield q, v_d + 1e-3 * rng.normal(size=arm.nv), q_d, v_d, a_d


def run(controller, count=400, seed=0):
    return np.array([controller.update(*tick) for tick in ticks(controller.arm, count, seed)])


def learner(name="panda", law=fp.RobustFONFTSM, **options):
    return fp.ModelLearning(law(fp.load_arm(name), DT), bears=(0.3, 3.0), **options)


def test_switched_off_it_is_the_law_itself():
    arm = fp.load_arm("panda")
    silent = fp.ModelLearning(fp.RobustFONFTSM(arm, DT), feed_forward=False, in_loop=False)
    assert np.array_equal(run(silent), run(fp.RobustFONFTSM(arm, DT)))


@pytest.mark.parametrize("law", [fp.RobustFONFTSM, fp.ComputedTorque, fp.TDEFONTSM])
@pytest.mark.parametrize("in_loop", [True, False])
def test_it_learns_something_and_stays_within_limits(law, in_loop):
    controller = learner(law=law, in_loop=in_loop)
    torques = run(controller, 600)
    assert not np.array_equal(torques, run(law(controller.arm, DT), 600))
    assert np.isfinite(torques).all()
    assert (np.abs(torques) <= controller.arm.effort_limit).all()
    deviation = controller.signals["friction_deviation"]
    assert (deviation < 0.5 * controller.estimates().group("friction")[0].first_deviation).any()


@pytest.mark.parametrize("name", ["panda", "kinova"])
def test_reset_forgets_everything(name):
    controller = learner(name)
    first = run(controller, 403)  # not a whole number of windows
    controller.reset()
    assert np.array_equal(run(controller, 403), first)


@pytest.mark.parametrize("count", [201, 202, 203, 204])
def test_copies_and_saved_states_go_on_bit_for_bit(count):
    controller = learner()
    run(controller, count)
    other = learner()
    run(other, 57, seed=5)
    other.restore_state(controller.save_state())
    twins = [copy.copy(controller), copy.deepcopy(controller), other]
    twins.append(pickle.loads(pickle.dumps(controller)))
    expected = run(controller, 200, seed=1)
    for twin in twins:
        assert np.array_equal(run(twin, 200, seed=1), expected)
        assert not np.shares_memory(twin._P, controller._P)


def test_of_what_is_not_a_measurement_nothing_is_learnt():
    controller, twin = learner(), learner()
    run(controller, 150), run(twin, 150)
    n = controller.arm.nv
    bad = [np.full(n, np.nan), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)]
    for place in range(5):
        broken = [np.zeros(n) for _ in bad]
        broken[place] = bad[0]
        with pytest.raises(MeasurementError):
            controller.update(*broken)
    assert np.array_equal(run(controller, 200, seed=1), run(twin, 200, seed=1))


def test_a_state_that_is_not_whole_changes_nothing():
    controller = learner()
    run(controller, 150)
    state = controller.save_state()
    before = run(copy.deepcopy(controller), 50, seed=1)
    for name in ("P", "beliefs", "controller.state.z"):
        broken = {key: value for key, value in state.items() if key != name}
        with pytest.raises(ArgumentError):
            controller.restore_state(broken)
    with pytest.raises(ArgumentError):
        controller.restore_state({**state, "P": state["P"] * np.nan})
    assert np.array_equal(run(controller, 50, seed=1), before)


@pytest.mark.parametrize(
    ("options", "name"),
    [
        ({"delay": -1}, "delay"),
        ({"bears": (2.0, 3.0)}, "bears"),
        ({"prior": Prior(links=-0.1)}, "links"),
        ({"prior": Prior(friction=[1.0])}, "friction"),
    ],
)
def test_wrong_arguments_are_named(options, name):
    law = fp.RobustFONFTSM(fp.load_arm("panda"), DT)
    with pytest.raises(ArgumentError, match=name):
        fp.ModelLearning(law, **{"bears": (0.3, 3.0), **options})


def test_a_range_of_inertia_comes_from_the_margins_of_the_law():
    law = fp.RobustFONFTSM(fp.load_arm("two_link"), DT)
    found = fp.margins(law, delay=1)
    assert fp.ModelLearning(law).bears == pytest.approx((2.0 * found.lowest, 0.5 * found.highest))
    assert fp.ModelLearning(fp.TDEFONTSM(law.arm, DT)).bears == (0.3, 3.0)
