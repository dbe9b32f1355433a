"""One sample through a fractional operator, as compiled functions that a control law calls.

Every scheme has the same shape. The modes `Z_k` carry all intervals but the newest,

    y_n = Σ_k d_k Z_k + Σ_m l_m f_m,        Z_k ← d_k Z_k + Σ_m g_{k,m} f_m,

where the `f_m` describe the kernel's input on the newest interval (`interval.kernel_input`). The
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

from fotsmc_pin.compiled import kernel
from fotsmc_pin.fractional.interval import (
    decay_table,
    kernel_input,
    local_moments,
    mode_response,
    response_table,
)
from fotsmc_pin.fractional.layout import (
    BEFORE_LAST,
    COUNT,
    DECAY,
    FIRST_MODE,
    GAIN,
    HEADER,
    HISTORY,
    LAST,
    LAST_PERIOD,
    LOCAL,
    MODES,
    PERIOD,
    QUADRATIC,
    SCHEME,
    START,
    START_GAIN,
)

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array: TypeAlias = NDArray[np.float64]


@kernel
def advance(coefficients: Array, memory: Array, x: Array, dt: float, y: Array) -> None:
    """Take the next sample and write the output to `y`: `predict` and `commit` in one."""
    if memory[0, COUNT] == 0.0 or dt == coefficients[HEADER, PERIOD]:
        gain = predict(coefficients, memory, dt, y)
        commit(coefficients, memory, x, dt)
    else:
        table = response_table(coefficients, dt)
        _recall(memory, table, y)
        gain = _add_newest_interval(coefficients, memory, dt, y)
        _store(coefficients, memory, x, dt, table)
    for j in range(x.size):
        y[j] += gain * x[j]


@kernel
def predict(coefficients: Array, memory: Array, dt: float, y_history: Array) -> float:
    """Write what the past adds to the next output; return the gain of the next sample.

    The output for a sample `x` after `dt` is `y_history + gain x`. The memory stays as it is.
    """
    if memory[0, COUNT] == 0.0:
        y_history[:] = 0.0
        return float(coefficients[HEADER, START_GAIN])
    if dt == coefficients[HEADER, PERIOD]:
        for j in range(memory.shape[0]):
            y_history[j] = memory[j, HISTORY]
    else:
        _recall(memory, decay_table(coefficients, dt), y_history)
    return _add_newest_interval(coefficients, memory, dt, y_history)


@kernel
def commit(coefficients: Array, memory: Array, x: Array, dt: float) -> None:
    """Store the next sample."""
    if memory[0, COUNT] == 0.0:
        _start(coefficients, memory, x)
    elif dt == coefficients[HEADER, PERIOD]:
        _store(coefficients, memory, x, dt, coefficients[DECAY : GAIN + 3])
    else:
        _store(coefficients, memory, x, dt, response_table(coefficients, dt))


@kernel
def advance_if_finite(coefficients: Array, memory: Array, x: Array, dt: float, y: Array) -> bool:
    """Call `advance` if every entry of `x` is finite; otherwise leave all as it is."""
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


@kernel(sums_in_any_order=True)
def _recall(memory: Array, table: Array, y: Array) -> None:
    """Write the modes' share of the output to `y`; the first row of `table` holds their decays."""
    decay = table[0]
    for j in range(memory.shape[0]):
        modes = memory[j, FIRST_MODE:]
        total = 0.0
        for k in range(decay.size):
            total += decay[k] * modes[k]
        y[j] = total


@kernel
def _add_newest_interval(coefficients: Array, memory: Array, dt: float, y: Array) -> float:
    """Add the known part of the newest interval to `y`; return the gain of the newest sample."""
    header = coefficients[HEADER]
    if dt == header[PERIOD]:
        l0, l1, l2 = header[LOCAL], header[LOCAL + 1], header[LOCAL + 2]
    else:
        l0, l1, l2 = local_moments(header, dt)
    f0, f1, f2 = kernel_input(header, dt, 1.0, 0.0, 0.0)
    value_gain = l0 * f0 + l1 * f1 + l2 * f2
    f0, f1, f2 = kernel_input(header, dt, 0.0, 1.0, 0.0)
    gain = value_gain + l0 * f0 + l1 * f1 + l2 * f2
    bend, ratio = _curvature(header, memory, dt)
    if bend != 0.0:
        f0, f1, f2 = kernel_input(header, dt, 0.0, 0.0, 1.0)
        bend_gain = l0 * f0 + l1 * f1 + l2 * f2
        if memory[0, COUNT] == 2.0:
            decays = decay_table(coefficients, dt)
            for k in range(decays.shape[1]):
                bend_gain += decays[0, k] * _bent_first_interval(coefficients, memory, k, ratio)
        bend *= bend_gain
    gain += bend
    for j in range(memory.shape[0]):
        last = memory[j, LAST]
        y[j] += (value_gain - gain) * last - bend * ratio * (last - memory[j, BEFORE_LAST])
    return float(gain)


