"""Errors of the tool of a recorded task: of the true arm's, from what was asked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms.frames import frame_id
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from fotsmc_pin.simulation.recording import Recording
    from fotsmc_pin.types import Array


def pose_errors(rec: Recording, rows: Any = None) -> Array:
    """Return the errors of the tool from the poses that it was asked for, in a run of a task.

    Args:
        rec: run of a `TaskSpace`, whose signal "pose_d" holds what was asked for.
        rows: which rows, a slice, a mask or indices; all by default.

    Returns:
        `log(T_d⁻¹ T)` of the true tool (n, 6), linear part first, in its own axes [m, rad].

    Raises:
        ArgumentError: a run without poses.
    """
    if "pose_d" not in rec.signals:
        raise ArgumentError("rec", rec, "it is not one of a task: no poses were asked for")
    asked, q = rec.signals["pose_d"], rec.q
    if rows is not None:
        asked, q = asked[rows], q[rows]
    model, data = rec.arm.model, rec.arm.model.createData()
    frame = frame_id(rec.arm, rec.metadata.get("task", {}).get("frame"))
    found = np.empty((len(q), 6))
    for k, place in enumerate(np.ascontiguousarray(q)):
        pin.framesForwardKinematics(model, data, place)
        wanted = pin.XYZQUATToSE3(asked[k])
        found[k] = pin.log6(wanted.inverse() * data.oMf[frame]).vector
    return found
