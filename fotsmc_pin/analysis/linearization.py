"""A control law near its equilibrium as a finite linear system, read off its own compiled tick."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.analysis.sampled_loop import Joint
from fotsmc_pin.control import SpringObserver
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from fotsmc_pin.control import Controller
    from fotsmc_pin.types import Array


SETTLING_TICKS = 5
"""Ticks at equilibrium after which every operator has the samples that its scheme needs."""
PROBE_RATE = 20.0
"""Rate of the motion whose size scales the perturbations [rad/s]."""
PROBE_TICKS = 400
COUPLED = 1e-6
"""Response of another joint, relative to a joint's own, from which on a law counts as coupled."""
ALIKE_TICKS, ALIKE = 60, 1e-3
"""Ticks over which two joints must answer the same error alike, and by how much they may differ."""
CONNECTED = 1e-9
"""Scaled response below which one state does not depend on another."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LinearLaw:
    """One joint of a law, `x⁺ = A x + B (e, ė)`, `u = C x + D (e, ė)`, with `τ = M0 u + h0`.

    Attributes:
        A: (n, n).
        B: (n, 2), columns for `e` and `ė`.
        C: commanded acceleration per state, (n,).
        D: commanded acceleration per `e` [1/s²] and per `ė` [1/s], (2,).
        dt: period of a tick [s].
        joint: what it was made for: a rigid joint, or the spring that is observed.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    dt: float
    joint: Joint = field(default_factory=Joint)


class _Tick:
    """The controller's tick as a function of its memory and of the errors of one joint."""

    def __init__(self, controller: Controller) -> None:
        self.controller, self.arm = controller, controller.arm
        self._parts = [
            *(stream.memory for stream in controller.memories.values()),
            *controller.state,
            controller.joints.tau,
        ]
        self._neutral = np.array(self.arm.neutral)  # Compiled calls are slow on a read-only array.
        torques = [getattr(controller.state, name) for name in controller.torque_rows]
        self._holds_torques = [any(part is torque for torque in torques) for part in self._parts]
        self._mass = np.array(self.arm.mass_matrix(self._neutral))
        self._kept = [part.copy() for part in self._parts]
        self._rest = np.zeros(self.arm.nv)
        # The loop is that of torques within their limits, also where weight alone exceeds them.
        self._limits = controller.joints.effort_limit.copy()
        controller.joints.effort_limit[:] = np.inf

    def memory(self) -> Array:
        """Return all states; torques as accelerations, each of which belongs to one joint."""
        return np.concatenate(
            [
                np.linalg.solve(self._mass, part) if holds_torques else part.ravel()
                for part, holds_torques in zip(self._parts, self._holds_torques, strict=True)
            ]
        )

    def restore(self, memory: Array) -> None:
        start = 0
        for part, holds_torques in zip(self._parts, self._holds_torques, strict=True):
            row = memory[start : start + part.size].reshape(part.shape)
            part[...] = self._mass @ row if holds_torques else row
            start += part.size

    def put_back(self) -> None:
        for part, kept in zip(self._parts, self._kept, strict=True):
            part[...] = kept
        self.controller.joints.effort_limit[:] = self._limits

    def advance(self, e: Array, ed: Array) -> tuple[Array, Array]:
        """Go on by a tick from the memory as it is; return `q` and the torque."""
        q = self.arm.integrate(self._neutral, e)
        return q, self.controller.update(q, ed, self._neutral, self._rest, self._rest)

    def acceleration(self, e: Array, ed: Array) -> Array:
        """Go on from the memory as it is; return the commanded acceleration `M0⁻¹ (τ - h0)`."""
        q, tau = self.advance(e, ed)
        h0 = self.arm.inverse_dynamics(q, ed, self._rest)
        return np.linalg.solve(self.arm.mass_matrix(q), tau - h0).astype(np.float64)

    def __call__(self, memory: Array, e: Array, ed: Array) -> tuple[Array, Array]:
        """Return the memory after a tick and the commanded acceleration."""
        self.restore(memory)
        u = self.acceleration(e, ed)
        return self.memory(), u


