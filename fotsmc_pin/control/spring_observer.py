"""`SpringObserver`: any controller on elastic joints with encoders on the links."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.compiled import specialized
from fotsmc_pin.control.arguments import cleaned_arguments, read_arguments
from fotsmc_pin.control.controller import LONGEST_TICK, SHORTEST_TICK, Controller
from fotsmc_pin.control.rows import Joints, named_rows
from fotsmc_pin.control.saved_state import part, present, with_prefix
from fotsmc_pin.control.spring_model import (
    FASTEST_SWING,
    SpringRows,
    SpringState,
    corrections,
    observe,
    observer_rates,
)
from fotsmc_pin.control.wrapper import Wrapper
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.types import Array

MEMORY = ("_state", "_sent")
LINKED = {"_q", "_v", "_links", "_data", "_M", "_h", "_signals", "_arguments", "_code"}
"""What only refers to the arrays or is made from the arm; no copy takes it along."""
USUAL_DAMPING = 0.02
"""Damping ratio of a motor on its spring, where it is not given."""


class SpringObserver(Wrapper):
    """Wraps a controller: it works with the motors' positions, estimated from the links'.

    With encoders on the links of elastic joints the spring lies inside the loop and turns its phase
    where a law is fast: only slow laws are stable. With encoders on the motors it does not. This
    observer runs the motor's own equation with the torque that acted, and the spring and rotor
    that the maker states:

        δ̇ = ω - v,   J ω̇ = τ - K δ - D (ω - v),   π̇ = K δ + D (ω - v) + d - (M0 v̇ + C0 v + G0)

    `π` is the impulse that the model foresees for the link, without its rotor, beyond the measured
    one: a momentum observer. `d` is what the model does not know, such as weight. All four are
    corrected by `π` so that errors decay at rates that the sampled loop bears (`observer_rates`).
    The controller is given

        q ⊕ (δ - δ_s),   ω - c (δ - δ_s),   δ̇_s = c (δ - δ_s)

    in place of `q` and `v`: fast motions are the motor's, and what lasts is the link's, so that at
    rest the links are where the reference is. Rigid joints pass through, and so do those whose
    motors swing by more than 2 rad in a tick.

    It has the face of a controller and works with all of them, also with `ModelLearning` around
    one. `fotsmc_pin.margins` and `fotsmc_pin.analysis.largest_bandwidth` take it.

    Attributes:
        controller: what is wrapped.
        arm: its nominal arm.
        dt: its period of a tick [s].
        joint_stiffness: `K`, inf where rigid (nv,) [N·m/rad, N/m].
        joint_damping: `D` (nv,) [N·m·s/rad, N·s/m].
        rotor: `J` (nv,) [kg·m², kg].
        delay: ticks from a torque to the drive.
        corner: `c` [1/s].

    Signals: the controller's; "motor_lead", the estimated `δ`; "spring_load", the estimated `d`.

    Source: the model is that of Spong, Journal of Dynamic Systems, Measurement, and Control, 1987;
    the momentum observer that of De Luca and Mattone, IEEE ICRA, 2003.
    """

    _state: Array
    _later: Array
    _sent: Array

    def __init__(
        self,
        controller: Any,
        joint_stiffness: ArrayLike,
        *,
        joint_damping: ArrayLike | None = None,
        rotor: ArrayLike | None = None,
        delay: int = 1,
        corner: float = 3.0,
    ) -> None:
        """Wrap a controller.

        Args:
            controller: any controller, or `ModelLearning` around one; from now on it belongs to the
                wrapper.
            joint_stiffness: `K` of each joint, one number or (nv,) [N·m/rad, N/m]; inf for a rigid
                one.
            joint_damping: `D` of the springs, one number or (nv,) [N·m·s/rad, N·s/m]; None for what
                damps the motor on its spring by a ratio of 0.02, as makers seldom state it.
            rotor: `J`, inertia on the motor's side, one number or (nv,) [kg·m², kg]; the arm's
                armature if None.
            delay: ticks from a torque to the drive.
            corner: `c`, rate below which the link is followed, and above which the motor is [1/s].

        Raises:
            ArgumentError: naming the argument, its value and the remedy.
        """
        remedy = "give a control law, or what wraps one"
        checks.instance("controller", controller, (Controller, Wrapper), remedy)
        self.controller, self.arm, self.dt = controller, controller.arm, controller.dt
        n = self.arm.nv
        self.joint_stiffness = checks.per_joint(
            "joint_stiffness", joint_stiffness, n, above=0.0, unlimited=True
        )
        own = self.arm.armature if rotor is None else rotor
        self.rotor = checks.per_joint("rotor", own, n, at_least=0.0)
        if joint_damping is None:
            K = np.where(np.isfinite(self.joint_stiffness), self.joint_stiffness, 0.0)
            joint_damping = 2.0 * USUAL_DAMPING * np.sqrt(K * self.rotor)
        self.joint_damping = checks.per_joint("joint_damping", joint_damping, n, at_least=0.0)
        self.delay = checks.count("delay", delay, at_least=0)
        self.corner = checks.finite_number("corner", corner, above=0.0)
        elastic = np.isfinite(self.joint_stiffness)
        if ((self.rotor <= 0.0) & elastic).any():
            remedy = "an elastic joint has a motor: give its rotor's inertia"
            raise ArgumentError("rotor", self.rotor, remedy)
        self._joints = _constants(self, elastic)
        shape = (len(SpringState._fields), n)
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
    def observed(self) -> Array:
        """Which joints have a spring that is observed, and do not pass through, (nv,)."""
        return np.array(self._joints[0] > 0.0)

    def around(self, controller: Any) -> SpringObserver:
        """Return a new observer of the same springs around another controller."""
        return SpringObserver(
            controller,
            self.joint_stiffness,
            joint_damping=self.joint_damping,
            rotor=self.rotor,
            delay=self.delay,
            corner=self.corner,
        )

    def joint_constants(self, joint: int) -> Array:
        """Return what is known of a joint, the rows of `SpringRows` (9,)."""
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

        `q` and `v` are those of the links. After a measurement that is not usable, observer and
        controller are as they were.
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

    def __getstate__(self) -> dict[str, Any]:
        """Return what makes the wrapper, without the views and the code that `_link` makes."""
        return {name: value for name, value in self.__dict__.items() if name not in LINKED}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._link()

    def __repr__(self) -> str:
        """Name what is wrapped."""
        return f"SpringObserver({self.controller!r}, delay={self.delay}, corner={self.corner:g})"

    def _link(self) -> None:
        """Make what only refers to the arrays: the model of the links, the signals, the code."""
        self._links = self.arm.model.copy()
        self._links.armature = np.where(self.observed, 0.0, self.arm.armature)
        self._data = self._links.createData()
        self._q, self._v = self._configurations[0], named_rows(self._arrived, Joints).v
        state = named_rows(self._state, SpringState)
        self._signals = {"motor_lead": state.deflection, "spring_load": state.load}
        self._arguments = (
            self._data.M.T,
            self._data.nle,
            self._v,
            self._sent[0],
            self._joints,
            self._state,
            self._later,
            self._lead,
        )
        self._code = specialized(observe, self.dt, *self._arguments)


def _constants(observer: SpringObserver, elastic: Array) -> Array:
    """Return the rows of `SpringRows`."""
    table = np.zeros((len(SpringRows._fields), observer.arm.nv))
    x = named_rows(table, SpringRows)
    x.stiffness[:] = x.rotor[:] = 1.0
    x.corner[:] = observer.corner
    for i in np.flatnonzero(elastic):
        numbers = (observer.rotor[i], observer.joint_stiffness[i], observer.joint_damping[i])
        J, K, D = (float(number) for number in numbers)
        if math.sqrt(K / J) * observer.dt > FASTEST_SWING:
            continue
        found = corrections(observer.dt, J, K, D, observer_rates(observer.dt, J, K, D))
        x.elastic[i], x.rotor[i], x.stiffness[i], x.damping[i] = 1.0, J, K, D
        x.to_impulse[i], x.to_deflection[i], x.to_speed[i], x.to_load[i] = found
    return table
