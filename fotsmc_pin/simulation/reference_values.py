"""The reference evaluated for many ticks at once, which costs less than tick by tick."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array, Reference


def reference_values(reference: Reference, t: Array, arm: Arm) -> tuple[Array, Array, Array]:
    """Return `q_d` (N, nq), `v_d` and `a_d` (N, nv) at the times `t` (N,).

    A reference with a method `at(t)` that returns these is evaluated once; any other is called
    for each time.
    """
    at = getattr(reference, "at", None)
    if at is not None:
        q_d, v_d, a_d = at(t)
        return q_d, v_d, a_d
    q_d, v_d, a_d = (np.empty((len(t), width)) for width in (arm.nq, arm.nv, arm.nv))
    for k, instant in enumerate(t.tolist()):
        q_d[k], v_d[k], a_d[k] = reference(instant)
    return q_d, v_d, a_d
