"""The safeguard: soft from any state, rate limits that hold, stops that come and come to rest."""

import copy

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import (
    CONTROLLERS,
    ComputedTorque,
    FrictionCompensation,
    RobustFONFTSM,
    Safeguard,
    SoftStart,
)
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.learning import recorded_estimates
from fotsmc_pin.references import Hold, Sinusoid
from fotsmc_pin.simulation import Plant, simulate

DT = 1e-3


@pytest.fixture(scope="module")
def arm():
    return fp.load_arm("two_link")


def far_state(arm):
    q_d, v_d, _ = Sinusoid.inside_limits(arm)(0.0)
    return arm.integrate(q_d, [0.7, -0.4]), v_d + np.array([0.5, -0.2])


class TestSoftStart:
    def test_it_begins_at_the_state_and_ends_on_the_reference(self, arm):
        reference, lead = Sinusoid.inside_limits(arm), SoftStart(arm, 1.0)
        q, v = far_state(arm)
        led = [lead.lead(q, v, *reference(k * DT), DT) for k in range(1201)]
        np.testing.assert_allclose(led[0][0], q, atol=1e-12)
        np.testing.assert_allclose(led[0][1], v, atol=1e-12)
        np.testing.assert_allclose(led[0][2], reference(0.0)[2], atol=1e-12)
        for k in (1000, 1200):
            for part, original in zip(led[k], reference(k * DT), strict=True):
                np.testing.assert_allclose(part, original, atol=1e-9)

    def test_speed_and_acceleration_are_derivatives_of_the_position(self, arm):
        reference, lead = Sinusoid.inside_limits(arm), SoftStart(arm, 1.0)
        q, v = far_state(arm)
        q_d, v_d, a_d = (
            np.array(part)
            for part in zip(
                *(lead.lead(q, v, *reference(k * DT), DT) for k in range(900)), strict=True
            )
        )
        np.testing.assert_allclose(np.gradient(q_d, DT, axis=0)[1:-1], v_d[1:-1], atol=1e-5)
        np.testing.assert_allclose(np.gradient(v_d, DT, axis=0)[1:-1], a_d[1:-1], atol=2e-4)

    @pytest.mark.parametrize("name", ["FONFTSM", "SuperTwistingSMC", "ComputedTorque"])
    def test_it_takes_the_peak_off_any_law(self, arm, name):
        reference = Sinusoid.inside_limits(arm)
        q0, _ = far_state(arm)
        peaks = []
        for duration in (0.0, 1.5):
            law = CONTROLLERS[name](arm, DT, preset=[*CONTROLLERS[name].presets][-1])
            guarded = Safeguard(law, soft_start=duration)
            rec = simulate(arm, guarded, reference, 1.0, q0=q0, v0=np.zeros(2))
            peaks.append(np.abs(rec.tau).max())
        assert peaks[1] < 0.5 * peaks[0]


def test_the_torque_rate_is_never_exceeded(arm):
    rate = np.array([400.0, 300.0])
    guarded = Safeguard(ComputedTorque(arm, DT), soft_start=0.0, torque_rate=rate)
    q0, _ = far_state(arm)
    reference = Sinusoid.inside_limits(arm)
    rec = simulate(arm, guarded, reference, 1.0, q0=q0, v0=np.zeros(2))
    steps = np.abs(np.diff(rec.tau, axis=0, prepend=0.0))
    assert (steps <= rate * DT + 1e-9).all()
    assert np.isclose(steps, rate * DT).any()  # the limit was at work


