"""`Plant`: the true arm, integrated under a torque that is held over each tick."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.compiled import kernel, specialized
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.simulation.dry_friction import apply_friction

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array, Disturbance


INTEGRATORS = ("rk4", "semi-implicit")
FRICTION_WIDTH = 1e-3
"""Least width of the speed band in which Coulomb friction changes sign [rad/s, m/s]."""
LARGEST_SPEED = 1e4
"""A joint that is faster than this has diverged [rad/s, m/s]."""
STIFFEST = 1.0
"""Largest `h D / M` of a joint for explicit steps; unstable from 2.8 on, and `M` varies."""

# Rows of the plant's workspace. A recorder copies the first three in one piece.
Q0, V0, TAU, Q_STAGE, V_STAGE, STEP, SUM_V, SUM_A, LOAD = range(9)
DISTURBANCE, DAMPING, FRICTION, WIDTH, LIMIT = range(9, 14)
ROWS = 14


class Plant:
    """Forward dynamics `M a + C v + G + D v + F_c sign(v) = τ + τ_d` of an arm, step by step.

    Torque is held between ticks (zero-order hold); the disturbance is evaluated at every stage
    of the integrator.

    Friction is explicit in "rk4": Coulomb friction changes sign over a narrow band of
    speed, 1e-3 wide or as wide as keeps one integration step from overshooting a standstill, and
    strong damping of a light joint requires short steps (`h D / M < 2`). In "semi-implicit" both
    are implicit: joints stick and slip, and any step is stable.

    Attributes:
        integrator: "rk4" or "semi-implicit".
        q: configuration (nq,), the array that the plant updates in place.
        v: velocity (nv,), updated in place too.
        tau: torque at the joints within the arm's effort limits (nv,), updated in place too.
        live: flat arrays that hold `q`, `v` and `tau`, in this order.
    """

    def __init__(
        self,
        arm: Arm,
        q0: Array,
        v0: Array,
        *,
        dt: float,
        substeps: int = 1,
        integrator: str | None = None,
        disturbance: Disturbance | None = None,
    ) -> None:
        """Put the arm at `q0`, `v0` at time 0.

        Args:
            arm: the true arm.
            q0: configuration (nq,).
            v0: velocity (nv,).
            dt: period of a tick [s].
            substeps: integration steps in a tick.
            integrator: "rk4" (fourth order) or "semi-implicit" (Euler, first order, symplectic;
                friction implicit). By default "rk4", unless the arm has Coulomb friction, as
                joints stick only in "semi-implicit", or damping too strong for explicit steps.
            disturbance: `t -> (nv,)`, torque added at the joints [N·m, N].

        Raises:
            ArgumentError: naming the argument, its value and the remedy.
        """
        self._substeps = checks.count("substeps", substeps)
        self._arm, self._model, self._data = arm, arm.model, arm.model.createData()
        h = dt / self._substeps
        lightest = self._lightest(np.array(q0))
        self.integrator = self._suitable(integrator, h * arm.damping / lightest)
        rk4 = self.integrator == "rk4"
        self._advance = self._rk4 if rk4 else self._semi_implicit
        self._acceleration: Array = self._data.ddq
        self._disturbance = disturbance
        self._euclidean = arm.is_euclidean
        self._work = work = np.zeros((ROWS, arm.nv))
        self.v, self.tau = work[V0], work[TAU]
        self._v_stage, self._load, self._step = work[V_STAGE], work[LOAD], work[STEP]
        if self._euclidean:
            self.q, self._q_stage = work[Q0], work[Q_STAGE]
            self.live: tuple[Array, ...] = (work[Q0 : TAU + 1].reshape(-1),)
        else:  # q is not a plain vector, so the kernels' rows for positions are not used.
            self.q, self._q_stage = np.zeros((2, arm.nq))
            self.live = (self.q, self.v, self.tau)
        self.q[:], self.v[:] = q0, v0
        self._impulse = np.zeros(arm.nv)
        self._has_friction = not rk4 and bool(np.any(arm.friction) or np.any(arm.damping))
        if rk4:
            work[DAMPING], work[FRICTION] = arm.damping, arm.friction
        work[WIDTH] = np.maximum(FRICTION_WIDTH, arm.friction * h / lightest)
        work[LIMIT] = arm.effort_limit
        a = self._acceleration
        self._begin = specialized(begin, work)
        self._rk4_stage = specialized(rk4_stage, 0, h, a, work)
        self._rk4_finish = specialized(rk4_finish, h, a, work)
        self._accelerate = specialized(accelerate, h, a, work)
        self._coast = specialized(coast, h, work)

    def load(self, t: float, tau: Array) -> None:
        """Apply `tau` (nv,), clipped to the effort limits, to the joints from time `t` on."""
        self.tau[:] = tau
        if self._disturbance is not None:
            self._work[DISTURBANCE] = self._disturbance(t)
        self._begin(self._work)

    def hold(self, t: float, dt: float) -> int:
        """Hold the torque that was applied from `t` for `dt` seconds.

        Returns:
            The index of the joint that diverged, or -1.
        """
        if self._substeps == 1:
            return self._advance(t, dt)
        h = dt / self._substeps
        lost = -1
        for k in range(self._substeps):
            lost = self._advance(t + k * h, h)
        return lost

    def _rk4(self, t: float, h: float) -> int:
        model, data, load, disturbance = self._model, self._data, self._load, self._disturbance
        stage, acceleration, work = self._rk4_stage, self._acceleration, self._work
        pin.aba(model, data, self.q, self.v, load)
        if disturbance is not None:
            work[DISTURBANCE] = disturbance(t + 0.5 * h)
        for k in range(3):
            if k == 2 and disturbance is not None:
                work[DISTURBANCE] = disturbance(t + h)
            stage(k, h, acceleration, work)
            if not self._euclidean:
                self._q_stage[:] = pin.integrate(model, self.q, self._step)
            pin.aba(model, data, self._q_stage, self._v_stage, load)
        lost = self._rk4_finish(h, acceleration, work)
        self._move_continuous_joints()
        return lost

    def _semi_implicit(self, t: float, h: float) -> int:
        pin.aba(self._model, self._data, self.q, self.v, self._load)
        if self._disturbance is not None:
            self._work[DISTURBANCE] = self._disturbance(t + h)
        self._accelerate(h, self._acceleration, self._work)
        if self._has_friction:
            inverse_mass = pin.computeMinverse(self._model, self._data, self.q)
            friction, damping = self._arm.friction, self._arm.damping
            apply_friction(h, inverse_mass.T, friction, damping, self._impulse, self.v)
        lost = self._coast(h, self._work)
        self._move_continuous_joints()
        return lost

    def _move_continuous_joints(self) -> None:
        """Move a configuration that is not a plain vector by the workspace's tangent step."""
        if not self._euclidean:
            self.q[:] = pin.integrate(self._model, self.q, self._step)

    def _suitable(self, integrator: str | None, stiffness: Array) -> str:
        """Return the integrator that was asked for, or the one that suits friction and damping."""
        stiff = float(stiffness.max(initial=0.0))
        if integrator is None:
            implicit = stiff > STIFFEST or bool(np.any(self._arm.friction))
            return "semi-implicit" if implicit else "rk4"
        if checks.choice("integrator", integrator, INTEGRATORS) == "rk4" and stiff > STIFFEST:
            joint = self._arm.joint_names[int(stiffness.argmax())]
            needed = math.ceil(self._substeps * stiff / STIFFEST)
            remedy = f"the damping of {joint} wants substeps={needed}, or 'semi-implicit'"
            raise ArgumentError("integrator", integrator, remedy)
        return integrator

    def _lightest(self, q: Array) -> Array:
        """Inertia (nv,) that each joint has at `q` when all others are free."""
        inverse = pin.computeMinverse(self._model, self._data, q)
        lightest: Array = 1.0 / np.diag(inverse)
        return lightest


