"""`RobustFONFTSM`: the fractional terminal law made robust, one set of gains for every arm."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import A_D, ED, LIMIT, TAU, V_D, Controller, E, V
from fotsmc_pin.control.gains import Gains, flag, per_joint, scalar
from fotsmc_pin.control.gravity_check import warn_of_gravity
from fotsmc_pin.control.inertia_floor import OBSERVER_RATE, largest_floor, raise_floor
from fotsmc_pin.control.momentum_observer import smooth, unexplained
from fotsmc_pin.control.rotor_search import largest_rotor, search_rotor
from fotsmc_pin.control.saturation import integrated, inverse_dynamics, unwound
from fotsmc_pin.control.standstill import follow_rest, watch_standstill
from fotsmc_pin.control.switching import sig
from fotsmc_pin.fractional import FractionalDerivative, FractionalIntegral
from fotsmc_pin.fractional.advance import advance, commit, predict

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.compiled import Kernel
    from fotsmc_pin.control.gains import Array

LONGEST_TICK_AT_FULL_SPEED = 1.35e-3
"""The default rates suit ticks up to this; longer ones slow them in proportion [s]."""
APPROACH = 0.9
"""Share of a joint's velocity limit at which a large error is closed."""
WIDEST_REACH = 0.25
"""Reach where no velocity limit asks for less [rad]."""
FADING = 5.0
"""Rate at which the second integral is emptied where the reference rests [1/s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RobustFONFTSMGains(Gains):
    """Gains of `RobustFONFTSM`, all in joint units: none depends on the arm's inertia.

    Attributes:
        bandwidth: one factor on all rates of the loop; less than 1 for elastic joints, noisy
            sensors or slow drives. Where `dt` is above 1.35 ms all rates are slowed in proportion
            besides. The numbers below are those at `bandwidth` 1.
        alpha: order `α` of the surface and of the integral; with 0 the law is of integer order.
        tempering: `σ`; both operators fade with `e^{-σt}`, so that errors die exponentially and not
            like a power of time. 0 is the paper's.
        A: linear gain of the surface.
        lam: gain `λ` of the terminal term.
        power: `p/q`, between 1 and 2 as the paper's proof demands.
        reach: error `ē` beyond which the surface asks for no more speed, so that a large start
            error takes no large torque. By default `reach_of_limits`.
        theta: gain `Θ` of the reaching law.
        mu: power `μ` of the reaching law.
        integral: rate `b` of the integral that stands in place of a sign; 0 switches it off.
        boundary_layer: `φ`, the distance from the surface at which the integral works hardest.
        observer: bandwidth `K` of the disturbance observer; 0 switches it off.
        rotor_limit: bound of the rotor inertia that is found from oscillation; 0 switches the
            search off. By default `largest_rotor` of the arm.
        floor_share: how much inertia is added per disturbance torque; 0 switches the floor off.
        floor_rate: bandwidth `ω_f` of the torque that the added inertia asks for.
        floor_limit: the most that is added. By default `largest_floor` of the arm.
        anti_windup: whether torque limits hold back the law's three memories.
        memory_horizon: time over which the operators' memory is certified [s].
    """

    bandwidth: float = scalar(1.0, above=0.0)
    alpha: float = scalar(0.3, at_least=0.0, below=1.0)
    tempering: float = scalar(14.0, "1/s", at_least=0.0)
    A: Array = per_joint(28.0, "s^-(1+α)", above=0.0)
    lam: Array = per_joint(2.0, "rad^(1-p/q) s^-(1+α)", at_least=0.0)
    power: float = scalar(1.1, above=1.0, below=2.0)
    reach: Array = per_joint(None, "rad", above=0.0)
    theta: Array = per_joint(21.0, "1/s", above=0.0)
    mu: float = scalar(0.99, above=0.0, below=1.0)
    integral: Array = per_joint(50.0, "rad s^-(3+α)", at_least=0.0)
    boundary_layer: Array = per_joint(0.05, "rad s^-(1+α)", above=0.0)
    observer: Array = per_joint(88.0, "rad/s", at_least=0.0)
    rotor_limit: Array = per_joint(None, "kg·m²", at_least=0.0)
    floor_share: Array = per_joint(0.16, "s²/rad", at_least=0.0)
    floor_rate: Array = per_joint(25.0, "rad/s", above=0.0)
    floor_limit: Array = per_joint(None, "kg·m²", at_least=0.0)
    anti_windup: bool = flag(True)
    memory_horizon: float = scalar(1e3, "s", above=0.0, tuned=False)


class RobustFONFTSM(Controller):
    """Fractional terminal sliding mode control that needs no tuning to the arm.

    Surface, with the tempered Caputo derivative `D^{α,σ}` and `ς(e) = e / √(1 + (e/ē)²)`:

        S = D^{α,σ} ė + A ς(e) + λ sig(e)^{p/q}

    The law is a commanded acceleration, with the integral of a bounded function of `S` in place of
    the sign of sliding mode:

        w = Θ S + Θ sig(S)^μ + A ς'(e) ė + λ (p/q) |e|^{p/q-1} ∘ ė + z
        ż = b x / (1 + x²),  x = S/φ
        a = a_d - I^{α,σ} w

    An observer compares the speed error that was commanded, `ė_a`, with the one that came, and asks
    for the acceleration that is missing; a floor `δ` under the inertia, raised where the momentum
    observer meets friction (`inertia_floor`), lends it weight below `ω_f`:

        u = a + K (ė_a - ė),   ë_a = a - a_d,   ẏ = ω_f (u - y),   τ = M0 u + δ ∘ y + C0 v + G0

    `K (ė_a - ė)` is a disturbance observer of bandwidth `K` in units of acceleration. Where a
    torque limit cuts in, the fractional integral, `z` and `ė_a` take in only what was followed.

    Warns:
        GravityWarning: gravity asks the arm for more than its effort limits.

    Signals: "s"; "z"; "disturbance", the momentum observer's torque; "inertia_floor", `δ`.

    Source: the surface and the reaching law are [19] and [21] of Nojavanzadeh and Badamchizadeh,
    IET Control Theory & Applications, 2016; the integral is that of the super-twisting of Levant,
    International Journal of Control, 1993, smoothed.
    """

    Gains = RobustFONFTSMGains

    def _prepare(self) -> None:
        warn_of_gravity(self.arm, stacklevel=3)
        self.gains = complete_gains(self.gains, self.arm, self.dt)
        g = scaled(self.gains, self.dt)
        n = self.arm.nv
        memory: dict[str, Any] = {
            "order": g.alpha,
            "dt": self.dt,
            "horizon": g.memory_horizon,
            "tempering": g.tempering,
        }
        derivative = FractionalDerivative(**memory).stream(n)
        integral = FractionalIntegral(**memory).stream(n)
        self._streams = [derivative, integral]
        # Rows: z, ė_a, y, last v, d, mean of d, δ, ρ, last ė, last a_d, J, c, and
        # whether there was a tick; then the rows of `watch_standstill` and of `search_rotor`.
        self._state = np.zeros((34, n))
        work = np.zeros((5, n))
        self._signals = {
            "s": work[0],
            "z": self._state[0],
            "disturbance": self._state[4],
            "inertia_floor": self._state[6],
            "rest": self._state[7],
            "rotor": self._state[9],
        }
        self._arguments = (
            self._joints,
            self._M0,
            self._h0,
            self._pack(
                g.A, g.lam, g.power, g.reach, g.theta, g.mu, g.integral, g.boundary_layer,
                g.observer, g.floor_share, g.floor_rate, g.floor_limit, g.rotor_limit,
            ),
            g.anti_windup,
            derivative.coefficients,
            derivative.memory,
            integral.coefficients,
            integral.memory,
            self._state,
            work,
        )  # fmt: skip

    @property
    def _kernel(self) -> Kernel:
        return control_law


def complete_gains(gains: RobustFONFTSMGains, arm: Arm, dt: float) -> RobustFONFTSMGains:
    """Return the gains with those filled in that follow from the arm and the period of a tick."""
    defaults: dict[str, Any] = {
        "reach": reach_of_limits(scaled(gains, dt), arm),
        "floor_limit": largest_floor(arm),
        "rotor_limit": largest_rotor(arm),
    }
    missing = {name for name in defaults if getattr(gains, name) is None}
    return replace(gains, **{name: defaults[name] for name in missing})


def reach_of_limits(gains: RobustFONFTSMGains, arm: Arm) -> Array:
    """Return `ē` (nv,) [rad] with which a large error is closed within the velocity limits.

    On the surface, far away, `D^{α,σ} ė = -(A ē + λ ē^{p/q})`, and of a constant speed the tempered
    derivative becomes `σ^α ė`: the speed is `(A ē + λ ē^{p/q}) / σ^α`. As `λ ē^{p/q} ≤ λ ē` for
    `ē ≤ 1 rad`, `ē = 0.9 v_max σ^α / (A + λ)` keeps it below the limit, and 0.25 rad is the most.
    """
    allowed = APPROACH * arm.velocity_limit * gains.tempering**gains.alpha
    reach: Array = np.minimum(allowed / (gains.A + gains.lam), WIDEST_REACH)
    return reach


def scaled(gains: RobustFONFTSMGains, dt: float) -> RobustFONFTSMGains:
    """Return the gains with every rate scaled by `bandwidth`, and slowed for long ticks.

    A loop that acts `1.5 dt` late, by the hold and one tick of delay, bears rates in proportion to
    `1 / dt`: beyond 1.35 ms all are slowed by one factor. With time measured in units of
    `1 / factor` the law stays the same; a gain counts that unit as often as its own unit says.
    """
    factor = gains.bandwidth * min(1.0, LONGEST_TICK_AT_FULL_SPEED / dt)
    surface = factor ** (1.0 + gains.alpha)
    return replace(
        gains,
        tempering=gains.tempering * factor,
        A=gains.A * surface,
        lam=gains.lam * surface,
        theta=gains.theta * factor,
        integral=gains.integral * factor ** (3.0 + gains.alpha),
        boundary_layer=gains.boundary_layer * surface,
        observer=gains.observer * factor,
        floor_rate=gains.floor_rate * factor,
    )


@kernel
def control_law(
    dt: float,
    joints: Array,
    M0: Array,
    h0: Array,
    gains: Array,
    anti_windup: bool,
    derivative: Array,
    derivative_memory: Array,
    integral: Array,
    integral_memory: Array,
    state: Array,
    work: Array,
) -> None:
    """One tick; `tau` still holds the torque of the last one."""
    e, ed, v, v_d, a_d, tau = (
        joints[E], joints[ED], joints[V], joints[V_D], joints[A_D], joints[TAU],
    )  # fmt: skip
    A, lam, r, reach, theta, mu, b, phi, K, share, floor_rate, largest_floor, largest_rotor = (
        gains[0], gains[1], gains[2], gains[3], gains[4], gains[5], gains[6], gains[7], gains[8],
        gains[9], gains[10], gains[11], gains[12],
    )  # fmt: skip
    z, ed_a, y, last_v, d, mean_d, delta, rest, last_ed, J, offset, started = (
        state[0], state[1], state[2], state[3], state[4], state[5], state[6], state[7], state[8],
        state[9], state[10], state[11],
    )  # fmt: skip
    watch, kept, held, probe = state[12:21], state[19], state[20], state[21:32]
    lacking, a_e = state[32], state[33]
    S, w, a, u, excess = work[0], work[1], work[2], work[3], work[4]
    n = e.size

    # What the last tick did: the disturbance, the floor that it calls for, the rotors.
    if started[0] == 0.0:
        started[0] = 1.0
        ed_a[:] = ed
    else:
        unexplained(dt, M0, h0, J, v, last_v, tau, lacking)
        smooth(dt, OBSERVER_RATE, lacking, d)
        raise_floor(dt, e, M0, d, share, largest_floor, mean_d, delta)
        for i in range(n):
            a_e[i] = (ed[i] - last_ed[i]) / dt
            offset[i] += J[i] * y[i]
        search_rotor(dt, e, lacking, a_e, largest_rotor, J, probe)
        for i in range(n):
            offset[i] -= J[i] * y[i]  # The torque stays what it was.
    last_v[:] = v
    last_ed[:] = ed
    follow_rest(dt, v_d, a_d, rest)

    # S = D^{α,σ} ė + A ς(e) + λ sig(ς(e))^{p/q}
    advance(derivative, derivative_memory, ed, dt, S)
    for i in range(n):
        bend = 1.0 / math.sqrt(1.0 + (e[i] / reach[i]) ** 2)
        near = bend * e[i]
        S[i] += A[i] * near + lam[i] * sig(near, r[i])
        w[i] = (
            theta[i] * (S[i] + sig(S[i], mu[i]))
            + (A[i] + lam[i] * r[i] * abs(near) ** (r[i] - 1.0)) * bend**3 * ed[i]
            + z[i]
        )

    # a = a_d - I^{α,σ} w,   u = a + K (ė_a - ė),   τ = (M0 + J) u + δ y + C0 v + G0
    gain = predict(integral, integral_memory, dt, a)
    for i in range(n):
        a[i] = a_d[i] - a[i] - gain * w[i]
        u[i] = a[i] + K[i] * (ed_a[i] - ed[i])
        y[i] += floor_rate[i] * dt / (1.0 + floor_rate[i] * dt) * (u[i] - y[i])
        excess[i] = h0[i] + offset[i] + J[i] * u[i] + delta[i] * y[i]
    inverse_dynamics(M0, excess, u, joints[LIMIT], tau, excess)
    watch_standstill(dt, e, u, rest, watch)

    # What the actuator cannot follow does not enter the memories; nor what friction holds.
    for i in range(n):
        unfollowed = excess[i] if anti_windup else 0.0
        inertia = M0[i, i] + J[i] + delta[i]
        if unfollowed != 0.0:
            w[i] = unwound(w[i], unfollowed, gain * inertia)
        x, idle = S[i] / phi[i], rest[i] * (1.0 - kept[i])
        rate = (1.0 - idle) * b[i] * x / (1.0 + x * x) - FADING * idle * z[i]
        z[i] = integrated(z[i], rate, dt, unfollowed)
        ed_a[i] += dt * (1.0 - rest[i] * held[i]) * (a[i] - a_d[i] - unfollowed / inertia)
    commit(integral, integral_memory, w, dt)
