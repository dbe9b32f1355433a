"""`Brake`: brings an arm to rest and holds it without the control law."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms.drive_size import drive_size
from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.functions import clip
from fotsmc_pin.control.saved_state import present
from fotsmc_pin.copying import SharesNothing

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

RATE = 20.0
"""Threefold root of the loop where the model is right [1/s]."""
MOST_HELD = 0.6
"""Share of the drive that holds what the model does not know."""
HEAVIEST = 1.0 / 50.0
"""Largest inertia beyond the nominal one, over the size of the drive [s²/rad]."""
SLOW, QUICK = 15.0, 150.0
"""Rates at which a joint follows below and above which its inertia is taken for another [1/s]."""
GROWTH, SEED = 40.0, 0.05
"""Rate at which the inertia grows [1/s], from this share of the nominal one."""
SHRINK = 0.7
"""Factor by which it shrinks in a tick."""
NOISE, MOVING = 0.01, 0.05
"""Speeds that are not looked at: below the noise, and too small to matter [rad/s, m/s]."""
MEMORY = ("load", "inertia", "last")


class Brake(SharesNothing):
    """A follower of last resort: PID in units of acceleration, on the nominal model.

        τ = M0 (a_b + u) + J ∘ (a_b + u) + C0 v + G0 + w
        u = -3 κ ė - 3 κ² e,   ẇ = -κ³ (diag M0 + J) ∘ e,   κ = 20 / s

    `J` is inertia that the model lacks, the rotors' and the payload's: it grows while a joint does
    not follow, and shrinks while it follows too fast.

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
        self._load, self._inertia, self._last = np.zeros((3, self._n))

    def begin(self, v: Array, a: Array, tau: Array, M: Array, h: Array) -> None:
        """Begin with the load that `tau` (nv,) bore, as far as it does not drive the motion on.

        Args:
            v: velocity (nv,).
            a: acceleration at which the torque acted (nv,).
            tau: the torque (nv,).
            M: mass matrix (nv, nv).
            h: `C0 v + G0` (nv,).
        """
        borne(v, a, tau, M, h, self.drive, self._load)
        self._last = np.zeros(self._n)

    def torque(
        self, e: Array, v: Array, target: tuple[Array, Array], M: Array, h: Array, dt: float
    ) -> Array:
        """Return the torque (nv,) of one tick.

        Args:
            e: how far the arm is from the path (nv,).
            v: velocity (nv,).
            target: the path's velocity and acceleration (nv,).
            M: mass matrix (nv, nv).
            h: `C0 v + G0` (nv,).
            dt: time since the last tick [s].
        """
        tau = np.zeros(self._n)
        memory = (self._load, self._inertia, self._last)
        braked(e, v, *target, M, h, self.drive, self.rate, dt, *memory, tau)
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
        self._load, self._inertia, self._last = (np.array(row) for row in rows)


@kernel
def beyond_inertia(a: Array, tau: Array, M: Array, load: Array) -> None:
    """Write the torque into `load` (nv,) that `tau` (nv,) bears beyond `M a`."""
    for i in range(a.size):
        load[i] = tau[i]
        for j in range(a.size):
            load[i] -= M[i, j] * a[j]


@kernel
def borne(v: Array, a: Array, tau: Array, M: Array, h: Array, drive: Array, load: Array) -> None:
    """Write the torque into `load` (nv,) that the model does not explain; see `Brake.begin`."""
    beyond_inertia(a, tau, M, load)
    for i in range(v.size):
        unknown = load[i] - h[i]
        load[i] = 0.0 if unknown * v[i] > 0.0 else clip(unknown, MOST_HELD * drive[i])


@kernel
def braked(
    e: Array,
    v: Array,
    v_b: Array,
    a_b: Array,
    M: Array,
    h: Array,
    drive: Array,
    rate: float,
    dt: float,
    load: Array,
    inertia: Array,
    last: Array,
    tau: Array,
) -> None:
    """One tick of the equations of `Brake`; `load`, `inertia` and `last` are its memory."""
    a = np.zeros(v.size)
    for i in range(v.size):
        e_dot = v[i] - v_b[i]
        follows = (last[i] - e_dot) * last[i] / (dt * (last[i] * last[i] + NOISE * NOISE))
        if follows > QUICK:
            inertia[i] *= SHRINK
        elif follows < SLOW and abs(e_dot) > MOVING:
            inertia[i] += GROWTH * dt * (inertia[i] + SEED * M[i, i])
        inertia[i] = min(inertia[i], HEAVIEST * drive[i])
        last[i] = e_dot
        a[i] = a_b[i] - 3.0 * rate * e_dot - 3.0 * rate * rate * e[i]
        held = load[i] - rate * rate * rate * dt * (M[i, i] + inertia[i]) * e[i]
        load[i] = clip(held, MOST_HELD * drive[i])
    for i in range(v.size):
        tau[i] = h[i] + inertia[i] * a[i] + load[i]
        for j in range(v.size):
            tau[i] += M[i, j] * a[j]
