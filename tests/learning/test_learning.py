"""What is learnt is right, what is not told is said to be, and what is odd does no harm."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.analysis import inertia_ratios
from fotsmc_pin.evaluation.stress.cases import stress_scenario
from fotsmc_pin.evaluation.stress.courses import hold
from fotsmc_pin.evaluation.stress.plants import stress_plant
from fotsmc_pin.learning.estimator import JointRows
from fotsmc_pin.learning.parameters import Beliefs, Layout, Prior, first_beliefs
from fotsmc_pin.learning.trust import RELIEF, trust, turn_friction
from fotsmc_pin.simulation import NoisySensor, TickDelay

DT = 1e-3
MRAD = 1e-3


def run(true, controller, reference, duration, q0, **options):
    """A run of noisy sensors and one tick of delay."""
    return fp.simulate(
        true,
        controller,
        reference,
        duration,
        q0=q0,
        v0=np.zeros(true.nv),
        sensor=NoisySensor(true, position=1e-5, velocity=1e-3),
        actuator=TickDelay(1),
        integrator="semi-implicit",
        substeps=2,
        **options,
    )


def joint_rows(n):
    """Rows of joints that move."""
    return JointRows(*np.zeros((len(JointRows._fields), n)))


def norm(recording, start, end):
    inside = (start <= recording.t) & (recording.t < end)
    return np.linalg.norm(recording.e[inside], axis=1)


class TestStressPlant:
    def test_the_error_ends_far_below_that_of_the_law_alone(self, stressed):
        assert np.sqrt((norm(stressed.recording, 3.0, 6.0) ** 2).mean()) < 0.045 * MRAD
        assert stressed.error(2.0, 6.0) < 0.3 * MRAD

    def test_payload_and_friction_are_found(self, stressed):
        estimates = stressed.controller.estimates()
        mass = estimates.group("payload")[0]
        assert mass.known
        assert abs(mass.value - 3.0) < 2.0 * mass.deviation < 1.0
        friction = [row.value for row in estimates.group("friction")]
        assert friction == pytest.approx(stressed.true.friction, rel=0.1)

    def test_the_learned_arm_has_the_mass_matrix_of_the_true_one(self, stressed):
        learnt, true = stressed.controller.learned_arm(), stressed.true
        rng = np.random.default_rng(0)
        for _ in range(5):
            q = true.random_configuration(rng)
            expected = true.mass_matrix(q)
            assert np.abs(learnt.mass_matrix(q) - expected).max() < 0.05 * np.abs(expected).max()

    def test_what_did_not_show_stays_as_it_was_believed(self, stressed):
        first_link = stressed.controller.estimates().group("link_scale")[0]
        assert not first_link.known  # Its only axis is vertical, and it is nearly on it.
        assert first_link.value == pytest.approx(1.0, abs=0.05)
        assert first_link.of in str(stressed.controller.estimates()).splitlines()[-1]

    def test_the_signals_of_the_recording_are_the_estimates(self, stressed):
        signals, estimates = stressed.recording.signals, stressed.controller.estimates()
        for group in ("link_scale", "payload", "link_moment", "armature", "damping", "friction"):
            rows = estimates.group(group)
            assert signals[group][-1] == pytest.approx([row.value for row in rows])
            deviations = [row.deviation for row in rows]
            assert signals[f"{group}_deviation"][-1] == pytest.approx(deviations)


@pytest.mark.parametrize("divisor", [400.0, 50.0])
def test_rotors_that_the_file_lacks_are_found(panda, learner, divisor):
    """Inertia ratios up to 40, where the law alone oscillates until it has found them."""
    scenario = stress_scenario(panda, f"rotors 1/{divisor:g} unknown")
    recording = scenario.run(learner, 4.0)
    found = recording.signals["armature"][-1]
    assert found == pytest.approx(panda.effort_limit / divisor, rel=0.2)
    assert norm(recording, 1.0, 4.0).max() < 2.0 * MRAD
    assert np.sqrt((norm(recording, 3.0, 4.0) ** 2).mean()) < 0.08 * MRAD


@pytest.mark.parametrize(
    ("name", "law"), [("ur5", fp.ComputedTorque), ("ur5", fp.TerminalSMC), ("panda", fp.LinearSMC)]
)
def test_other_laws_keep_the_arm_that_they_lose_alone(name, law):
    """The Panda's last joint sticks under a law that knows hardly any inertia there."""
    arm = fp.load_arm(name)
    scenario = stress_scenario(arm, "sine raw")
    preset = "pid" if "pid" in law.presets else None
    alone, learning = law(arm, DT, preset=preset), law(arm, DT, preset=preset)
    learning = fp.ModelLearning(learning)
    tails = [norm(scenario.run(each, 6.0), 3.0, 6.0).max() for each in (alone, learning)]
    assert tails[1] < 5.0 * MRAD < tails[0]


def test_a_payload_that_comes_and_goes_is_noticed(panda, learner):
    scenario = stress_scenario(panda, "sine raw", payload=0.0)
    empty, loaded = (stress_plant(panda, payload=mass) for mass in (0.0, 2.0))
    events = {3.0: loaded, 6.0: empty}
    recording = run(empty, learner, scenario.reference, 8.5, scenario.q0, events=events)
    payload = recording.signals["payload"][:, 0]
    deviation = recording.signals["payload_deviation"][:, 0]
    for when, held in ((2.99, 0.0), (5.99, 2.0), (8.49, 0.0)):
        k = np.searchsorted(recording.t, when)
        assert abs(payload[k] - held) < min(2.0 * deviation[k], 0.5)
    assert recording.signals["changes"][-1, 0] == 2.0
    for start in (5.0, 8.0):
        assert norm(recording, start, start + 0.5).max() < 0.3 * MRAD


