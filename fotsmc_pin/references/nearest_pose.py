"""`NearestPose`: joint positions that bring the tool to a pose, or as near as the arm can."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin.checks import finite_array
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

STEPS, CLOSE = 100, 1e-6
"""Most iterations, and the error at which they end [m, rad]."""
DAMPING = 1e-4
"""Added to the squared singular values of the Jacobian, times the squared error."""
LONGEST = 0.3
"""Longest step of a joint in an iteration [rad, m]."""


class NearestPose:
    """Damped Gauss-Newton iterations from a start, within position limits.

    It has a scratch memory of its own, so that it may run beside a loop that uses the arm.
    """

    def __init__(self, arm: Arm, lower: Array, upper: Array) -> None:
        """Take the arm and the limits of its joints (nv,)."""
        self._model, self._data = arm.model, arm.model.createData()
        self._frame, self._lower, self._upper = arm.tool_frame_id, lower, upper
        self._neutral = pin.neutral(arm.model)

    def solve(self, pose: pin.SE3 | ArrayLike, near: Array) -> tuple[Array, float]:
        """Return joint positions (nv,) near `near`, and how far the tool stays off [m].

        Raises:
            ArgumentError: a pose that is none.
        """
        target, rows = _read(pose)
        x = best = np.clip(near, self._lower, self._upper)
        least, damping = np.inf, DAMPING
        for _ in range(STEPS):
            error, jacobian = self._error(target, x, rows)
            size = float(error @ error)
            if size < least:
                best, least = x, size
                damping = max(0.3 * damping, 1e-9)
            else:
                x, damping = best, 10.0 * damping
                if damping > 1e4:
                    break
                error, jacobian = self._error(target, x, rows)
            if least < CLOSE**2:
                break
            blocked = ((x <= self._lower) & (jacobian.T @ error < 0.0)) | (
                (x >= self._upper) & (jacobian.T @ error > 0.0)
            )
            jacobian[:, blocked] = 0.0
            square = jacobian @ jacobian.T
            square.flat[:: len(square) + 1] += damping
            step = jacobian.T @ np.linalg.solve(square, error)
            step *= min(1.0, LONGEST / max(float(np.abs(step).max()), 1e-12))
            x = np.clip(x + step, self._lower, self._upper)
        return best, float(np.linalg.norm(self._place(best).translation - target.translation))

    def _place(self, x: Array) -> pin.SE3:
        q = pin.integrate(self._model, self._neutral, x)
        pin.forwardKinematics(self._model, self._data, q)
        pin.updateFramePlacement(self._model, self._data, self._frame)
        return self._data.oMf[self._frame]

    def _error(self, target: pin.SE3, x: Array, rows: int) -> tuple[Array, Array]:
        """Return the error in the axes of the world, and the Jacobian that reduces it."""
        place = self._place(x)
        turn = place.rotation @ pin.log3(place.rotation.T @ target.rotation)
        error = np.concatenate([target.translation - place.translation, turn])
        q = pin.integrate(self._model, self._neutral, x)
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        jacobian = pin.computeFrameJacobian(self._model, self._data, q, self._frame, axes)
        return error[:rows], np.array(jacobian[:rows])


def _read(pose: pin.SE3 | ArrayLike) -> tuple[pin.SE3, int]:
    """Return a pose, and how many of its six parts count."""
    if isinstance(pose, pin.SE3):
        pose = pose.homogeneous
    if np.shape(pose) == (3,):
        return pin.SE3(np.eye(3), finite_array("pose", pose, (3,))), 3
    matrix = finite_array("pose", pose, (4, 4))
    rotation = matrix[:3, :3]
    if not np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-6) or np.linalg.det(rotation) < 0:
        raise ArgumentError("pose", pose, "its upper left (3, 3) is no rotation")
    return pin.SE3(rotation, matrix[:3, 3]), 6
