"""How much of what is learnt a law is given: as much as is known, and as its loop bears."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.learning.parameters import Beliefs
    from fotsmc_pin.types import Array

FADING = 0.3
"""Time in which the law's model follows the estimate [s]."""
SURE = 2.0
"""Standard deviations that are counted as possible."""
FARTHEST = 0.3
"""Largest distance of the payload's centre from the tool frame [m]."""


@kernel(is_part=True)
def trust(dt: float, n: int, lowest: float, highest: float, b: Beliefs, P: Array) -> None:
    """Move `used` by one tick towards the estimate.

    The mass matrix is a sum of positive semidefinite parts, one for each link, for the payload and
    for each rotor, each times its parameter. Where each true parameter is at least `lowest` and at
    most `highest` times the one that is used, the same holds for the matrices, and so for every
    ratio of true to believed inertia that the loop meets. A parameter is therefore raised above the
    nominal one no further than to `(θ - 2σ) / lowest`, and lowered no further than to
    `(θ + 2σ) / highest`. Friction does not enter the loop and is used as it is estimated.

    Args:
        dt: time since the last tick [s].
        n: number of joints.
        lowest: ratio of true to believed inertia down to which the loop is used.
        highest: the same, upward.
        b: the beliefs.
        P: covariance (p, p).
    """
    share = dt / (FADING + dt)
    for i in range(b.estimate.size):
        b.sigma[i] = math.sqrt(max(P[i, i], 0.0))
        wanted = b.estimate[i]
        if i <= n or n + 4 <= i < 2 * n + 4:
            doubt = SURE * b.sigma[i]
            ceiling = max(b.nominal[i], (wanted - doubt) / lowest)
            floor = min(b.nominal[i], (wanted + doubt) / highest)
            wanted = min(max(wanted, floor), ceiling)
        b.used[i] += share * (wanted - b.used[i])


@kernel(is_part=True)
def body(
    i: int, n: int, tool: int, centre: Array, bodies: Array, used: Array, dynamic: Array
) -> None:
    """Write the ten dynamic parameters of link `i`, its payload included, into `dynamic` (10,).

    The payload is a point mass, which is possible wherever it lies and however heavy it is.

    Args:
        i: index of the link.
        n: number of joints.
        tool: index of the link that carries the tool.
        centre: of the tool frame in that link's (3,) [m].
        bodies: dynamic parameters of the nominal links (nv + 4, 10); the rest is not read.
        used: the parameters (p,).
        dynamic: overwritten.
    """
    for k in range(10):
        dynamic[k] = used[i] * bodies[i, k]
    m = used[n]
    if i != tool or m <= 1e-9:
        return
    x, y, z = (
        centre[0] + min(max(used[n + 1] / m, -FARTHEST), FARTHEST),
        centre[1] + min(max(used[n + 2] / m, -FARTHEST), FARTHEST),
        centre[2] + min(max(used[n + 3] / m, -FARTHEST), FARTHEST),
    )
    dynamic[0] += m
    dynamic[1] += m * x
    dynamic[2] += m * y
    dynamic[3] += m * z
    dynamic[4] += m * (y * y + z * z)
    dynamic[5] -= m * x * y
    dynamic[6] += m * (x * x + z * z)
    dynamic[7] -= m * x * z
    dynamic[8] -= m * y * z
    dynamic[9] += m * (x * x + y * y)


@kernel
def add_friction(v_d: Array, used: Array, stribeck_velocity: float, h: Array) -> None:
    """Add the friction that the wanted speed `v_d` (nv,) will meet to the torque `h` (nv,).

    It closes no loop: the speed is the wanted one. Its sign changes within 2 mrad/s.
    """
    n = v_d.size
    for j in range(n):
        sign = math.tanh(v_d[j] / 2e-3)
        h[j] += used[2 * n + 4 + j] * v_d[j] + used[3 * n + 4 + j] * sign
        if used.size > 4 * n + 4:
            fall = math.exp(-((v_d[j] / stribeck_velocity) ** 2))
            h[j] += used[4 * n + 4 + j] * sign * fall
