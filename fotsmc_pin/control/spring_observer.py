"""`SpringObserver`: any controller on elastic joints, with encoders on either side."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.compiled import specialized
from fotsmc_pin.control.arguments import cleaned_arguments, read_arguments
from fotsmc_pin.control.controller import LONGEST_TICK, SHORTEST_TICK, Controller
from fotsmc_pin.control.link_model import LinkState, link_constants, observe_links
from fotsmc_pin.control.rows import Joints, named_rows
from fotsmc_pin.control.saved_state import part, present, with_prefix
from fotsmc_pin.control.spring_model import SpringState, motor_constants, observe, usual_damping
from fotsmc_pin.control.wrapper import Wrapper
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.types import Array

MEMORY = ("_state", "_sent")
CORNERS = {"link": 3.0, "motor": 9.0}
"""Rate below which the measured side is followed, by the side [1/s]."""


class SpringObserver(Wrapper):
    """Wraps a controller: it works with the side of elastic joints that it bears, by an estimate.

    **Encoders on the links.** The spring lies inside the loop and turns its phase where a law is
    fast. This observer runs the motor's own equation with the torque that acted:

        δ̇ = ω - v,   J ω̇ = τ - K δ - D (ω - v),   π̇ = K δ + D (ω - v) + d - (M0 v̇ + C0 v + G0)

    `π` is the impulse that the model foresees for the link, without its rotor, beyond the measured
    one; `d` is what the model does not know. All four are corrected by `π` (`observer_rates`). The
    controller is given

        q ⊕ (δ - δ_s),   ω - c (δ - δ_s),   δ̇_s = c (δ - δ_s)

    in place of `q` and `v`: fast motions are the motor's, what lasts is the link's, and at rest the
    links are where the reference is.

    **Encoders on the motors.** Where a law is fast it moves the rotor alone, a tenth of what it
    reckons with; and its integrals feed the swing of a link whose motor it holds. This observer
    runs the equation of the links, with the measured `ω`:

        δ̇ = ω - v,   M0 v̇ = K δ + D (ω - v) - C0 v - G0 + d,   d = M0 a

    What `J ω̇ = τ - K δ - D (ω - v)` leaves of the motor's change of speed corrects `δ`, `v` and `a`
    (`link_corrections`). With `x = s²/(s + c)² δ` the controller is given

        q ⊖ (x - x_J),   ω - (ẋ - ẋ_J),   x_J = (J + ε M0)⁻¹ J x,   ε = 0.3

    Slow motions are the motor's; fast ones are those of an inertia `J + ε M0`, of which the spring
    hides nothing. A motor that stands tells nothing of its link, since friction takes what the
    spring does not: there nothing is corrected. At rest the motors are where the reference is.

    Rigid joints pass through, and so do those whose motors swing by more than 2 rad in a tick.

    It has the face of a controller and works with all of them, also with `ModelLearning` around
    one. What that learns is then fed forward, and the loop keeps its nominal model: how fast it may
    be before the springs swing depends on the inertia that it works with. `fotsmc_pin.margins` and
    `fotsmc_pin.analysis.largest_bandwidth` take it.

    Attributes:
        controller: what is wrapped.
        arm: its nominal arm.
        dt: its period of a tick [s].
        encoder: "link" or "motor", the side that is measured.
        joint_stiffness: `K`, inf where rigid (nv,) [N·m/rad, N/m].
        joint_damping: `D` (nv,) [N·m·s/rad, N·s/m].
        rotor: `J` (nv,) [kg·m², kg].
        delay: ticks from a torque to the drive.
        corner: `c` [1/s].

    Signals: the controller's; "motor_lead", the estimated `δ`; "spring_load", the estimated `d`.

    Source: the model is that of Spong, Journal of Dynamic Systems, Measurement, and Control, 1987;
    the momentum observer that of De Luca and Mattone, IEEE ICRA, 2003.
    """

    linked: ClassVar[frozenset[str]] = frozenset(
        {"_q", "_v", "_links", "_data", "_M", "_h", "_signals", "_arguments", "_code"}
    )
    _state: Array
    _later: Array
    _sent: Array

    def __init__(
        self,
        controller: Any,
        joint_stiffness: ArrayLike,
        *,
        encoder: str = "link",
        joint_damping: ArrayLike | None = None,
        rotor: ArrayLike | None = None,
        delay: int = 1,
        corner: float | None = None,
    ) -> None:
        """Wrap a controller.

        Args:
            controller: any controller, or `ModelLearning` around one; from now on it belongs to the
                wrapper.
            joint_stiffness: `K` of each joint, one number or (nv,) [N·m/rad, N/m]; inf for a rigid
                one.
            encoder: "link" or "motor", the side of the springs that is measured.
            joint_damping: `D` of the springs, one number or (nv,) [N·m·s/rad, N·s/m]; None for what
                damps the motor on its spring by a ratio of 0.02, as makers seldom state it.
            rotor: `J`, inertia on the motor's side, one number or (nv,) [kg·m², kg]; the arm's
                armature if None.
            delay: ticks from a torque to the drive.
            corner: `c`, rate below which the measured side is followed [1/s]; None for 3 with
                encoders on the links, 9 on the motors.

        Raises:
            ArgumentError: naming the argument, its value and the remedy.
        """
        remedy = "give a control law, or what wraps one"
        checks.instance("controller", controller, (Controller, Wrapper), remedy)
        self.controller, self.arm, self.dt = controller, controller.arm, controller.dt
        controller.keep_nominal_model()
        n = self.arm.nv
        self.joint_stiffness = checks.per_joint(
            "joint_stiffness", joint_stiffness, n, above=0.0, unlimited=True
        )
        own = self.arm.armature if rotor is None else rotor
        self.rotor = checks.per_joint("rotor", own, n, at_least=0.0)
        if joint_damping is None:
            joint_damping = usual_damping(self.joint_stiffness, self.rotor)
        self.joint_damping = checks.per_joint("joint_damping", joint_damping, n, at_least=0.0)
        self.delay = checks.count("delay", delay, at_least=0)
        self.encoder = checks.choice("encoder", encoder, [*CORNERS])
        given = CORNERS[self.encoder] if corner is None else corner
        self.corner = checks.finite_number("corner", given, above=0.0)
        elastic = np.isfinite(self.joint_stiffness)
        if ((self.rotor <= 0.0) & elastic).any():
            remedy = "an elastic joint has a motor: give its rotor's inertia"
            raise ArgumentError("rotor", self.rotor, remedy)
        constants = motor_constants if self.encoder == "link" else link_constants
        self._joints = constants(self, elastic)
        shape = (len(self.state_names._fields), n)
        self._state, self._later = np.zeros(shape), np.zeros(shape)
        self._sent = np.zeros((self.delay + 1, n))
        self._configurations = np.zeros((2, self.arm.nq))
        self._arrived = np.zeros((len(Joints._fields), n))
        self._lead = np.zeros((2, n))
        self._link()
        self.reset()

    @property
    def live_signals(self) -> dict[str, Array]:
        """The signals themselves, which every tick writes anew: for reading, by a recorder."""
        return {**self.controller.live_signals, **self._signals}

    @property
    def label(self) -> str:
        """The controller's name, and that its springs are observed."""
        name = getattr(self.controller, "label", type(self.controller).__name__)
        return f"{name} + spring observer"

    @property
    def state_names(self) -> type[SpringState] | type[LinkState]:
        """Names of the rows of the state."""
        return SpringState if self.encoder == "link" else LinkState

    @property
    def observed(self) -> Array:
        """Which joints have a spring that is observed, and do not pass through, (nv,)."""
        return np.array(self._joints[0] > 0.0)

    def around(self, controller: Any) -> SpringObserver:
        """Return a new observer of the same springs around another controller."""
        names = ("encoder", "joint_damping", "rotor", "delay", "corner")
        given: Any = {name: getattr(self, name) for name in names}
        return SpringObserver(controller, self.joint_stiffness, **given)

    def joint_constants(self, joint: int) -> Array:
        """Return what is known of a joint, the rows of `SpringRows` or `LinkRows`."""
        return np.array(self._joints[:, joint])

    @property
    def law(self) -> Controller:
        """The control law itself, without what learns around it."""
        law = self.controller
        while not isinstance(law, Controller):
            law = law.controller
        return law

    def reset(self) -> None:
        """Forget every tick; the next one starts with springs that carry the nominal weight."""
        self.controller.reset()
        for memory in (self._state, self._later, self._sent):
            memory[:] = 0.0

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

        `q` and `v` are those of the side that is measured. After a measurement that is not usable,
        observer and controller are as they were.
        """
        nq, nv = self.arm.nq, self.arm.nv
        given: tuple[Any, ...] = (q, v, q_d, v_d, a_d)
        try:
            are_read = read_arguments(*given, self._configurations, self._arrived)  # type: ignore[call-arg]
        except (AttributeError, TypeError):  # not plain arrays of floats
            are_read = False
        if not are_read:
            given = tuple(cleaned_arguments(nq, nv, *given))
            read_arguments(*given, self._configurations, self._arrived)  # type: ignore[call-arg]
        period = self.dt
        if dt is not None:
            shortest, longest = SHORTEST_TICK * self.dt, LONGEST_TICK * self.dt
            period = checks.finite_number("dt", dt, at_least=shortest, at_most=longest)
        place, lead = self._q, self._lead
        pin.crba(self._links, self._data, place)
        pin.nonLinearEffects(self._links, self._data, place, self._v)
        self._code(period, *self._arguments)
        if self.arm.is_euclidean:
            place = place + lead[0]
        elif lead[0].any():
            place = pin.integrate(self._links, place, lead[0])
        tau: Array = self.controller.update(place, lead[1], *given[2:], dt)
        self._state[:] = self._later
        self._sent[:-1] = self._sent[1:]
        self._sent[-1] = tau
        return tau

    def note_applied(self, tau: Array, friction: Array) -> None:
        """Take `tau` less `friction` as what drives the motors; see `Controller.note_applied`."""
        self._sent[-1] = tau - friction
        self.controller.note_applied(tau, friction)

    def save_state(self) -> dict[str, Array]:
        """Return everything that is remembered, the controller's memory included, as arrays."""
        own = {name[1:]: getattr(self, name).copy() for name in MEMORY}
        return own | with_prefix("controller", self.controller.save_state())

    def restore_state(self, arrays: Mapping[str, ArrayLike]) -> None:
        """Take over what `save_state` gave, and go on from there bit for bit.

        Raises:
            ArgumentError: an array is missing, of the wrong shape or not finite. The memory stays
                as it was.
        """
        own = {}
        for name in MEMORY:
            given = present(arrays, name[1:])
            own[name] = checks.finite_array(name[1:], given, getattr(self, name).shape)
        self.controller.restore_state(part(arrays, "controller"))
        for name, array in own.items():
            getattr(self, name)[:] = array

    def __repr__(self) -> str:
        """Name what is wrapped."""
        return (
            f"SpringObserver({self.controller!r}, encoder={self.encoder!r}, delay={self.delay}, "
            f"corner={self.corner:g})"
        )

    def _link(self) -> None:
        """Make what only refers to the arrays: the model of the links, the signals, the code."""
        self._links = self.arm.model.copy()
        self._links.armature = np.where(self.observed, 0.0, self.arm.armature)
        self._data = self._links.createData()
        self._q, self._v = self._configurations[0], named_rows(self._arrived, Joints).v
        state: Any = named_rows(self._state, self.state_names)
        self._signals = {"motor_lead": state.deflection, "spring_load": state.load}
        self._arguments: tuple[Any, ...] = (
            self._data.M.T,
            self._data.nle,
            self._v,
            self._sent[0],
            self._joints,
            self._state,
            self._later,
            self._lead,
        )
        tick: Any = observe
        if self.encoder == "motor":
            tick = observe_links
            self._arguments += (np.zeros((self.arm.nv, self.arm.nv)),)
        self._code = specialized(tick, self.dt, *self._arguments)
