"""The way to the reference from far off: a large error becomes a small one that is led home.

Far from its surface a law asks for a motion whose speed depends on what the arm is, not on what the
model says: a joint that friction holds, or whose inertia the model lacks, winds up every integral
on its way and shoots past the goal. So the surface sees the error `e - e_g` from a point that leads
the joint home, and that waits for it. Near the reference `e_g = 0`, and the law is itself.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.robust_rows import State, Work
    from fotsmc_pin.control.rows import Joints
    from fotsmc_pin.types import Array

SPEED = 0.8
"""Share of a joint's velocity limit at which a large error is closed."""
LARGEST_ERROR = 0.08
"""Largest error of a joint behind the point that leads it, over `v_a / ω_g`."""
SMOOTHNESS = 3.6
"""Rate at which the leading point takes on its speed, over `ω_g`; from 4 on it never overshoots."""
BRAKING, LEAST_SPARE = 0.3, 0.1
"""Share of the torque beside gravity with which a joint is to brake, for the true arm is heavier;
and the least of the effort limit that is taken to be left beside gravity."""
NEGLIGIBLE, SLOW = 1e-6, 1e-4
"""Way [rad] and speed [rad/s] at which it has arrived; far below any noise."""


def speed_of_limits(arm: Arm) -> Array:
    """Return the speed `v_a` at which a large error is closed, (nv,) [rad/s]: 0.8 of the limit."""
    speed: Array = SPEED * arm.velocity_limit
    return speed


@kernel(is_part=True)
def lead(
    dt: float, x: Joints, M0: Array, h0: Array, speed: Array, rate: Array, m: State, w: Work
) -> None:
    """Move the way `e_g` (nv,) by one tick, and write what the surface is to see.

    With the error `ε = e - e_g` behind the leading point, of which `|ε| ≤ ε_max = 0.08 v_a / ω_g`
    is left to the surface (`e_g` takes up the rest at once):

        ë_g = 3.6 ω_g (-(1 - ζ) v(|e_g|) sign(e_g) - ė_g)
        v(x) = min(v_a x / √(x² + (v_a/ω_g)²), √(2 · 0.3 (τ_max - |h0|) x / M0_ii))

    `ζ = (ε / ε_max)²` where the joint lags, 0 where it is ahead: the point waits for it. From the
    second speed the joint can stop with 0.3 of the torque that it has.

    What a joint meets on its way passes, such as the weight of a payload at other poses, and the
    inertia floor is not to learn it. But a joint that does not follow has met what the floor is
    for. So the floor is told the error `ε + (1 - l) e_g`, with `l = (ε² + (ε̇/ω_g)²) / ε_max² ≤ 1`.

    Args:
        dt: time since the last tick [s].
        x: rows of the joints, for the error, its rate and the reference's acceleration.
        M0: nominal mass matrix (nv, nv).
        h0: nominal `C0 v + G0` (nv,).
        speed: `v_a` (nv,) [rad/s]; inf leaves the whole error to the surface.
        rate: `ω_g` (nv,) [1/s], at which the way ends.
        m: the law's state, for `e_g` and `ė_g`.
        w: the law's work, for `ε`, `ε̇`, `a_d + ë_g` and the error that the floor is told.
    """
    for i in range(x.e.size):
        width = speed[i] / rate[i]
        largest = LARGEST_ERROR * width
        error, lag, acceleration = x.e[i] - m.way[i], 0.0, 0.0
        if abs(error) > largest:
            error = math.copysign(largest, error)
            m.way[i] = x.e[i] - error
        if m.way[i] != 0.0:
            part, part_dot = error / largest, (x.e_dot[i] - m.way_speed[i]) / (rate[i] * largest)
            lag = min(part * part + part_dot * part_dot, 1.0)
            waits = part * part if error * m.way[i] > 0.0 else 0.0
            spare = max(x.effort_limit[i] - abs(h0[i]), LEAST_SPARE * x.effort_limit[i])
            stops = math.sqrt(2.0 * BRAKING * spare / M0[i, i] * abs(m.way[i]))
            most = min(speed[i] * abs(m.way[i]) / math.hypot(m.way[i], width), stops)
            wanted = -math.copysign((1.0 - waits) * most, m.way[i])
            follow = SMOOTHNESS * rate[i]
            acceleration = follow / (1.0 + follow * dt) * (wanted - m.way_speed[i])
            m.way_speed[i] += dt * acceleration
            m.way[i] += dt * m.way_speed[i]
            if abs(m.way[i]) < NEGLIGIBLE and abs(m.way_speed[i]) < SLOW:
                m.way[i] = m.way_speed[i] = 0.0
        w.near[i] = x.e[i] - m.way[i]
        w.near_dot[i] = x.e_dot[i] - m.way_speed[i]
        w.near_a_d[i] = x.a_d[i] + acceleration
        w.passing[i] = w.near[i] + (1.0 - lag) * m.way[i]
