"""`RobustFONFTSM`: the two-link case with its defaults, what each ingredient does, its own laws."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import RobustFONFTSM, TickWarning
from fotsmc_pin.control.inertia_floor import largest_floor
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.paper import two_link
from fotsmc_pin.references import Hold, Sinusoid
from fotsmc_pin.simulation import NoisySensor, TickDelay, simulate

DT = 1e-3


def two_link_case(**gains):
    return fp.summarize(two_link.run(RobustFONFTSM(two_link.nominal_arm(), DT, **gains)))


@pytest.fixture(scope="module")
def with_defaults():
    return two_link_case()


class TestTwoLinkCase:
    """The printed disturbance and plant at 1 kHz, no gain given."""

    def test_it_settles(self, with_defaults):
        assert with_defaults.settling_time <= 0.5
        assert with_defaults.settling_time_0_1_mrad <= 0.85

    def test_it_stays(self, with_defaults):
        assert with_defaults.tail_rms_error <= 1e-6

    def test_it_is_easy_on_the_drives(self, with_defaults):
        assert with_defaults.peak_torque <= 360.0
        assert with_defaults.tail_torque_variation <= 120.0

    @pytest.mark.parametrize(
        ("missing", "worse"),
        [({"observer": 0.0}, 30.0), ({"integral": 0.0}, 10.0), ({"tempering": 0.0}, 2.0)],
    )
    def test_what_keeps_the_tail_small(self, with_defaults, missing, worse):
        assert two_link_case(**missing).tail_rms_error > worse * with_defaults.tail_rms_error

    def test_the_bounded_reach_takes_the_peak_off(self):
        bounded, wide = (two_link_case(approach=np.inf, reach=r).peak_torque for r in (0.25, 1e3))
        assert wide > 1.5 * bounded

    def test_a_leading_point_takes_more_off(self, with_defaults):
        assert with_defaults.peak_torque < 0.75 * two_link_case(approach=np.inf).peak_torque


class TestInertiaFloor:
    def run(self, arm, true, duration=3.0, **gains):
        reference = Sinusoid.inside_limits(arm)
        return simulate(
            true,
            RobustFONFTSM(arm, DT, **gains),
            reference,
            duration,
            q0=arm.integrate(reference(0.0)[0], np.full(arm.nv, 0.2)),
            v0=np.zeros(arm.nv),
            sensor=NoisySensor(arm, position=1e-5, velocity=1e-3),
            actuator=TickDelay(1),
            integrator="semi-implicit",
        )

    def test_a_light_joint_without_friction_keeps_the_inertia_of_its_model(self):
        arm = fp.load_arm("so100")
        rec = self.run(arm, arm)
        floor = rec.signals["inertia_floor"][-1]
        lightest = np.diag(arm.mass_matrix(rec.q[-1]))
        assert (floor < 0.3 * lightest).all()
        assert fp.summarize(rec).tail_rms_error < 1e-4

    def test_friction_raises_it_and_the_joint_follows(self):
        arm = fp.load_arm("so100")
        true = fp.perturb(arm, friction=0.5, damping=0.5)
        rec, without = self.run(arm, true, 4.0), self.run(arm, true, 4.0, floor_share=0.0)
        assert rec.signals["inertia_floor"][-1].min() > 0.02
        assert (without.signals["inertia_floor"] == 0.0).all()
        tails = [fp.summarize(each).tail_rms_error for each in (rec, without)]
        assert tails[0] < 0.05 * tails[1]

    def test_it_stays_below_its_bound(self):
        arm = fp.load_arm("so100")
        rec = self.run(arm, fp.perturb(arm, friction=3.0, damping=1.0), duration=1.5)
        assert (rec.signals["inertia_floor"] <= largest_floor(arm) + 1e-12).all()
        assert (rec.signals["inertia_floor"] >= 0.0).all()

    def test_it_leaks_away_when_nothing_is_met(self):
        arm = fp.load_arm("two_link")
        law, q, rest = RobustFONFTSM(arm, DT), arm.neutral, np.zeros(2)
        law.update(q, rest, q, rest, rest)
        law.state.delta[:] = 0.5
        floors = []
        for _ in range(3000):
            law.update(q, rest, q, rest, rest)
            floors.append(law.signals["inertia_floor"][0])
        assert floors[-1] == pytest.approx(0.5 * np.exp(-0.15 * 3.0), rel=1e-3)
        assert (np.diff(floors) < 0.0).all()


class TestObservers:
    def test_the_momentum_observer_finds_a_constant_disturbance(self):
        arm, push = fp.load_arm("two_link"), np.array([3.0, -2.0])
        law = RobustFONFTSM(arm, DT)
        rec = simulate(arm, law, Hold(arm), 1.0, disturbance=lambda t: push)
        np.testing.assert_allclose(rec.signals["disturbance"][-1], push, rtol=1e-3)
        assert rec.error_norm[-1] < 1e-6

    def test_a_saturated_start_does_not_wind_up(self):
        strong = fp.load_arm("two_link")
        arm = fp.load_arm("two_link", effort_limit=[60.0, 40.0])
        assert (arm.effort_limit < strong.effort_limit).all()
        reference = Hold(arm)
        start = arm.integrate(arm.neutral, [1.5, -1.0])
        overshoot = []
        for anti_windup in (True, False):
            law = RobustFONFTSM(arm, DT, anti_windup=anti_windup)
            rec = simulate(arm, law, reference, 4.0, q0=start)
            overshoot.append(max(-rec.e[:, 0].min(), rec.e[:, 1].max()))
        assert overshoot[0] < 1e-3
        assert overshoot[1] > 0.5


def test_a_loop_that_is_far_too_fast_saturates_and_stays_finite():
    """The integrals behind the torque limits must not swing up, whatever the rates."""
    arm = fp.load_arm("two_link")
    q_d, rest, peaks = arm.neutral, np.zeros(2), []
    for anti_windup in (True, False):
        with pytest.warns(TickWarning):
            law = fp.RobustFONFTSM(arm, DT, bandwidth=8.3, observer=330.0, anti_windup=anti_windup)
        kept = []
        for k in range(4000):
            e = 0.5 * np.array([np.sin(0.9 * k), np.cos(0.7 * k)])
            tau = law.update(arm.integrate(q_d, e), 20.0 * e, q_d, rest, rest)
            assert np.isfinite(tau).all()
            kept.append(np.abs(law.state.T).max())
        assert all(np.isfinite(row).all() for row in law.state)
        peaks.append([max(kept[1000:2000]), max(kept[3000:])])
    # In this noise one tick alone asks for up to 80 times the limit; nothing adds up to more.
    with_it, without = peaks
    assert with_it[1] < 1.05 * with_it[0] < 1e2 * arm.effort_limit.max()
    assert without[1] > 1.1 * without[0] > 10.0 * with_it[0]


class TestGains:
    def test_the_power_obeys_the_condition_of_the_proof(self):
        arm = fp.load_arm("two_link")
        for power in (0.9, 1.0, 2.0):
            with pytest.raises(ArgumentError, match="power"):
                RobustFONFTSM(arm, DT, power=power)

    @pytest.mark.parametrize("dt", [2.5e-4, 1e-3, 2e-3, 4e-3, 8e-3])
    def test_the_defaults_suit_any_period(self, dt):
        arm = fp.load_arm("panda")
        reference = Sinusoid.inside_limits(arm)
        rec = simulate(
            fp.perturb(arm, mass_scale=1.2),
            RobustFONFTSM(arm, dt),
            reference,
            5.0 if dt > 1e-3 else 1.5,
            q0=arm.integrate(reference(0.0)[0], np.full(7, 0.1)),
            v0=np.zeros(7),
            actuator=TickDelay(1),
            integrator="semi-implicit",
            substeps=max(1, round(dt / 1e-3)),
        )
        assert rec.error_norm[-50:].max() < 1e-2

    def test_they_do_not_depend_on_the_arm(self):
        gains = [RobustFONFTSM(fp.load_arm(name), DT).gains for name in ("two_link", "panda")]
        for name in ("A", "theta", "observer", "integral", "floor_share"):
            assert getattr(gains[0], name)[0] == getattr(gains[1], name)[0]
