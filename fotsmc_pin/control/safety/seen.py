"""`Seen`: where an arm was last seen, and its model there."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.control.saved_state import present
from fotsmc_pin.copying import SharesNothing

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


class Seen(SharesNothing):
    """The last usable measurement. The model is evaluated there when it is asked for.

    Attributes:
        q: configuration (nq,); None before the first.
        v: velocity (nv,).
        is_believed: whether `v` was measured; else nothing is known of `C v`, which is left out.
        share: which share of `C v` is left since then, where the arm has become slower unseen.
    """

    def __init__(self, arm: Arm) -> None:
        self.arm = arm
        self.reset()

    def reset(self) -> None:
        """Forget it."""
        self.q: Array | None = None
        self.v = np.zeros(self.arm.nv)
        self.is_believed, self.share = True, 1.0
        self._M: Array | None = None
        self._h: Array | None = None
        self._g: Array | None = None

    def see(self, q: Array, v: Array, *, is_believed: bool = True) -> None:
        """Take a measurement."""
        self.q, self.v, self.is_believed, self.share = q, v, is_believed, 1.0
        self._M = self._h = self._g = None

    def look_away(self, share: float) -> None:
        """Go on without a measurement: of `C v` so much is left as the arm has become slower."""
        self.share, self._h = share, None

    @property
    def mass_matrix(self) -> Array:
        """Mass matrix (nv, nv) [kg·m²]."""
        assert self.q is not None
        if self._M is None:  # It is symmetric, and its transpose lies in memory row by row.
            self._M = np.ascontiguousarray(self.arm.mass_matrix(self.q).T)
        return self._M

    @property
    def h(self) -> Array:
        """`C v + G` (nv,) [N·m, N], with what is left of `C v`; `G` for a speed not believed."""
        assert self.q is not None
        if self._h is None:
            still = np.zeros(self.arm.nv)
            believed = self.is_believed
            self._h = self.arm.inverse_dynamics(self.q, self.v, still) if believed else self.gravity
            if self.share != 1.0:
                self._h = self.gravity + self.share * (self._h - self.gravity)
        return self._h

    @property
    def gravity(self) -> Array:
        """`G` (nv,) [N·m, N]."""
        assert self.q is not None
        if self._g is None:
            self._g = self.arm.gravity(self.q)
        return self._g

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered."""
        q = np.zeros(0) if self.q is None else self.q
        known = {"is_believed": np.array(self.is_believed), "share": np.array(self.share)}
        return {"q": q, "v": self.v} | known

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave.

        Raises:
            ArgumentError: an array is missing or of the wrong shape. The memory stays as it was.
        """
        given = present(arrays, "q")
        q = checks.finite_vector("q", given, self.arm.nq) if np.size(given) else None
        v = checks.finite_vector("v", present(arrays, "v"), self.arm.nv)
        is_believed = bool(present(arrays, "is_believed"))
        share = checks.finite_number("share", present(arrays, "share"), at_least=0.0, at_most=1.0)
        self.reset()
        self.q, self.v, self.is_believed, self.share = q, v, is_believed, share
