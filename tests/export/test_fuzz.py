"""Whatever comes in: no NaN goes out, no torque beyond its limit, and the errors are Python's."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import fotsmc_pin as fp
from fotsmc_pin.control import CONTROLLERS
from fotsmc_pin.errors import ArgumentError

from .compiled_c import terms
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
