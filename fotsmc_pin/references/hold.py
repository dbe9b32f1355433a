"""`Hold`: a constant configuration."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.arms import demand_arm
from fotsmc_pin.checks import finite_vector

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


@dataclass(frozen=True, eq=False)
class Hold:
    """One configuration for all time.

    Attributes:
        arm: the arm that it is for.
        q: configuration to hold, (nq,); None for `arm.neutral`.
    """

    arm: Arm
    q: ArrayLike | None = None

    def __post_init__(self) -> None:
        """Check the arm and the configuration."""
        demand_arm(self.arm)
        q = self.arm.neutral if self.q is None else self.q
        object.__setattr__(self, "q", finite_vector("q", q, self.arm.nq))

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Return `q_d` (nq,), `v_d` (nv,) and `a_d` (nv,) at time `t` [s], all fresh arrays."""
        return np.array(self.q), np.zeros(self.arm.nv), np.zeros(self.arm.nv)

    def at(self, t: Array) -> tuple[Array, Array, Array]:
        """Return `q_d` (N, nq), `v_d` and `a_d` (N, nv) at the times `t` (N,) [s]."""
        n, nv = len(t), self.arm.nv
        return np.tile(np.asarray(self.q), (n, 1)), np.zeros((n, nv)), np.zeros((n, nv))
