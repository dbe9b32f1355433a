"""`margins` against simulation: a mass on a slider whose true mass is wrong by a factor."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.analysis import inertia_ratios, largest_bandwidth, margins
from fotsmc_pin.analysis.linearization import linearize
from fotsmc_pin.control import GravityWarning, TickWarning
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import NoisySensor, TickDelay, simulate

DT = 1e-3
SLIDER = """<robot name="slider"><link name="base"/><link name="cart"><inertial><mass value="{}"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="x" type="prismatic"><parent link="base"/><child link="cart"/><axis xyz="1 0 0"/>
<limit lower="-10" upper="10" effort="1e9" velocity="1e9"/></joint></robot>"""
LAWS = {
    "robust at rest": lambda arm: fp.RobustFONFTSM(arm, DT, integral=0.0, rotor_limit=0.0),
    "robust in motion": lambda arm: fp.RobustFONFTSM(arm, DT, rotor_limit=0.0),
    "robust, integer order": lambda arm: fp.RobustFONFTSM(
        arm, DT, alpha=0.0, integral=0.0, rotor_limit=0.0
    ),
    "robust, slower": lambda arm: fp.RobustFONFTSM(
        arm, DT, bandwidth=0.6, integral=0.0, rotor_limit=0.0
    ),
    "PID": lambda arm: fp.ComputedTorque(arm, DT, preset="pid"),
    "linear surface": lambda arm: fp.LinearSMC(arm, DT, preset="boundary_layer"),
}


@pytest.fixture(scope="module")
def slider(tmp_path_factory):
    folder = tmp_path_factory.mktemp("slider")

    def load(mass):
        path = folder / f"slider_{mass:.9g}.urdf"
        path.write_text(SLIDER.format(mass))
        return fp.load_arm(path)

    return load


def swings(slider, make, mass, delay, moving):
    """Size of the last and of an earlier quarter of a hold that starts 0.1 mm off."""
    arm = slider(1.0)
    reference = Hold(arm)
    if moving:
        # At a constant speed the loop is the same as at rest, and the law sees a motion.
        def reference(t):
            return np.array([0.5 * t]), np.array([0.5]), np.zeros(1)

    rec = simulate(
        slider(mass),
        make(arm),
        reference,
        6.0,
        q0=[1e-4],
        actuator=TickDelay(delay) if delay else None,
    )
    n = len(rec.t) // 4
    return np.abs(rec.e[n : 2 * n]).max(), np.abs(rec.e[-n:]).max()


@pytest.mark.parametrize("delay", [1, 2])
@pytest.mark.parametrize("name", LAWS)
def test_the_edges_are_those_of_the_simulation(slider, name, delay):
    make = LAWS[name]
    found = margins(make(slider(1.0)), delay)
    # At rest a joint of about ten times its nominal inertia may count as one that sticks, which the
    # linear loop does not know; without the second integral it is the same loop in motion.
    moving = name in ("robust in motion", "robust, integer order")
    assert found.lowest < 0.5
    inside = [1.1 * found.lowest, found.highest / 1.1]
    outside = [found.lowest / 1.1, 1.1 * found.highest]
    for mass in inside:
        if mass < 100.0:
            earlier, last = swings(slider, make, mass, delay, moving)
            assert last < 0.9 * earlier, (mass, earlier, last)
    for mass in outside:
        if mass < 100.0:
            assert grows(slider, make, mass, delay, moving), mass


def grows(slider, make, mass, delay, moving):
    try:
        earlier, last = swings(slider, make, mass, delay, moving)
    except fp.errors.DivergenceError:
        return True
    return last > 0.95 * earlier


def test_a_pid_has_the_edge_of_routh(slider):
    """`m < kd kp / ki` in continuous time; hold and delay take little at 10 rad/s."""
    found = margins(LAWS["PID"](slider(1.0)), 0)
    assert found.highest == pytest.approx(30.0 * 300.0 / 1000.0, rel=0.02)
    assert margins(fp.ComputedTorque(slider(1.0), DT), 0).highest == 1e3


def test_the_delay_margin_is_where_whole_ticks_lose_the_loop(slider):
    law = fp.ComputedTorque(slider(1.0), DT, kp=2e4, kd=200.0)
    free = margins(law, 0)
    whole = int(free.delay_margin)
    assert margins(law, whole).delay_margin == pytest.approx(free.delay_margin - whole, abs=0.02)
    with pytest.raises(ArgumentError, match="unstable"):
        margins(law, whole + 1)


def test_noise_gains_are_those_of_the_simulation(slider):
    arm = slider(1.0)
    law = fp.RobustFONFTSM(arm, DT, integral=0.0, rotor_limit=0.0)
    found = margins(law, 1)
    for position, velocity, gain in (
        (1e-6, 0.0, found.position_noise),
        (0.0, 1e-4, found.velocity_noise),
    ):
        sensor = NoisySensor(arm, position=position, velocity=velocity, seed=1)
        rec = simulate(arm, law, Hold(arm), 8.0, sensor=sensor, actuator=TickDelay(1))
        rms = np.sqrt(np.mean(rec.tau[1000:] ** 2))
        assert rms == pytest.approx(gain[0] * (position + velocity), rel=0.1)


class TestForm:
    def test_a_law_without_the_nominal_inertia_is_refused(self):
        with pytest.raises(ArgumentError, match="nominal inertia"):
            margins(fp.TDEFONTSM(fp.load_arm("two_link"), DT))

    def test_an_unstable_loop_is_refused(self):
        with pytest.warns(TickWarning, match="kd"):
            law = fp.ComputedTorque(fp.load_arm("two_link"), DT, kd=3000.0)
        with pytest.raises(ArgumentError, match="unstable"):
            margins(law)

    def test_the_controller_is_left_as_it_was(self):
        arm = fp.load_arm("two_link")
        used, twin = fp.RobustFONFTSM(arm, DT), fp.RobustFONFTSM(arm, DT)
        rows = [([0.01 * k, 0.0], [0.1, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]) for k in range(9)]
        for row in rows[:5]:
            used.update(*row)
            twin.update(*row)
        margins(used)
        for row in rows[5:]:
            np.testing.assert_array_equal(used.update(*row), twin.update(*row))

    def test_all_joints_of_one_set_of_gains_have_one_law(self):
        one, two = linearize(fp.RobustFONFTSM(fp.load_arm("two_link"), DT))
        np.testing.assert_allclose(one.A, two.A, atol=1e-9)
        np.testing.assert_allclose(one.D, two.D, rtol=1e-6)

    @pytest.mark.parametrize("name", ["two_link", "kinova"])
    def test_no_way_is_led_near_the_reference(self, name):
        arm = fp.load_arm(name)
        led, free = (linearize(fp.RobustFONFTSM(arm, DT, **g)) for g in ({}, {"approach": np.inf}))
        for one, other in zip(led, free, strict=True):
            np.testing.assert_array_equal(one.A, other.A)
            np.testing.assert_array_equal(one.D, other.D)


class TestInertiaRatios:
    def test_the_same_arm_has_ratios_of_one(self):
        arm = fp.load_arm("panda")
        np.testing.assert_allclose(inertia_ratios(arm, arm).ratios, 1.0, rtol=1e-9)

    def test_a_factor_on_all_masses_is_the_ratio(self):
        arm = fp.load_arm("ur5")
        found = inertia_ratios(fp.perturb(arm, mass_scale=1.5), arm)
        assert found.lowest == pytest.approx(1.5, rel=1e-3)
        assert found.highest == pytest.approx(1.5, rel=1e-3)

    def test_the_joint_that_is_too_heavy_is_named(self):
        arm = fp.load_arm("panda")
        found = inertia_ratios(fp.perturb(arm, armature={"panda_joint7": 0.2}), arm)
        assert found.highest > 10.0
        assert found.joint_highest == "panda_joint7"
        assert found.lowest == pytest.approx(1.0)

    def test_other_joints_are_refused(self):
        with pytest.raises(ArgumentError, match="joints"):
            inertia_ratios(fp.load_arm("panda"), fp.load_arm("two_link"))


@pytest.fixture
def two_link():
    return fp.load_arm("two_link", armature=[0.4, 0.4]), np.array([0.4, 0.4])


class TestElasticJoints:
    def test_a_stiffer_joint_bears_more(self, two_link):
        arm, rotor = two_link
        law = fp.RobustFONFTSM(arm, DT, integral=0.0)
        soft, stiff = (largest_bandwidth(law, k, rotor=rotor) for k in (2e3, 2e4))
        assert soft < stiff

    def test_the_motor_side_bears_more_than_the_link_side(self, two_link):
        arm, rotor = two_link
        law = fp.RobustFONFTSM(arm, DT, integral=0.0)
        sides = [largest_bandwidth(law, 5e3, rotor=rotor, encoder=s) for s in ("link", "motor")]
        assert sides[0] < sides[1]

    def test_a_rotor_outside_the_nominal_inertia_is_refused(self, two_link):
        with pytest.raises(ArgumentError, match="rotor"):
            largest_bandwidth(fp.RobustFONFTSM(two_link[0], DT), 1e3, rotor=1e3)


def test_weight_beyond_an_effort_limit_changes_no_margin():
    """Torque limits are left out of the loop, also where the arm cannot bear its own weight."""
    arm = fp.load_arm("ur5", armature="rotors")
    weak = fp.load_arm("ur5", armature=arm.armature, effort_limit=1.0)
    with pytest.warns(GravityWarning):
        law = fp.LinearSMC(weak, DT, preset="boundary_layer")
    found, expected = margins(law), margins(fp.LinearSMC(arm, DT, preset="boundary_layer"))
    assert found.lowest == pytest.approx(expected.lowest, rel=1e-3)
    assert found.highest == pytest.approx(expected.highest, rel=1e-3)
    torque = law.update(weak.neutral, *np.zeros((1, 6)), weak.neutral, *np.zeros((2, 6)))
    assert np.abs(torque).max() == 1.0
