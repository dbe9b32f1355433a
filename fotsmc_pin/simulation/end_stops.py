"""`EndStops`: what happens where a joint is driven beyond its range."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

STIFFNESS = 0.3
"""Frequency of a joint on its stop, times the step of the integrator: stable below 2."""
DAMPING_RATIO = 0.5
LOWER, UPPER, SPRING, DAMPER, PUSH = range(5)


class EndStops:
    """Springs and dampers at the ends of each joint's range.

    Beyond an end by `x` a joint feels `-k x - d v`, and never a pull towards the end. They are as
    stiff as explicit steps of the integrator allow: `k = m (0.3 / h)²`, where `m` is the joint's
    inertia with all others free at the start.

    Attributes:
        push: torque of the stops at the end of the last step (nv,) [N·m, N]; 0 inside the range.
    """

    def __init__(self, arm: Arm, lightest: Array, h: float) -> None:
        """Fit the stops to an arm.

        Args:
            arm: the true arm.
            lightest: inertia of each joint (nv,) [kg·m², kg].
            h: step of the integrator [s].
        """
        self._places = np.array(arm.model.idx_qs[1:], dtype=np.int64)
        self._table = table = np.zeros((PUSH + 1, arm.nv))
        table[LOWER], table[UPPER] = arm.lower_position_limit, arm.upper_position_limit
        table[SPRING] = lightest * (STIFFNESS / h) ** 2
        table[DAMPER] = 2.0 * DAMPING_RATIO * lightest * STIFFNESS / h
        self.push = table[PUSH]

    def add_to(self, load: Array, q: Array, v: Array) -> None:
        """Add the stops' torque at `q` (nq,), `v` (nv,) to `load` (nv,)."""
        press(q, v, self._places, self._table)
        load += self.push


@kernel
def press(q: Array, v: Array, places: NDArray[np.int64], table: Array) -> None:
    """Write what each stop does. A joint without ends has one position at infinity on each side."""
    for j in range(v.size):
        lower, upper = table[LOWER, j], table[UPPER, j]
        table[PUSH, j] = 0.0
        if lower == -np.inf and upper == np.inf:
            continue
        x = q[places[j]]
        beyond = x - upper if x > upper else min(x - lower, 0.0)
        if beyond != 0.0:
            push = -table[SPRING, j] * beyond - table[DAMPER, j] * v[j]
            table[PUSH, j] = min(push, 0.0) if beyond > 0.0 else max(push, 0.0)
