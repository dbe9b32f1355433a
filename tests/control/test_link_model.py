"""`SpringObserver` with encoders on the motors: the links' side from the motors'."""

import copy
import pickle

import numpy as np
import pytest
from scipy.linalg import expm

import fotsmc_pin as fp
from fotsmc_pin.control.link_model import (
    LinkRows,
    LinkState,
    link_corrections,
    observe_links,
)
from fotsmc_pin.control.rows import named_rows
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import TickDelay, simulate

DT = 1e-3
J, LINK = 0.1, 0.9


def arm_of(name="ur5"):
    return fp.load_arm(name, armature="rotors", friction=0.0, damping=0.0)


def observer(arm, stiffness=200.0, **options):
    K = np.asarray(stiffness * arm.effort_limit)
    return fp.SpringObserver(fp.RobustFONFTSM(arm, DT), K, encoder="motor", **options)


def on_springs(arm, stiffness, **changes):
    K = stiffness * arm.effort_limit
    damping = 2.0 * 0.02 * np.sqrt(K * arm.armature)
    return fp.perturb(arm, joint_stiffness=K, joint_damping=damping, **changes)


def held(true, controller, offset, duration):
    arm = controller.arm
    return simulate(
        true,
        controller,
        Hold(arm),
        duration,
        q0=arm.integrate(arm.neutral, np.full(arm.nv, offset)),
        substeps=4,
        encoder="motor",
        actuator=TickDelay(1),
    )


def ticks(controller, count, seed=0):
    """Torques of a wavy motion with small errors."""
    arm, rng = controller.arm, np.random.default_rng(seed)
    middle, rates = arm.random_configuration(rng), np.linspace(2.0, 6.0, arm.nv)
    torques = []
    for k in range(count):
        angle = rates * k * DT
        q_d = arm.integrate(middle, 0.2 * np.sin(angle))
        v_d, a_d = 0.2 * rates * np.cos(angle), -0.2 * rates**2 * np.sin(angle)
        q = arm.integrate(q_d, 1e-4 * rng.normal(size=arm.nv))
        torques.append(controller.update(q, v_d + 1e-3 * rng.normal(size=arm.nv), q_d, v_d, a_d))
    return np.array(torques)


@pytest.mark.parametrize("swing", [50.0, 150.0, 450.0])
def test_a_link_on_a_motor_that_is_led_swings_as_it_should(swing):
    """Without corrections, against the exact solution: only the midpoint rule is between them."""
    K = LINK * swing**2
    D = 0.02 * np.sqrt(K * J)
    table = np.zeros((len(LinkRows._fields), 1))
    x = named_rows(table, LinkRows)
    x.elastic[:], x.rotor[:], x.stiffness[:], x.damping[:], x.corner[:] = 1.0, J, K, D, 9.0
    state = np.zeros((len(LinkState._fields), 1))
    s = named_rows(state, LinkState)
    s.ticks[:], s.deflection[:] = 1.0, 1e-3
    A = np.array([[0.0, -1.0], [K / LINK, -D / LINK]])
    exact, dt = np.array([1e-3, 0.0]), 1e-4
    for _ in range(200):
        later, lead, rest = np.zeros_like(state), np.zeros((2, 1)), np.zeros(1)
        mass, scratch = np.array([[LINK]]), np.zeros((1, 1))
        s.fastest[:] = 1e3  # as of a motor that moves: a link on one that stands comes to rest
        observe_links(dt, mass, rest, rest, rest, table, state, later, lead, scratch)
        state[:] = later
        exact = expm(A * dt) @ exact
    assert s.deflection[0] == pytest.approx(exact[0], abs=3e-6)
    assert s.v[0] == pytest.approx(exact[1], abs=3e-6 * swing)