def test_a_push_is_not_learnt(panda, learner):
    scenario = stress_scenario(panda, "sine raw")

    def push(t):
        return np.eye(7)[1] * (50.0 if 3.0 <= t < 3.5 else 0.0)

    recording = run(scenario.true, learner, scenario.reference, 5.0, scenario.q0, disturbance=push)
    payload = recording.signals["payload"][recording.t > 2.5, 0]
    assert np.abs(payload - 3.0).max() < 0.6
    assert recording.signals["learning"].min() == -1.0
    assert norm(recording, 4.0, 5.0).max() < 0.3 * MRAD


def test_nothing_drifts_while_the_arm_holds_still(panda, learner):
    true = stress_plant(panda, payload=3.0)
    course = hold(panda, true, 20.0)
    q0 = panda.integrate(course.reference(0.0)[0], np.full(7, 0.2))
    recording = run(true, learner, course.reference, 20.0, q0)
    late = recording.t > 4.0
    for name in ("link_scale", "payload", "armature", "damping", "friction"):
        for signal in (name, f"{name}_deviation"):
            assert np.ptp(recording.signals[signal][late], axis=0).max() == 0.0, signal
    assert norm(recording, 10.0, 20.0).max() < 0.3 * MRAD


@pytest.mark.filterwarnings("ignore::fotsmc_pin.control.conditions.GravityWarning")
def test_torque_limits_of_a_hundredth_leave_it_bounded(panda):
    weak = fp.load_arm("panda", effort_limit=(0.01 * panda.effort_limit).tolist())
    controller = fp.ModelLearning(fp.RobustFONFTSM(weak, DT), bears=(0.27, 2.5))
    scenario = stress_scenario(panda, "sine raw")
    true = fp.perturb(weak, mass_scale=1.3, friction=0.1, damping=0.1)
    recording = run(true, controller, scenario.reference, 3.0, scenario.q0)
    assert (np.abs(recording.tau) <= weak.effort_limit).all()
    layout = Layout(7, stribeck=False)
    beliefs = Beliefs(*first_beliefs(weak, Prior(), layout))
    for group, place in layout.groups.items():
        signal = recording.signals[group]
        assert (signal >= beliefs.lowest[place] - 1e-12).all(), group
        assert (signal <= beliefs.highest[place] + 1e-12).all(), group


def test_what_is_used_keeps_the_ratios_that_the_law_bears(panda):
    """The true arm is anywhere within two deviations of the estimate, and the nominal one bears."""
    lowest, highest = 0.3, 2.5
    layout = Layout(7, stribeck=False)
    table = first_beliefs(panda, Prior(centres=0.0, offset=0.0), layout)
    b = Beliefs(*table)
    armature = layout.groups["armature"]
    b.estimate[armature] = panda.effort_limit / 100.0
    b.estimate[layout.groups["payload"].start] = 2.0
    sigma = np.where(b.mean == 0.0, 0.3 * b.estimate, 0.1)
    for _ in range(20000):
        trust(DT, 7, lowest, highest, joint_rows(7), b, np.diag(sigma**2))
    used = fp.perturb(panda, armature=b.used[armature], payload=float(b.used[7]))
    assert (b.used[armature] > 0.0).all()
    for sign in (-1.0, 1.0):
        true = fp.perturb(
            panda,
            mass_scale=1.0 + sign * 0.2,
            armature=(b.estimate + 2.0 * sign * sigma)[armature],
            payload=float(b.estimate[7] + 2.0 * sign * sigma[7]),
        )
        ratios = inertia_ratios(true, used)
        assert lowest < ratios.lowest
        assert ratios.highest < highest


def test_the_model_stays_while_the_arm_rests(panda):
    layout = Layout(7, stribeck=False)
    b = Beliefs(*first_beliefs(panda, Prior(), layout))
    b.estimate[:] += 0.1 * b.deviation
    joints, before = joint_rows(7), b.used.copy()
    friction = layout.groups["friction"]
    joints.idle[:] = 1.0
    for _ in range(1000):
        trust(DT, 7, 0.3, 2.5, joints, b, np.zeros((layout.size, layout.size)))
    inertial = slice(0, layout.groups["damping"].start)
    assert (b.used[inertial] == before[inertial]).all()
    assert (b.used[friction] > before[friction]).all()
    joints.idle[3] = 0.0
    for _ in range(1000):
        trust(DT, 7, 0.3, 2.5, joints, b, np.zeros((layout.size, layout.size)))
    assert b.used[layout.groups["armature"]] == pytest.approx(
        b.estimate[layout.groups["armature"]], rel=0.1
    )


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_friction_is_fed_forward_to_the_last_bit_of_the_way_and_taken_back_at_rest(sign):
    joints = joint_rows(1)
    for share in np.linspace(1.0, 0.0, 200):
        turn_friction(DT, np.array([0.5 * sign * share**2]), joints)
    assert sign * joints.direction[0] > 0.99
    for _ in range(200):  # Still on its way.
        turn_friction(DT, np.zeros(1), joints)
    assert sign * joints.direction[0] > 0.99
    joints.idle[:] = 1.0
    for _ in range(round(RELIEF / DT) + 1):
        turn_friction(DT, np.zeros(1), joints)
    assert joints.direction[0] == 0.0