@kernel
def _start(coefficients: Array, memory: Array, x: Array) -> None:
    """Take the first sample."""
    for j in range(memory.shape[0]):
        memory[j, LAST] = memory[j, BEFORE_LAST] = x[j]
        memory[j, HISTORY] = 0.0
        for k in range(int(coefficients[HEADER, MODES])):
            mode = coefficients[START, k] * x[j]
            memory[j, FIRST_MODE + k] = mode
            memory[j, HISTORY] += coefficients[DECAY, k] * mode
    memory[0, COUNT] = 1.0


@kernel(sums_in_any_order=True)
def _store(coefficients: Array, memory: Array, x: Array, dt: float, table: Array) -> None:
    """Move the modes over the newest interval, whose decays and gains are the rows of `table`."""
    header = coefficients[HEADER]
    bend, ratio = _curvature(header, memory, dt)
    if bend != 0.0 and memory[0, COUNT] == 2.0:
        _bend_first_interval(coefficients, memory, x, bend, ratio)
    decay, g0, g1, g2 = table[0], table[1], table[2], table[3]
    nominal_decay = coefficients[DECAY]
    number = int(header[MODES])
    for j in range(memory.shape[0]):
        last = memory[j, LAST]
        difference = x[j] - last
        curvature = bend * (difference - ratio * (last - memory[j, BEFORE_LAST]))
        f0, f1, f2 = kernel_input(header, dt, x[j], difference, curvature)
        modes = memory[j, FIRST_MODE:]
        history = 0.0
        for k in range(number):
            mode = decay[k] * modes[k] + g0[k] * f0 + g1[k] * f1 + g2[k] * f2
            modes[k] = mode
            history += nominal_decay[k] * mode
        memory[j, HISTORY] = history
        memory[j, BEFORE_LAST] = last
        memory[j, LAST] = x[j]
    memory[0, LAST_PERIOD] = dt
    memory[0, COUNT] += 1.0


@kernel
def _curvature(header: Array, memory: Array, dt: float) -> tuple[float, float]:
    """Return `b` and `r = h/h'` in `curvature = b (x_n - x_{n-1} - r (x_{n-1} - x_{n-2}))`.

    `b = 0` where the input is taken as linear: with two samples nothing else is known.
    """
    if header[SCHEME] != QUADRATIC or memory[0, COUNT] < 2.0:
        return 0.0, 0.0
    ratio = dt / memory[0, LAST_PERIOD]
    return ratio / (1.0 + ratio), ratio


@kernel
def _bent_first_interval(coefficients: Array, memory: Array, k: int, ratio: float) -> float:
    """Return what the first interval adds to mode `k`, per unit of the second one's curvature.

    The first interval was taken as linear. The third sample shows its curvature, which is that of
    the second interval over ratio², as curvatures are measured per interval.
    """
    period = memory[0, LAST_PERIOD]
    _, g0, g1, g2 = mode_response(coefficients, k, period)
    f0, f1, f2 = kernel_input(coefficients[HEADER], period, 0.0, 0.0, 1.0 / (ratio * ratio))
    return float(g0 * f0 + g1 * f1 + g2 * f2)


@kernel
def _bend_first_interval(
    coefficients: Array, memory: Array, x: Array, bend: float, ratio: float
) -> None:
    """Give the modes the curvature of the first interval, once the third sample is there."""
    for k in range(int(coefficients[HEADER, MODES])):
        response = _bent_first_interval(coefficients, memory, k, ratio)
        for j in range(memory.shape[0]):
            last = memory[j, LAST]
            curvature = bend * (x[j] - last - ratio * (last - memory[j, BEFORE_LAST]))
            memory[j, FIRST_MODE + k] += response * curvature