@pytest.mark.parametrize("rotor", [0.02, 0.1, 0.9])
@pytest.mark.parametrize("swing", [20.0, 141.0, 447.0, 1900.0])
@pytest.mark.parametrize("dt", [5e-4, 1e-3])
def test_errors_of_the_estimate_decay(rotor, swing, dt):
    """Of the sampled equations that it is made for, whatever the shares of motor and link."""
    link, K = 1.0 - rotor, rotor * swing**2
    D = 2.0 * 0.02 * rotor * swing
    gains = link_corrections(dt, rotor, link, K, D)
    m = max(link, K * dt * dt / 4.0)
    A = np.array(
        [
            [-D / rotor, -K / rotor, D / rotor, 0.0],
            [1.0, 0.0, -1.0, 0.0],
            [D / m, K / m, -D / m, 1.0],
            [0.0, 0.0, 0.0, 0.0],
        ]
    )
    F = expm(A * dt)
    gain = np.array([1.0, gains[0] + 0.5 * dt, gains[1], gains[2]])
    moved = F - np.outer(gain, F[0])
    assert np.abs(np.linalg.eigvals(moved)).max() < 1.0 - 1e-5


def test_with_the_right_model_the_links_are_found():
    arm = arm_of()
    rec = held(on_springs(arm, 200.0), observer(arm), 0.05, 1.0)
    lead, found = rec.signals["deflection"], rec.signals["motor_lead"]
    assert np.abs(lead[rec.t < 0.5] - lead[-1]).max() > 5e-4
    assert np.abs(found - lead)[rec.t > 0.1].max() < 0.03 * np.abs(lead).max()
    assert np.abs(rec.e_motor[-1]).max() < 1e-4  # the motors are where they should be


def test_a_heavy_arm_with_small_rotors_comes_to_rest():
    """The UR10 with a tool: its rotors are a tenth of what they turn, and the bare law rattles."""
    arm = fp.load_arm("ur10", armature="rotors")
    true = on_springs(arm, 1000.0, mass_scale=1.3, payload=10.0)
    bare = held(true, fp.RobustFONFTSM(arm, DT), 0.02, 1.0)
    found = held(true, observer(arm, 1000.0), 0.02, 1.0)
    late = bare.t > 0.7
    assert np.abs(found.v_motor[late]).max() < 0.01
    assert np.abs(bare.v_motor[late]).max() > 0.1


def test_a_motor_that_friction_holds_is_not_shaken():
    """Corrected by its torque, which friction takes up, the estimate would feed the law itself."""
    arm = fp.load_arm("panda", armature="rotors")
    true = on_springs(arm, 100.0, mass_scale=1.3, friction=0.5, damping=0.5)
    rec = held(true, observer(arm, 100.0), 0.02, 3.0)
    swing = np.ptp(rec.signals["deflection"][rec.t > 2.0], axis=0)
    assert swing.max() < 1.5e-4


def test_rigid_joints_pass_through_beside_elastic_ones():
    arm = arm_of("kinova")
    expected = ticks(fp.RobustFONFTSM(arm, DT), 60)
    assert np.array_equal(ticks(observer(arm, np.inf), 60), expected)
    mixed = observer(arm, np.where(np.arange(arm.nv) == 1, 200.0, np.inf))
    ticks(mixed, 60)
    lead = mixed._lead
    assert lead[0, 1] != 0.0
    assert np.array_equal(np.delete(lead[0], 1), np.zeros(arm.nv - 1))


@pytest.mark.parametrize("name", ["ur5", "kinova"])
def test_copies_and_saved_states_go_on_bit_for_bit(name):
    arm = arm_of(name)
    controller = observer(arm, delay=2)
    first = ticks(controller, 70)
    other = observer(arm, delay=2)
    other.restore_state(controller.save_state())
    twins = [copy.deepcopy(controller), other, pickle.loads(pickle.dumps(controller))]
    expected = ticks(controller, 50, seed=1)
    for twin in twins:
        assert np.array_equal(ticks(twin, 50, seed=1), expected)
    controller.reset()
    assert np.array_equal(ticks(controller, 70), first)
    assert controller.around(fp.LinearSMC(arm, DT)).encoder == "motor"


def test_a_side_that_there_is_not_is_named():
    with pytest.raises(ArgumentError, match="encoder"):
        fp.SpringObserver(fp.LinearSMC(arm_of(), DT), 1e4, encoder="both")
