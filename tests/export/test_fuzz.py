"""Whatever comes in: no NaN goes out, no torque beyond its limit, and the errors are Python's."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import fotsmc_pin as fp
from fotsmc_pin.control import CONTROLLERS
from fotsmc_pin.errors import ArgumentError

from .compiled_c import pointers, terms
from .conftest import DT, arm_named, make

ARGUMENTS = ("q", "v", "q_d", "v_d", "a_d", "dt")
BAD_MODEL = 7
LAWS = ("RobustFONFTSM", "AdaptiveFONFTSM")

anything = st.one_of(
    st.floats(-3.0, 3.0),
    st.floats(allow_nan=True, allow_infinity=True, allow_subnormal=True),
    st.sampled_from([0.0, -0.0, 1e8, -1e300, 5e-324, np.inf, -np.inf, np.nan]),
)
usual = st.floats(-3.0, 3.0)
ticks = st.lists(
    st.tuples(
        st.lists(st.one_of(usual, anything), min_size=10, max_size=10),
        st.one_of(st.just(DT), st.floats(1e-4, 1e-1), anything),
    ),
    min_size=1,
    max_size=6,
)
models = st.lists(
    st.tuples(
        st.lists(usual, min_size=10, max_size=10),
        st.lists(st.one_of(st.floats(1e-6, 10.0), anything), min_size=6, max_size=6),
    ),
    max_size=6,
)
fuzz = settings(
    max_examples=12,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)


@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("name", LAWS)
def test_a_law(name, single, compiled):
    law, arm = CONTROLLERS[name], arm_named("two_link")
    controller = make(law, arm, [*law.presets][-1])
    c = compiled(controller, single=single)
    largest = float(np.finfo(c.real).max)

    @fuzz
    @given(ticks)
    def runs(rows):
        controller.reset()
        c.init()
        for numbers, dt in rows:
            with np.errstate(over="ignore"):
                given = np.array(numbers, c.real).astype(float).reshape(5, 2)
                period = float(c.real(dt))
            code = 0
            try:
                controller.update(*given, dt=period)
            except ArgumentError as error:
                code = 1 + ARGUMENTS.index(error.argument)
            model = [np.clip(x, -largest, largest) for x in terms(arm, controller, *given[:2])]
            before = bytes(c.state)
            tau, status = c.update(*given, *model, period)
            near_bound = single and {code, status} == {0, 6}
            assert status == code or near_bound
            assert np.isfinite(tau).all()
            assert (np.abs(tau) <= arm.effort_limit * (1.0 + 1e-6 * single)).all()
            assert not status or bytes(c.state) == before

    runs()


@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("name", LAWS)
def test_any_model(name, single, compiled):
    law, arm = CONTROLLERS[name], arm_named("two_link")
    c = compiled(make(law, arm, [*law.presets][-1]), single=single)

    @fuzz
    @given(models)
    def runs(rows):
        c.init()
        for numbers, model in rows:
            q, v, q_d, v_d, a_d = np.reshape(numbers, (5, 2))
            with np.errstate(over="ignore"):
                M, h = np.array(model[:4], c.real).reshape(2, 2), np.array(model[4:], c.real)
            tau, status = c.update(q, v, q_d, v_d, a_d, M, h, h, DT)
            assert status in (0, BAD_MODEL)
            good = np.isfinite(M).all() and np.isfinite(h).all() and (np.diag(M) > 0.0).all()
            assert status or good
            assert np.isfinite(tau).all()
            assert (np.abs(tau) <= arm.effort_limit * (1.0 + 1e-6 * single)).all()

    runs()


def learning_controller():
    return fp.ModelLearning(fp.RobustFONFTSM(arm_named("two_link"), DT), bears=(0.3, 3.0))


def test_what_learns(compiled):
    controller = learning_controller()
    c, limit = compiled(controller), controller.arm.effort_limit

    @fuzz
    @given(ticks)
    def runs(rows):
        controller.reset()
        c.init()
        c.believe()
        for numbers, dt in rows * 6:  # Every fourth tick is learnt from.
            row, code = np.reshape(numbers, (5, 2)), 0
            try:
                controller.update(*row, dt=dt)
            except ArgumentError as error:
                code = 1 + ARGUMENTS.index(error.argument)
            regressor = c.regressor()
            if regressor is not None:
                assert c.give(c.state, *pointers(regressor)) == 0
            before = bytes(c.state)
            tau, status = c.update(*row, *c.terms(*row[:2], *row[3:]), dt)
            assert status == code
            assert (np.abs(tau) <= limit).all()
            assert not status or bytes(c.state) == before
            links, armature = c.believe()
            assert np.isfinite(links).all()
            assert (armature >= 0.0).all()

    runs()


def test_what_learns_from_anything(compiled):
    controller = learning_controller()
    c, limit = compiled(controller), controller.arm.effort_limit

    @fuzz
    @given(models, st.lists(anything, min_size=3, max_size=3), st.floats(1e-4, 1.0))
    def runs(rows, entries, dt):
        c.init()
        for numbers, model in rows * 20:
            regressor = np.resize([*numbers, *entries], (2, 20))
            if c.regressor() is not None and c.give(c.state, *pointers(regressor)):
                assert not (np.abs(regressor) <= 1e20).all()
                assert c.give(c.state, *pointers(np.reshape([numbers * 4], (2, 20)))) == 0
            row, M = np.reshape(numbers, (5, 2)), np.reshape(model[:4], (2, 2))
            tau, status = c.update(*row, M, model[4:], model[4:], dt)
            assert status in (0, BAD_MODEL)
            assert (np.abs(tau) <= limit).all()
            links, armature = c.believe()
            assert np.isfinite(links).all()
            assert (armature >= 0.0).all()

    runs()


def test_a_guarded_law_is_never_without_a_torque(compiled):
    arm = arm_named("two_link")
    c = compiled(fp.Safeguard(fp.RobustFONFTSM(arm, DT), torque_rate=1e3, soft_start=0.0))

    @fuzz
    @given(ticks, st.lists(anything, min_size=8, max_size=8))
    def runs(rows, model):
        c.init()
        M, h, g = np.reshape(model[:4], (2, 2)), model[4:6], model[6:]
        stopped, last = 0, np.zeros(2)
        for numbers, dt in rows:
            tau, status = c.update(*np.reshape(numbers, (5, 2)), M, h, g, dt)
            assert not stopped or status == stopped
            assert np.isfinite(tau).all()
            assert (np.abs(tau) <= arm.effort_limit).all()
            period = dt if 0.0 < dt <= 0.01 else DT
            assert (np.abs(tau - last) <= 1e3 * period * (1.0 + 1e-9) + 1e-9).all()
            stopped, last = status, tau

    runs()