class TestSafeStop:
    def stopped_plant(self, arm, guarded, trip, seconds=2.0):
        """Run a moving arm, trip the safeguard at 0.5 s, return the plant and all torques."""
        reference = Sinusoid.inside_limits(arm, ramp=0.0)
        q0, v0, _ = reference(0.0)
        plant, torques = Plant(arm, q0, v0, dt=DT), []
        for k in range(500 + round(seconds / DT)):
            row = [plant.q, plant.v, *reference(k * DT)]
            tau = trip(guarded, row) if k == 500 else guarded.update(*row)
            torques.append(tau)
            plant.load(k * DT, tau)
            plant.hold(k * DT, DT)
        return plant, np.array(torques)

    def trip_by_call(self, guarded, row):
        guarded.stop("emergency button")
        return guarded.update(*row)

    def trip_by_nan(self, guarded, row):
        return guarded.update(row[0] * np.nan, *row[1:])

    def trip_by_speed(self, guarded, row):
        return guarded.update(row[0], row[1] + 100.0, *row[2:])

    def trip_by_lateness(self, guarded, row):
        return guarded.update(*row, dt=0.5)

    @pytest.mark.parametrize("how", ["call", "nan", "speed", "lateness"])
    def test_the_arm_comes_to_rest_without_a_jump(self, arm, how):
        guarded = Safeguard(RobustFONFTSM(arm, DT), soft_start=0.0)
        plant, tau = self.stopped_plant(arm, guarded, getattr(self, f"trip_by_{how}"))
        assert guarded.stopped is not None
        assert np.abs(plant.v).max() < 1e-3
        np.testing.assert_allclose(tau[-1], arm.gravity(plant.q), atol=0.05)
        assert np.abs(np.diff(tau[500:700], axis=0)).max() < 5.0

    def test_all_is_well_until_something_happens(self, arm):
        guarded = Safeguard(RobustFONFTSM(arm, DT), soft_start=0.5)
        reference = Sinusoid.inside_limits(arm)
        rec = simulate(arm, guarded, reference, 1.0)
        assert guarded.stopped is None
        assert rec.error_norm.max() < 1e-3

    def test_a_stop_is_latched_until_reset(self, arm):
        guarded = Safeguard(RobustFONFTSM(arm, DT))
        q, v, a = arm.neutral, np.zeros(2), np.zeros(2)
        guarded.update(q, v, q, v, a)
        guarded.stop("first")
        guarded.stop("second")
        for _ in range(1000):
            tau = guarded.update(q, v, q + 0.5, v, a)
        assert guarded.stopped == "first"
        np.testing.assert_allclose(tau, arm.gravity(q), atol=1e-9)
        guarded.reset()
        assert guarded.stopped is None

    def test_nothing_measured_at_all_gives_no_torque(self, arm):
        guarded = Safeguard(RobustFONFTSM(arm, DT))
        bad = np.full(2, np.nan)
        np.testing.assert_array_equal(guarded.update(bad, bad, bad, bad, bad), 0.0)


class TestFrictionCompensation:
    def test_it_equals_friction_and_damping_away_from_rest(self, arm):
        compensation = FrictionCompensation(arm, friction=[1.0, 2.0], damping=0.5)
        np.testing.assert_allclose(compensation.torque([0.4, -0.4]), [1.2, -2.2], atol=1e-6)

    def test_it_helps_a_law_without_an_integral(self, arm):
        true = fp.perturb(arm, friction=3.0, damping=2.0)
        reference = Sinusoid.inside_limits(arm)
        tails = []
        for friction in (0.0, 3.0):
            compensation = FrictionCompensation(arm, friction=friction, damping=2.0 * friction / 3)
            guarded = Safeguard(
                ComputedTorque(arm, DT), friction_compensation=compensation, soft_start=0.0
            )
            rec = simulate(true, guarded, reference, 4.0, integrator="semi-implicit")
            tails.append(fp.summarize(rec).tail_rms_error)
        assert tails[1] < 0.3 * tails[0]

    def test_negative_friction_is_refused(self, arm):
        with pytest.raises(ArgumentError, match="friction"):
            FrictionCompensation(arm, friction=-1.0)


def test_a_heavy_arm_warns_before_the_run():
    from fotsmc_pin.control import GravityWarning, warn_of_gravity

    with pytest.warns(GravityWarning, match=r"arm_left_2_joint \(1\.2"):
        warn_of_gravity(fp.load_arm("talos_arm"))
    with pytest.warns(GravityWarning, match="baxter.*left_s1"):
        warn_of_gravity(fp.load_arm("baxter"))
    with pytest.warns(GravityWarning, match="talos_arm") as caught:
        RobustFONFTSM(fp.load_arm("talos_arm"), DT)
    assert caught[0].filename == __file__
    warn_of_gravity(fp.load_arm("panda"))


def test_holding_is_gravity_compensation(arm):
    guarded = Safeguard(RobustFONFTSM(arm, DT), soft_start=0.0)
    rec = simulate(arm, guarded, Hold(arm), 0.3)
    np.testing.assert_allclose(rec.tau[-1], arm.gravity(arm.neutral), atol=1e-6)


class TestLearning:
    def test_a_model_is_learnt_inside_of_a_safeguard(self, arm):
        true = fp.perturb(arm, mass_scale=1.3, armature=8.0)
        guarded = Safeguard(fp.ModelLearning(RobustFONFTSM(arm, DT), delay=0), soft_start=0.3)
        reference = Sinusoid.inside_limits(arm)
        rec = simulate(true, guarded, reference, 3.0)
        known = recorded_estimates(rec)
        assert known == guarded.controller.estimates()
        for row in known.group("armature"):
            assert row.first_value == 5.0
            assert row.value == pytest.approx(8.0, abs=3.0 * row.deviation)
            assert row.deviation < 1.0  # of a difference of 3
        twin = copy.deepcopy(guarded)
        state = (rec.q[-1], rec.v[-1], *reference(3.0))
        np.testing.assert_array_equal(twin.update(*state), guarded.update(*state))

    def test_of_another_law_there_is_nothing_to_tell(self, arm):
        assert Safeguard(RobustFONFTSM(arm, DT)).about == {}
