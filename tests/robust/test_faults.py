"""The faults that `simulate` injects: each does what it says, and the robust law bears them."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import (
    ExactDifferentiator,
    FilteredDifferentiator,
    FrictionCompensation,
    Safeguard,
)
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import Sinusoid
from fotsmc_pin.simulation import (
    Chain,
    NoisySensor,
    Plant,
    QuantizedSensor,
    TickDelay,
    TorqueLag,
    TorqueRateLimit,
    VelocityFromPosition,
    simulate,
)

DT = 1e-3
ENCODER = 2.0 * np.pi / 2**17


@pytest.fixture(scope="module")
def panda():
    return fp.load_arm("panda")


@pytest.fixture(scope="module")
def kinova():
    return fp.load_arm("kinova")


class TestSensors:
    def test_noise_has_its_size_and_its_seed(self, kinova):
        sensor = NoisySensor(kinova, position=1e-3, velocity=[0.1] * 6, seed=4)
        q, v = kinova.neutral, np.ones(6)
        rows = [sensor(0.0, q, v) for _ in range(3000)]
        e = np.array([kinova.difference(q, each) for each, _ in rows])
        e_dot = np.array([each - v for _, each in rows])
        np.testing.assert_allclose(e.std(axis=0), 1e-3, rtol=0.1)
        np.testing.assert_allclose(e_dot.std(axis=0), 0.1, rtol=0.1)
        sensor.reset()
        np.testing.assert_array_equal(sensor(0.0, q, v)[0], rows[0][0])

    def test_readings_stand_on_the_steps_of_the_encoder(self, kinova):
        sensor = QuantizedSensor(kinova, position=0.01, velocity=0.5)
        rng = np.random.default_rng(0)
        for _ in range(20):
            angles, speeds = rng.uniform(-1.5, 1.5, 6), rng.normal(size=6)
            q, v = sensor(0.0, kinova.from_joint_positions(angles), speeds)
            read = kinova.to_joint_positions(q)
            np.testing.assert_allclose(read / 0.01, np.round(angles / 0.01), atol=1e-9)
            np.testing.assert_allclose(v / 0.5, np.round(speeds / 0.5), atol=1e-12)

    def test_a_step_of_zero_is_none(self, panda):
        q, v = QuantizedSensor(panda)(0.0, panda.neutral, np.full(7, 0.123))
        np.testing.assert_array_equal(v, 0.123)
        np.testing.assert_allclose(q, panda.neutral, atol=1e-15)

    def test_bad_numbers_are_refused(self, panda):
        with pytest.raises(ArgumentError, match="position"):
            NoisySensor(panda, position=-1.0)
        with pytest.raises(ArgumentError, match="velocity"):
            QuantizedSensor(panda, velocity=[1.0, 2.0])


class TestActuators:
    def test_a_delay_is_whole_ticks(self):
        delay = TickDelay(2)
        got = [delay(0.0, np.array([float(k)]))[0] for k in range(1, 6)]
        assert got == [0.0, 0.0, 1.0, 2.0, 3.0]
        delay.reset()
        assert delay(0.0, np.array([9.0]))[0] == 0.0

    def test_a_delayed_sensor_repeats_its_first_reading(self):
        delay = TickDelay(1)
        got = [delay(0.0, np.array([k]), np.array([-k]))[0][0] for k in (5, 6, 7)]
        assert got == [5, 5, 6]

    def test_the_rate_is_limited(self, panda):
        limit = TorqueRateLimit(panda, rate=100.0, dt=DT)
        limit(0.0, np.zeros(7))
        np.testing.assert_allclose(limit(0.0, np.full(7, 50.0)), 0.1)
        np.testing.assert_allclose(limit(0.0, np.full(7, 0.15)), 0.15)

    def test_a_lag_is_of_first_order(self):
        lag = TorqueLag(bandwidth=100.0, dt=DT)
        lag(0.0, np.zeros(1))
        for _ in range(10):
            torque = lag(0.0, np.ones(1))
        assert torque[0] == pytest.approx(1.0 - np.exp(-1.0))

    def test_a_chain_goes_from_one_to_the_next_and_resets_all(self, panda):
        chain = Chain(TickDelay(1), TorqueRateLimit(panda, rate=1000.0, dt=DT))
        chain(0.0, np.zeros(7))
        chain(0.0, np.full(7, 5.0))
        np.testing.assert_allclose(chain(0.0, np.full(7, 5.0)), 1.0)
        chain.reset()
        np.testing.assert_allclose(chain(0.0, np.full(7, 5.0)), 0.0)


class TestFriction:
    def test_a_joint_sticks_below_its_friction_and_slips_above(self):
        arm = fp.load_arm("asr_twodof")
        true = fp.perturb(arm, friction=0.5, damping=0.0)
        for torque, moves in ((0.49, False), (0.6, True)):
            plant = Plant(true, arm.neutral, np.zeros(2), dt=DT, integrator="semi-implicit")
            for k in range(200):
                plant.load(k * DT, np.array([torque, 0.0]) + true.gravity(plant.q))
                plant.hold(k * DT, DT)
            assert (abs(plant.v[0]) > 1e-3) == moves
            assert moves or abs(plant.v[0]) < 1e-9

    def test_a_light_damped_joint_needs_no_short_steps(self):
        arm = fp.load_arm("so100")
        true = fp.perturb(arm, friction=0.5, damping=0.5)
        ends = []
        for substeps in (1, 20):
            plant = Plant(
                true, arm.neutral, np.zeros(5), dt=DT, substeps=substeps, integrator="semi-implicit"
            )
            for k in range(500):
                plant.load(k * DT, np.sin(0.02 * k) * np.ones(5))
                assert plant.hold(k * DT, DT) == -1
            ends.append(plant.q.copy())
        np.testing.assert_allclose(ends[0], ends[1], atol=5e-3)


class TestJitter:
    def test_the_controller_is_told_the_period_that_was(self):
        arm, periods = fp.load_arm("two_link"), []

        class Spy(fp.RobustFONFTSM):
            def update(self, *row, dt=None):
                periods.append(dt)
                return super().update(*row, dt=dt)

        rec = simulate(arm, Spy(arm, DT), Sinusoid.inside_limits(arm), 0.5, jitter=0.3, seed=1)
        np.testing.assert_allclose(np.diff(rec.t), periods[1:], atol=1e-12)
        assert np.std(np.diff(rec.t)) > 0.1 * DT
        assert rec.error_norm.max() < 1e-3

    def test_none_is_the_plain_clock(self):
        arm = fp.load_arm("two_link")
        rec = simulate(arm, fp.RobustFONFTSM(arm, DT), Sinusoid.inside_limits(arm), 0.1)
        np.testing.assert_array_equal(rec.t, DT * np.arange(101.0))

    def test_ticks_never_change_their_order(self):
        arm = fp.load_arm("two_link")
        with pytest.raises(ArgumentError, match="jitter"):
            simulate(arm, fp.RobustFONFTSM(arm, DT), Sinusoid.inside_limits(arm), 0.1, jitter=0.5)


FAULTS = {
    "encoder and filter": lambda arm: {
        "sensor": Chain(
            QuantizedSensor(arm, position=ENCODER),
            VelocityFromPosition(FilteredDifferentiator(arm, DT, bandwidth=300.0)),
        )
    },
    "encoder and exact differentiator": lambda arm: {
        "sensor": Chain(
            QuantizedSensor(arm, position=ENCODER / 8.0),
            VelocityFromPosition(ExactDifferentiator(arm, DT)),
        )
    },
    "two ticks": lambda arm: {"actuator": TickDelay(2)},
    "slow drives": lambda arm: {"actuator": TorqueLag(bandwidth=600.0, dt=DT)},
    "limited rate": lambda arm: {"actuator": TorqueRateLimit(arm, rate=2000.0, dt=DT)},
    "jitter": lambda arm: {"jitter": 0.3},
}


@pytest.mark.parametrize("fault", FAULTS)
def test_the_robust_law_bears(panda, fault):
    true = fp.perturb(panda, mass_scale=1.2, payload=1.0, friction=0.3, damping=0.3)
    reference = Sinusoid.inside_limits(panda)
    guarded = Safeguard(
        fp.RobustFONFTSM(panda, DT), friction_compensation=FrictionCompensation(true)
    )
    q0 = panda.integrate(reference(0.0)[0], np.full(7, 0.1))
    faults = FAULTS[fault](panda)
    rec = simulate(
        true,
        guarded,
        reference,
        4.0,
        q0=q0,
        v0=np.zeros(7),
        integrator="semi-implicit",
        **faults,
    )
    assert guarded.stopped is None
    assert fp.summarize(rec).max_tail_error < 5e-3
