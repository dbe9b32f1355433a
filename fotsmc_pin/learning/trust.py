"""How much of what is learnt a law is given: as much as is known, and as its loop bears."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.functions import clip
from fotsmc_pin.learning.estimator import IDLE
from fotsmc_pin.learning.parameters import shared_columns

if TYPE_CHECKING:
    from fotsmc_pin.learning.estimator import JointRows
    from fotsmc_pin.learning.parameters import Beliefs
    from fotsmc_pin.types import Array

FADING = 0.3
"""Time in which the law's model follows the estimate [s]."""
SURE = 2.0
"""Standard deviations that are counted as possible."""
TURNING = 1e-6
"""Wanted way on which the friction that is fed forward turns round [rad, m]."""
RELIEF = 0.1
"""Time in which it is taken back from a joint that stands [s]."""
LIGHTEST = 1e-9
"""Mass below which there is nothing to move [kg]."""
FARTHEST_LINK = 0.05
"""Largest distance of a link's centre of mass from the nominal one, along each axis [m]."""
ASKED = 0.06
"""Wanted speed at which a joint ought to move [rad/s, m/s]: twice that at which it may stick."""
STARTING = 1.0
"""Time in which a joint that does not start is given a standard deviation of friction more [s]."""
MOST_FRICTION = 4.0
"""Standard deviations beyond the mean beforehand up to which that goes on."""
FARTHEST = 0.3
"""Largest distance of the payload's centre from the tool frame [m]."""


@kernel(is_part=True)
def trust(
    dt: float, n: int, lowest: float, highest: float, joints: JointRows, b: Beliefs, P: Array
) -> None:
    """Move `used` by one tick towards the estimate; friction alone where the whole arm rests.

    There a law holds with a torque that it has found: another weight in the model would move it.

    The mass matrix is a sum of positive semidefinite parts, one for each link, for the payload and
    for each rotor, each times its parameter. Where each true parameter is at least `lowest` and at
    most `highest` times the one that is used, the same holds for the matrices, and so for every
    ratio of true to believed inertia that the loop meets. A parameter is therefore raised above the
    nominal one no further than to `(θ - 2σ) / lowest`, and lowered no further than to
    `(θ + 2σ) / highest`. First moments move the parts' masses and are used as estimated, and so is
    friction, which does not enter the loop.

    Args:
        dt: time since the last tick [s].
        n: number of joints.
        lowest: ratio of true to believed inertia down to which the loop is used.
        highest: the same, upward.
        joints: the joints' rows.
        b: the beliefs.
        P: covariance (p, p).
    """
    share, shared = dt / (FADING + dt), shared_columns(n)
    resting = joints.idle.min() > IDLE
    for i in range(b.estimate.size):
        b.sigma[i] = math.sqrt(max(P[i, i], 0.0))
        wanted = b.estimate[i]
        if i <= n or shared <= i < shared + n:
            doubt = SURE * b.sigma[i]
            ceiling = max(b.mean[i], (wanted - doubt) / lowest)
            floor = min(b.mean[i], (wanted + doubt) / highest)
            wanted = min(max(wanted, floor), ceiling)
        if not (resting and i < shared + n):
            b.used[i] += share * (wanted - b.used[i])


@kernel(is_part=True)
def help_start(dt: float, v_d: Array, joints: JointRows, b: Beliefs) -> None:
    """Add to the friction that is fed forward where a joint does not start though it is to move.

    It teaches nothing while it sticks, and a law whose model has hardly any inertia there does not
    break it loose. That it sticks shows that its friction is larger than believed: what is fed
    forward rises until it starts, and falls back to the estimate, which then is learnt.

    Args:
        dt: time since the last tick [s].
        v_d: wanted speed (nv,).
        joints: the joints' rows.
        b: the beliefs.
    """
    friction = shared_columns(v_d.size) + 2 * v_d.size
    for j in range(v_d.size):
        k = friction + j
        if joints.idle[j] > IDLE and abs(v_d[j]) > ASKED:
            most = max(b.mean[k] + MOST_FRICTION * b.deviation[k] - b.estimate[k], 0.0)
            joints.extra[j] = min(joints.extra[j] + dt / STARTING * b.deviation[k], most)
        else:
            joints.extra[j] *= 1.0 - dt / (FADING + dt)
        b.used[k] += dt / (FADING + dt) * joints.extra[j]


