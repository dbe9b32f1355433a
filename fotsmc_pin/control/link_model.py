"""Links seen from their motors: what `SpringObserver` runs with encoders on the motors."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.rows import named_rows
from fotsmc_pin.control.small_matrices import cholesky, solve
from fotsmc_pin.control.spring_model import FASTEST_SWING

if TYPE_CHECKING:
    from fotsmc_pin.control.spring_observer import SpringObserver
    from fotsmc_pin.types import Array

LINK_SHARE = 0.3
"""Share of the link that a fast torque moves in what the law is given.

With all of it, a link that is lighter than believed turns the sign in which the law meets the
swing of motor against link; with none, the law meets the rotor alone where it is fast.
"""
LINK_NOISE, DRIFT = 0.2, 4.5
"""Accelerations of a link that the model does not explain over those of its motor, which has the
friction, and how fast they drift [1/s]: the weights of the observer's Kalman filter."""
SPEED_NOISE = 0.01
"""Noise of a measured speed over what the motor's unexplained acceleration makes in a tick."""
STANDS = 2e-3
"""Speed below which a motor is taken to stand [rad/s, m/s]: smoothed, above a sensor's noise.

Friction then takes up what the spring does not, and the motor's equation tells nothing of the link:
an estimate that is corrected by it feeds the law its own torque."""
SMOOTHING, FORGETTING = 100.0, 20.0
"""Bandwidth in which the speed is smoothed, and rate at which a motion is forgotten [1/s]."""
STILLING = 50.0
"""Rate at which a link is taken to come to rest on a motor that stands [1/s]."""
TINY = 1e-9
FASTEST_LINK = 2.0
"""Phase by which a link is taken to swing in a tick at most [rad], for the filter's gains."""


class LinkRows(NamedTuple):
    """What the observer knows of each joint, a row (nv,) each.

    Attributes:
        elastic: 1 where the joint has a spring, 0 where it is rigid.
        rotor: `J` [kg·m², kg].
        stiffness: `K` [N·m/rad, N/m]; 1 where it is rigid.
        damping: `D` of the spring [N·m·s/rad, N·s/m].
        to_deflection: part of the motor's unexplained change of speed that corrects `δ` [s].
        to_speed: the same of `v`.
        to_drift: the same of `a` [1/s].
        corner: rate below which the motor is left as it is [1/s].
    """

    elastic: Array
    rotor: Array
    stiffness: Array
    damping: Array
    to_deflection: Array
    to_speed: Array
    to_drift: Array
    corner: Array


class LinkState(NamedTuple):
    """What the observer remembers of each joint, a row (nv,) each.

    Attributes:
        speed: `ω` of the motor at the last tick [rad/s, m/s].
        bias: `C0 v + G0` of the links at the last tick [N·m, N].
        deflection: `δ`, motor beyond link [rad, m].
        v: speed of the link [rad/s, m/s].
        drift: `a`, acceleration of the link beyond the model [rad/s², m/s²].
        load: `d = M_l a`, torque on the link beyond the model [N·m, N].
        lasting: lasting part of `ω - v` [rad/s, m/s].
        swing: `x`, what `δ` changes by for a while [rad, m].
        swing_speed: its rate [rad/s, m/s].
        smooth: `ω` smoothed [rad/s, m/s].
        fastest: the largest of it lately [rad/s, m/s].
        ticks: how many there were.
    """

    speed: Array
    bias: Array
    deflection: Array
    v: Array
    drift: Array
    load: Array
    lasting: Array
    swing: Array
    swing_speed: Array
    smooth: Array
    fastest: Array
    ticks: Array


