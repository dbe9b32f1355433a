"""`ModelLearning`: any controller, with a model that is learnt while the arm moves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.analysis.margins import inertia_range
from fotsmc_pin.arms.drive_size import drive_size
from fotsmc_pin.compiled import specialized
from fotsmc_pin.control.rows import named_rows
from fotsmc_pin.control.saved_state import part, present, with_prefix
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.learning.described import Described
from fotsmc_pin.learning.estimates import Estimates, learned_arm
from fotsmc_pin.learning.estimator import WINDOW, JointRows
from fotsmc_pin.learning.learned_terms import LearnedTerms
from fotsmc_pin.learning.parameters import Beliefs, Layout, Prior, first_beliefs
from fotsmc_pin.learning.tick import Whole, learn
from fotsmc_pin.learning.tool import tool_link, unit_bodies

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control import Controller, TaskSpace
    from fotsmc_pin.types import Array

MIDDLE = 1
"""Tick of a window whose configuration stands for it."""
FIRST_NOISE, LEAST_NOISE = 1e-3, 3e-4
"""Standard deviation of a row over the drive's size: believed at first, and the least."""
SAFETY = 2.0
"""Factor by which the learnt inertia stays inside of what the loop bears."""
UNKNOWN_RANGE = (0.3, 3.0)
"""Ratios of inertia that a loop without computable margins is trusted with."""

MEMORY = ("_whole", "_sent", "_joints", "_beliefs", "_P", "_Y", "_middle", "_written")
"""Arrays that live on from tick to tick."""


