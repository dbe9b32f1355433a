"""The estimator of `ModelLearning`: a Kalman filter on low-passed torques, a piece per tick.

The equation of motion is linear in the parameters `θ`:

    τ = Y(q, v, v̇) θ

Both sides are averaged over a window of four ticks, in which the acceleration is the change of
speed over its duration, and low-passed at the same rate, so that no acceleration is measured and
none is differentiated from noise. Each joint's row then is one measurement of `θ`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from fotsmc_pin.compiled import kernel
from fotsmc_pin.learning.parameters import shared_columns

if TYPE_CHECKING:
    from fotsmc_pin.learning.parameters import Beliefs
    from fotsmc_pin.types import Array

WINDOW = 4
"""Ticks over which torque and speed are averaged; one of them evaluates the regressor, the others
take in a share of the joints each."""
ROUND = 2
"""Windows in which every joint is taken in once."""
RATE = 25.0
"""Bandwidth of the low-pass on torques and regressor [rad/s]."""
SIGN_WIDTH = 0.01
"""Speed over which Coulomb friction changes sign [rad/s, m/s]."""
STICKING = 0.5
DOUBTED = 0.25
"""Share of the deviation of a joint's friction that counts as friction while it may stick: with all
of it friction is learnt late, with none what is not known of it passes for a rotor."""
STILL = 0.03
"""Speed below which a joint may stick, so that its friction is anything up to a bound."""
IDLE = 0.5
"""Share of the recent time at rest from which on a joint's row says nothing."""
REPEATS = 2.0
DRIFT = 1e-4
"""Variance that a parameter gains in a second of motion, over that beforehand: friction may change
by a third of its deviation in a quarter of an hour, as in a gearbox that warms up."""
NOISE_RATE = 1.0
"""Rate at which the noise of a row is tracked [1/s]."""
SURPRISE_RATE = 10.0
"""Rate at which surprise is averaged [1/s]."""
MOST_SURPRISE = 100.0
SURPRISING = 9.0
"""Squared error of a row over its variance, on average, from which on something has changed."""


class JointRows(NamedTuple):
    """One number per joint, (nv,).

    Attributes:
        torque: integral of the torque that acted in the window [N·m·s].
        travel: integral of the speed [rad].
        signs: integral of the speed's smoothed sign [s].
        last_speed: at the start of the window [rad/s].
        mean_torque: over the last window [N·m].
        mean_speed: over the last window [rad/s].
        mean_sign: of the speed, over the last window.
        acceleration: change of speed over the last window [rad/s²].
        smoothed: torque after one low-pass [N·m].
        filtered: torque after both [N·m].
        sticking: share of the time in which the joint may stick, after one low-pass.
        idle: the same after both.
        noise: variance of a row [N²·m²].
        least_noise: the least that is believed.
        unexplained: torque that the estimate did not predict [N·m].
        learning: 1 where the row was taken in, 0 where it was idle.
        surprise: recent mean of the squared error over its variance.
        extra: friction beyond the estimate that a joint is given which does not start [N·m].
        direction: of the friction that is fed forward, from -1 to 1.
    """

    torque: Array
    travel: Array
    signs: Array
    last_speed: Array
    mean_torque: Array
    mean_speed: Array
    mean_sign: Array
    acceleration: Array
    smoothed: Array
    filtered: Array
    sticking: Array
    idle: Array
    noise: Array
    least_noise: Array
    unexplained: Array
    learning: Array
    surprise: Array
    extra: Array
    direction: Array


@kernel(is_part=True)
def collect(dt: float, tau: Array, v: Array, joints: JointRows) -> None:
    """Add a tick with the torque `tau` (nv,) that acted and the speed `v` (nv,) after it."""
    for j in range(v.size):
        joints.torque[j] += dt * tau[j]
        joints.travel[j] += dt * v[j]
        joints.signs[j] += dt * math.tanh(v[j] / SIGN_WIDTH)


@kernel(is_part=True)
def close_window(duration: float, v: Array, joints: JointRows) -> None:
    """Turn the integrals over a window into means, and begin a new one."""
    for j in range(v.size):
        joints.mean_torque[j] = joints.torque[j] / duration
        gained = v[j] - joints.last_speed[j]
        joints.mean_speed[j] = joints.travel[j] / duration - 0.5 * gained / WINDOW
        joints.acceleration[j] = gained / duration
        joints.mean_sign[j] = joints.signs[j] / duration
        joints.torque[j] = joints.travel[j] = joints.signs[j] = 0.0
        joints.last_speed[j] = v[j]


