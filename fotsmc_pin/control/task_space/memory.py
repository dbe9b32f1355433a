"""What a task remembers, shows and is linked to, apart from what it does in a tick."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.compiled import address, restricted, specialized
from fotsmc_pin.control.friction_terms import are_own, terms_of
from fotsmc_pin.control.model_terms import ModelTerms
from fotsmc_pin.control.rows import Joints, named_rows
from fotsmc_pin.control.saved_state import part, present, with_prefix
from fotsmc_pin.control.task_space.chain import chain_of
from fotsmc_pin.control.task_space.configurations import places_in_q
from fotsmc_pin.control.task_space.given import read_motion
from fotsmc_pin.control.task_space.sharing import tell
from fotsmc_pin.control.task_space.tick import tick
from fotsmc_pin.control.task_space.tool_rows import (
    NUMBERS,
    POINT,
    ROOM,
    SCRATCH,
    Numbers,
    PointRows,
    ToolRows,
    rows_of_joints,
)
from fotsmc_pin.copying import SharesNothing

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.controller import Controller
    from fotsmc_pin.control.task_space.directions import Directions
    from fotsmc_pin.types import Array

CLOSING, PER_TICK = 40.0, 0.05
"""Rate at which the feasible reference closes its error [1/s], and the most of it in a tick."""
POSTURE_RATE = 3.0
"""Rate at which the feasible reference goes back to its posture [1/s]."""
MEMORY = ("_joints", "_tool", "_configurations", "_poses")
"""Arrays that live on from tick to tick."""


class TaskTerms(ModelTerms):
    """`Λ` and `h` of the tool as a law's `M0` and `h0`, or those of the joints; written elsewhere.

    Attributes:
        M: (n, n).
        h: (n,).
    """

    def __init__(self, M: Array, h: Array) -> None:
        self.M, self.h = M, h

    def evaluate(self, q: Array, joints: Joints) -> None:
        """Leave the terms as they were written."""


class TaskMemory(SharesNothing):
    """The arrays of a task, and all that only reads or refers to them.

    Attributes:
        q: live configuration of the last tick (nq,).
        joints: live rows of the joints: errors from the feasible reference, speeds, torque.
    """

    linked: ClassVar[frozenset[str]] = frozenset(
        {
            *("_terms", "_memory", "_arguments", "_tick", "_tell", "_last"),
            *("_signals", "q", "joints", "_n", "_p", "_t"),
        }
    )

    follows_poses = True
    uses_model = True
    _feeds_friction = True

    arm: Arm
    dt: float
    frame: str
    directions: Directions
    law: Controller[Any]
    posture_law: Controller[Any]
    length: float
    threshold: float
    _frame: int
    _posture: Array | None

    def _allocate(self) -> None:
        m, n = len(self.directions), self.arm.nv
        self._chain, rigid = chain_of(self.arm, self._frame)
        self._joints = np.zeros((rows_of_joints(n), n))
        self._tool = np.zeros((SCRATCH + ROOM, 6))
        self._configurations = np.zeros((4, self.arm.nq))
        self._poses = np.vstack([np.zeros((4, 4, 3)), rigid])
        self._quaternions = np.zeros((3, 7))
        self._mobility, self._drift = np.zeros((m, m)), np.zeros(m)

    @property
    def gains(self) -> Any:
        """The law's gains."""
        return self.law.gains

    @property
    def preset(self) -> str:
        """The law's preset."""
        return self.law.preset

    @property
    def label(self) -> str:
        """The law's name, and that it works at the tool."""
        return f"{type(self.law).__name__} at the tool"

    @property
    def about(self) -> dict[str, Any]:
        """Plain data for a recording's metadata, under "task"."""
        return {"task": {"frame": self.frame, "directions": list(self.directions.names)}}

    def note_applied(self, tau: Array, friction: Array) -> None:
        """Take note of the torque that acts; see `Controller.note_applied`.

        Both laws are told what acceleration it is beyond their own.
        """
        more = tau - friction - self.joints.tau
        if more.any():
            self.joints.tau[:] += more
            self._tell(*self._last)

    def feed_friction(self, wanted: bool) -> None:
        """Feed friction that is known forward, or leave it to drives that compensate it."""
        self._feeds_friction = wanted
        if are_own(self._terms):
            self.use_terms(terms_of(self.arm, feeds_friction=wanted))

    def reset(self) -> None:
        """Forget everything: the next tick starts where the arm is then."""
        self.law.reset()
        self.posture_law.reset()
        self._joints[:], self._tool[:], self._configurations[:] = 0.0, 0.0, 0.0
        self._poses[:4] = 0.0
        self._set_constants()

    @property
    def resolved(self) -> tuple[Array, Array]:
        """Live views of the joints' part of the feasible reference, `q_f` (nq,) and `v_f` (nv,)."""
        return self._configurations[3], self.joints.v_d

    @property
    def signals(self) -> dict[str, Array]:
        """Copies of the last tick's inner signals by name."""
        return {name: signal.copy() for name, signal in self._signals.items()}

    @property
    def live_signals(self) -> dict[str, Array]:
        """The signals themselves, which every tick writes anew: for reading, by a recorder."""
        return self._signals

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered, as plain arrays by name."""
        own = {name[1:]: getattr(self, name).copy() for name in MEMORY}
        return (
            own
            | with_prefix("law", self.law.save_state())
            | with_prefix("posture_law", self.posture_law.save_state())
        )

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave, and go on from there bit for bit.

        Raises:
            ArgumentError: an array is missing, of the wrong shape or not finite.
        """
        own = {
            name: checks.finite_array(
                name[1:], present(arrays, name[1:]), getattr(self, name).shape, unlimited=True
            )
            for name in MEMORY
        }
        self.law.restore_state(part(arrays, "law"))
        self.posture_law.restore_state(part(arrays, "posture_law"))
        for name, array in own.items():
            getattr(self, name)[:] = array
        self._link()

    def use_terms(self, terms: ModelTerms) -> None:
        """Evaluate `M0` and `h0` by `terms` from now on, in place of the arm's own model.

        For wrappers; a copy of the controller goes back to the arm's own.
        """
        self._terms = terms
        self._link_kernels()

    def __repr__(self) -> str:
        """Name the frame, the directions and the law."""
        held = ", ".join(self.directions.names)
        return f"{type(self).__name__}({self.arm.name}, {self.frame}: {held}; {self.law!r})"

    def _set_constants(self) -> None:
        """Fill in what never changes, where `reset` has emptied the arrays."""
        arm, b, p = self.arm, self._n, self._p
        b.rate[0] = min(CLOSING, PER_TICK / self.dt)
        b.posture_rate[0] = POSTURE_RATE
        b.threshold[0] = self.threshold
        self.joints.effort_limit[:] = arm.effort_limit
        p.fastest[:] = arm.velocity_limit
        p.lower[:], p.upper[:] = arm.lower_position_limit, arm.upper_position_limit
        self._t.scale[: len(self.directions)] = self.directions.scale(self.length)
        self.law.joints.effort_limit[:] = np.inf

    def _link(self) -> None:
        """Make what only refers to the arrays: the named rows, Pinocchio's memory, the code."""
        m = len(self.directions)
        self.q = self._configurations[0]
        self.joints = named_rows(self._joints, Joints)
        self._p = named_rows(self._joints[POINT:], PointRows)
        self._t = named_rows(self._tool, ToolRows)
        self._n = named_rows(self._tool[NUMBERS:], Numbers)
        first = NUMBERS + Numbers._fields.index("kept")
        kept = self._tool[first : first + 2, 0]
        self._signals = {
            "pose": self._quaternions[0],
            "pose_d": self._quaternions[1],
            "pose_f": self._quaternions[2],
            "pose_error": self._t.error[:m],
            "given_up": self._t.given_up[:m],
            "kept": kept,
        }
        six, pose = np.zeros(6), pin.SE3.Identity().homogeneous
        self._memory = (self._configurations, self._joints, self._tool, self._poses)
        restricted(read_motion, self.q, self.joints.v, pose, six, six, *self._memory)
        self.law.use_terms(TaskTerms(self._mobility, self._drift))
        self._signals = {**self.law.live_signals, **self._signals}
        self.use_terms(terms_of(self.arm, feeds_friction=self._feeds_friction))

    def _link_kernels(self) -> None:
        terms, law = self._terms, self.law
        self.posture_law.use_terms(TaskTerms(terms.M, terms.h))
        laws: list[Any] = []
        for acting in (law, self.posture_law):
            own = acting.compiled[1]
            laws += [address(acting.tick, self.dt, *own), own]
        self._arguments = (
            *laws,
            self._joints,
            self._tool,
            self._configurations,
            self._poses,
            self._quaternions,
            self._chain,
            places_in_q(self.arm),
            self.directions.code,
        )
        self._tick = specialized(tick, self.dt, *self._arguments)
        tables = law.joints.e.base, self.posture_law.joints.e.base
        self._last = (*tables, terms.h, self._joints, self._tool, self._mobility)
        self._tell = specialized(tell, *self._last)
