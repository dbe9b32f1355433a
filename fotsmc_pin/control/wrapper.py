"""`Wrapper`: what wraps a controller and shows what that shows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fotsmc_pin.copying import SharesNothing

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


class Wrapper(SharesNothing):
    """Has the gains, the preset and the signals of the controller that it wraps.

    Attributes:
        controller: what is wrapped.
    """

    controller: Any

    @property
    def gains(self) -> Any:
        """The controller's gains."""
        return self.controller.gains

    @property
    def preset(self) -> str | None:
        """The controller's preset."""
        preset: str | None = self.controller.preset
        return preset

    @property
    def about(self) -> dict[str, Any]:
        """What the controller says of itself for a recording's metadata."""
        about: dict[str, Any] = getattr(self.controller, "about", {})
        return about

    def feed_friction(self, wanted: bool) -> None:
        """See `Controller.feed_friction`."""
        self.controller.feed_friction(wanted)

    def keep_nominal_model(self) -> None:
        """See `Controller.keep_nominal_model`."""
        self.controller.keep_nominal_model()

    @property
    def follows_poses(self) -> bool:
        """Whether the reference is `t -> (T, V, A)`, as that of `TaskSpace`."""
        return bool(getattr(self.controller, "follows_poses", False))

    @property
    def resolved(self) -> tuple[Array, Array] | None:
        """What a controller that follows poses found for the joints; None of any other."""
        found: tuple[Array, Array] | None = getattr(self.controller, "resolved", None)
        return found

    @property
    def signals(self) -> dict[str, Array]:
        """Copies of the signals by name."""
        return {name: signal.copy() for name, signal in self.live_signals.items()}

    @property
    def live_signals(self) -> dict[str, Array]:
        """The signals themselves, which every tick writes anew: for reading, by a recorder."""
        signals: dict[str, Array] = self.controller.live_signals
        return signals