@kernel(is_part=True)
def body(i: int, n: int, tool: int, bodies: Array, used: Array, dynamic: Array) -> None:
    """Write the ten dynamic parameters of link `i`, its payload included, into `dynamic` (10,).

    A link is the nominal one times its factor, moved as a whole within 5 cm. The payload is a point
    mass within 30 cm of the tool. Both are possible wherever they lie and however heavy they are.

    Args:
        i: index of the link.
        n: number of joints.
        tool: index of the link that carries the tool.
        bodies: dynamic parameters of the nominal links in the first rows; in the last one the place
            of the tool in its link.
        used: the parameters (p,).
        dynamic: overwritten.
    """
    for k in range(10):
        dynamic[k] = used[i] * bodies[i, k]
    m, moment = dynamic[0], n + 4 + 3 * i
    if m > LIGHTEST:
        x, y, z = dynamic[1] / m, dynamic[2] / m, dynamic[3] / m
        add_point(-m, x, y, z, dynamic)
        x += clip(used[moment] / m, FARTHEST_LINK)
        y += clip(used[moment + 1] / m, FARTHEST_LINK)
        z += clip(used[moment + 2] / m, FARTHEST_LINK)
        add_point(m, x, y, z, dynamic)
    m, centre = used[n], bodies[-1]
    if i == tool and m > LIGHTEST:
        x = centre[0] + clip(used[n + 1] / m, FARTHEST)
        y = centre[1] + clip(used[n + 2] / m, FARTHEST)
        z = centre[2] + clip(used[n + 3] / m, FARTHEST)
        add_point(m, x, y, z, dynamic)


@kernel(is_part=True)
def add_point(m: float, x: float, y: float, z: float, dynamic: Array) -> None:
    """Add a point mass at a place to ten dynamic parameters, in Pinocchio's order."""
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


@kernel(is_part=True)
def turn_friction(dt: float, v_d: Array, joints: JointRows) -> None:
    """Turn the friction that is fed forward the way a joint is to move; take it back at rest.

    It lasts until the joint stands: were it to go with the wanted speed, the last bit of the way
    would be made without, and the joint would stop short. A joint that stands has to be pushed by
    its whole friction to either side before it slips.

    Args:
        dt: time since the last tick [s].
        v_d: wanted speed (nv,).
        joints: the joints' rows.
    """
    for j in range(v_d.size):
        way = abs(v_d[j]) * dt
        sign = 1.0 if v_d[j] > 0.0 else -1.0
        joints.direction[j] = sign + (joints.direction[j] - sign) * math.exp(-way / TURNING)
        if way < TURNING and joints.idle[j] > IDLE:
            joints.direction[j] -= clip(joints.direction[j], dt / RELIEF)


@kernel
def add_friction(
    v_d: Array, direction: Array, used: Array, stribeck_velocity: float, h: Array
) -> None:
    """Add the friction that the wanted speed `v_d` (nv,) will meet to the torque `h` (nv,).

    It closes no loop: speed and direction are the wanted ones.
    """
    n = v_d.size
    damping = shared_columns(n) + n
    friction, stribeck = damping + n, damping + 2 * n
    for j in range(n):
        h[j] += used[damping + j] * v_d[j] + used[friction + j] * direction[j]
        if used.size > stribeck:
            fall = math.exp(-((v_d[j] / stribeck_velocity) ** 2))
            h[j] += used[stribeck + j] * direction[j] * fall