def linearize(
    controller: Controller | SpringObserver,
    amplitude: float = 1e-4,
    joints: Sequence[int] | None = None,
) -> tuple[LinearLaw, ...]:
    """Return the linear system that a law is near its equilibrium, one per joint.

    The real tick is run at the arm's neutral configuration with one state or one error changed at
    a time, up and down: central differences, whose size is that which the state has in a motion of
    `amplitude` at 20 rad/s. Counters, flags and whatever no error reaches or no torque sees are
    left out, and so are torque limits. Smooth laws do not depend on `amplitude`; the slope of a
    power below 1, of a sign or of a boundary layer is the secant over it. The controller is left as
    it was. The law in a `SpringObserver` is linearised so, and the observer, which is linear, is
    put before it.

    Args:
        controller: a law that multiplies a commanded acceleration with the nominal mass matrix,
            each joint's from its own error; or a `SpringObserver` around one.
        amplitude: size of the error at which slopes are taken [rad, m].
        joints: indices of the joints that are wanted; all by default.

    Raises:
        ArgumentError: the law does not have that form.
    """
    if isinstance(controller, SpringObserver):
        from fotsmc_pin.analysis.spring_loop import behind_springs

        return behind_springs(controller, linearize(controller.law, amplitude, joints), joints)
    tick = _Tick(controller)
    try:
        controller.reset()
        rest = np.zeros(controller.arm.nv)
        memory = tick.memory()
        for _ in range(SETTLING_TICKS):
            memory, _ = tick(memory, rest, rest)
        _demand_form(tick, memory)
        wanted = range(controller.arm.nv) if joints is None else joints
        found: dict[int, LinearLaw] = {}
        answers, laws = _answers(tick, memory, amplitude), []
        for j in wanted:
            # Joints with the same gains have the same law: one of them is run.
            like = next((k for k in found if _alike(answers[:, k], answers[:, j])), j)
            if like == j:
                found[j] = _joint(tick, memory, j, amplitude)
            else:
                _demand_uncoupled(tick, memory, j, amplitude)
            laws.append(found[like])
        return tuple(laws)
    finally:
        tick.put_back()


def _answers(tick: _Tick, memory: Array, amplitude: float) -> Array:
    """Commanded accelerations while all joints have one and the same small error, (ticks, nv)."""
    answers, all_joints = [], np.ones(tick.arm.nv)
    tick.restore(memory)
    for k in range(ALIKE_TICKS):
        phase = PROBE_RATE * k * tick.controller.dt
        e, ed = amplitude * np.sin(phase), amplitude * PROBE_RATE * np.cos(phase)
        answers.append(tick.acceleration(e * all_joints, ed * all_joints))
    return np.array(answers)


def _alike(one: Array, other: Array) -> bool:
    return bool(np.abs(one - other).max() <= ALIKE * np.abs(one).max())


def _demand_uncoupled(tick: _Tick, memory: Array, joint: int, amplitude: float) -> None:
    """Raise where an error of one joint accelerates another."""
    unit = np.eye(tick.arm.nv)[joint]
    for e, ed in ((amplitude, 0.0), (0.0, PROBE_RATE * amplitude)):
        _, up = tick(memory, e * unit, ed * unit)
        _, down = tick(memory, -e * unit, -ed * unit)
        u = 0.5 * (up - down)
        if np.abs(np.delete(u, joint)).max(initial=0.0) > COUPLED * np.abs(u).max():
            remedy = "give a law in which each joint's acceleration follows from its own error"
            raise ArgumentError("controller", type(tick.controller).__name__, remedy)