class ModelLearning(Described):
    """Wraps a controller: the model that it works with is learnt while the arm moves.

    From measured position and velocity and the torque that acted, without an acceleration sensor, a
    Kalman filter estimates what the nominal file may have wrong: mass and centre of mass of each
    link, the payload at the tool, and the armature, viscous and Coulomb friction of each joint.
    Friction is fed forward at the reference; all else is the law's own model, `M0`, `C0` and `G0`.
    The law is not changed.

    It has the face of a controller and works with all of them. The modules of `learning` say what
    it learns from (`estimator`), when it waits or forgets (`change`), and how far a loop follows it
    (`trust`).

    Attributes:
        controller: what is wrapped.
        prior: what is believed beforehand.
        delay: ticks from a torque to the drive.
        bears: ratios of true to believed inertia that the loop is trusted with.

    Signals: the controller's; "link_scale" (nv,); "payload" (4,), mass [kg] and first moments about
    the tool frame [kg·m]; "link_moment" (3 nv,), first moments beyond the nominal ones [kg·m];
    "armature", "damping", "friction" (nv,) and, where it is learnt, "stribeck"; each with its
    standard deviation, as in "payload_deviation"; "learning" (nv,), 1 where a joint teaches
    something, 0 where it rests, -1 where it contradicts what is known; "unexplained" (nv,), torque
    that was not foreseen [N·m]; "changes" (1,), how often the payload was found to be another.
    """

    linked: ClassVar[frozenset[str]] = frozenset(
        {"_a", "_x", "_b", "_terms", "_data", "_arguments", "_code", "_signals"}
    )
    _a: Whole
    _x: JointRows
    _b: Beliefs
    _terms: LearnedTerms
    _ticks: int
    _data: pin.Data
    _signals: dict[str, Array]
    _arguments: tuple[Any, ...]
    _code: Callable[..., None]

    def __init__(
        self,
        controller: Controller | TaskSpace,
        *,
        prior: Prior | None = None,
        delay: int = 1,
        feed_forward: bool = True,
        in_loop: bool = True,
        bears: tuple[float, float] | None = None,
    ) -> None:
        """Wrap a controller, and begin with what its arm's file says.

        Args:
            controller: any controller; from now on it belongs to the wrapper.
            prior: what is believed beforehand; `Prior()` if None.
            delay: ticks from a torque to the drive.
            feed_forward: add the learnt friction to the torque, and where the model stays the
                nominal one, what the learnt one would ask for besides.
            in_loop: let the law work with the learnt model; not done inside of a `SpringObserver`.
            bears: ratios of true to believed inertia that the loop is trusted with; None for half
                of what `fotsmc_pin.margins` finds on either side, or 0.3 to 3 where it finds none.

        Raises:
            ArgumentError: naming the argument, its value and the remedy.
        """
        self.controller, self.arm, self.dt = controller, controller.arm, controller.dt
        self.prior = Prior() if prior is None else prior
        self.delay = checks.count("delay", delay, at_least=0)
        self._feeds, self._in_loop = bool(feed_forward), bool(in_loop)
        self.bears = _range(controller, self.delay) if bears is None else _checked_range(bears)
        n = self.arm.nv
        self._layout = Layout(n, stribeck=self.prior.stribeck is not None)
        self._first = first_beliefs(self.arm, self.prior, self._layout)
        self._drive = drive_size(self.arm)
        self._bodies = unit_bodies(self.arm)
        self._whole = np.zeros((len(Whole._fields), 1))
        self._sent = np.zeros((self.delay + 1, n))
        self._joints = np.zeros((len(JointRows._fields), n))
        self._beliefs = self._first.copy()
        self._P = np.zeros((self._layout.size, self._layout.size))
        self._Y = np.zeros((2, n, self._layout.columns))
        self._middle = np.zeros(self.arm.nq)
        self._written = self._bodies[:n].copy()
        self._link()
        self.reset()

    @property
    def live_signals(self) -> dict[str, Array]:
        """The signals themselves, which every tick writes anew: for reading, by a recorder."""
        return {**self.controller.live_signals, **self._signals}

    def reset(self) -> None:
        """Forget what was learnt, and begin anew."""
        self.controller.reset()
        self._ticks, self._friction = 0, np.zeros(self.arm.nv)
        for name in MEMORY:
            getattr(self, name)[:] = 0.0
        self._beliefs[:] = self._first
        self._P[:] = np.diag(self._b.deviation**2)
        self._x.sticking[:] = self._x.idle[:] = 1.0
        self._x.noise[:] = (FIRST_NOISE * self._drive) ** 2
        self._x.least_noise[:] = (LEAST_NOISE * self._drive) ** 2
        self._a.lowest[:], self._a.highest[:] = self.bears
        self._a.fall[:], self._a.tool[:] = self.prior.stribeck_velocity, tool_link(self.arm)
        self._written[:] = self._bodies[: self.arm.nv]
        self._write_model()

    def update(
        self,
        q: ArrayLike,
        v: ArrayLike,
        q_d: ArrayLike,
        v_d: ArrayLike,
        a_d: ArrayLike,
        dt: float | None = None,
    ) -> Array:
        """Advance by one tick; arguments, result and errors are those of `Controller.update`.

        The torque is the wrapped controller's, with the model of the tick before; then the tick is
        learnt from. Of a measurement that is not usable nothing is learnt.
        """
        law, terms, x, limit = self.controller, self._terms, self._x, self.arm.effort_limit
        tau: Array = law.update(q, v, q_d, v_d, a_d, dt)
        if not law.uses_model and self._feeds:
            self._friction = terms.friction(law.joints)
            tau = np.clip(tau + self._friction, -limit, limit)
        ticks = self._ticks
        phase = ticks % WINDOW
        if phase == 0:
            if ticks:
                middle = (self._middle, x.mean_speed, x.acceleration)
                pin.computeJointTorqueRegressor(self.arm.model, self._data, *middle)
        elif phase == MIDDLE:
            self._middle[:] = law.q
        self._code(self.dt if dt is None else dt, tau, *self._arguments)
        if phase:
            link = (ticks - ticks // WINDOW) % len(tau)
            terms.write(link, self._written[link])
        terms.write_rotors()
        self._ticks = ticks + 1
        return tau

    def note_applied(self, tau: Array, friction: Array) -> None:
        """Learn from `tau` as what acts, friction included, in place of what `update` returned."""
        self._sent[self.delay] = tau
        self.controller.note_applied(tau, friction + self._friction)

    def keep_nominal_model(self) -> None:
        """Feed forward what is learnt, and leave the loop its nominal model from now on."""
        self._in_loop = False
        self._link()

    def estimates(self) -> Estimates:
        """Return what is known of the arm by now, as a table with standard deviations."""
        return Estimates.of(self.arm, self._layout, self._b)

    def learned_arm(self) -> Arm:
        """Return the nominal arm with all estimates written in, an `Arm` of its own.

        What the motion did not tell is estimated as it was believed beforehand: as the file has it.
        """
        return learned_arm(self.arm, self.estimates())

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered, the controller's memory included, as arrays."""
        whole = with_prefix("controller", self.controller.save_state())
        return {name[1:]: getattr(self, name).copy() for name in MEMORY} | whole

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave, and go on from there bit for bit.

        Raises:
            ArgumentError: an array is missing, of the wrong shape or not finite. The memory stays
                as it was.
        """
        own = {
            name: checks.finite_array(name[1:], present(arrays, name[1:]), memory.shape)
            for name, memory in ((name, getattr(self, name)) for name in MEMORY)
        }
        self.controller.restore_state(part(arrays, "controller"))
        for name, array in own.items():
            getattr(self, name)[:] = array
        self._link()

    def __repr__(self) -> str:
        """Name what is wrapped."""
        return f"ModelLearning({self.controller!r}, delay={self.delay})"

    def _link(self) -> None:
        """Make what only refers to the arrays: named rows, the model, the code."""
        self._a = named_rows(self._whole, Whole)
        self._x = named_rows(self._joints, JointRows)
        self._b = named_rows(self._beliefs, Beliefs)
        self._ticks = int(self._a.ticks[0])
        model, law, b = self.arm.model, self.controller, self._b
        self._data = model.createData()
        self._terms = LearnedTerms(
            model,
            b.used,
            self._x.direction,
            self.prior.stribeck_velocity,
            feed_forward=self._feeds,
            in_loop=self._in_loop,
        )
        law.use_terms(self._terms)
        groups = self._layout.groups.items()
        self._signals = {name: b.estimate[place] for name, place in groups}
        self._signals |= {f"{name}_deviation": b.sigma[place] for name, place in groups}
        self._signals |= {
            "learning": self._x.learning,
            "unexplained": self._x.unexplained,
            "changes": self._a.changes,
        }
        regressor = self._data.jointTorqueRegressor
        memory = (self._whole, self._sent, self._joints, self._beliefs, self._P, self._Y)
        self._arguments = (
            law.joints.v,
            law.joints.v_d,
            *memory,
            regressor,
            self._bodies,
            self._written,
        )
        self._code = specialized(learn, self.dt, law.joints.tau, *self._arguments)
        self._write_model()

    def _write_model(self) -> None:
        """Write all links at once into the learnt model, as at the start and for a copy."""
        for link, dynamic in enumerate(self._written):
            self._terms.write(link, dynamic)
        self._terms.write_rotors()


def _range(controller: Controller | TaskSpace, delay: int) -> tuple[float, float]:
    """Return half of what the loop bears on either side."""
    try:
        lowest, highest = inertia_range(controller, delay)
    except ArgumentError:
        return UNKNOWN_RANGE
    return min(SAFETY * lowest, 1.0), max(highest / SAFETY, 1.0)


def _checked_range(bears: tuple[float, float]) -> tuple[float, float]:
    lowest, highest = checks.finite_vector("bears", bears, 2).tolist()
    if not 0.0 < lowest <= 1.0 <= highest:
        raise ArgumentError("bears", bears, "give a ratio of at most 1 and one of at least 1")
    return lowest, highest
