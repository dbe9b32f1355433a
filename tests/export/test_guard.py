"""A safeguard in C starts, limits and stops as Python's does."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import FrictionCompensation
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import Sinusoid

from .compiled_c import Inputs, Logged
from .conftest import DT, arm_named, worst

EXACT = 1e-12
OK, STOPPED, TOO_LATE, TOO_FAST = 0, 8, 9, 10


def guarded(name, **options):
    arm = arm_named(name)
    ahead = FrictionCompensation(arm, friction=0.3, damping=0.1)
    options = {"soft_start": 0.1, "torque_rate": 400.0, "stop_ramp": 0.05} | options
    guard = fp.Safeguard(fp.RobustFONFTSM(arm, DT), friction_compensation=ahead, **options)
    guard._stop.carried._least_weight = np.inf  # C has no kinematics to find a payload by
    return guard


def run(guard, ticks=160, spoil=lambda k, row: row):
    """Drive a safeguard near a reference; `spoil` changes single ticks."""
    arm = guard.arm
    reference, log = Sinusoid.inside_limits(arm, ramp=0.1), Logged(guard)
    log.reset()
    for k in range(ticks):
        q_d, v_d, a_d = reference(k * DT)
        e = 0.03 * np.exp(-10.0 * k * DT) * np.cos(np.arange(arm.nv))
        row = [arm.integrate(q_d, e), v_d - 10.0 * e, q_d, v_d, a_d, None]
        log.update(*spoil(k, row))
    return log.inputs


def changed(tick, place, value):
    def spoil(k, row):
        if k == tick:
            row[place] = value(row[place]) if callable(value) else value
        return row

    return spoil


def part(inputs, ticks):
    return Inputs(*(getattr(inputs, name)[ticks] for name in Inputs.__dataclass_fields__))


def broken(x):
    return np.full_like(x, np.nan)


STOPS = {
    "none": (lambda k, row: row, OK),
    "late": (changed(120, 5, 0.05), TOO_LATE),
    "fast": (changed(120, 1, lambda v: v + 100.0), TOO_FAST),
    "blind": (changed(120, 0, broken), 1),
    "blind for long": (lambda k, row: changed(k if 120 <= k < 150 else -1, 1, broken)(k, row), 2),
    "blind from the start": (changed(0, 0, broken), 1),
    "no reference": (changed(120, 2, broken), 3),
    "short tick": (changed(120, 5, 1e-9), 6),
}


@pytest.mark.parametrize(
    ("why", "name"),
    [("none", "kinova"), ("blind", "kinova"), *((why, "two_link") for why in STOPS)],
)
def test_it_stops_as_pythons_does(why, name, compiled):
    spoil, code = STOPS[why]
    guard = guarded(name)
    inputs = run(guard, spoil=spoil)
    tau, status = compiled(guarded(name)).replay(inputs)
    assert (guard.stopped is None) == (code == OK)
    assert set(status) <= {OK, code}
    assert status[-1] == code
    assert worst(tau, inputs) < EXACT
    assert (np.abs(np.diff(tau, axis=0)) <= 400.0 * 0.05 * 1.001).all()


def test_a_stop_can_be_asked_for_and_a_reset_ends_it(compiled):
    guard = guarded("two_link")
    inputs = run(guard, ticks=60)
    c = compiled(guarded("two_link"))
    first, _ = c.replay(inputs)
    c.reset()
    c.replay(inputs)
    c.code.fotsmc_two_link_stop(c.state)
    tau, status = c.replay(inputs)
    assert set(status) == {STOPPED}
    log = Logged(guard)
    guard.stop()
    for row in zip(inputs.q, inputs.v, inputs.q_d, inputs.v_d, inputs.a_d, strict=True):
        log.update(*row)
    assert worst(tau, log.inputs) < EXACT
    c.reset()
    again, status = c.replay(inputs)
    assert not status.any()
    assert again.tobytes() == first.tobytes()


@pytest.mark.parametrize(
    "words", [("gravity",), ("coriolis",), ("gravity", "coriolis", "friction")]
)
def test_what_the_drives_add_is_taken_away_as_in_python(words, compiled):
    guard, again = guarded("two_link"), guarded("two_link")
    guard.compensates = again.compensates = words
    sent = []

    def spoil(k, row):
        sent.append(guard.sent)
        return changed(80, 1, broken)(k, row)

    inputs = run(guard, ticks=100, spoil=spoil)
    c = compiled(again)
    for k in range(99):
        tau, _ = c.replay(part(inputs, slice(k, k + 1)))
        np.testing.assert_allclose(tau[0], inputs.tau[k], rtol=EXACT, atol=1e-10)
        np.testing.assert_allclose(c.sent, sent[k + 1], rtol=EXACT, atol=1e-10)
    assert np.abs(inputs.tau[:99] - sent[1:]).max() > 0.0


def test_a_law_that_loses_the_path_is_relieved_as_in_python(compiled):
    """The arm moves on while the path comes to rest."""
    guard, last = guarded("two_link"), {}

    def spoil(k, row):
        if k == 100:
            guard.stop()
        if k >= 100:
            row[0] = last.setdefault("q", row[0]) + 1.5e-3 * (k - 100)
        return row

    inputs = run(guard, ticks=300, spoil=spoil)
    assert not guard._stop.by_law
    c = compiled(guarded("two_link"))
    c.replay(part(inputs, slice(100)))
    c.code.fotsmc_two_link_stop(c.state)
    tau, status = c.replay(part(inputs, slice(100, None)))
    assert set(status) == {STOPPED}
    assert worst(tau, part(inputs, slice(100, None))) < EXACT


def test_limits_stay_in_python(tmp_path):
    guard = guarded("two_link", limits=fp.Limits(arm_named("two_link")))
    with pytest.raises(ArgumentError, match="quadratic program"):
        fp.export_c(guard, tmp_path)


def test_in_single_precision(compiled):
    inputs = run(guarded("panda", soft_start=0.05))
    tau, status = compiled(guarded("panda", soft_start=0.05), single=True).replay(inputs)
    assert not status.any()
    assert (np.abs(tau - inputs.tau) / np.abs(inputs.tau).max(axis=0)).max() < 1e-4
