"""`Plant`: the true arm, integrated under a torque that is held over each tick."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.compiled import specialized
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.simulation import stages
from fotsmc_pin.simulation.end_stops import EndStops
from fotsmc_pin.simulation.implicit_joints import ImplicitJoints
from fotsmc_pin.simulation.stages import (
    DAMPING,
    DISTURBANCE,
    EXCESS,
    FRICTION,
    LIMIT,
    LOAD,
    Q0,
    Q_STAGE,
    ROWS,
    STEP,
    STRIBECK,
    TABLE,
    TAU,
    V0,
    V_STAGE,
    WIDTH,
)
from fotsmc_pin.simulation.wrench import WrenchesOnArm

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.simulation.wrench import Wrench
    from fotsmc_pin.types import Array, Disturbance


INTEGRATORS = ("rk4", "semi-implicit")
FRICTION_WIDTH = 1e-3
"""Speed over which Coulomb friction changes sign, at the least [rad/s, m/s]."""
LOCAL = pin.Convention.LOCAL
"""Faster than the default for a mass matrix alone, and the same to rounding."""
STIFFEST = 1.0
"""Largest `h D / M` of a joint for explicit steps; unstable from 2.8 on, and `M` varies."""


class Plant:
    """Forward dynamics `M a + C v + G + D v + F_c sign(v) = τ + τ_d` of an arm, step by step.

    Torque is held between ticks (zero-order hold); the disturbance is evaluated at every stage
    of the integrator, and wrenches where the arm is in that stage.

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
        wrenches: Sequence[Wrench] = (),
        end_stops: bool = False,
    ) -> None:
        """Put the arm at `q0`, `v0` at time 0.

        Args:
            arm: the true arm.
            q0: configuration (nq,).
            v0: velocity (nv,).
            dt: period of a tick [s].
            substeps: integration steps in a tick.
            integrator: "rk4" (fourth order) or "semi-implicit" (Euler, first order, symplectic;
                friction and springs implicit). By default "rk4", unless the arm has Coulomb
                friction, which sticks in the other only, elastic joints, which only the other
                knows, or damping too strong for explicit steps.
            disturbance: `t -> (nv,)`, torque added at the joints [N·m, N].
            wrenches: forces and torques at frames of the arm.
            end_stops: whether springs and dampers hold the joints within their ranges.

        Raises:
            ArgumentError: naming the argument, its value and the remedy.
            UrdfError: a joint of the arm moves no inertia.
        """
        arm.demand_dynamics()
        self._substeps = checks.count("substeps", substeps)
        self._arm, self._model, self._data = arm, arm.model, arm.model.createData()
        h = dt / self._substeps
        lightest = self._lightest(np.array(q0))
        self.integrator = self._suitable(integrator, h * arm.damping / lightest)
        rk4 = self.integrator == "rk4"
        self._advance = Plant._rk4 if rk4 else Plant._semi_implicit
        self._acceleration: Array = self._data.ddq
        self._wrenches = WrenchesOnArm(arm, wrenches) if wrenches else None
        self._stops = EndStops(arm, lightest, h) if end_stops else None
        self._is_pushed = bool(wrenches) or end_stops
        self._disturbance = disturbance
        self._euclidean = arm.is_euclidean
        self._work = work = np.zeros((ROWS + arm.nv, arm.nv))
        self.v, self.tau = work[V0], work[TAU]
        self._v_stage, self._load, self._step = work[V_STAGE], work[LOAD], work[STEP]
        if self._euclidean:
            self.q, self._q_stage = work[Q0], work[Q_STAGE]
            self.live: tuple[Array, ...] = (work[Q0 : TAU + 1].reshape(-1),)
        else:  # q is not a plain vector, so the kernels' rows for positions are not used.
            self.q, self._q_stage = np.zeros((2, arm.nq))
            self.live = (self.q, self.v, self.tau)
        self.q[:], self.v[:] = q0, v0
        if rk4:
            work[DAMPING], work[FRICTION] = arm.damping, arm.friction
        work[EXCESS], work[STRIBECK] = arm.stiction - 1.0, arm.stribeck_velocity
        work[WIDTH] = np.maximum(FRICTION_WIDTH, arm.friction * arm.stiction * h / lightest)
        work[LIMIT] = arm.effort_limit
        self.joints: ImplicitJoints | None = None
        self._links = self._of_links = None
        self._glide = stages.glide
        if not rk4 and has_friction_or_springs(arm):
            self.joints = joints = ImplicitJoints(arm, self.q, self.v, work[TABLE])
            self._links, self._of_links = joints.model, joints.data
            self._parts = (joints.mass, joints.bias, work)
            self._glide = specialized(stages.glide, h, *self._parts)
            self._advance = Plant._with_friction
        a = self._acceleration
        self._begin = specialized(stages.begin, work)
        self._rk4_stage = specialized(stages.rk4_stage, 0, h, a, work)
        self._rk4_finish = specialized(stages.rk4_finish, h, a, work)
        self._accelerate = specialized(stages.accelerate, h, a, work)
        self._coast = specialized(stages.coast, h, work)

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
            return self._advance(self, t, dt)
        h = dt / self._substeps
        for k in range(self._substeps):
            lost = self._advance(self, t + k * h, h)
            if lost >= 0:
                return lost
        return -1

    @property
    def is_elastic(self) -> bool:
        """Whether any joint has a spring between motor and link."""
        return self.joints is not None and self.joints.is_elastic

    def encoders(self) -> tuple[Array, Array]:
        """Return configuration (nq,) and speed (nv,) of the motors, which lead by the springs."""
        if self.joints is None:
            return self.q, self.v
        deflection = self.joints.deflection
        q = (
            self.q + deflection
            if self._euclidean
            else pin.integrate(self._model, self.q, deflection)
        )
        return q, self.joints.motor_speed

    @property
    def live_signals(self) -> dict[str, Array]:
        """What a recording keeps of end stops and elastic joints, the plant's own memory."""
        shown = {} if self._stops is None else {"end_stop": self._stops.push}
        if self.joints is not None and self.is_elastic:
            shown["deflection"] = self.joints.deflection
            shown["motor_speed"] = self.joints.motor_speed
        return shown

    def stage_times(self, t: float, dt: float) -> list[float]:
        """Return when the disturbance is asked in a tick that starts at `t` [s]."""
        halves = 2 * self._substeps
        return [t + dt * k / halves for k in range(halves + 1)]

    def _rk4(self, t: float, h: float) -> int:
        model, data, load, disturbance = self._model, self._data, self._load, self._disturbance
        stage, acceleration, work = self._rk4_stage, self._acceleration, self._work
        is_pushed = self._is_pushed
        if is_pushed:
            self._push(load, t, self.q, self.v)
        pin.aba(model, data, self.q, self.v, load)
        if disturbance is not None:
            work[DISTURBANCE] = disturbance(t + 0.5 * h)
        for k in range(3):
            if k == 2 and disturbance is not None:
                work[DISTURBANCE] = disturbance(t + h)
            stage(k, h, acceleration, work)
            if not self._euclidean:
                self._q_stage[:] = pin.integrate(model, self.q, self._step)
            if is_pushed:
                moment = t + (h if k == 2 else 0.5 * h)
                self._push(load, moment, self._q_stage, self._v_stage)
            pin.aba(model, data, self._q_stage, self._v_stage, load)
        lost = self._rk4_finish(h, acceleration, work)
        self._move_continuous_joints()
        return lost

    def _semi_implicit(self, t: float, h: float) -> int:
        if self._is_pushed:
            self._push(self._load, t, self.q, self.v)
        pin.aba(self._model, self._data, self.q, self.v, self._load)
        if self._disturbance is not None:
            self._work[DISTURBANCE] = self._disturbance(t + h)
        self._accelerate(h, self._acceleration, self._work)
        lost = self._coast(h, self._work)
        self._move_continuous_joints()
        return lost

    def _with_friction(self, t: float, h: float) -> int:
        if self._is_pushed:
            self._push(self._work[DISTURBANCE], t, self.q, self.v)
        pin.crba(self._links, self._of_links, self.q, LOCAL)
        pin.nonLinearEffects(self._links, self._of_links, self.q, self.v)
        lost = self._glide(h, *self._parts)
        if self._disturbance is not None:
            self._work[DISTURBANCE] = self._disturbance(t + h)
        elif self._is_pushed:
            self._work[DISTURBANCE] = 0.0
        self._move_continuous_joints()
        return lost

    def _push(self, load: Array, t: float, q: Array, v: Array) -> None:
        """Add to `load` (nv,) what wrenches and end stops do."""
        if self._wrenches is not None:
            self._wrenches.add_to(load, t, q)
        if self._stops is not None:
            self._stops.add_to(load, q, v)

    def _move_continuous_joints(self) -> None:
        """Move a configuration that is not a plain vector by the workspace's tangent step."""
        if not self._euclidean:
            self.q[:] = pin.integrate(self._model, self.q, self._step)

    def _suitable(self, integrator: str | None, stiffness: Array) -> str:
        """Return the integrator that was asked for, or the one that suits friction and damping."""
        stiff = float(stiffness.max(initial=0.0))
        elastic = bool(np.isfinite(self._arm.joint_stiffness).any())
        if integrator is None:
            implicit = elastic or stiff > STIFFEST or bool(np.any(self._arm.friction))
            return "semi-implicit" if implicit else "rk4"
        if elastic and integrator == "rk4":
            raise ArgumentError(
                "integrator", integrator, "the springs of elastic joints want 'semi-implicit'"
            )
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


def has_friction_or_springs(arm: Arm) -> bool:
    """Return whether an arm has more in its joints than torque."""
    elastic = np.isfinite(arm.joint_stiffness)
    return bool(np.any(arm.friction) or np.any(arm.damping) or np.any(elastic))
