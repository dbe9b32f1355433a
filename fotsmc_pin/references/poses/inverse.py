"""Configurations that bring a frame to poses one after the other, each near the one before."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

STEPS, CLOSE = 100, 1e-9
"""Most steps of Newton's method, and the error that ends it [m, rad]."""
LARGEST_STEP = 0.3
"""Of a joint, so that far poses do not throw the arm about [rad, m]."""
DAMPING = 1e-4
"""Damping of a step, over the error: none is left near the pose."""


class Kinematics:
    """Pose and Jacobian of a frame, in its own axes.

    Args:
        arm: the arm.
        frame: index of the frame.
    """

    def __init__(self, arm: Arm, frame: int) -> None:
        self.arm, self.frame = arm, frame
        self._data = arm.model.createData()

    def pose(self, q: Array) -> pin.SE3:
        """Return where the frame is at `q` (nq,)."""
        pin.framesForwardKinematics(self.arm.model, self._data, q)
        return self._data.oMf[self.frame].copy()

    def jacobian(self, q: Array) -> Array:
        """Return its Jacobian at `q` (6, nv)."""
        model, local = self.arm.model, pin.ReferenceFrame.LOCAL
        return np.array(pin.computeFrameJacobian(model, self._data, q, self.frame, local))

    def drift(self, q: Array, v: Array) -> Array:
        """Return `J̇ v` (6,)."""
        model, local = self.arm.model, pin.ReferenceFrame.LOCAL
        pin.forwardKinematics(model, self._data, q, v, np.zeros(self.arm.nv))
        return np.array(pin.getFrameAcceleration(model, self._data, self.frame, local).vector)

    def solve(self, target: pin.SE3, q: Array) -> Array | None:
        """Return a configuration near `q` that brings the frame there; None if none is found."""
        q = np.array(q)
        for _ in range(STEPS):
            e = pin.log6(target.inverse() * self.pose(q))
            size = float(np.linalg.norm(e.vector))
            if size < CLOSE:
                return q
            J = pin.Jlog6(target.inverse() * self.pose(q)) @ self.jacobian(q)
            square = J @ J.T + DAMPING * min(size, 1.0) * np.eye(6)
            move = -J.T @ np.linalg.solve(square, e.vector)
            move *= min(1.0, LARGEST_STEP / max(float(np.abs(move).max()), 1e-12))
            q = self.arm.integrate(q, move)
        return None


def configurations_along(
    kinematics: Kinematics, poses: Iterable[pin.SE3], q: Array, argument: str
) -> list[Array]:
    """Return a configuration for each pose, each near the one before, the first near `q` (nq,).

    Raises:
        ArgumentError: naming `argument`, where the frame cannot follow, or a joint would end.
    """
    arm, found = kinematics.arm, []
    for number, pose in enumerate(poses):
        next_q = kinematics.solve(pose, q)
        if next_q is None:
            raise ArgumentError(
                argument,
                pose.translation.round(4).tolist(),
                f"the frame does not get there (pose {number} of the way): out of reach, or past a "
                "singularity",
            )
        x = arm.to_joint_positions(next_q)
        beyond = (x < arm.lower_position_limit) | (x > arm.upper_position_limit)
        if beyond.any():
            joint = arm.joint_names[int(np.argmax(beyond))]
            raise ArgumentError(
                argument,
                pose.translation.round(4).tolist(),
                f"{joint} would pass its end there (pose {number} of the way): start elsewhere",
            )
        found.append(next_q)
        q = next_q
    return found
