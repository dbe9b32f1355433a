"""`SafeStop`: how a safeguard brakes an arm and then holds it."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.control.safety.brake import Brake, unexplained
from fotsmc_pin.control.safety.braking_path import BrakingPath
from fotsmc_pin.control.safety.carried import Carried
from fotsmc_pin.control.safety.seen import Seen
from fotsmc_pin.control.safety.steps import caught_up, is_kept
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
        carried: the mass at the tool that path and brake reckon with.
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
        self.carried = Carried(arm)
        self.reset()

    def reset(self) -> None:
        """Forget the stop."""
        self.by_law, self.is_under_way = True, False
        self.brake.reset()
        self.carried.reset()

    def begin(self, seen: Seen, target: tuple[Array, Array, Array] | None, recent: Array) -> None:
        """Begin to brake from where the arm was last seen, or at its `target` where that is near.

        Args:
            seen: where the arm was last seen.
            target: what it followed: configuration (nq,), velocity and acceleration (nv,).
            recent: averages of what acted and of what was seen (4, nv), from which follows what
                the arm carries and bears; they are brought up to date.
        """
        assert seen.q is not None
        start = (seen.q, seen.v, np.zeros(self.arm.nv))
        if target is not None and self._is_kept((seen.q, seen.v), target, NEAR, ALIKE):
            start = target
        caught_up(recent)
        self.carried.find(seen, recent)
        self._draw(start, seen, recent, is_urgent=not self.by_law)
        self.is_under_way = True

    def advance(
        self, state: tuple[Array, Array] | None, seen: Seen, acted: tuple[Array, Array], dt: float
    ) -> tuple[Array, Array, Array]:
        """Return the path's `q`, `v` and `a` after another `dt` seconds.

        A law that lets a joint become faster than it was is no longer followed; where it lost the
        path too, braking begins anew from where the arm is.

        Args:
            state: measured configuration (nq,) and velocity (nv,); None where they are not usable.
            seen: where the arm was last seen.
            acted: the last torque (nv,), and the averages as in `begin`.
            dt: the time [s].
        """
        tau, recent = acted
        M, h, _ = self.carried.model(seen, recent)
        target = self.path.advance(M, h, tau, dt, learns=state is not None)
        if state is None or not self.by_law:
            return target
        is_kept = self._is_kept(state, target, LOST, ASTRAY)
        if is_kept and not self.path.is_faster(state[1]):
            return target
        self.by_law = False
        if is_kept:
            self.brake.begin(self._load(seen, recent))
            return target
        self._draw((*state, np.zeros(self.arm.nv)), seen, recent, is_urgent=True)
        return self.path.advance(M, h, tau, dt, learns=False)

    def torque(
        self,
        state: tuple[Array, Array] | None,
        seen: Seen,
        target: tuple[Array, Array, Array],
        recent: Array,
        dt: float,
    ) -> Array:
        """Return the brake's torque (nv,); blind, along the path, where `state` is None."""
        q, v = target[:2] if state is None else state
        e, sees = self.arm.difference(target[0], q), state is not None
        model = self.carried.model(seen, recent)
        return self.brake.torque(e, v, target[1:], *model, dt, sees=sees)

    def _draw(
        self, start: tuple[Array, Array, Array], seen: Seen, recent: Array, *, is_urgent: bool
    ) -> None:
        """Begin path and brake with the torque that the model does not explain."""
        M, h, _ = self.carried.model(seen, recent)
        load = self._load(seen, recent)
        self.path.begin(start, M, h, load, v=seen.v, is_urgent=is_urgent)
        self.brake.begin(load)

    def _load(self, seen: Seen, recent: Array) -> Array:
        """Return the torque (nv,) that the model does not explain."""
        M, _, beyond = self.carried.model(seen, recent)
        load = np.zeros(self.arm.nv)
        unexplained(seen.v, beyond, M, load)
        return load

    def run_through(self) -> Seen:
        """Stop an arm at rest, which compiles all kernels, and forget it; return where it stood."""
        q, still, seen = self.arm.neutral, np.zeros(self.arm.nv), Seen(self.arm)
        seen.see(q, still)
        recent = np.zeros((4, self.arm.nv))
        self.begin(seen, (q, still, still), recent)
        target = self.advance((q, still), seen, (still, recent), self._dt)
        self.torque(None, seen, target, recent, self._dt)
        self.reset()
        return seen

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered, as arrays."""
        own = {"by_law": np.array(self.by_law), "is_under_way": np.array(self.is_under_way)}
        path = with_prefix("path", self.path.save_state())
        carried = with_prefix("carried", self.carried.save_state())
        return own | path | carried | with_prefix("brake", self.brake.save_state())

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave.

        Raises:
            ArgumentError: an array is missing or of the wrong shape. The memory stays as it was.
        """
        by_law, is_under_way = (bool(present(arrays, name)) for name in ("by_law", "is_under_way"))
        path, carried = copy.copy(self.path), copy.copy(self.carried)
        path.restore_state(part(arrays, "path"))
        carried.restore_state(part(arrays, "carried"))
        self.brake.restore_state(part(arrays, "brake"))
        self.path, self.carried = path, carried
        self.by_law, self.is_under_way = by_law, is_under_way

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
