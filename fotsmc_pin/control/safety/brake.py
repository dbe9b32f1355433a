"""`Brake`: brings an arm to rest and holds it without the control law."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms.drive_size import drive_size
from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.functions import clip
from fotsmc_pin.control.safety.steps import BORNE, RECENT, SPEED
from fotsmc_pin.control.saved_state import present
from fotsmc_pin.copying import SharesNothing

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

RATE = 20.0
"""Double root of the loop where the model is right [1/s]."""
MOST_HELD = 0.6
"""Share of the drive that holds what the model does not know."""
HEAVIEST = 1.0 / 50.0
"""Largest inertia beyond the nominal one, over the size of the drive [s²/rad]."""
FIRST = 1.0 / 20.0
"""Inertia beyond the nominal one at first, over the torque that the model does not explain: a joint
that bears some has gears, and a motor behind them [s²/rad]."""
SLOW, QUICK = 15.0, 150.0
"""Rates at which a joint follows below and above which its inertia is taken for another [1/s]."""
GROWTH, SEED = 40.0, 0.05
"""Rate at which the inertia grows [1/s], from this share of the nominal one."""
SHRINK = 0.7
"""Factor by which it shrinks in a tick."""
NOISE, MOVING = 0.01, 0.05
"""Speeds that are not looked at: below the noise, and too small to matter [rad/s, m/s]."""
STILL = 0.01
"""Speed below which a joint has come to rest [rad/s, m/s]."""
MEMORY = ("load", "inertia", "last", "left")


class Brake(SharesNothing):
    """A follower that needs nothing but a model of the arm: it knows its own load from what acted.

        τ = M̂ (a_b - 2 κ ė - κ² (e - e_r)) + C v + G + w,   κ = 20 / s
        w = Q (τ - C v - G) - M̂ Q v̇,   M̂ = M + diag J

    `Q` is an average over the last 10 ms, so that `w` is what the model did not explain of late:
    friction, and errors of masses. `J` is inertia that the model lacks, as the rotors': it grows
    while a joint does not follow, and shrinks while it follows too fast. A joint that has come to
    rest at the end of its path is held where it is, at the error `e_r`: to be pulled on to where
    the path ended would be another motion.

    Attributes:
        rate: `κ` [1/s]; less where ticks are long.
        drive: size of each joint's drive (nv,) [N·m, N].
    """

    def __init__(self, arm: Arm, dt: float) -> None:
        self._n = arm.nv
        self.drive, self.rate = drive_size(arm), min(RATE, 0.1 / dt)
        self.reset()

    def reset(self) -> None:
        """Forget load and inertia."""
        self._load, self._inertia, self._last, self._left = np.zeros((4, self._n))

    def begin(self, load: Array) -> None:
        """Begin with a torque (nv,) that the model does not explain."""
        begun(load, self.drive, self._load, self._inertia, self._last, self._left)

    def torque(
        self,
        e: Array,
        v: Array,
        target: tuple[Array, Array],
        M: Array,
        h: Array,
        recent: Array,
        dt: float,
        *,
        sees: bool,
    ) -> Array:
        """Return the torque (nv,) of one tick.

        Args:
            e: how far the arm is from the path (nv,).
            v: velocity (nv,).
            target: the path's velocity and acceleration (nv,).
            M: mass matrix (nv, nv).
            h: `C v + G` (nv,).
            recent: averages of what acted and of what was seen (4, nv); see `steps.averaged`.
            dt: time since the last tick [s].
            sees: whether `v` was measured; else the load stays what it was.
        """
        tau = np.zeros(self._n)
        memory = (self._load, self._inertia, self._last, self._left)
        braked(e, v, *target, M, h, recent, self.drive, self.rate, dt, sees, *memory, tau)
        return tau

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered."""
        return {name: getattr(self, f"_{name}") for name in MEMORY}

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave.

        Raises:
            ArgumentError: an array is missing or of the wrong shape. The memory stays as it was.
        """
        rows = [checks.finite_vector(name, present(arrays, name), self._n) for name in MEMORY]
        self._load, self._inertia, self._last, self._left = (np.array(row) for row in rows)


@kernel
def unexplained(v: Array, recent: Array, M: Array, load: Array) -> None:
    """Write the torque into `load` (nv,) that acted of late beyond `M v̇ + C v + G`."""
    for i in range(v.size):
        load[i] = recent[BORNE, i]
        for j in range(v.size):
            load[i] -= M[i, j] * RECENT * (v[j] - recent[SPEED, j])


@kernel
def begun(
    found: Array, drive: Array, load: Array, inertia: Array, last: Array, left: Array
) -> None:
    """Write the memory of a `Brake` that begins with the load `found` (nv,)."""
    for i in range(found.size):
        load[i] = clip(found[i], MOST_HELD * drive[i])
        inertia[i] = min(FIRST * abs(found[i]), HEAVIEST * drive[i])
        last[i], left[i] = 0.0, 0.0


@kernel
def braked(
    e: Array,
    v: Array,
    v_b: Array,
    a_b: Array,
    M: Array,
    h: Array,
    recent: Array,
    drive: Array,
    rate: float,
    dt: float,
    sees: bool,
    load: Array,
    inertia: Array,
    last: Array,
    left: Array,
    tau: Array,
) -> None:
    """One tick of the equations of `Brake`; `load`, `inertia`, `last` and `left` are its memory."""
    a = np.zeros(v.size)
    if sees:
        unexplained(v, recent, M, load)
    for i in range(v.size):
        e_dot = v[i] - v_b[i]
        follows = (last[i] - e_dot) * last[i] / (dt * (last[i] * last[i] + NOISE * NOISE))
        if follows > QUICK:
            inertia[i] *= SHRINK
        elif follows < SLOW and abs(e_dot) > MOVING:
            inertia[i] += GROWTH * dt * (inertia[i] + SEED * M[i, i])
        inertia[i] = min(inertia[i], HEAVIEST * drive[i])
        last[i] = e_dot
        if v_b[i] != 0.0 or a_b[i] != 0.0:
            left[i] = 0.0
        elif left[i] == 0.0 and abs(v[i]) < STILL:
            left[i] = e[i]
        a[i] = a_b[i] - 2.0 * rate * e_dot - rate * rate * (e[i] - left[i])
        if sees:
            load[i] -= inertia[i] * RECENT * (v[i] - recent[SPEED, i])
            load[i] = clip(load[i], MOST_HELD * drive[i])
    for i in range(v.size):
        tau[i] = h[i] + inertia[i] * a[i] + load[i]
        for j in range(v.size):
            tau[i] += M[i, j] * a[j]
