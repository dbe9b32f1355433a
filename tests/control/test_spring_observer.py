"""`SpringObserver`: the motor's side from the link's, with the face of a controller."""

import copy
import math
import pickle

import numpy as np
import pytest
from scipy.linalg import expm

import fotsmc_pin as fp
from fotsmc_pin.control import CONTROLLERS
from fotsmc_pin.control.spring_model import corrections, observer_rates, swung, transition
from fotsmc_pin.errors import ArgumentError, MeasurementError
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import TickDelay, simulate

DT = 1e-3


def arm_of(name="ur5"):
    return fp.load_arm(name, armature="rotors", friction=0.0, damping=0.0)


def observer(arm=None, law=fp.RobustFONFTSM, stiffness=200.0, gains=None, **options):
    arm = arm_of() if arm is None else arm
    K = stiffness * arm.effort_limit
    return fp.SpringObserver(law(arm, DT, **(gains or {})), K, **options)


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


def run(controller, count=100, seed=0):
    return np.array([controller.update(*tick) for tick in ticks(controller.arm, count, seed)])


@pytest.mark.parametrize("damping", [0.0, 3.0, 400.0], ids=["none", "swinging", "overdamped"])
@pytest.mark.parametrize("dt", [1e-4, 1e-3, 0.02, 1.0])
def test_a_step_of_the_spring_is_exact_and_of_any_length(dt, damping):
    J, K, tau, v0, v1, delta, omega = 0.5, 2e4, 30.0, 0.4, -0.3, 1e-3, 0.2
    A = np.zeros((5, 5))  # δ, ω, v, its slope, 1
    A[0, 1], A[0, 2], A[2, 3] = 1.0, -1.0, 1.0
    A[1] = [-K / J, -damping / J, damping / J, 0.0, tau / J]
    exact = expm(A * dt) @ [delta, omega, v0, (v1 - v0) / dt, 1.0]
    found = swung(dt, J, K, damping, tau, v0, v1, delta, omega)
    assert found == pytest.approx(exact[:2], rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("swing", [20.0, 150.0, 450.0, 1000.0, 1900.0])
@pytest.mark.parametrize("dt", [1e-3, 5e-4])
def test_errors_decay_at_the_rates_that_are_designed(swing, dt):
    J, D = 0.3, 0.2
    K = J * swing**2
    rates = observer_rates(dt, J, K, D)
    gains = corrections(dt, J, K, D, rates)
    F = transition(dt, J, K, D)
    moved = (np.eye(4) - np.outer(gains, [1.0, 0.0, 0.0, 0.0])) @ F
    poles = np.linalg.eigvals(moved)
    wanted = np.exp(rates * dt)
    assert np.sort_complex(poles) == pytest.approx(np.sort_complex(wanted), abs=1e-6)
    assert (np.abs(wanted) < 1.0).all()


def elastic(arm, stiffness, damping_ratio=0.02):
    K = stiffness * arm.effort_limit
    damping = 2.0 * damping_ratio * np.sqrt(K * arm.armature)
    return fp.perturb(arm, joint_stiffness=K, joint_damping=damping)


def test_with_the_right_model_the_motors_are_found():
    arm = arm_of()
    true = elastic(arm, 200.0)
    watched = observer(arm, joint_damping=true.joint_damping, gains={"bandwidth": 0.5})
    start = arm.integrate(arm.neutral, np.full(arm.nv, 0.05))
    rec = simulate(
        true, watched, Hold(arm), 1.5, q0=start, substeps=10, encoder="link", actuator=TickDelay(1)
    )
    lead, found = rec.signals["deflection"], rec.signals["motor_lead"]
    moving = rec.t < 0.5
    assert np.abs(lead[moving] - lead[-1]).max() > 5e-4
    assert np.abs(found - lead)[rec.t > 0.2].max() < 0.02 * np.abs(lead).max()
    assert np.abs(found - lead)[-1].max() < 1e-6
    assert np.abs(rec.e[-1]).max() < 1e-4  # the links, and not the motors, are where they should be


def test_a_panda_with_wrong_masses_follows_on_soft_springs():
    arm = fp.load_arm("panda", armature="rotors")
    true = elastic(fp.perturb(arm, mass_scale=1.3, payload=2.0, friction=0.5, damping=0.5), 200.0)
    reference = fp.references.Sinusoid.inside_limits(arm, amplitude=0.3)
    rec = simulate(
        true,
        observer(arm, gains={"bandwidth": 0.5}),
        reference,
        2.5,
        q0=reference(0.0)[0],
        substeps=2,
        encoder="link",
        actuator=TickDelay(1),
    )
    assert np.linalg.norm(rec.e, axis=1)[rec.t > 1.0].max() < 0.02


@pytest.mark.parametrize("stiffness", [math.inf, 1e9], ids=["rigid", "stiff"])
def test_rigid_joints_pass_through(stiffness):
    arm = arm_of("kinova")
    expected = run(fp.RobustFONFTSM(arm, DT))
    assert np.array_equal(run(observer(arm, stiffness=stiffness)), expected)


@pytest.mark.filterwarnings("ignore::fotsmc_pin.control.PaperConditionWarning")
@pytest.mark.parametrize("law", CONTROLLERS.values(), ids=CONTROLLERS)
def test_every_law_can_be_wrapped(law):
    controller = observer(law=law)
    torques = run(controller, 50)
    assert np.isfinite(torques).all()
    assert (np.abs(torques) <= controller.arm.effort_limit).all()
    assert {"motor_lead", *controller.controller.signals} <= set(controller.signals)
    assert not np.array_equal(torques, run(law(controller.arm, DT), 50))


def test_it_goes_around_a_law_that_learns():
    arm = arm_of()
    learner = fp.ModelLearning(fp.RobustFONFTSM(arm, DT), bears=(0.3, 3.0))
    controller = fp.SpringObserver(learner, 200.0 * arm.effort_limit)
    run(controller, 50)
    assert controller.label == "RobustFONFTSM + learning + spring observer"
    assert {"payload", "motor_lead"} <= set(controller.signals)


def test_inside_of_it_the_loop_keeps_the_nominal_model():
    arm = arm_of()
    learner = fp.ModelLearning(fp.RobustFONFTSM(arm, DT), bears=(0.3, 3.0))
    assert learner.controller.model_terms.model is not arm.model
    controller = fp.SpringObserver(learner, 200.0 * arm.effort_limit)
    run(controller, 50)
    for one in (controller, copy.deepcopy(controller)):
        assert one.controller.controller.model_terms.model is one.arm.model


@pytest.mark.parametrize("name", ["ur5", "kinova"])
def test_copies_and_saved_states_go_on_bit_for_bit(name):
    arm = arm_of(name)
    controller = observer(arm, delay=2)
    first = run(controller, 70)
    other = observer(arm, delay=2)
    run(other, 13, seed=5)
    other.restore_state(controller.save_state())
    twins = [copy.copy(controller), copy.deepcopy(controller), other]
    twins.append(pickle.loads(pickle.dumps(controller)))
    expected = run(controller, 50, seed=1)
    for twin in twins:
        assert np.array_equal(run(twin, 50, seed=1), expected)
        assert not np.shares_memory(twin._state, controller._state)
    controller.reset()
    assert np.array_equal(run(controller, 70), first)


def test_what_is_not_a_measurement_leaves_the_memory_as_it_was():
    controller, twin = observer(), observer()
    run(controller, 50), run(twin, 50)
    n = controller.arm.nv
    for place in range(5):
        broken = [np.zeros(n) for _ in range(5)]
        broken[place] = np.full(n, np.nan)
        with pytest.raises(MeasurementError):
            controller.update(*broken)
    with pytest.raises(ArgumentError, match="dt"):
        controller.update(*(np.zeros(n) for _ in range(5)), dt=-1.0)
    assert np.array_equal(run(controller, 50, seed=1), run(twin, 50, seed=1))


def test_a_state_that_is_not_whole_changes_nothing():
    controller = observer()
    run(controller, 30)
    state = controller.save_state()
    before = run(copy.deepcopy(controller), 20, seed=1)
    for name in ("sent", "state", "controller.state.z"):
        with pytest.raises(ArgumentError):
            controller.restore_state({key: a for key, a in state.items() if key != name})
    with pytest.raises(ArgumentError):
        controller.restore_state({**state, "sent": state["sent"] * np.nan})
    assert np.array_equal(run(controller, 20, seed=1), before)


@pytest.mark.parametrize(
    ("options", "name"),
    [
        ({"joint_stiffness": -1.0}, "joint_stiffness"),
        ({"joint_stiffness": [1.0]}, "joint_stiffness"),
        ({"joint_damping": -1.0}, "joint_damping"),
        ({"rotor": 0.0}, "rotor"),
        ({"delay": -1}, "delay"),
        ({"corner": 0.0}, "corner"),
    ],
)
def test_wrong_arguments_are_named(options, name):
    law = fp.LinearSMC(arm_of(), DT)
    with pytest.raises(ArgumentError, match=name):
        fp.SpringObserver(law, **{"joint_stiffness": 1e4, **options})


def test_what_is_not_a_controller_is_refused():
    with pytest.raises(ArgumentError, match="controller"):
        fp.SpringObserver(arm_of(), 1e4)


def test_a_safeguard_goes_around_it():
    guarded, twin = fp.Safeguard(observer()), fp.Safeguard(observer())
    run(guarded, 20)
    twin.restore_state(guarded.save_state())
    assert np.array_equal(run(twin, 20, seed=1), run(guarded, 20, seed=1))
    assert guarded.gains is guarded.controller.controller.gains