def _demand_form(tick: _Tick, memory: Array) -> None:
    """Raise where `τ` is not `M0 a_d + h0` at zero error."""
    arm, name = tick.arm, type(tick.controller).__name__
    rest, q = np.zeros(arm.nv), arm.neutral
    asked = np.full(arm.nv, 1e-3)
    tick.restore(memory)
    tau = tick.controller.update(q, rest, q, rest, asked)
    wanted = arm.inverse_dynamics(q, rest, asked)
    inertial = np.abs(wanted - arm.gravity(q))
    if not (np.abs(tau - wanted) <= 1e-6 * (inertial.max() + 1e-12)).all():
        remedy = "give a law that multiplies its commanded acceleration with the nominal inertia"
        raise ArgumentError("controller", name, remedy)


def _joint(tick: _Tick, memory: Array, joint: int, amplitude: float) -> LinearLaw:
    nv, dt = tick.arm.nv, tick.controller.dt
    unit = np.eye(nv)[joint]
    scale = _scales(tick, memory, unit, amplitude)

    def slopes(change: Array, e: float, ed: float) -> tuple[Array, Array]:
        up, u_up = tick(memory + change, e * unit, ed * unit)
        down, u_down = tick(memory - change, -e * unit, -ed * unit)
        moved = np.divide(up - down, 2.0 * scale, out=np.zeros_like(scale), where=scale > 0.0)
        return moved, 0.5 * (u_up - u_down)

    def connected(response: Array) -> list[int]:
        return [int(k) for k in np.flatnonzero(np.abs(response) > CONNECTED)]

    quiet, speed = np.zeros_like(scale), PROBE_RATE * amplitude
    _demand_uncoupled(tick, memory, joint, amplitude)
    inputs = [slopes(quiet, amplitude, 0.0), slopes(quiet, 0.0, speed)]
    columns: dict[int, tuple[Array, Array]] = {}
    waiting = sorted({k for response, _ in inputs for k in connected(response)})
    while waiting:
        k = waiting.pop()
        if k not in columns:
            change = np.zeros_like(scale)
            change[k] = scale[k]
            columns[k] = slopes(change, 0.0, 0.0)
            waiting += connected(columns[k][0])
    order = _seen(columns, joint, connected)
    A = np.array([[columns[j][0][i] for j in order] for i in order]).reshape(2 * (len(order),))
    sizes = np.array([amplitude, speed])
    B = np.array([[response[i] for response, _ in inputs] for i in order]).reshape(-1, 2) / sizes
    C = np.array([columns[j][1][joint] for j in order])
    D = np.array([u[joint] for _, u in inputs]) / sizes
    return LinearLaw(A=A, B=B, C=C, D=D, dt=dt)


def _scales(tick: _Tick, memory: Array, unit: Array, amplitude: float) -> Array:
    """RMS of what each state moves by in a small motion of one joint; 0 for those that count."""
    states = []
    tick.restore(memory)
    for k in range(PROBE_TICKS):
        phase = PROBE_RATE * k * tick.controller.dt
        e, ed = amplitude * np.sin(phase), amplitude * PROBE_RATE * np.cos(phase)
        tick.advance(e * unit, ed * unit)
        states.append(tick.memory() - memory)
    moved = np.array(states)
    scale = np.sqrt(np.mean(moved**2, axis=0))
    counts = (np.diff(moved, axis=0) == 1.0).all(axis=0)
    return np.array(np.where(counts, 0.0, scale))


def _seen(
    columns: dict[int, tuple[Array, Array]], joint: int, connected: Callable[[Array], list[int]]
) -> list[int]:
    """States on which the torque depends, at once or later."""
    largest = max((abs(u[joint]) for _, u in columns.values()), default=0.0)
    seen = {k for k, (_, u) in columns.items() if abs(u[joint]) > CONNECTED * largest}
    while True:
        more = {
            k
            for k, (moved, _) in columns.items()
            if k not in seen and not seen.isdisjoint(connected(moved))
        }
        if not more:
            return sorted(seen)
        seen |= more
