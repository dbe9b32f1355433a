"""`SafeStop`: how a safeguard brakes an arm and then holds it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.control.safety.brake import Brake
from fotsmc_pin.control.safety.braking_path import BrakingPath
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
    """

    def __init__(self, arm: Arm, dt: float, shortest: float, fastest: Array) -> None:
        self.arm, self._shortest = arm, shortest
        self._fastest = np.where(np.isfinite(fastest), fastest, 1.0)
        self._brake = Brake(arm, dt)
        self.reset()

    def reset(self) -> None:
        """Forget the stop."""
        self.by_law = True
        self._path: BrakingPath | None = None
        self._brake.reset()

    @property
    def is_under_way(self) -> bool:
        """Whether a path was begun."""
        return self._path is not None

    def begin(
        self,
        state: tuple[Array, Array],
        target: tuple[Array, Array, Array] | None,
        tau: Array,
        a: Array | None = None,
    ) -> None:
        """Begin to brake from the last tick's `state` (q, v), at its `target` where that is near.

        `tau` is the torque that acted of late, from which the load follows that the arm bears; `a`
        the acceleration at which it acted, where that was another path's.
        """
        q, v = state
        start = (q, v, np.zeros(self.arm.nv))
        if target is not None and self._is_kept(state, target, NEAR, ALIKE):
            start = target
        if a is None:
            a = start[2]
            load = tau - self.arm.mass_matrix(q) @ a
        else:  # What braking found too much is inertia, not load: brake as hard as can be.
            load = self.arm.inverse_dynamics(q, v, np.zeros(self.arm.nv))
        self._path = BrakingPath(self.arm, *start, load, self._shortest)
        self._brake.begin(q, v, a, tau)

    def advance(
        self, state: tuple[Array, Array] | None, tau: Array, dt: float
    ) -> tuple[Array, Array, Array]:
        """Return the path's `q`, `v` and `a` after another `dt` seconds.

        A law that lost the path is no longer followed: braking begins anew from where the arm is.
        """
        assert self._path is not None, "begin comes first"
        target = self._path.advance(dt)
        if state is None or not self.by_law:
            return target
        if not self._is_kept(state, target, LOST, ASTRAY):
            self.by_law = False
            self.begin(state, None, tau, target[2])
            target = self._path.advance(dt)
        return target

    def torque(
        self, state: tuple[Array, Array] | None, target: tuple[Array, Array, Array], dt: float
    ) -> Array:
        """Return the brake's torque (nv,); blind, along the path, where `state` is None."""
        q, v = target[:2] if state is None else state
        return self._brake.torque(q, v, target, dt)

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered, as arrays."""
        path = {} if self._path is None else self._path.save_state()
        own = {"by_law": np.array(self.by_law), "is_under_way": np.array(bool(path))}
        return own | with_prefix("path", path) | with_prefix("brake", self._brake.save_state())

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave."""
        path = None
        if present(arrays, "is_under_way"):
            path = BrakingPath.restored(self.arm, part(arrays, "path"))
        self._brake.restore_state(part(arrays, "brake"))
        self._path, self.by_law = path, bool(present(arrays, "by_law"))

    def _is_kept(
        self,
        state: tuple[Array, Array],
        target: tuple[Array, Array, Array],
        way: float,
        share: float,
    ) -> bool:
        """Return whether a state is within `way` and a share of the fastest speed of a target."""
        near = np.abs(self.arm.difference(target[0], state[0])) <= way
        alike = np.abs(state[1] - target[1]) <= share * self._fastest
        return bool(near.all() and alike.all())
