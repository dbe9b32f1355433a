"""The arithmetic of the safeguard, as kernels: soft start, limits, what is kept."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.functions import clip

if TYPE_CHECKING:
    from fotsmc_pin.types import Array

CATCHING_UP, CAUGHT_UP = 20.0, 1e-4
"""Rate at which a torque makes up for what its own rate made it lag behind [1/s], and the lag, as a
share of the limit, that does not count."""
BORNE, SPEED = 0, 1
"""Rows of a safeguard's averages, (4, nv): of the torque beyond `C v + G`, and of the velocity; the
averages of both follow, which tell how far they lag behind."""
RECENT = 100.0
"""Rate at which the torque is averaged that a stop begins with [1/s]."""


@kernel
def faded(t: float, T: float, e: Array, e_dot: Array, v_d: Array, a_d: Array, way: Array) -> None:
    """Fade an offset out of a reference: `SoftStart` says how.

    Args:
        t: time since the start [s], below `T`.
        T: length of the fade [s].
        e: offset of the configuration at the start (nv,) [rad, m].
        e_dot: offset of the velocity at the start (nv,) [rad/s, m/s].
        v_d: reference velocity (nv,), overwritten by the one to follow.
        a_d: reference acceleration (nv,), overwritten by the one to follow.
        way: what is to be added to the reference configuration (nv,) [rad, m], overwritten.
    """
    u = t / T
    p = 1.0 - u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)
    r = u - u * u * u * (6.0 - 8.0 * u + 3.0 * u * u)
    p_dot = -30.0 * u * u * (1.0 - u) * (1.0 - u)
    r_dot = 1.0 - u * u * (18.0 - 32.0 * u + 15.0 * u * u)
    p_ddot = -60.0 * u * (1.0 - u) * (1.0 - 2.0 * u)
    r_ddot = -u * (36.0 - 96.0 * u + 60.0 * u * u)
    for i in range(e.size):
        way[i] = e[i] * p + T * e_dot[i] * r
        v_d[i] += (e[i] * p_dot + T * e_dot[i] * r_dot) / T
        a_d[i] += (e[i] * p_ddot + T * e_dot[i] * r_ddot) / (T * T)


@kernel
def too_fast(v: Array, fastest: Array) -> bool:
    """Whether a joint is faster than it may be."""
    most = 0.0
    for i in range(v.size):
        most = max(most, abs(v[i]) - fastest[i])
    return most > 0.0


@kernel
def slowed(v: Array, fastest: Array) -> None:
    """Keep the speeds `v` (nv,) within what they may be."""
    for i in range(v.size):
        v[i] = clip(v[i], fastest[i])


@kernel
def is_kept(e: Array, e_dot: Array, fastest: Array, way: float, share: float) -> bool:
    """Whether errors of position and speed (nv,) are within `way` and a share of `fastest`.

    A joint whose speed has no limit counts as one of 1 rad/s or m/s.
    """
    for i in range(e.size):
        quick = fastest[i] if math.isfinite(fastest[i]) else 1.0
        if not (abs(e[i]) <= way and abs(e_dot[i]) <= share * quick):
            return False
    return True


@kernel
def finite_or_last(tau: Array, last: Array) -> None:
    """Put the last torque in place of one that is no number."""
    for i in range(tau.size):
        if not math.isfinite(tau[i]):
            tau[i] = last[i]


@kernel
def within_limits(
    tau: Array,
    last: Array,
    sent: Array,
    added: Array,
    rate: Array,
    limit: Array,
    lag: Array,
    dt: float,
) -> None:
    """Keep a torque within all limits, which hold for the total and for what is commanded.

    A torque that could only follow the last one as far as its rate allows would go on to rise long
    after the law wants it to fall, and that delay makes loops unstable which were stable without a
    limit of the rate. So it follows the law's changes from where it is, and what it lags behind is
    made up for slowly.

    Args:
        tau: the total torque (nv,), overwritten.
        last: the last tick's (nv,).
        sent: what the last tick commanded (nv,).
        added: what the drives add to it now (nv,).
        rate: largest rate of either (nv,); inf for none.
        limit: limit of either (nv,).
        lag: how far the torque is from what it would be without a limit of the rate (nv,),
            overwritten.
        dt: time since the last tick [s].
    """
    left = max(1.0 - CATCHING_UP * dt, 0.0)
    for i in range(tau.size):
        step = rate[i] * dt
        least, most = max(added[i] - limit[i], -limit[i]), min(added[i] + limit[i], limit[i])
        free = min(max(tau[i], least), most)
        total = min(max(free - left * lag[i], last[i] - step), last[i] + step)
        commanded = sent[i] + added[i]
        total = min(max(total, commanded - step), commanded + step)
        tau[i] = min(max(total, least), most)
        lag[i] = free - tau[i]
        if abs(lag[i]) < CAUGHT_UP * limit[i]:
            lag[i] = 0.0


@kernel
def averaged(tau: Array, h: Array, v: Array, dt: float, recent: Array) -> None:
    """Take `tau - h` and velocity (nv,) into the averages of the last ones, `recent` (4, nv)."""
    weight = min(RECENT * dt, 1.0)
    for i in range(tau.size):
        recent[BORNE, i] += weight * (tau[i] - h[i] - recent[BORNE, i])
        recent[SPEED, i] += weight * (v[i] - recent[SPEED, i])
        for k in range(2):
            recent[2 + k, i] += weight * (recent[k, i] - recent[2 + k, i])


@kernel
def caught_up(recent: Array) -> None:
    """Make up for the lag of the averages `recent` (4, nv) while what they follow rises evenly."""
    for i in range(recent.shape[1]):
        for k in range(2):
            recent[k, i] += recent[k, i] - recent[2 + k, i]