@kernel
def observe_links(
    dt: float,
    M: Array,
    h: Array,
    omega: Array,
    acting: Array,
    joints: Array,
    state: Array,
    later: Array,
    lead: Array,
    scratch: Array,
) -> None:
    """Write the observer's state after a tick, and what the law is given of it.

    Args:
        dt: time since the last tick [s].
        M: mass matrix of the links at the measured configuration (nv, nv).
        h: `C0 v + G0` of the links (nv,).
        omega: measured speed of the motors (nv,).
        acting: torque that acted since the last tick (nv,).
        joints: rows of `LinkRows` (8, nv).
        state: rows of `LinkState` (12, nv).
        later: the same after this tick, overwritten.
        lead: what is added to the motor's position, and the speed that goes with the sum (2, nv),
            overwritten.
        scratch: (nv, nv), overwritten.
    """
    x = named_rows(joints, LinkRows)
    s, t = named_rows(state, LinkState), named_rows(later, LinkState)
    n = omega.size
    for i in range(n):
        t.speed[i], t.bias[i], t.ticks[i] = omega[i], h[i], s.ticks[i] + 1.0
        lead[0, i], lead[1, i], t.v[i] = 0.0, omega[i], omega[i]
        t.drift[i] = t.load[i] = t.lasting[i] = t.swing[i] = t.swing_speed[i] = 0.0
        t.smooth[i] = t.fastest[i] = 0.0
        t.deflection[i] = x.elastic[i] * h[i] / x.stiffness[i]
    if s.ticks[0] == 0.0:
        return

    # M Δv = (K δ̄ + D (ω̄ - v̄) - h̄) dt + M a dt, by the midpoint rule; rigid links turn with ω.
    change = lead[0]
    for i in range(n):
        gained = omega[i] - s.speed[i]
        if x.elastic[i] == 0.0:
            change[i] = gained
            for j in range(n):
                scratch[i, j] = 0.0
            scratch[i, i] = 1.0
            continue
        away = s.speed[i] + 0.5 * gained - s.v[i]
        K, D = x.stiffness[i], x.damping[i]
        push = K * (s.deflection[i] + 0.5 * dt * away) + D * away
        push -= 0.5 * (h[i] + s.bias[i])
        change[i] = dt * push
        for j in range(n):
            scratch[i, j] = M[i, j]
            change[i] += dt * M[i, j] * s.drift[j]
            if x.elastic[j] == 0.0:
                scratch[i, j] = 0.0
                change[i] -= M[i, j] * (omega[j] - s.speed[j])
        scratch[i, i] += 0.5 * dt * (D + 0.5 * dt * K)
    cholesky(scratch, scratch)
    solve(scratch, change)

    # What the motor's own equation leaves of its change of speed corrects δ, v and a.
    smoothing, stilling = (
        SMOOTHING * dt / (1.0 + SMOOTHING * dt),
        STILLING * dt / (1.0 + STILLING * dt),
    )
    for i in range(n):
        t.smooth[i] = s.smooth[i] + smoothing * (omega[i] - s.smooth[i])
        t.fastest[i] = max(abs(t.smooth[i]), s.fastest[i] / (1.0 + FORGETTING * dt))
        if x.elastic[i] == 0.0:
            continue
        gained = omega[i] - s.speed[i]
        away = s.speed[i] + 0.5 * gained - s.v[i] - 0.5 * change[i]
        given = x.stiffness[i] * (s.deflection[i] + 0.5 * dt * away) + x.damping[i] * away
        missed = gained - dt * (acting[i] - given) / x.rotor[i]
        moves = 1.0 / (1.0 + (STANDS / max(t.fastest[i], TINY)) ** 4)
        missed *= moves
        t.deflection[i] = s.deflection[i] + dt * away + x.to_deflection[i] * missed
        t.v[i] = s.v[i] + change[i] + x.to_speed[i] * missed
        t.v[i] += (1.0 - moves) * stilling * (omega[i] - t.v[i])
        t.drift[i] = s.drift[i] + x.to_drift[i] * missed
        share = x.corner[i] * dt / (1.0 + x.corner[i] * dt)
        t.lasting[i] = s.lasting[i] + share * (omega[i] - t.v[i] - s.lasting[i])
        fast = omega[i] - t.v[i] - t.lasting[i]
        t.swing[i] = (s.swing[i] + dt * fast) * (1.0 - share)
        t.swing_speed[i] = fast - x.corner[i] * t.swing[i]

    # x - (J + ε M)⁻¹ J x is taken off the motor: what is left moves like an inertia J + ε M.
    for i in range(n):
        moving = x.elastic[i]
        for j in range(n):
            t.load[i] += moving * M[i, j] * t.drift[j]
            scratch[i, j] = LINK_SHARE * moving * x.elastic[j] * M[i, j]
        scratch[i, i] += x.rotor[i] if moving != 0.0 else 1.0
        lead[0, i], lead[1, i] = x.rotor[i] * t.swing[i], x.rotor[i] * t.swing_speed[i]
    cholesky(scratch, scratch)
    solve(scratch, lead[0])
    solve(scratch, lead[1])
    for i in range(n):
        lead[0, i] -= t.swing[i]
        lead[1, i] += omega[i] - t.swing_speed[i]


