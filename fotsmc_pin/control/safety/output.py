"""`Output`: the last torque of a safeguard, and what of it a robot is commanded."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.control.safety.drives import Drives
from fotsmc_pin.control.safety.steps import averaged, finite_or_last, within_limits
from fotsmc_pin.control.saved_state import present
from fotsmc_pin.copying import SharesNothing

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.model_terms import ModelTerms
    from fotsmc_pin.control.safety.limit_filter import LimitFilter
    from fotsmc_pin.control.safety.seen import Seen
    from fotsmc_pin.types import Array

MEMORY = ("tau", "sent", "lag")


class Output(SharesNothing):
    """Brings torques within all limits, one after the other.

    Attributes:
        drives: what the robot's drives add.
        rate: largest rate of each torque (nv,); inf for none [N·m/s, N/s].
        tau: the last tick's total torque (nv,) [N·m, N].
        sent: what of it is to be commanded (nv,).
        recent: averages of what was sent and seen of late (4, nv); see `steps.averaged`.
        lag: how far the torque is from what it would be without a limit of its rate (nv,).
        has_sent: whether there was one since the last reset.
    """

    def __init__(self, arm: Arm, rate: Array) -> None:
        self.arm, self.drives, self.rate = arm, Drives(arm), rate
        self._limit, self._nothing = arm.effort_limit.copy(), np.zeros(arm.nv)
        self.reset()

    def reset(self) -> None:
        """Forget every torque."""
        self.tau, self.sent, self.lag = np.zeros((3, self.arm.nv))
        self.recent = np.zeros((4, self.arm.nv))
        self.has_sent = False

    def send(
        self,
        tau: Array,
        moves: tuple[Array, Array],
        seen: Seen,
        dt: float,
        limits: LimitFilter | None = None,
        terms: ModelTerms | None = None,
    ) -> None:
        """Bring the torque `tau` (nv,) within all limits, and note it and what is commanded.

        Args:
            tau: the total torque that is wanted; overwritten.
            moves: velocity, and `C v + G` of the nominal arm (nv,).
            seen: where the arm is.
            dt: time since the last tick [s].
            limits: what the arm may never pass.
            terms: mass matrix and `C v + G` where they are known already.
        """
        adds, (v, h) = self.drives.adds, moves
        added = self.drives.added_at(seen) if adds else self._nothing
        is_first = not self.has_sent
        if is_first:  # What acts before the first torque is what the drives add.
            self.tau, self.has_sent = added, True
        last, sent, rate, limit = self.tau, self.sent, self.rate, self._limit

        def allowed(tau: Array) -> Array:
            no_lag = np.zeros(tau.size)
            within_limits(tau, last, sent, added, rate, limit, no_lag, dt)
            return tau

        finite_or_last(tau, last)
        within_limits(tau, last, sent, added, rate, limit, self.lag, dt)
        if limits is not None:
            is_free = not adds and bool(np.isinf(rate).all())
            tau = limits.torque(tau, None if is_free else allowed, terms)
        self.tau, self.sent = tau, tau - added if adds else tau
        if is_first:
            self.recent = np.array([tau - h, v, tau - h, v])
        averaged(tau, h, v, dt, self.recent)

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered."""
        own = {name: getattr(self, name) for name in MEMORY}
        return own | {"recent": self.recent, "has_sent": np.array(self.has_sent)}

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave.

        Raises:
            ArgumentError: an array is missing or of the wrong shape. The memory stays as it was.
        """
        n = self.arm.nv
        tau, sent, lag = (
            np.array(checks.finite_vector(name, present(arrays, name), n)) for name in MEMORY
        )
        recent = checks.finite_array("recent", present(arrays, "recent"), (4, n))
        self.has_sent = bool(present(arrays, "has_sent"))
        self.tau, self.sent, self.lag, self.recent = tau, sent, lag, recent
