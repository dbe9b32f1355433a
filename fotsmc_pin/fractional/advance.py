"""One sample through a fractional operator, as compiled functions that a control law calls.

Every scheme has the same shape. The modes `Z_k` carry all intervals but the newest,

    y_n = Σ_k d_k Z_k + Σ_m l_m v_m,        Z_k ← d_k Z_k + Σ_m g_{k,m} v_m,

where the `v_m` are value, difference and curvature of the newest interval (see `interval`). The
output is affine in the newest sample, which `predict` uses. Arguments are not checked here.

    advance(coefficients, memory, x, dt, y)                 y in place
    gain = predict(coefficients, memory, dt, y_history)     y = y_history + gain x, memory untouched
    commit(coefficients, memory, x, dt)                     stores the sample

`coefficients` and `memory` are those of a `Stream`, `dt` [s] is the time since the last sample, and
`x`, `y`, `y_history` have one entry per signal.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.fractional.interval import mode_decay, mode_response, output_gains
from fotsmc_pin.fractional.layout import (
    BEFORE_LAST,
    COUNT,
    DECAY,
    DIFFERENTIATES,
    EXPONENT,
    FIRST_MODE,
    HEADER,
    HISTORY,
    LAST,
    LAST_PERIOD,
    NORMALIZER,
    OUTPUT_GAINS,
    PERIOD,
    QUADRATIC,
    RATE,
    SCHEME,
    START,
    START_GAIN,
    TEMPERING,
    WEIGHT,
)

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


TINY = 1e-280
"""Modes below this are set to zero: arithmetic with subnormal numbers is 40 times slower."""


@kernel
def advance(coefficients: Array, memory: Array, x: Array, dt: float, y: Array) -> None:
    """Take the next sample and write the output to `y`: `predict` and `commit` in one."""
    if _is_plain(coefficients, memory, dt):
        _move(coefficients, memory, x, dt, coefficients, y)
        return
    gain = _predict(coefficients, memory, dt, y)
    for j in range(x.size):
        y[j] += gain * x[j]
    _commit(coefficients, memory, x, dt)


@kernel
def predict(coefficients: Array, memory: Array, dt: float, y_history: Array) -> float:
    """Write what the past adds to the next output; return the gain of the next sample.

    The output for a sample `x` after `dt` is `y_history + gain x`. The memory stays as it is.
    """
    if _is_plain(coefficients, memory, dt):
        return _plain_predict(coefficients, memory, dt, y_history)
    return _predict(coefficients, memory, dt, y_history)


@kernel
def commit(coefficients: Array, memory: Array, x: Array, dt: float) -> None:
    """Store the next sample, and move the modes over the interval that it ends."""
    if _is_plain(coefficients, memory, dt):
        _move(coefficients, memory, x, dt, coefficients, None)
    else:
        _commit(coefficients, memory, x, dt)


@kernel
def _is_plain(coefficients: Array, memory: Array, dt: float) -> bool:
    """Return whether a sample is plain: one nominal period after at least two others.

    Most samples are. They need only values from tables, which is faster.
    """
    return bool(dt == coefficients[HEADER, PERIOD] and memory[0, COUNT] > 2.0)


@kernel(rounds_freely=True)
def _move(
    coefficients: Array, memory: Array, x: Array, dt: float, response: Array, y: Array | None
) -> None:
    """Store a sample; write the output of a plain one to `y`, unless that is None.

    The last four rows of `response` are the decay of each mode over the interval that ends, and
    what value, difference and curvature add to it.
    """
    n, modes = memory.shape[0], memory.shape[1] - FIRST_MODE
    l0 = coefficients[HEADER, OUTPUT_GAINS]
    l1 = coefficients[HEADER, OUTPUT_GAINS + 1]
    l2 = coefficients[HEADER, OUTPUT_GAINS + 2]
    decay, g0, g1, g2 = response[-4], response[-3], response[-2], response[-1]
    next_decay = coefficients[DECAY]
    bend, ratio = _bend(coefficients[HEADER, SCHEME], memory[0, COUNT], dt, memory[0, LAST_PERIOD])
    for j in range(n):
        row = memory[j]
        value, last = x[j], row[LAST]
        difference = value - last
        curvature = bend * (difference - ratio * (last - row[BEFORE_LAST]))
        if y is not None:
            y[j] = row[HISTORY] + l0 * value + l1 * difference + l2 * curvature
        mode = row[FIRST_MODE:]
        history = 0.0
        for k in range(modes):
            moved = decay[k] * mode[k] + g0[k] * value + g1[k] * difference + g2[k] * curvature
            if abs(moved) < TINY:
                moved = 0.0
            mode[k] = moved
            history += next_decay[k] * moved
        row[HISTORY], row[BEFORE_LAST], row[LAST] = history, last, value
    memory[0, LAST_PERIOD] = dt
    memory[0, COUNT] += 1.0


@kernel
def _plain_predict(coefficients: Array, memory: Array, dt: float, y_history: Array) -> float:
    """Do the work of `predict` for a plain sample."""
    l0 = coefficients[HEADER, OUTPUT_GAINS]
    bend, ratio = _bend(coefficients[HEADER, SCHEME], memory[0, COUNT], dt, memory[0, LAST_PERIOD])
    bend *= coefficients[HEADER, OUTPUT_GAINS + 2]
    gain = l0 + coefficients[HEADER, OUTPUT_GAINS + 1] + bend
    for j in range(memory.shape[0]):
        last = memory[j, LAST]
        turn = ratio * (last - memory[j, BEFORE_LAST])
        y_history[j] = memory[j, HISTORY] + (l0 - gain) * last - bend * turn
    return float(gain)


@kernel(rounds_freely=True)
def _predict(coefficients: Array, memory: Array, dt: float, y_history: Array) -> float:
    """Do the work of `predict` for any sample."""
    header, n, modes = coefficients[HEADER], memory.shape[0], memory.shape[1] - FIRST_MODE
    scheme, slope, tempering = header[SCHEME], header[DIFFERENTIATES], header[TEMPERING]
    count = memory[0, COUNT]
    if count == 0.0:
        for j in range(n):  # In loops: Numba compiles assignments of slices for two seconds.
            y_history[j] = 0.0
        return float(header[START_GAIN])
    l0, l1, l2 = output_gains(scheme, slope, tempering, dt, header[EXPONENT], header[NORMALIZER])
    bend, ratio = _bend(scheme, count, dt, memory[0, LAST_PERIOD])
    decay = np.empty(modes)
    for k in range(modes):
        rate, weight = coefficients[RATE, k], coefficients[WEIGHT, k]
        decay[k] = mode_decay(scheme, tempering, dt, rate)
        if bend != 0.0 and count == 2.0:
            l2 += decay[k] * _bent_first(scheme, slope, tempering, dt, ratio, rate, weight)
    bend *= l2
    gain = l0 + l1 + bend
    for j in range(n):
        last, mode = memory[j, LAST], memory[j, FIRST_MODE:]
        history = (l0 - gain) * last - bend * ratio * (last - memory[j, BEFORE_LAST])
        for k in range(modes):
            history += decay[k] * mode[k]
        y_history[j] = history
    return float(gain)


@kernel
def _commit(coefficients: Array, memory: Array, x: Array, dt: float) -> None:
    """Do the work of `commit` for any sample."""
    header, n, modes = coefficients[HEADER], memory.shape[0], memory.shape[1] - FIRST_MODE
    scheme, slope, tempering = header[SCHEME], header[DIFFERENTIATES], header[TEMPERING]
    count = memory[0, COUNT]
    response = np.zeros((4, modes))
    if count == 0.0:  # A step from zero, which enters the modes as a value.
        for k in range(modes):
            response[1, k] = coefficients[START, k]
    else:
        bend, ratio = _bend(scheme, count, dt, memory[0, LAST_PERIOD])
        for k in range(modes):
            rate, weight = coefficients[RATE, k], coefficients[WEIGHT, k]
            decay, g0, g1, g2 = mode_response(scheme, slope, tempering, dt, rate, weight)
            if bend != 0.0 and count == 2.0:
                g2 += decay * _bent_first(scheme, slope, tempering, dt, ratio, rate, weight)
            response[0, k], response[1, k], response[2, k], response[3, k] = decay, g0, g1, g2
    _move(coefficients, memory, x, dt, response, None)
    if count == 0.0:
        for j in range(n):
            memory[j, BEFORE_LAST] = x[j]


@kernel
def _bend(scheme: float, count: float, dt: float, last_period: float) -> tuple[float, float]:
    """Return `b` and `r = h/h'` in `curvature = b (x_n - x_{n-1} - r (x_{n-1} - x_{n-2}))`.

    `b = 0` where the input is taken as linear: with two samples nothing else is known.
    """
    if scheme != QUADRATIC or count < 2.0:
        return 0.0, 0.0
    ratio = dt / last_period
    return ratio / (1.0 + ratio), ratio


@kernel
def _bent_first(
    scheme: float,
    slope: float,
    tempering: float,
    dt: float,
    ratio: float,
    rate: float,
    weight: float,
) -> float:
    """Return what the first interval adds to a mode, per unit of the second one's curvature.

    The first interval was taken as linear. The third sample shows its curvature, which is that of
    the second interval over ratio², as curvatures are measured per interval.
    """
    _, _, _, gain = mode_response(scheme, slope, tempering, dt / ratio, rate, weight)
    return gain / (ratio * ratio)


@kernel
def advance_checked(coefficients: Array, memory: Array, x: Array, dt: float, y: Array) -> bool:
    """Call `advance`; where `x` has another shape or is not finite, change nothing."""
    if x.shape != y.shape:
        return False
    for j in range(x.size):
        if not math.isfinite(x[j]):
            return False
    advance(coefficients, memory, x, dt, y)
    return True


@kernel
def advance_many(
    coefficients: Array, memory: Array, rows: Array, periods: Array, values: Array
) -> None:
    """Call `advance` for each row."""
    for i in range(rows.shape[0]):
        advance(coefficients, memory, rows[i], periods[i], values[i])