def link_corrections(
    dt: float, rotor: float, link: float, stiffness: float, damping: float
) -> Array:
    """Return the corrections of `δ`, `v` and `a` per missed change of the motor's speed, (3,).

    Those of the stationary Kalman filter of motor, spring and link, in which the motor accelerates
    by white noise, the link by `LINK_NOISE` of it and by a drift of `DRIFT` of it per second; the
    speed is measured with `SPEED_NOISE`. In the observer `δ` follows the measured speed, half of
    whose missed change has moved it already.

    Args:
        dt: period of a tick [s].
        rotor: `J` [kg·m²].
        link: inertia behind the spring [kg·m²].
        stiffness: `K` [N·m/rad].
        damping: `D` [N·m·s/rad].
    """
    from scipy.linalg import expm, solve_discrete_are  # take a noticeable part of a start

    m = max(link, stiffness * (dt / FASTEST_LINK) ** 2)
    A = np.zeros((4, 4))  # ω dt, δ, v dt, a dt²: all are angles
    A[0, :3] = np.array([-damping, -stiffness * dt, damping]) * dt / rotor
    A[1] = [1.0, 0.0, -1.0, 0.0]
    A[2] = np.array([damping, stiffness * dt, -damping, 0.0]) * dt / m
    A[2, 3] = 1.0
    F, seen = expm(A), np.array([[1.0, 0.0, 0.0, 0.0]])
    noise = np.diag([1.0, 1e-12, LINK_NOISE**2, (DRIFT * dt) ** 2])
    R = np.array([[SPEED_NOISE**2]])
    P = solve_discrete_are(F.T, seen.T, noise, R)
    gain = (P @ seen.T / (seen @ P @ seen.T + R))[:, 0]
    return np.array([(gain[1] - 0.5) * dt, gain[2], gain[3] / dt])


def link_constants(observer: SpringObserver, elastic: Array) -> Array:
    """Return the rows of `LinkRows` of an observer, with the joints `elastic` (nv,)."""
    arm, dt = observer.arm, observer.dt
    table = np.zeros((len(LinkRows._fields), arm.nv))
    x = named_rows(table, LinkRows)
    x.stiffness[:] = x.rotor[:] = 1.0
    x.corner[:] = observer.corner
    links = np.diag(arm.mass_matrix(arm.neutral)) - arm.armature
    for i in np.flatnonzero(elastic):
        numbers = (observer.rotor[i], observer.joint_stiffness[i], observer.joint_damping[i])
        J, K, D = (float(number) for number in numbers)
        if math.sqrt(K / J) * dt > FASTEST_SWING:
            continue
        found = link_corrections(dt, J, float(links[i]), K, D)
        x.elastic[i], x.rotor[i], x.stiffness[i], x.damping[i] = 1.0, J, K, D
        x.to_deflection[i], x.to_speed[i], x.to_drift[i] = found
    return table
