"""`Brake`: brings an arm to rest and holds it without the control law."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms.drive_size import drive_size
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


class Brake(SharesNothing):
    """A follower of last resort: PID in units of acceleration, on the nominal model.

        τ = M0 (a_b + u) + J ∘ (a_b + u) + C0 v + G0 + w
        u = -3 κ ė - 3 κ² e,   ẇ = -κ³ (diag M0 + J) ∘ e,   κ = 20 / s

    `J` is inertia that the model lacks, the rotors' and the payload's: it grows while a joint does
    not follow, and shrinks while it follows too fast.
    """

    def __init__(self, arm: Arm, dt: float) -> None:
        self.arm = arm
        self._drive = drive_size(arm)
        self._rate = min(RATE, 0.1 / dt)
        self.reset()

    def reset(self) -> None:
        """Forget load and inertia."""
        n = self.arm.nv
        self._load, self._inertia = np.zeros(n), np.zeros(n)
        self._last: Array | None = None

    def begin(self, q: Array, v: Array, a: Array, tau: Array) -> None:
        """Begin with the load that `tau` (nv,) bore, as far as it does not drive the motion on."""
        load = tau - self.arm.inverse_dynamics(q, v, a)
        most = MOST_HELD * self._drive
        self._load = np.where(load * v > 0.0, 0.0, np.clip(load, -most, most))
        self._last = None

    def torque(self, q: Array, v: Array, target: tuple[Array, Array, Array], dt: float) -> Array:
        """Return the torque (nv,) of one tick."""
        q_b, v_b, a_b = target
        e, e_dot, k = self.arm.difference(q_b, q), v - v_b, self._rate
        M0 = self.arm.mass_matrix(q)
        own = np.diag(M0)
        self._search(e_dot, own, dt)
        a = a_b - 3.0 * k * e_dot - 3.0 * k * k * e
        most = MOST_HELD * self._drive
        self._load = np.clip(self._load - k**3 * dt * (own + self._inertia) * e, -most, most)
        return self.arm.inverse_dynamics(q, v, a) + self._inertia * a + self._load

    def _search(self, e_dot: Array, own: Array, dt: float) -> None:
        """Change the inertia of joints that follow much too slowly or too fast."""
        last, self._last = self._last, e_dot
        if last is None:
            return
        rate = (last - e_dot) * last / (dt * (last**2 + NOISE**2))
        slow = (rate < SLOW) & (np.abs(e_dot) > MOVING)
        grown = self._inertia + GROWTH * dt * (self._inertia + SEED * own)
        found = np.where(slow, grown, np.where(rate > QUICK, SHRINK * self._inertia, self._inertia))
        self._inertia = np.minimum(found, HEAVIEST * self._drive)

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered."""
        last = np.zeros(0) if self._last is None else self._last
        return {"load": self._load, "inertia": self._inertia, "last": last}

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave.

        Raises:
            ArgumentError: an array is missing or of the wrong shape.
        """
        n = self.arm.nv
        given = present(arrays, "last")
        last = checks.finite_vector("last", given, n) if np.size(given) else None
        load, inertia = (
            checks.finite_vector(name, present(arrays, name), n) for name in ("load", "inertia")
        )
        self._load, self._inertia, self._last = load, inertia, last
