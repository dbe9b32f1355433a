"""`TaskSpace`: a law of the library at the tool, with poses as its reference."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

from fotsmc_pin import checks
from fotsmc_pin.arms import demand_arm
from fotsmc_pin.arms.frames import frame_id
from fotsmc_pin.control.computed_torque import ComputedTorque
from fotsmc_pin.control.controller import LONGEST_TICK, SHORTEST_TICK, Controller
from fotsmc_pin.control.robust_fonftsm import RobustFONFTSM
from fotsmc_pin.control.task_space.directions import Directions
from fotsmc_pin.control.task_space.given import cleaned_motion, read_motion
from fotsmc_pin.control.task_space.memory import TaskMemory
from fotsmc_pin.control.task_space.tool_body import reach, tool_body
from fotsmc_pin.control.task_space.tool_rows import BEGINS
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import TypeAlias

    import pinocchio as pin
    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

    Maker: TypeAlias = Callable[..., Controller]

LENGTH, THRESHOLD = 0.1, 0.01
"""Way that a radian counts as, and singular value below which a direction is given up, both over
the arm's reach."""


class TaskSpace(TaskMemory):
    """Any law of the library on the error of the tool's pose.

    The error is `e = log(T_f⁻¹ T)` on SE(3), linear part first, in the tool's own axes, or a part
    of it (`Directions`). The law sees a mechanical system of as many directions,

        Λ d/dt (E V) + h = F,   Λ = (Je M0⁻¹ Jeᵀ)⁻¹,   Je = E J,   ė = E ν,

    whose commanded acceleration it turns into a force `F`. The torque is

        τ = τ_p + κ Jeᵀ (F - J̄ᵀ (τ_p - C0 v - G0)),   J̄ = M0⁻¹ Jeᵀ Λ

    with the torque `τ_p` of a second law, on the joints, for the posture. Where no direction is
    lost, `κ = 1`, and posture does not accelerate the tool; at a singularity `κ = 0`, and posture's
    law has the arm (`sharing.tell`). `T_f` is where a point in joint space has the tool,
    which goes where the reference `T_d` asks it to be as far as that is possible (`feasible`): at
    the start it is where the arm is; at a singularity, a joint's end or beyond a speed limit it
    stays behind, and the signals say by how much. On the way `T_f = T_d`.

    It has the face of a controller, but its reference is `t -> (T, V, A)`: a `pinocchio.SE3`, its
    twist (6,) and the derivative of that (6,), linear part first, in the axes of `T` (LOCAL).
    `ModelLearning` and `Safeguard` take it.

    Attributes:
        arm: the nominal arm.
        dt: nominal period of a tick [s].
        frame: name of the frame that is moved.
        directions: which directions are held.
        law: the law at the tool, made for a body of as many joints as directions.
        posture_law: the law of the posture, and of what is given up, made for the arm.
        length: what a radian counts as where ways and rotations are compared [m].
        threshold: singular value, with that, below which a direction is given up [m].

    Signals: the law's, with an entry per direction; "pose", of the frame, "pose_d", as asked for,
    and "pose_f", as is feasible, (7,) [m] and a quaternion x, y, z, w; "pose_error", of the frame
    from what is asked (m,) [m, rad]; "given_up", of what is feasible from that (m,); "kept" (2,),
    the smallest share of a direction that the law and the feasible reference keep, 1 away from
    singularities.

    Source: Khatib, IEEE Journal of Robotics and Automation, 1987, for the dynamically consistent
    inverse; Bullo and Murray, European Control Conference, 1995, for the error by the logarithm.
    """

    def __init__(
        self,
        arm: Arm,
        dt: float,
        *,
        frame: str | None = None,
        directions: str | Iterable[str] = "all",
        law: Maker = RobustFONFTSM,
        posture: ArrayLike | None = None,
        posture_law: Maker | None = None,
        length: float | None = None,
        threshold: float | None = None,
        **gains: Any,
    ) -> None:
        """Make the law, and the memory of the task.

        Args:
            arm: the nominal arm.
            dt: period of a tick [s].
            frame: name of the frame that is moved; the arm's tool frame by default.
            directions: "all", "position", "orientation", "plane" (x and y), "axis" (z),
                "pointing" (all but the rotation about z), or names out of x, y, z, rx, ry, rz. Two
                rotations point the third axis. They are those of the reference's axes.
            law: class of a law, or a function that makes one of an arm and a tick.
            posture: configuration that a redundant arm stays near (nq,); that of the first tick by
                default.
            posture_law: as `law`, for the posture and what is given up at singularities. By default
                `ComputedTorque` for a redundant arm, whose posture is to give way and to rest where
                friction holds it; else `RobustFONFTSM`, which has nothing to hold but that.
            length: what a radian counts as [m]; a tenth of the arm's reach by default.
            threshold: `σ_0` of `mobility` [m]; 0.01 of the arm's reach by default.
            **gains: of the law, where `law` is a class.

        Raises:
            ArgumentError: naming the argument, its value and the remedy.
        """
        demand_arm(arm)
        arm.demand_dynamics()
        self.arm, self.dt = arm, checks.finite_number("dt", dt, above=0.0)
        self._frame = frame_id(arm, frame)
        self.frame = str(arm.model.frames[self._frame].name)
        self.directions = Directions.read(directions)
        m, n = len(self.directions), arm.nv
        if m > n:
            remedy = f"{arm.name} has {n} joints: hold fewer directions"
            raise ArgumentError("directions", self.directions.names, remedy)
        size = reach(arm, self._frame)
        given = LENGTH * size if length is None else length
        self.length = checks.finite_number("length", given, above=0.0)
        given = THRESHOLD * size if threshold is None else threshold
        self.threshold = checks.finite_number("threshold", given, above=0.0)
        self._posture = (
            None if posture is None else checks.finite_vector("posture", posture, arm.nq)
        )
        body = tool_body(arm, self._frame, self.directions, self.length)
        self.law: Controller[Any] = law(body, self.dt, **gains)
        if posture_law is None:
            posture_law = ComputedTorque if arm.nv > m else RobustFONFTSM
        self.posture_law: Controller[Any] = posture_law(arm, self.dt)
        self._allocate()
        self._link()
        self.reset()

    def update(
        self,
        q: ArrayLike,
        v: ArrayLike,
        T: pin.SE3 | ArrayLike,
        V: ArrayLike,
        A: ArrayLike,
        dt: float | None = None,
    ) -> Array:
        """Advance by one tick.

        Args:
            q: measured configuration (nq,) [rad, m].
            v: measured velocity (nv,) [rad/s, m/s].
            T: reference pose of the frame in the world; a `pinocchio.SE3`, or a matrix (4, 4).
            V: its twist (6,), linear part first, in the axes of `T` [m/s, rad/s].
            A: time derivative of `V` (6,) [m/s², rad/s²].
            dt: measured time since the last tick [s]; the nominal one if None.

        Returns:
            Torque (nv,) [N·m, N]: finite, and within the arm's effort limits.

        Raises:
            MeasurementError: an argument has the wrong shape or is not finite. The memory is as it
                was, and the next good tick goes on from there.
        """
        try:
            are_read = read_motion(q, v, T.homogeneous, V, A, *self._memory)  # type: ignore[union-attr, arg-type]
        except (AttributeError, TypeError):  # not an SE3 and plain arrays of floats
            are_read = False
        if not are_read:
            read_motion(*cleaned_motion(self.arm, q, v, T, V, A), *self._memory)  # type: ignore[call-arg]
        if dt is None:
            dt = self.dt
        else:
            shortest, longest = SHORTEST_TICK * self.dt, LONGEST_TICK * self.dt
            dt = checks.finite_number("dt", dt, at_least=shortest, at_most=longest)
        if not self._n.begun[0]:
            self._begin()
        joints = self.joints
        self._terms.evaluate(self.q, joints)
        self._tick(dt, *self._arguments)
        if self._n.has_say[0] == BEGINS:
            self.posture_law.reset()
            self._n.has_say[0] = 1.0
        tau: Array = joints.tau.copy()
        return tau

    def law_alone(self) -> Controller[Any]:
        """Return a copy of the law with the inertia and limits of the body that it was made for."""
        twin = copy.copy(self.law)
        twin.joints.effort_limit[:] = twin.arm.effort_limit
        twin.reset()
        return twin

    def _begin(self) -> None:
        """Let the point start where the arm is, at its speed."""
        q, q_f, q_p, _ = self._configurations
        q_f[:] = q
        q_p[:] = q if self._posture is None else self._posture
        self._p.v[:] = self.joints.v
