"""`CartesianImpedance`: a tool that gives way like a spring."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.control.computed_torque import ComputedTorque
from fotsmc_pin.control.task_space.directions import Directions
from fotsmc_pin.control.task_space.impedance_law import ImpedanceLaw
from fotsmc_pin.control.task_space.task_space import TaskSpace

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm

SOFT = partial(ComputedTorque, kp=16.0, kd=8.0)
"""Law of the posture: what pushes at the elbow meets something soft too."""


STIFFNESS, TURNING_STIFFNESS = 500.0, 30.0
"""Of positions [N/m] and of rotations [N·m/rad], where none is given."""


class CartesianImpedance(TaskSpace):
    """Pulls the tool to its reference like a spring with a damper, and lets contact push it away.

    It is the compliant counterpart of `TaskSpace` with a robust law, which takes a wall for a
    disturbance and pushes until the motors' limits. It integrates nothing and observes nothing, so
    that a weight that the model does not know moves the tool by its force over the stiffness:

        Λ ë + (½ Λ̇ + D) ė + K e = F_ext

    with `e`, `Λ` and the reference as in `TaskSpace`, and `D` as `ImpedanceLaw` says. The tool
    behaves passively against whatever it touches.

    Signals: those of `TaskSpace`; "spring" and "contact" (m,) [N, N·m].
    """

    def __init__(
        self,
        arm: Arm,
        dt: float,
        *,
        stiffness: ArrayLike | None = None,
        damping_ratio: ArrayLike = 1.0,
        inertia: ArrayLike | None = None,
        frame: str | None = None,
        directions: str | Iterable[str] = "all",
        posture: ArrayLike | None = None,
        **options: Any,
    ) -> None:
        """Make the spring.

        Args:
            arm: the nominal arm.
            dt: period of a tick [s].
            stiffness: `K`, one number or one per direction (m,) [N/m, N·m/rad]; by default 500 N/m
                for positions and 30 N·m/rad for rotations.
            damping_ratio: `ζ`, one number or one per mode (m,).
            inertia: `M_d`, what the tool is to weigh, one number or one per direction (m,)
                [kg, kg·m²]; None leaves it its own inertia, which is passive whatever the model
                lacks.
            frame: as in `TaskSpace`.
            directions: as in `TaskSpace`.
            posture: as in `TaskSpace`.
            **options: others of `TaskSpace`.

        Raises:
            ArgumentError: naming the argument, its value and the remedy.
        """
        if stiffness is None:
            turns = Directions.read(directions).are_rotations
            stiffness = np.where(turns, TURNING_STIFFNESS, STIFFNESS)
        options.setdefault("posture_law", SOFT)
        if inertia is not None:
            options["inertia"] = inertia
        super().__init__(
            arm,
            dt,
            frame=frame,
            directions=directions,
            law=ImpedanceLaw,
            posture=posture,
            stiffness=stiffness,
            damping_ratio=damping_ratio,
            **options,
        )
