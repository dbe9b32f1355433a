"""`Guarded`: what a safeguard uses of a controller."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


class Guarded(Protocol):
    """A control law, or what wraps one and keeps its face.

    Attributes:
        arm: the nominal arm.
        dt: period of a tick [s].
    """

    arm: Arm
    dt: float

    @property
    def signals(self) -> dict[str, Array]:
        """The last tick's named arrays."""
        ...

    @property
    def gains(self) -> Any:
        """The gains of the law."""
        ...

    def update(
        self,
        q: ArrayLike,
        v: ArrayLike,
        q_d: ArrayLike,
        v_d: ArrayLike,
        a_d: ArrayLike,
        dt: float | None = None,
    ) -> Array:
        """Return the torque of one tick (nv,)."""
        ...

    def note_applied(self, tau: Array, friction: Array) -> None:
        """Take note of the torque that acts from the last tick on, where it is another.

        Args:
            tau: the total torque (nv,).
            friction: the part of it that was added against friction (nv,).
        """
        ...

    def feed_friction(self, wanted: bool) -> None:
        """Feed friction that is known forward, or leave it to the drives."""
        ...

    def reset(self) -> None:
        """Forget every tick."""
        ...

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered."""
        ...

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave."""
        ...