@kernel(is_part=True)
def absorb(
    duration: float,
    regressor: Array,
    bodies: Array,
    tool: int,
    joints: JointRows,
    Y: Array,
    stribeck_velocity: float,
) -> None:
    """Take the last window into the low-passed rows `Y` (nv, c) and torques.

    The columns of a row are those of `Layout`: of all links, of the payload, and the joint's own.

    Args:
        duration: of the window [s].
        regressor: Pinocchio's joint torque regressor (nv, 10 nv).
        bodies: dynamic parameters per unit of each shared column, and a last row (4 nv + 5, 10).
        tool: index of the link that carries the tool.
        joints: the joints' rows.
        Y: overwritten.
        stribeck_velocity: speed at which friction falls [rad/s].
    """
    n, own = joints.torque.size, bodies.shape[0] - 1
    first, second = Y
    share = 1.0 - math.exp(-RATE * duration)
    for j in range(n):
        v = joints.mean_speed[j]
        for i in range(own):
            start = 10 * (i if i < n else tool if i < n + 4 else (i - n - 4) // 3)
            y = 0.0
            for k in range(10):
                y += regressor[j, start + k] * bodies[i, k]
            first[j, i] += share * (y - first[j, i])
        sign = joints.mean_sign[j]
        first[j, own] += share * (joints.acceleration[j] - first[j, own])
        first[j, own + 1] += share * (v - first[j, own + 1])
        first[j, own + 2] += share * (sign - first[j, own + 2])
        if first.shape[1] > own + 3:
            more = sign * math.exp(-((v / stribeck_velocity) ** 2))
            first[j, own + 3] += share * (more - first[j, own + 3])
        for c in range(first.shape[1]):
            second[j, c] += share * (first[j, c] - second[j, c])
        joints.smoothed[j] += share * (joints.mean_torque[j] - joints.smoothed[j])
        joints.filtered[j] += share * (joints.smoothed[j] - joints.filtered[j])
        may_stick = math.exp(-((v / STILL) ** 2))
        joints.sticking[j] += share * (may_stick - joints.sticking[j])
        joints.idle[j] += share * (joints.sticking[j] - joints.idle[j])


@kernel(is_part=True)
def place(j: int, c: int, n: int) -> int:
    """Return which parameter stands in column `c` of the row of joint `j`."""
    shared = shared_columns(n)
    return c if c < shared else shared + (c - shared) * n + j


@kernel(is_part=True)
def take_row(j: int, duration: float, joints: JointRows, Y: Array, b: Beliefs, P: Array) -> None:
    """Take the row of joint `j` into the estimate and its covariance `P` (p, p): a Kalman update.

    Rows follow each other faster than the low-pass forgets, so their noise is alike: the variance
    counts as often as there are rows in `1 / RATE`.
    """
    n, p, columns, g = joints.torque.size, b.estimate.size, Y.shape[1], b.work
    joints.learning[j] = 0.0
    if joints.idle[j] > IDLE:
        return
    error = joints.filtered[j]
    for c in range(columns):
        error -= Y[j, c] * b.estimate[place(j, c, n)]
    for i in range(p):
        g[i] = 0.0
    for c in range(columns):
        row, y = P[place(j, c, n)], Y[j, c]
        for i in range(p):
            g[i] += row[i] * y
    known = 0.0
    for c in range(columns):
        known += Y[j, c] * g[place(j, c, n)]
    rubbing = place(j, shared_columns(n) + 2, n)
    friction = b.estimate[rubbing] ** 2 + DOUBTED**2 * P[rubbing, rubbing]  # Squared.
    noise = joints.noise[j] + (STICKING * joints.idle[j]) ** 2 * friction
    surprise = min(error * error / (noise + known), MOST_SURPRISE)
    joints.surprise[j] += SURPRISE_RATE * duration * (surprise - joints.surprise[j])
    repeated = noise * max(1.0, REPEATS / (RATE * duration))
    total = repeated + known
    left = error * repeated / total
    joints.unexplained[j] = error
    most = SURPRISING * joints.noise[j]  # One jump shall not make the row deaf.
    share = min(1.0, NOISE_RATE * duration)
    joints.noise[j] += share * (min(left * left, most) - joints.noise[j])
    joints.noise[j] = max(joints.noise[j], joints.least_noise[j])
    if surprise > SURPRISING:
        joints.learning[j] = -1.0
        return
    step, scale = error / total, 1.0 / math.sqrt(total)
    for i in range(p):
        b.estimate[i] += g[i] * step
        g[i] *= scale
    for i in range(p):
        gain, row = g[i], P[i]
        for k in range(p):
            row[k] -= gain * g[k]
    joints.learning[j] = 1.0


@kernel(is_part=True)
def drift(duration: float, joints: JointRows, b: Beliefs, P: Array) -> None:
    """Let the parameters of what moves become less certain, at most as at the start."""
    n, p = joints.torque.size, b.estimate.size
    shared = shared_columns(n)
    moving = 0.0
    for j in range(n):
        moving += max(joints.learning[j], 0.0) / n
    for i in range(p):
        active = moving if i < shared else max(joints.learning[(i - shared) % n], 0.0)
        P[i, i] += DRIFT * duration * active * b.deviation[i] ** 2
        most = b.deviation[i] ** 2
        if P[i, i] > most:
            factor = math.sqrt(most / P[i, i])
            for k in range(p):
                P[i, k] *= factor
                P[k, i] *= factor


@kernel(is_part=True)
def keep_possible(b: Beliefs, P: Array) -> None:
    """Move estimates that no arm has to their bound, and the others with them as `P` says."""
    p = b.estimate.size
    for i in range(p):
        bound = min(max(b.estimate[i], b.lowest[i]), b.highest[i])
        if bound != b.estimate[i] and P[i, i] > 0.0:
            step = (bound - b.estimate[i]) / P[i, i]
            for k in range(p):
                b.estimate[k] += P[k, i] * step
    for i in range(p):
        b.estimate[i] = min(max(b.estimate[i], b.lowest[i]), b.highest[i])
