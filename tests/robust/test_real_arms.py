"""`RobustFONFTSM` on arms as they are: rest, friction, rotors, wrong masses, far starts."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.evaluation.stress.payloads import stress_payload
from fotsmc_pin.references import Hold, Sinusoid
from fotsmc_pin.simulation import Encoder, NoisySensor, TickDelay, simulate

DT = 1e-3
SLIDER = """<robot name="slider"><link name="base"/><link name="cart"><inertial><mass value="{}"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="x" type="prismatic"><parent link="base"/><child link="cart"/><axis xyz="1 0 0"/>
<limit lower="-10" upper="10" effort="1e9" velocity="1e9"/></joint></robot>"""


class FromPoseToPose:
    """Each joint 0.5 rad forth and back in `time`, with a dwell of 1.5 s after each way."""

    def __init__(self, arm, time):
        self.arm, self.time, self.period = arm, time, time + 1.5
        self.start = Sinusoid.inside_limits(arm)(0.0)[0]
        self.way = 0.5 * (-1.0) ** np.arange(arm.nv)

    def __call__(self, t):
        number, s = int(t // self.period), min((t % self.period) / self.time, 1.0)
        sign = 1.0 if number % 2 == 0 else -1.0
        x = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        x = x if sign > 0.0 else 1.0 - x
        v = sign * 30.0 * s**2 * (1.0 - s) ** 2 / self.time
        a = sign * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / self.time**2
        return self.arm.integrate(self.start, self.way * x), self.way * v, self.way * a


def arms(name, nominal=None, true=None):
    """Return a nominal arm, and a true one that is heavier, loaded and rubs.

    Their rotors are the effort limit over `nominal` and over `true`.
    """
    raw = fp.load_arm(name)
    limit = np.array(raw.effort_limit)
    rotors = {} if nominal is None else {"armature": (limit / nominal).tolist()}
    friction = (0.5 * np.minimum(1.0, limit / 20.0)).tolist()
    plant = fp.perturb(
        raw,
        mass_scale=1.3,
        payload=stress_payload(raw),
        friction=friction,
        damping=friction,
        **({} if true is None else {"armature": (limit / true).tolist()}),
    )
    return fp.load_arm(name, **rotors), plant


def run(
    name,
    make_reference,
    duration,
    *,
    nominal=None,
    true=None,
    start=0.2,
    bits=None,
    falling=False,
    **gains,
):
    arm, plant = arms(name, nominal, true)
    if falling:
        plant = fp.perturb(plant, stiction=1.5, stribeck_velocity=0.05)
    noisy = NoisySensor(arm, position=1e-5, velocity=1e-3)
    reference = make_reference(arm)
    return simulate(
        plant,
        fp.RobustFONFTSM(arm, DT, **gains),
        reference,
        duration,
        q0=arm.integrate(reference(0.0)[0], np.full(arm.nv, start)),
        v0=np.zeros(arm.nv),
        sensor=noisy if bits is None else Encoder(arm, DT, bits=bits),
        actuator=TickDelay(1),
        integrator="semi-implicit",
        substeps=2,
    )


def hold(arm):
    return Hold(arm, Sinusoid.inside_limits(arm)(0.0)[0])


def last(rec, seconds):
    return rec.e[rec.t > rec.t[-1] - seconds]


def rms(errors):
    return np.sqrt((errors**2).sum(axis=1).mean())


@pytest.fixture(scope="module")
def slider(tmp_path_factory):
    folder = tmp_path_factory.mktemp("slider")

    def load(mass):
        path = folder / f"slider_{mass:g}.urdf"
        path.write_text(SLIDER.format(mass))
        return fp.load_arm(path)

    return load


class TestSlider:
    """A mass `m` times the nominal one, held without friction from 50 mm off."""

    @pytest.mark.parametrize(
        ("dt", "delay", "masses"),
        [
            (1e-3, 1, (0.15, 0.5, 1.0, 3.0, 5.0, 10.0)),
            (1e-3, 2, (0.3, 1.0, 3.0, 10.0)),
            (4e-3, 1, (0.2, 1.0, 3.0, 5.0)),
        ],
    )
    def test_it_comes_to_rest(self, slider, dt, delay, masses):
        arm = slider(1.0)
        for mass in masses:
            law, plant = fp.RobustFONFTSM(arm, dt), slider(mass)
            rec = simulate(plant, law, Hold(arm), 20.0, q0=[0.05], actuator=TickDelay(delay))
            e = last(rec, 5.0)
            assert np.ptp(e) < 1e-6, mass
            assert np.abs(e).max() < (1e-8 if mass <= 3.0 else 3e-4), mass


class TestRest:
    @pytest.mark.parametrize("name", ["ur3", "kinova", "so100", "asr_twodof"])
    def test_it_holds_against_friction_and_does_not_hunt(self, name):
        rec = run(name, hold, 12.0)
        assert rms(last(rec, 4.0)) < 3e-4
        assert np.ptp(last(rec, 4.0), axis=0).max() < 3e-4

    def test_with_two_integrals_it_would_hunt(self):
        """What rest is worth: the same law under a reference that always seems to move."""

        def never_at_rest(arm):
            q_d, v_d, a_d = hold(arm)(0.0)
            return lambda t: (q_d.copy(), v_d.copy(), a_d + 1.0)

        rec = run("so100", never_at_rest, 12.0)
        assert np.ptp(last(rec, 4.0), axis=0).max() > 1e-3

    @pytest.mark.parametrize("name", ["ur3", "xarm7", "z1"])
    def test_it_rests_after_a_move(self, name):
        rec = run(name, lambda a: FromPoseToPose(a, 2.0), 7.0, nominal=200, true=150, start=0.0)
        for dwell in (2.0, 5.5):
            e = rec.e[(rec.t > dwell) & (rec.t < dwell + 1.5)]
            assert np.abs(e).max() < 3e-3
            assert np.linalg.norm(e[500:], axis=1).max() < 5e-4

    def test_the_torque_has_no_step_where_a_motion_begins_or_ends(self):
        arm = fp.load_arm("panda")
        rec = simulate(
            arm, fp.RobustFONFTSM(arm, DT), FromPoseToPose(arm, 1.0), 4.0, actuator=TickDelay(1)
        )
        steps = np.abs(np.diff(rec.tau[5:], axis=0)).max(axis=1)
        near_ends = steps[
            [k for end in (1.0, 2.5, 3.5) for k in range(int(1e3 * end) - 50, int(1e3 * end) + 45)]
        ]
        assert near_ends.max() < 1.5 * steps.max() / 2.0


class TestRotors:
    @pytest.mark.parametrize("true", [400, 50])
    @pytest.mark.parametrize("name", ["ur3", "so100", "ur10"])
    def test_they_are_found_where_the_model_has_none(self, name, true):
        rec = run(name, Sinusoid.inside_limits, 8.0, true=true)
        assert rms(last(rec, 3.0)) < 2e-3

    def test_no_more_is_found_than_there_is(self):
        rec = run("asr_twodof", Sinusoid.inside_limits, 8.0, true=100)
        limit = fp.load_arm("asr_twodof").effort_limit
        share = rec.signals["rotor"][-1] / (limit / 100.0)
        assert (share < 1.1).all()
        assert (share > 1.0 / 6.0).all()

    def test_without_the_search_the_loop_is_lost(self):
        rec = run("ur3", Sinusoid.inside_limits, 4.0, true=100, rotor_limit=0.0)
        assert rms(last(rec, 1.0)) > 2e-2

    @pytest.mark.parametrize("name", ["so100", "z1", "asr_twodof"])
    def test_none_is_found_where_there_is_none(self, name):
        rec = run(name, Sinusoid.inside_limits, 6.0)
        assert (rec.signals["rotor"][-1] < fp.load_arm(name).effort_limit / 2000.0).all()

    @pytest.mark.parametrize("name", ["panda", "ur10", "so100"])
    def test_a_nominal_rotor_in_the_middle_serves_all(self, name):
        for true in (400, 150):
            rec = run(name, Sinusoid.inside_limits, 6.0, nominal=200, true=true)
            assert rms(last(rec, 3.0)) < 3e-4


@pytest.mark.parametrize("reference", [Sinusoid.inside_limits, hold])
@pytest.mark.parametrize("name", ["panda", "kinova", "xarm7"])
class TestSensorsAndFriction:
    """The arms with the largest errors of the ten, with rotors."""

    @pytest.mark.parametrize(("bits", "bound"), [(20, 1e-3), (17, 2e-3)])
    def test_an_encoder_alone_is_enough(self, name, reference, bits, bound):
        rec = run(name, reference, 6.0, nominal=200, true=150, bits=bits)
        assert rms(last(rec, 3.0)) < bound

    def test_friction_may_fall_with_speed(self, name, reference):
        rec = run(name, reference, 6.0, nominal=200, true=150, falling=True)
        assert rms(last(rec, 3.0)) < 1e-3


class TestFarStart:
    @pytest.mark.parametrize("rotors", [{"nominal": 200, "true": 150}, {}], ids=["rotors", "raw"])
    @pytest.mark.parametrize("start", [0.5, 1.5, 3.0])
    @pytest.mark.parametrize("name", ["panda", "ur5", "kinova"])
    def test_the_way_keeps_the_velocity_limits(self, name, start, rotors):
        rec = run(name, hold, 9.0, start=start, **rotors)
        limit = fp.load_arm(name).velocity_limit
        assert (np.abs(rec.v - rec.v_d).max(axis=0) < 1.1 * limit).all()
        assert -rec.e.min() < 0.05 * start
        assert rms(last(rec, 1.0)) < 1e-3

    def test_without_a_leading_point_a_wrist_shoots_past(self):
        courses = [
            run("xarm7", hold, 4.0, start=0.5, **off).e for off in ({}, {"approach": np.inf})
        ]
        assert -courses[0].min() < 1e-3 < 0.1 < -courses[1].min()

    def test_a_small_error_is_left_to_the_surface(self):
        courses = [run("two_link", hold, 0.5, start=0.05, **off) for off in ({}, {"approach": 1e9})]
        assert np.abs(courses[0].e).max() > 0.04
        np.testing.assert_array_equal(courses[0].tau, courses[1].tau)

    def test_a_joint_that_brakes_shows_its_rotor(self):
        rec = run("z1", hold, 1.5, nominal=200, true=50)
        lacks = fp.load_arm("z1").effort_limit * (1.0 / 50.0 - 1.0 / 200.0)
        share = rec.signals["rotor"][-1] / lacks
        assert (share > 0.1).all()
        assert (share < 1.0).all()


class TestBandwidth:
    """Half the bandwidth on twice the time gives the same course of a small error."""

    def courses(self, slider, make_reference, begin, **start):
        arm, found = slider(1.0), []
        for bandwidth, duration in ((1.0, 0.5), (0.5, 1.0)):
            law, end = fp.RobustFONFTSM(arm, DT / 4.0, bandwidth=bandwidth), begin + duration
            rec = simulate(arm, law, make_reference(arm), end, **start)
            found.append(np.interp(np.linspace(begin, end, 50), rec.t, rec.e[:, 0]))
        return found

    def test_it_scales_time_in_motion(self, slider):
        def steady(arm):
            return lambda t: (np.array([0.5 * t]), np.array([0.5]), np.zeros(1))

        one, half = self.courses(slider, steady, 0.0, q0=[1e-4], v0=[0.5])
        assert np.abs(one).max() > 9e-5
        np.testing.assert_allclose(one, half, rtol=0.0, atol=2e-7)

    def test_it_scales_time_at_rest(self, slider):
        """From when rest is believed, which takes its time whatever the bandwidth."""

        def step(arm):
            return lambda t: (np.full(1, -1e-4 * (t >= 0.5)), np.zeros(1), np.zeros(1))

        one, half = self.courses(slider, step, 0.5)
        assert np.abs(one).max() > 9e-5
        np.testing.assert_allclose(one, half, rtol=0.0, atol=2e-7)
