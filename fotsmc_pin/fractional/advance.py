"""One sample through a fractional operator, as compiled functions that a control law calls.

Every scheme has the same shape. The modes `Z_k` carry all intervals but the newest,

    y_n = Σ_k d_k Z_k + Σ_m l_m f_m,        Z_k ← d_k Z_k + Σ_m g_{k,m} f_m,

where the `f_m` describe the kernel's input on the newest interval (`interval.kernel_input`). The
output is affine in the newest sample, which `predict` uses. Arguments are trusted here.

    advance(coefficients, memory, x, dt, y)                 y in place
    gain = predict(coefficients, memory, dt, y_history)     y = y_history + gain x, state untouched
    commit(coefficients, memory, x, dt)                     stores the sample
"""

from __future__ import annotations

from fotsmc_pin.compiled import kernel
from fotsmc_pin.fractional.interval import (
    kernel_input,
    local_moments,
    mode_decay,
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


@kernel
def advance(coefficients, memory, x, dt, y):  # type: ignore[no-untyped-def]
    """Take the sample `x` (n,), measured `dt` [s] after the last one, and write the output to `y`."""
    gain = predict(coefficients, memory, dt, y)
    for j in range(memory.shape[0]):
        y[j] += gain * x[j]
    commit(coefficients, memory, x, dt)


@kernel
def predict(coefficients, memory, dt, y_history):  # type: ignore[no-untyped-def]
    """Write what the past contributes to the next output; return the gain of the next sample.

    The output for a sample `x` that comes after `dt` [s] is `y_history + gain * x`. The memory stays
    as it is.
    """
    header = coefficients[HEADER]
    count = memory[0, COUNT]
    if count == 0.0:
        y_history[:] = 0.0
        return header[START_GAIN]
    nominal = dt == header[PERIOD]
    if nominal:
        l0, l1, l2 = header[LOCAL], header[LOCAL + 1], header[LOCAL + 2]
        for j in range(memory.shape[0]):
            y_history[j] = memory[j, HISTORY]
    else:
        l0, l1, l2 = local_moments(header, dt)
        y_history[:] = 0.0
        for k in range(int(header[MODES])):
            decay = mode_decay(coefficients, k, dt)
            for j in range(memory.shape[0]):
                y_history[j] += decay * memory[j, FIRST_MODE + k]

    f0, f1, f2 = kernel_input(header, dt, 1.0, 0.0, 0.0)
    value_gain = l0 * f0 + l1 * f1 + l2 * f2
    f0, f1, f2 = kernel_input(header, dt, 0.0, 1.0, 0.0)
    gain = value_gain + l0 * f0 + l1 * f1 + l2 * f2
    bend, ratio = _curvature_weights(header, memory, dt)
    if bend != 0.0:
        f0, f1, f2 = kernel_input(header, dt, 0.0, 0.0, 1.0)
        curvature_gain = l0 * f0 + l1 * f1 + l2 * f2
        if count == 2.0:
            for k in range(int(header[MODES])):
                decay = mode_decay(coefficients, k, dt)
                curvature_gain += decay * _first_interval(coefficients, memory, k, ratio)
        bend *= curvature_gain
    gain += bend
    bend *= ratio
    for j in range(memory.shape[0]):
        last = memory[j, LAST]
        y_history[j] += (value_gain - gain) * last - bend * (last - memory[j, BEFORE_LAST])
    return gain


@kernel
def commit(coefficients, memory, x, dt):  # type: ignore[no-untyped-def]
    """Store the sample `x` (n,), measured `dt` [s] after the last one."""
    header = coefficients[HEADER]
    count = memory[0, COUNT]
    if count == 0.0:
        _start(coefficients, memory, x)
    else:
        bend, ratio = _curvature_weights(header, memory, dt)
        if bend != 0.0 and count == 2.0:
            _bend_first_interval(coefficients, memory, x, bend, ratio)
        if dt == header[PERIOD]:
            table = coefficients[DECAY : GAIN + 3]
            _store(coefficients, memory, x, dt, bend, ratio, table)
        else:
            table = response_table(coefficients, dt)
            _store(coefficients, memory, x, dt, bend, ratio, table)
        memory[0, LAST_PERIOD] = dt
    memory[0, COUNT] = count + 1.0


@kernel
def _start(coefficients, memory, x):  # type: ignore[no-untyped-def]
    """Take the first sample."""
    for j in range(memory.shape[0]):
        memory[j, LAST] = memory[j, BEFORE_LAST] = x[j]
        memory[j, HISTORY] = 0.0
        for k in range(int(coefficients[HEADER, MODES])):
            mode = coefficients[START, k] * x[j]
            memory[j, FIRST_MODE + k] = mode
            memory[j, HISTORY] += coefficients[DECAY, k] * mode


@kernel
def _store(coefficients, memory, x, dt, bend, ratio, table):  # type: ignore[no-untyped-def]
    """Move the modes over the newest interval, whose decays and gains are the rows of `table`."""
    header = coefficients[HEADER]
    for j in range(memory.shape[0]):
        last = memory[j, LAST]
        difference = x[j] - last
        curvature = bend * (difference - ratio * (last - memory[j, BEFORE_LAST]))
        f0, f1, f2 = kernel_input(header, dt, x[j], difference, curvature)
        history = 0.0
        for k in range(int(header[MODES])):
            mode = table[0, k] * memory[j, FIRST_MODE + k]
            mode += table[1, k] * f0 + table[2, k] * f1 + table[3, k] * f2
            memory[j, FIRST_MODE + k] = mode
            history += coefficients[DECAY, k] * mode
        memory[j, HISTORY] = history
        memory[j, BEFORE_LAST] = last
        memory[j, LAST] = x[j]


@kernel
def _curvature_weights(header, memory, dt):  # type: ignore[no-untyped-def]
    """Return `b` and `r = h/h'` such that `curvature = b (x_n - x_{n-1} - r (x_{n-1} - x_{n-2}))`.

    `b = 0` where the input is taken as linear: with two samples nothing else is known.
    """
    if header[SCHEME] != QUADRATIC or memory[0, COUNT] < 2.0:
        return 0.0, 0.0
    ratio = dt / memory[0, LAST_PERIOD]
    return ratio / (1.0 + ratio), ratio


@kernel
def _first_interval(coefficients, memory, k, ratio):  # type: ignore[no-untyped-def]
    """Return what the curvature of the first interval would have added to mode `k`.

    It was taken as linear. The third sample shows the curvature, which is 1/ratio² times that of the
    second interval, in units of the intervals.
    """
    period = memory[0, LAST_PERIOD]
    _, g0, g1, g2 = mode_response(coefficients, k, period)
    f0, f1, f2 = kernel_input(coefficients[HEADER], period, 0.0, 0.0, 1.0 / (ratio * ratio))
    return g0 * f0 + g1 * f1 + g2 * f2


@kernel
def _bend_first_interval(coefficients, memory, x, bend, ratio):  # type: ignore[no-untyped-def]
    """Give the modes the curvature of the first interval, once the third sample is there."""
    for k in range(int(coefficients[HEADER, MODES])):
        response = _first_interval(coefficients, memory, k, ratio)
        for j in range(memory.shape[0]):
            last = memory[j, LAST]
            curvature = bend * (x[j] - last - ratio * (last - memory[j, BEFORE_LAST]))
            memory[j, FIRST_MODE + k] += response * curvature
