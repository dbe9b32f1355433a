"""`Wrench`: a force and a torque at a frame of the arm for a time, and what they are at joints."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


AXES = {"world": pin.ReferenceFrame.LOCAL_WORLD_ALIGNED, "local": pin.ReferenceFrame.LOCAL}
ROUNDING = 1e-9
"""A stage of the integrator this close to an edge of a wrench is at it [s]."""


@dataclass(frozen=True, kw_only=True)
class Wrench:
    """A force `f` and a torque `m` at the origin of a frame, which act from `start` for `duration`.

    At the joints they are `τ = J(q)ᵀ [f; m]`, with the frame's Jacobian where the arm is at that
    instant. They act on the links, also where joints are elastic. Over time they are a rectangle;
    with a `rise` its edges are the halves of a raised cosine, inside the duration.

    Attributes:
        start: when it begins [s].
        duration: how long it acts [s].
        force: (3,) [N].
        torque: (3,) [N·m].
        frame: name of the link whose frame it is; None for the arm's tool frame.
        axes: "world" for the axes of the URDF's root, which keep their direction, or "local" for
            those of the frame, which turn with it.
        rise: time from nothing to all, and back at the end [s].

    Raises:
        ArgumentError: a number that is not finite or out of its range, or unknown axes.
    """

    start: float
    duration: float
    force: ArrayLike = (0.0, 0.0, 0.0)
    torque: ArrayLike = (0.0, 0.0, 0.0)
    frame: str | None = None
    axes: Literal["world", "local"] = "world"
    rise: float = 0.0

    def __post_init__(self) -> None:
        """Check the numbers and keep them as plain ones, so that equal wrenches are equal."""
        duration = checks.finite_number("duration", self.duration, above=0.0)
        plain = {
            "start": checks.finite_number("start", self.start, at_least=0.0),
            "duration": duration,
            "force": tuple(checks.finite_vector("force", self.force, 3).tolist()),
            "torque": tuple(checks.finite_vector("torque", self.torque, 3).tolist()),
            "rise": checks.finite_number("rise", self.rise, at_least=0.0, at_most=duration / 2),
        }
        checks.choice("axes", self.axes, [*AXES])
        for name, value in plain.items():
            object.__setattr__(self, name, value)

    @property
    def end(self) -> float:
        """When it ends [s]."""
        return self.start + self.duration

    @property
    def words(self) -> str:
        """What it is, in plain words."""
        parts = [
            f"{np.linalg.norm(vector):.4g} {unit}"
            for vector, unit in ((self.force, "N"), (self.torque, "N·m"))
            if np.any(vector)
        ]
        return f"{' and '.join(parts) or '0 N'} at {self.frame or 'the tool'}"

    def share(self, t: float) -> float:
        """Return how much of it acts at time `t` [s], 0 to 1."""
        edge = min(t - self.start, self.end - t - 2.0 * ROUNDING)  # It has ended at its end.
        if edge < -ROUNDING:
            return 0.0
        if edge >= self.rise:
            return 1.0
        return math.sin(0.5 * math.pi * max(edge, 0.0) / self.rise) ** 2

    def frame_id(self, arm: Arm) -> int:
        """Return the index of its frame among `arm.model.frames`.

        Raises:
            ArgumentError: no link of the arm has this name.
        """
        name = self.frame or arm.tool_frame
        if not arm.model.existFrame(name, pin.FrameType.BODY):
            hint = checks.did_you_mean(name, arm.tree.links)
            remedy = f"{hint}no link of {arm.name} has it; known: {', '.join(arm.tree.links)}"
            raise ArgumentError("frame", name, remedy)
        return int(arm.model.getFrameId(name, pin.FrameType.BODY))

    def to_dict(self) -> dict[str, Any]:
        """Return its numbers as plain data; `Wrench(**data)` is equal."""
        return asdict(self)


class WrenchesOnArm:
    """What wrenches are at the joints of an arm: torques [N·m, N] that depend on where it is."""

    def __init__(self, arm: Arm, wrenches: Sequence[Wrench]) -> None:
        """Look up the frames."""
        self._model, self._data = arm.model, arm.model.createData()
        self._parts = [
            (w.start - ROUNDING, w.end, w, w.frame_id(arm), np.concatenate([w.force, w.torque]))
            for w in wrenches
        ]

    def add_to(self, load: Array, t: float, q: Array) -> None:
        """Add to `load` (nv,) all that act at time `t` [s], at the configuration `q` (nq,)."""
        for start, end, wrench, frame, vector in self._parts:
            if start <= t < end and (share := wrench.share(t)) > 0.0:
                axes = AXES[wrench.axes]
                jacobian = pin.computeFrameJacobian(self._model, self._data, q, frame, axes)
                load += (share * vector) @ jacobian
