"""What every controller promises, whatever its law: all laws, all presets, three arms."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fotsmc_pin.arms import perturb
from fotsmc_pin.errors import ArgumentError, MeasurementError
from fotsmc_pin.references import Hold, Sinusoid
from fotsmc_pin.simulation import simulate

MODEL_FREE = {"TDEFONTSM"}
"""Laws that know no model; the torque that the model asks for is what they converge to."""

ARGUMENTS = ("q", "v", "q_d", "v_d", "a_d")
FINITE = st.one_of(
    st.floats(-10.0, 10.0),
    st.floats(-1e300, 1e300),
    st.sampled_from([0.0, -0.0, 1e300, -1e300, 1e8, 5e-324, np.pi]),
)
QUICK = settings(
    max_examples=12,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


def torques(controller, rows):
    return np.array([controller.update(*row) for row in rows])


class TestEveryController:
    def test_zero_error_and_an_exact_model_give_inverse_dynamics(self, controller, arm):
        if type(controller).__name__ in MODEL_FREE:
            assert_gravity_is_found(controller, arm)
            return
        reference = Sinusoid.inside_limits(arm)
        for t in np.arange(0.0, 0.05, controller.dt):
            q_d, v_d, a_d = reference(t)
            exact = np.clip(
                arm.inverse_dynamics(q_d, v_d, a_d), -arm.effort_limit, arm.effort_limit
            )
            tau = controller.update(q_d, v_d, q_d, v_d, a_d)
            np.testing.assert_allclose(tau, exact, rtol=1e-9, atol=1e-9)

    @QUICK
    @given(data=st.data())
    def test_any_finite_input_gives_a_finite_torque_within_the_limits(self, controller, arm, data):
        vectors = st.lists(FINITE, min_size=arm.nv, max_size=arm.nv)
        for _ in range(3):
            q, v, q_d, v_d, a_d = (np.array(data.draw(vectors)) for _ in ARGUMENTS)
            dt = data.draw(st.sampled_from([None, 1e-3, 1e-6, 2.5e-4, 0.7e-3, 0.1, 1e3]))
            tau = controller.update(
                arm.from_joint_positions(q), v, arm.from_joint_positions(q_d), v_d, a_d, dt
            )
            assert np.isfinite(tau).all()
            assert (np.abs(tau) <= arm.effort_limit).all()
            assert all(np.isfinite(signal).all() for signal in controller.signals.values())

    def test_limits_hold_under_a_far_error(self, controller, arm):
        rows = [
            (q, v, arm.integrate(q_d, np.full(arm.nv, 2.0)), v_d, a_d)
            for q, v, q_d, v_d, a_d in wandering_start(arm, 30)
        ]
        tau = torques(controller, rows)
        assert (np.abs(tau) <= arm.effort_limit).all()

    def test_reset_gives_a_fresh_controller_bit_for_bit(self, controller, another, arm, wander):
        torques(controller, wander(arm, 40, seed=1, spread=0.5))
        controller.reset()
        fresh = another()
        assert_same_signals(controller, fresh)
        for row in wander(arm, 40, seed=2):
            np.testing.assert_array_equal(controller.update(*row), fresh.update(*row))
            assert_same_signals(controller, fresh)

    def test_a_bad_measurement_is_named_and_leaves_the_memory_alone(
        self, controller, another, arm, wander
    ):
        twin = another()
        rows = list(wander(arm, 30))
        torques(controller, rows[:20])
        torques(twin, rows[:20])
        for place, argument in enumerate(ARGUMENTS):
            good = rows[20][place]
            nan, infinite = good.copy(), good.copy()
            nan[-1], infinite[0] = np.nan, -np.inf
            wrong = [nan, infinite, good[:-1], np.append(good, 0.0), good[None], 0.0, None, "fast"]
            for value in wrong:
                row = list(rows[20])
                row[place] = value
                with pytest.raises(MeasurementError, match=argument) as caught:
                    controller.update(*row)
                assert caught.value.argument == argument
        for row in rows[20:]:
            np.testing.assert_array_equal(controller.update(*row), twin.update(*row))
            assert_same_signals(controller, twin)

    def test_a_bad_period_is_refused_and_leaves_the_memory_alone(
        self, controller, another, arm, wander
    ):
        twin = another()
        first, bad, second = wander(arm, 3)
        controller.update(*first)
        twin.update(*first)
        for dt in (0.0, -1e-3, np.nan, np.inf, 1e-9, 1e9, "soon"):
            with pytest.raises(ArgumentError, match="dt"):
                controller.update(*bad, dt=dt)
        np.testing.assert_array_equal(controller.update(*second), twin.update(*second))

    def test_the_nominal_period_may_be_told_or_left_out(self, controller, another, arm, wander):
        twin = another()
        for row in wander(arm, 20):
            told = controller.update(*row, dt=controller.dt)
            np.testing.assert_array_equal(told, twin.update(*row))

    def test_lists_and_whole_numbers_are_measurements_too(self, controller, another, arm, wander):
        twin = another()
        for q, v, q_d, _, _ in wander(arm, 3):
            plain = controller.update(q, v, q_d, np.zeros(arm.nv), np.ones(arm.nv))
            listed = twin.update(list(q), tuple(v), q_d, [0] * arm.nv, np.ones(arm.nv, dtype=int))
            np.testing.assert_array_equal(plain, listed)

    def test_what_is_handed_out_is_a_copy(self, controller, another, arm, wander):
        twin = another()
        for row in wander(arm, 5):
            kept = [np.array(value) for value in row]
            tau = controller.update(*row)
            np.testing.assert_array_equal(tau, twin.update(*kept))
            tau[:] = 1e9
            for signal in controller.signals.values():
                signal[:] = 1e9
            for before, after in zip(kept, row, strict=True):
                np.testing.assert_array_equal(before, after)

    def test_controllers_on_one_arm_do_not_disturb_each_other(
        self, controller, another, arm, wander
    ):
        text = arm.urdf
        one, two = list(wander(arm, 15, seed=3)), list(wander(arm, 15, seed=4))
        alone = torques(another(), one)
        other = another()
        together = []
        for mine, theirs in zip(one, two, strict=True):
            other.update(*theirs)
            together.append(controller.update(*mine))
        np.testing.assert_array_equal(together, alone)
        assert arm.urdf == text

    def test_the_torque_follows_from_the_measurements_whatever_the_plant(
        self, controller, another, arm
    ):
        seen, commanded = [], []

        def sensor(t, q, v):
            seen.append((t, q.copy(), v.copy()))
            return q, v

        def actuator(t, tau):
            commanded.append(tau.copy())
            return 0.9 * tau

        true = perturb(arm, mass_scale=1.1, payload=0.1, friction=0.05)
        reference = Sinusoid.inside_limits(arm)
        simulate(true, controller, reference, 0.05, sensor=sensor, actuator=actuator)
        fresh = another()
        replayed = [fresh.update(q, v, *reference(t)) for t, q, v in seen]
        np.testing.assert_array_equal(replayed, commanded)

    def test_repr_names_the_law_and_every_gain(self, controller):
        text = repr(controller)
        assert text.startswith(type(controller).__name__)
        assert all(f"{name}=" in text for name in controller.gains.as_dict())


def test_cosine_and_sine_off_the_circle_are_refused(case, arms, make, wander):
    law, preset = case
    arm = arms["kinova"]
    controller, twin = make(law, arm, preset), make(law, arm, preset)
    (q, v, q_d, v_d, a_d), row = wander(arm, 2)
    for argument, bad_q, bad_q_d in (("q", 1.1 * q, q_d), ("q_d", q, 1e200 * q_d)):
        with pytest.raises(MeasurementError, match="cosine") as caught:
            controller.update(bad_q, v, bad_q_d, v_d, a_d)
        assert caught.value.argument == argument
    np.testing.assert_array_equal(controller.update(*row), twin.update(*row))


def assert_gravity_is_found(controller, arm):
    """A law that knows no model ends at the torque that the model asks for."""
    rec = simulate(arm, controller, Hold(arm), 3.0)
    final = arm.inverse_dynamics(rec.q[-1], rec.v[-1], np.zeros(arm.nv))
    np.testing.assert_allclose(rec.tau[-1], final, rtol=1e-3, atol=0.02)


def wandering_start(arm, ticks):
    reference = Sinusoid.inside_limits(arm)
    for k in range(ticks):
        q_d, v_d, a_d = reference(k * 1e-3)
        yield q_d, v_d, q_d, v_d, a_d


def assert_same_signals(one, other):
    mine, theirs = one.signals, other.signals
    assert mine.keys() == theirs.keys()
    for name in mine:
        np.testing.assert_array_equal(mine[name], theirs[name], err_msg=name)
