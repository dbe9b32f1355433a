"""One sample through a fractional operator, as compiled functions that a control law calls.

Every scheme has the same shape. The modes `Z_k` carry all intervals but the newest,

    y_n = Σ_k d_k Z_k + Σ_m l_m v_m,        Z_k ← d_k Z_k + Σ_m g_{k,m} v_m,

where the `v_m` are value, difference and curvature of the newest interval (see `interval`). The
output is affine in the newest sample, which `predict` uses. Arguments are trusted here.

    advance(coefficients, memory, x, dt, y)                 y in place
    gain = predict(coefficients, memory, dt, y_history)     y = y_history + gain x, memory untouched
    commit(coefficients, memory, x, dt)                     stores the sample

`coefficients` and `memory` are those of a `Stream`, `dt` [s] is the time since the last sample, and
`x`, `y`, `y_history` have one entry per signal.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

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
    GAIN,
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
    from numpy.typing import NDArray

    Array: TypeAlias = NDArray[np.float64]

TINY = 1e-280
"""Modes below this are set to zero: arithmetic with subnormal numbers is 40 times slower."""


@kernel
def advance(coefficients: Array, memory: Array, x: Array, dt: float, y: Array) -> None:
    """Take the next sample and write the output to `y`: `predict` and `commit` in one."""
    gain = predict(coefficients, memory, dt, y)
    for j in range(x.size):
        y[j] += gain * x[j]
    commit(coefficients, memory, x, dt)


@kernel(sums_in_any_order=True)
def predict(coefficients: Array, memory: Array, dt: float, y_history: Array) -> float:
    """Write what the past adds to the next output; return the gain of the next sample.

    The output for a sample `x` after `dt` is `y_history + gain x`. The memory stays as it is.
    """
    header, n = coefficients[HEADER], memory.shape[0]
    scheme, slope, tempering = header[SCHEME], header[DIFFERENTIATES], header[TEMPERING]
    count = memory[0, COUNT]
    for j in range(n):
        y_history[j] = memory[j, HISTORY]
    if count == 0.0:
        return float(header[START_GAIN])
    if dt == header[PERIOD]:
        l0, l1, l2 = header[OUTPUT_GAINS], header[OUTPUT_GAINS + 1], header[OUTPUT_GAINS + 2]
    else:
        l0, l1, l2 = output_gains(
            scheme, slope, tempering, dt, header[EXPONENT], header[NORMALIZER]
        )
        modes = memory.shape[1] - FIRST_MODE
        decays = np.empty(modes)
        for k in range(modes):
            decays[k] = mode_decay(scheme, tempering, dt, coefficients[RATE, k])
        for j in range(n):
            row = memory[j, FIRST_MODE:]
            total = 0.0
            for k in range(modes):
                total += decays[k] * row[k]
            y_history[j] = total
    bend, ratio = _bend(scheme, count, dt, memory[0, LAST_PERIOD])
    if bend != 0.0 and count == 2.0:
        for k in range(memory.shape[1] - FIRST_MODE):
            rate, weight = coefficients[RATE, k], coefficients[WEIGHT, k]
            decay = mode_decay(scheme, tempering, dt, rate)
            l2 += decay * _bent_first(scheme, slope, tempering, dt, ratio, rate, weight)
    bend *= l2
    gain = l0 + l1 + bend
    for j in range(n):
        last = memory[j, LAST]
        y_history[j] += (l0 - gain) * last - bend * ratio * (last - memory[j, BEFORE_LAST])
    return float(gain)


@kernel(sums_in_any_order=True)
def commit(coefficients: Array, memory: Array, x: Array, dt: float) -> None:
    """Store the next sample, and move the modes over the interval that it ends."""
    header, n, modes = coefficients[HEADER], memory.shape[0], memory.shape[1] - FIRST_MODE
    scheme, slope, tempering = header[SCHEME], header[DIFFERENTIATES], header[TEMPERING]
    count = memory[0, COUNT]
    bend, ratio = _bend(scheme, count, dt, memory[0, LAST_PERIOD])
    if bend != 0.0 and count == 2.0:
        for k in range(modes):
            rate, weight = coefficients[RATE, k], coefficients[WEIGHT, k]
            gain = bend * _bent_first(scheme, slope, tempering, dt, ratio, rate, weight)
            for j in range(n):
                last = memory[j, LAST]
                turn = x[j] - last - ratio * (last - memory[j, BEFORE_LAST])
                memory[j, FIRST_MODE + k] += gain * turn

    if count > 0.0 and dt == header[PERIOD]:
        decay = coefficients[DECAY]
        g0, g1, g2 = coefficients[GAIN], coefficients[GAIN + 1], coefficients[GAIN + 2]
        for j in range(n):
            value, last = x[j], memory[j, LAST]
            difference = value - last
            curvature = bend * (difference - ratio * (last - memory[j, BEFORE_LAST]))
            row = memory[j, FIRST_MODE:]
            history = 0.0
            for k in range(modes):
                mode = decay[k] * row[k] + g0[k] * value + g1[k] * difference + g2[k] * curvature
                if abs(mode) < TINY:
                    mode = 0.0
                row[k] = mode
                history += decay[k] * mode
            memory[j, HISTORY] = history
    elif count > 0.0:
        table = np.empty((4, modes))
        for k in range(modes):
            rate, weight = coefficients[RATE, k], coefficients[WEIGHT, k]
            table[0, k], table[1, k], table[2, k], table[3, k] = mode_response(
                scheme, slope, tempering, dt, rate, weight
            )
        nominal_decay = coefficients[DECAY]
        for j in range(n):
            value, last = x[j], memory[j, LAST]
            difference = value - last
            curvature = bend * (difference - ratio * (last - memory[j, BEFORE_LAST]))
            row = memory[j, FIRST_MODE:]
            for k in range(modes):
                mode = table[0, k] * row[k]
                mode += table[1, k] * value + table[2, k] * difference + table[3, k] * curvature
                if abs(mode) < TINY:
                    mode = 0.0
                row[k] = mode
            history = 0.0
            for k in range(modes):
                history += nominal_decay[k] * row[k]
            memory[j, HISTORY] = history
    else:
        for j in range(n):
            memory[j, LAST] = x[j]
            for k in range(modes):
                mode = coefficients[START, k] * x[j]
                memory[j, FIRST_MODE + k] = mode
                memory[j, HISTORY] += coefficients[DECAY, k] * mode

    for j in range(n):
        memory[j, BEFORE_LAST] = memory[j, LAST]
        memory[j, LAST] = x[j]
    memory[0, LAST_PERIOD] = dt
    memory[0, COUNT] = count + 1.0


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
def advance_in_place(coefficients: Array, memory: Array, x: Array, dt: float) -> bool:
    """Turn the sample `x` into the output; where an entry is not finite leave all as it is."""
    for j in range(x.size):
        if not math.isfinite(x[j]):
            return False
    y = np.empty(x.size)
    advance(coefficients, memory, x, dt, y)
    x[:] = y
    return True


@kernel
def advance_many(
    coefficients: Array, memory: Array, rows: Array, periods: Array, values: Array
) -> None:
    """Call `advance` for each row."""
    for i in range(rows.shape[0]):
        advance(coefficients, memory, rows[i], periods[i], values[i])
