"""The reference evaluated for many ticks at once, which costs less than tick by tick."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.errors import MeasurementError
from fotsmc_pin.simulation.faults import NAMES, flaw

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
        for name, found, width in zip(
            NAMES, (q_d, v_d, a_d), (arm.nq, arm.nv, arm.nv), strict=True
        ):
            if np.shape(found) != (len(t), width):
                remedy = f"`at` of {len(t)} times has shape {np.shape(found)}"
                raise MeasurementError(name, found, f"{remedy}; return ({len(t)}, {width})")
        return q_d, v_d, a_d
    q_d, v_d, a_d = (np.empty((len(t), width)) for width in (arm.nq, arm.nv, arm.nv))
    shapes = [(arm.nq,), (arm.nv,), (arm.nv,)]
    for k, instant in enumerate(t.tolist()):
        row = reference(instant)
        if [np.shape(part) for part in row] != shapes:
            raise flawed(row, instant, arm)
        q_d[k], v_d[k], a_d[k] = row
    return q_d, v_d, a_d


def flawed(row: Any, t: float, arm: Arm) -> MeasurementError:
    """Return the error that names the part of a reference which has the wrong shape."""
    if isinstance(row, (tuple, list)) and len(row) == len(NAMES):
        for name, value, width in zip(NAMES, row, (arm.nq, arm.nv, arm.nv), strict=True):
            if (what := flaw(value, (width,))) is not None:
                return MeasurementError(name, value, f"at t = {t:.6g} s it {what}")
    return MeasurementError("reference", row, f"at t = {t:.6g} s it is not (q_d, v_d, a_d)")
