"""`SafeStop`: how a safeguard brakes an arm and then holds it."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.control.safety.brake import Brake, beyond_inertia
from fotsmc_pin.control.safety.braking_path import BrakingPath
from fotsmc_pin.control.safety.seen import Seen
from fotsmc_pin.control.safety.steps import is_kept
from fotsmc_pin.control.saved_state import part, present, with_prefix
from fotsmc_pin.copying import SharesNothing

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

NEAR, ALIKE = 0.05, 0.2
"""Position error [rad, m] and share of the fastest speed within which the reference is where the
arm is: the path then begins at the reference, so that the law sees no step."""
LOST, ASTRAY = 0.2, 0.5
"""Position error [rad, m] and share of the fastest speed from which on the law has lost the
path."""


class SafeStop(SharesNothing):
    """A braking path, followed by the law while it does so, and by a `Brake` from then on.

    Attributes:
        by_law: whether the law is to follow the path.
        is_under_way: whether the path was begun.
        path: the path.
        brake: the brake.
    """

    def __init__(
        self, arm: Arm, dt: float, least: float, fastest: Array, torque_rate: Array
    ) -> None:
        """Prepare to brake in no less than `least` seconds.

        Args:
            arm: the nominal arm.
            dt: period of a tick [s].
            least: least time in which a joint brakes [s].
            fastest: speed at which a stop begins (nv,).
            torque_rate: largest rates of the torques (nv,); inf for none.
        """
        self.arm, self._dt, self._fastest = arm, dt, fastest
        self.path, self.brake = BrakingPath(arm, least, torque_rate), Brake(arm, dt)
        self.reset()

    def reset(self) -> None:
        """Forget the stop."""
        self.by_law, self.is_under_way = True, False
        self.brake.reset()

    def begin(self, seen: Seen, target: tuple[Array, Array, Array] | None, tau: Array) -> None:
        """Begin to brake from where the arm was last seen, or at its `target` where that is near.

        `tau` is the torque that acted of late, from which the load follows that the arm bears.
        """
        assert seen.q is not None
        start = (seen.q, seen.v, np.zeros(self.arm.nv))
        if target is not None and self._is_kept((seen.q, seen.v), target, NEAR, ALIKE):
            start = target
        load = np.zeros(self.arm.nv)
        beyond_inertia(start[2], tau, seen.mass_matrix, load)
        in_doubt = not self.by_law
        self.path.begin(start, seen.mass_matrix, seen.h, load - seen.h, is_urgent=in_doubt)
        self.brake.begin(seen.v, start[2], tau, seen.mass_matrix, seen.h)
        self.is_under_way = True

    def advance(
        self, state: tuple[Array, Array] | None, seen: Seen, acted: tuple[Array, Array], dt: float
    ) -> tuple[Array, Array, Array]:
        """Return the path's `q`, `v` and `a` after another `dt` seconds.

        A law that lost the path is no longer followed: braking begins anew from where the arm is.
        What braking found too much then is inertia, not load.

        Args:
            state: measured configuration (nq,) and velocity (nv,); None where they are not usable.
            seen: where the arm was last seen.
            acted: the last torque (nv,), and the average of the last ones.
            dt: the time [s].
        """
        M, h, (tau, recent) = seen.mass_matrix, seen.h, acted
        target = self.path.advance(M, h, tau, dt, learns=state is not None)
        if state is None or not self.by_law or self._is_kept(state, target, LOST, ASTRAY):
            return target
        self.by_law, nothing = False, np.zeros(self.arm.nv)
        self.path.begin((*state, nothing), M, h, nothing, is_urgent=True)
        self.brake.begin(state[1], target[2], recent, M, h)
        return self.path.advance(M, h, tau, dt, learns=False)

    def torque(
        self,
        state: tuple[Array, Array] | None,
        seen: Seen,
        target: tuple[Array, Array, Array],
        dt: float,
    ) -> Array:
        """Return the brake's torque (nv,); blind, along the path, where `state` is None."""
        q, v = target[:2] if state is None else state
        e = self.arm.difference(target[0], q)
        return self.brake.torque(e, v, target[1:], seen.mass_matrix, seen.h, dt)

    def run_through(self) -> Seen:
        """Stop an arm at rest, which compiles all kernels, and forget it; return where it stood."""
        q, still, seen = self.arm.neutral, np.zeros(self.arm.nv), Seen(self.arm)
        seen.see(q, still)
        self.begin(seen, (q, still, still), still)
        target = self.advance((q, still), seen, (still, still), self._dt)
        self.torque(None, seen, target, self._dt)
        self.reset()
        return seen

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered, as arrays."""
        own = {"by_law": np.array(self.by_law), "is_under_way": np.array(self.is_under_way)}
        path = with_prefix("path", self.path.save_state())
        return own | path | with_prefix("brake", self.brake.save_state())

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave.

        Raises:
            ArgumentError: an array is missing or of the wrong shape. The memory stays as it was.
        """
        by_law, is_under_way = (bool(present(arrays, name)) for name in ("by_law", "is_under_way"))
        path = copy.copy(self.path)
        path.restore_state(part(arrays, "path"))
        self.brake.restore_state(part(arrays, "brake"))
        self.path, self.by_law, self.is_under_way = path, by_law, is_under_way

    def _is_kept(
        self,
        state: tuple[Array, Array],
        target: tuple[Array, Array, Array],
        way: float,
        share: float,
    ) -> bool:
        """Return whether a state is within `way` and a share of the fastest speed of a target."""
        e = self.arm.difference(target[0], state[0])
        return is_kept(e, state[1] - target[1], self._fastest, way, share)
