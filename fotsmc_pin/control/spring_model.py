"""The spring of a joint between two ticks, and the observer's rates: what `SpringObserver` runs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.rows import named_rows

if TYPE_CHECKING:
    from fotsmc_pin.control.spring_observer import SpringObserver
    from fotsmc_pin.types import Array

SWING_DAMPING = 0.15
"""Damping ratio that the observer gives its motor on the spring.

The largest with which `largest_bandwidth` of `RobustFONFTSM` is that of encoders on the motors, for
links of 0.7 to 2 times their nominal inertia, rotors from a twentieth of the joint's inertia on and
springs on which these swing at 150 to 450 rad/s: a wrong inertia of the link enters by what damps.
"""
IMPULSE_RATE, LOAD_RATE = 300.0, 2.0
"""Rates of the other two modes: of the impulse, and of the load that the model does not know [1/s].

The bandwidth that is borne does not depend on the first between 100/s and 600/s, nor on the second
between 2/s and 20/s. They stay at most this share of the rate at which ticks follow:
"""
LARGEST_SHARE = 0.5
USUAL_DAMPING = 0.02
"""Damping ratio of a motor on its spring, where it is not given."""
FASTEST_SWING = 2.0
"""Phase by which a motor may swing on its spring in a tick [rad]; faster, the joint is rigid."""


class SpringRows(NamedTuple):
    """What the observer knows of each joint, a row (nv,) each.

    Attributes:
        elastic: 1 where the joint has a spring, 0 where it is rigid.
        rotor: `J` [kg·m², kg].
        stiffness: `K` [N·m/rad, N/m]; 1 where it is rigid.
        damping: `D` of the spring [N·m·s/rad, N·s/m].
        to_impulse: part of the residual that corrects `π`.
        to_deflection: the same of `δ` per residual [rad/(N·m·s)].
        to_speed: the same of `ω` [rad/(N·m·s²)].
        to_load: the same of `d` [1/s].
        corner: rate at which lasting deflections are left out [1/s].
    """

    elastic: Array
    rotor: Array
    stiffness: Array
    damping: Array
    to_impulse: Array
    to_deflection: Array
    to_speed: Array
    to_load: Array
    corner: Array


class SpringState(NamedTuple):
    """What the observer remembers of each joint, a row (nv,) each.

    Attributes:
        v: link speed of the last tick [rad/s, m/s].
        bias: `C0 v + G0` of the links at the last tick [N·m, N].
        impulse: `π`, foreseen impulse of the link beyond the measured one [N·m·s, N·s].
        deflection: `δ`, motor beyond link [rad, m].
        speed: `ω` of the motor [rad/s, m/s].
        load: `d`, torque on the link beyond the model [N·m, N].
        lasting: part of `δ` that lasts [rad, m].
        ticks: how many there were.
    """

    v: Array
    bias: Array
    impulse: Array
    deflection: Array
    speed: Array
    load: Array
    lasting: Array
    ticks: Array


@kernel
def swung(
    dt: float,
    rotor: float,
    stiffness: float,
    damping: float,
    acting: float,
    v0: float,
    v1: float,
    deflection: float,
    speed: float,
) -> tuple[float, float]:
    """Return deflection and speed of a motor after `dt` under the constant torque `acting`.

        δ̇ = ω - v,   J ω̇ = τ - K δ - D (ω - v),   v linear from `v0` to `v1`

    In closed form: `δ` swings about `(τ - J v̇) / K`, so that no step is too long.
    """
    slope = (v1 - v0) / dt
    centre = (acting - rotor * slope) / stiffness
    away, rate = deflection - centre, speed - v0
    sigma, square = 0.5 * damping / rotor, stiffness / rotor
    span = square - sigma * sigma
    angle = math.sqrt(abs(span)) * dt
    if span > 0.0:
        decay = math.exp(-sigma * dt)
        even, odd = decay * math.cos(angle), decay * math.sin(angle) / angle * dt
    elif angle > 0.0:  # by the two decays themselves: a hyperbolic cosine might overflow
        slow, fast = math.exp(angle - sigma * dt), math.exp(-angle - sigma * dt)
        even, odd = 0.5 * (slow + fast), 0.5 * (slow - fast) / angle * dt
    else:
        even = math.exp(-sigma * dt)
        odd = even * dt
    moved = (even + sigma * odd) * away + odd * rate
    turned = (even - sigma * odd) * rate - square * odd * away
    return centre + moved, turned + v1


@kernel
def foreseen(
    dt: float,
    rotor: float,
    stiffness: float,
    damping: float,
    acting: float,
    v0: float,
    v1: float,
    gained: float,
    impulse: float,
    deflection: float,
    speed: float,
    load: float,
) -> tuple[float, float, float]:
    """Return `π`, `δ` and `ω` after `dt`, before they are corrected.

    What the spring gave the link, the motor got from the torque and lost: the impulse of the
    spring is `τ dt - J (ω⁺ - ω)`. `gained` is the measured impulse of the link.
    """
    later, turned = swung(dt, rotor, stiffness, damping, acting, v0, v1, deflection, speed)
    given = acting * dt - rotor * (turned - speed) + load * dt
    return impulse + given - gained, later, turned


@kernel
def observe(
    dt: float,
    M: Array,
    h: Array,
    v: Array,
    acting: Array,
    joints: Array,
    state: Array,
    later: Array,
    lead: Array,
) -> None:
    """Write the observer's state after a tick, and what the law is given of it.

    Args:
        dt: time since the last tick [s].
        M: mass matrix of the links at the measured configuration (nv, nv).
        h: `C0 v + G0` of the links (nv,).
        v: measured speed of the links (nv,).
        acting: torque that acted since the last tick (nv,).
        joints: rows of `SpringRows` (9, nv).
        state: rows of `SpringState` (8, nv).
        later: the same after this tick, overwritten.
        lead: by how much the motor leads the link, its lasting part left out, and the speed that
            goes with it (2, nv), overwritten.
    """
    x = named_rows(joints, SpringRows)
    s, t = named_rows(state, SpringState), named_rows(later, SpringState)
    n = v.size
    for i in range(n):
        t.v[i], t.bias[i], t.ticks[i] = v[i], h[i], s.ticks[i] + 1.0
        lead[0, i], lead[1, i] = 0.0, v[i]
        if x.elastic[i] == 0.0:
            continue
        if s.ticks[i] == 0.0:
            t.impulse[i], t.load[i], t.speed[i] = 0.0, 0.0, v[i]
            t.deflection[i] = t.lasting[i] = h[i] / x.stiffness[i]
            continue
        gained = 0.5 * dt * (h[i] + s.bias[i])
        for j in range(n):
            gained += M[i, j] * (v[j] - s.v[j])
        impulse, deflection, speed = foreseen(
            dt,
            x.rotor[i],
            x.stiffness[i],
            x.damping[i],
            acting[i],
            s.v[i],
            v[i],
            gained,
            s.impulse[i],
            s.deflection[i],
            s.speed[i],
            s.load[i],
        )
        t.impulse[i] = impulse - x.to_impulse[i] * impulse
        t.deflection[i] = deflection - x.to_deflection[i] * impulse
        t.speed[i] = speed - x.to_speed[i] * impulse
        t.load[i] = s.load[i] - x.to_load[i] * impulse
        share = -math.expm1(-x.corner[i] * dt)
        t.lasting[i] = s.lasting[i] + share * (t.deflection[i] - s.lasting[i])
        lead[0, i] = t.deflection[i] - t.lasting[i]
        lead[1, i] = t.speed[i] - x.corner[i] * lead[0, i]


def transition(dt: float, rotor: float, stiffness: float, damping: float) -> Array:
    """Return how `(π, δ, ω, d)` move in a tick without torque, motion and correction, (4, 4)."""
    columns = []
    for state in np.eye(4):
        pi, delta, omega, load = state.tolist()
        moved = foreseen(dt, rotor, stiffness, damping, 0.0, 0.0, 0.0, 0.0, pi, delta, omega, load)
        columns.append([*moved, load])
    return np.array(columns).T


def corrections(dt: float, rotor: float, stiffness: float, damping: float, rates: Array) -> Array:
    """Return the four corrections per residual with which errors decay at `rates`.

    With the right model, errors obey `x⁺ = (1 - l cᵀ) F x`, `cᵀ = (1, 0, 0, 0)`; `l` follows from
    the wanted poles `exp(rates dt)` by Ackermann's formula, in units in which all are alike.

    Args:
        dt: period of a tick [s].
        rotor: `J` [kg·m²].
        stiffness: `K` [N·m/rad].
        damping: `D` [N·m·s/rad].
        rates: four rates, complex ones in pairs [1/s].
    """
    w = math.sqrt(stiffness / rotor)
    units = np.array([rotor * w, 1.0, w, stiffness])
    F = transition(dt, rotor, stiffness, damping) * units / units[:, None]
    wanted = np.poly(np.exp(np.asarray(rates, dtype=complex) * dt)).real
    seen = np.vstack([np.linalg.matrix_power(F, k + 1)[0] for k in range(4)])
    polynomial = sum(c * np.linalg.matrix_power(F, 4 - k) for k, c in enumerate(wanted))
    found = polynomial @ np.linalg.solve(seen, np.array([0.0, 0.0, 0.0, 1.0]))
    return np.array(found * units / units[0])


def observer_rates(dt: float, rotor: float, stiffness: float, damping: float) -> Array:
    """Return the rates at which errors of `SpringObserver` decay, (4,) complex [1/s].

    The motor's swing on its spring keeps its rate `w = √(K/J)` and gets `SWING_DAMPING`, or its own
    damping where that is more; the impulse settles at `IMPULSE_RATE` and the load at `LOAD_RATE`.
    """
    w = math.sqrt(stiffness / rotor)
    zeta = max(SWING_DAMPING, 0.5 * damping / (rotor * w))
    swing = w * (-zeta + np.sqrt(complex(zeta * zeta - 1.0)))
    other = w * (-zeta - np.sqrt(complex(zeta * zeta - 1.0)))
    cap = LARGEST_SHARE / dt
    return np.array([swing, other, -min(IMPULSE_RATE, cap), -min(LOAD_RATE, cap)])


def usual_damping(stiffness: Array, rotor: Array) -> Array:
    """Return the damping of springs of which none is stated, (nv,) [N·m·s/rad, N·s/m]."""
    K = np.where(np.isfinite(stiffness), stiffness, 0.0)
    return np.asarray(2.0 * USUAL_DAMPING * np.sqrt(K * rotor))


def motor_constants(observer: SpringObserver, elastic: Array) -> Array:
    """Return the rows of `SpringRows` of an observer, with the joints `elastic` (nv,)."""
    table = np.zeros((len(SpringRows._fields), observer.arm.nv))
    x = named_rows(table, SpringRows)
    x.stiffness[:] = x.rotor[:] = 1.0
    x.corner[:] = observer.corner
    for i in np.flatnonzero(elastic):
        numbers = (observer.rotor[i], observer.joint_stiffness[i], observer.joint_damping[i])
        J, K, D = (float(number) for number in numbers)
        if math.sqrt(K / J) * observer.dt > FASTEST_SWING:
            continue
        found = corrections(observer.dt, J, K, D, observer_rates(observer.dt, J, K, D))
        x.elastic[i], x.rotor[i], x.stiffness[i], x.damping[i] = 1.0, J, K, D
        x.to_impulse[i], x.to_deflection[i], x.to_speed[i], x.to_load[i] = found
    return table