@kernel
def load(work: Array, v: Array) -> None:
    """What acts on the joints at speed `v`: torque, disturbance and friction."""
    for j in range(v.size):
        friction = work[FRICTION, j]
        if friction > 0.0:
            friction *= math.tanh(v[j] / work[WIDTH, j])
        work[LOAD, j] = work[TAU, j] + work[DISTURBANCE, j] - work[DAMPING, j] * v[j] - friction


@kernel
def begin(work: Array) -> None:
    """Clip the torque to its limits and apply it to the joints."""
    for j in range(work.shape[1]):
        work[TAU, j] = min(max(work[TAU, j], -work[LIMIT, j]), work[LIMIT, j])
    load(work, work[V0])


@kernel
def diverged(work: Array) -> int:
    """Index of the first joint whose speed is not finite or too large, or -1."""
    for j in range(work.shape[1]):
        if not abs(work[V0, j]) < LARGEST_SPEED:
            return j
    return -1


@kernel
def rk4_stage(stage: int, h: float, a: Array, work: Array) -> None:
    """Add the acceleration of `stage` 0, 1 or 2 to the sum; prepare the next stage."""
    reach = h if stage == 2 else 0.5 * h
    weight = 1.0 if stage == 0 else 2.0
    for j in range(a.size):
        v = work[V0, j] if stage == 0 else work[V_STAGE, j]
        work[SUM_V, j] = weight * v + (0.0 if stage == 0 else work[SUM_V, j])
        work[SUM_A, j] = weight * a[j] + (0.0 if stage == 0 else work[SUM_A, j])
        work[STEP, j] = reach * v
        work[V_STAGE, j] = work[V0, j] + reach * a[j]
        work[Q_STAGE, j] = work[Q0, j] + work[STEP, j]
    load(work, work[V_STAGE])


@kernel
def rk4_finish(h: float, a: Array, work: Array) -> int:
    """Add the last stage and move; return the index of a joint that diverged, or -1."""
    for j in range(a.size):
        work[STEP, j] = h / 6.0 * (work[SUM_V, j] + work[V_STAGE, j])
        work[V0, j] += h / 6.0 * (work[SUM_A, j] + a[j])
        work[Q0, j] += work[STEP, j]
    load(work, work[V0])
    return diverged(work)


@kernel
def accelerate(h: float, a: Array, work: Array) -> None:
    """Move the velocity over a step of `h` seconds."""
    for j in range(a.size):
        work[V0, j] += h * a[j]


@kernel
def coast(h: float, work: Array) -> int:
    """Move with the new velocity; return the index of a joint that diverged, or -1."""
    for j in range(work.shape[1]):
        work[STEP, j] = h * work[V0, j]
        work[Q0, j] += work[STEP, j]
    load(work, work[V0])
    return diverged(work)
