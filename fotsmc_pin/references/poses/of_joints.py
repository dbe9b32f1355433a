"""`PoseOfJoints`: where a reference of joints has a frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fotsmc_pin.arms import demand_arm
from fotsmc_pin.arms.frames import frame_id
from fotsmc_pin.references.poses.inverse import Kinematics

if TYPE_CHECKING:
    import pinocchio as pin

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array, Reference


class PoseOfJoints:
    """The pose of a frame under a reference of joints, for controllers that follow poses.

        T = T(q_d),   V = J(q_d) v_d,   A = J a_d + J̇ v_d

    So every reference of joints is one of poses, a `LiveTarget` with `set_pose` among them.

    Attributes:
        arm: the arm.
        reference: `t -> (q_d, v_d, a_d)`.
        frame: name of the frame.
        is_live: whether it may be evaluated only when it is due, as a `LiveTarget`.
    """

    def __init__(self, arm: Arm, reference: Reference, frame: str | None = None) -> None:
        """Follow a frame.

        Args:
            arm: the arm that the reference is for.
            reference: `t -> (q_d, v_d, a_d)`.
            frame: name of the frame; the arm's `tool_frame` if None.

        Raises:
            ArgumentError: no such frame.
        """
        demand_arm(arm)
        self.arm, self.reference = arm, reference
        index = frame_id(arm, frame)
        self.frame = str(arm.model.frames[index].name)
        self.is_live = bool(getattr(reference, "is_live", False))
        self._kinematics = Kinematics(arm, index)

    @property
    def q_start(self) -> Array:
        """Configuration of the reference at its start (nq,), from which a run starts."""
        return self.reference(0.0)[0]

    def __call__(self, t: float) -> tuple[pin.SE3, Array, Array]:
        """Return the pose, its twist (6,) and the derivative of that (6,) at time `t` [s]."""
        q_d, v_d, a_d = self.reference(t)
        jacobian = self._kinematics.jacobian(q_d)
        A = jacobian @ a_d + self._kinematics.drift(q_d, v_d)
        return self._kinematics.pose(q_d), jacobian @ v_d, A
