"""`RobustFONFTSM`: the fractional terminal law made robust, one set of gains for every arm."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import A_D, ED, LIMIT, TAU, Controller, E, V
from fotsmc_pin.control.gains import Gains, flag, per_joint, scalar
from fotsmc_pin.control.gravity_check import warn_of_gravity
from fotsmc_pin.control.inertia_floor import OBSERVER_RATE, largest_floor, raise_floor
from fotsmc_pin.control.momentum_observer import observe
from fotsmc_pin.control.saturation import integrated, inverse_dynamics, unwound
from fotsmc_pin.control.switching import sig
from fotsmc_pin.fractional import FractionalDerivative, FractionalIntegral
from fotsmc_pin.fractional.advance import advance, commit, predict

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.compiled import Kernel
    from fotsmc_pin.control.gains import Array

LONGEST_TICK_AT_FULL_SPEED = 1.5e-3
"""The default rates suit ticks up to this; longer ones slow them in proportion [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RobustFONFTSMGains(Gains):
    """Gains of `RobustFONFTSM`, all in joint units: none depends on the arm's inertia.

    Attributes:
        alpha: order `α` of the surface and of the integral; with 0 the law is of integer order.
        tempering: `σ`; both operators fade with `e^{-σt}`, so that errors die exponentially and not
            like a power of time. 0 is the paper's.
        A: linear gain of the surface. By default 25, less where `dt` is above 1.5 ms.
        lam: gain `λ` of the terminal term.
        power: `p/q`, between 1 and 2 as the paper's proof demands.
        reach: error `ē` beyond which the surface asks for no more speed, so that a large start
            error takes no large torque.
        theta: gain `Θ` of the reaching law. By default 12, less where `dt` is above 1.5 ms.
        mu: power `μ` of the reaching law.
        integral: rate `b` of the integral that stands in place of a sign; 0 switches it off.
        boundary_layer: `φ`, the distance from the surface at which the integral works hardest.
        observer: bandwidth `K` of the disturbance observer; 0 switches it off. By default 100, less
            where `dt` is above 1.5 ms.
        floor_share: how much inertia is added per disturbance torque; 0 switches the floor off.
        floor_rate: bandwidth `ω_f` of the torque that the added inertia asks for.
        floor_limit: the most that is added. By default `largest_floor` of the arm.
        anti_windup: whether torque limits hold back the law's three memories.
        memory_horizon: time over which the operators' memory is certified [s].
    """

    alpha: float = scalar(0.3, at_least=0.0, below=1.0)
    tempering: float = scalar(10.0, "1/s", at_least=0.0)
    A: Array = per_joint(None, "s^-(1+α)", above=0.0)
    lam: Array = per_joint(2.0, "rad^(1-p/q) s^-(1+α)", at_least=0.0)
    power: float = scalar(1.1, above=1.0, below=2.0)
    reach: Array = per_joint(0.3, "rad", above=0.0)
    theta: Array = per_joint(None, "1/s", above=0.0)
    mu: float = scalar(0.99, above=0.0, below=1.0)
    integral: Array = per_joint(50.0, "rad s^-(3-α)", at_least=0.0)
    boundary_layer: Array = per_joint(0.05, "rad s^-(1+α)", above=0.0)
    observer: Array = per_joint(None, "rad/s", at_least=0.0)
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
        self.gains = g = complete_gains(self.gains, self.arm, self.dt)
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
        # Rows: z, ė_a, y, last v, d, mean of d, δ; and, in the first entry of the last row, whether
        # there was a tick.
        self._state = np.zeros((8, n))
        work = np.zeros((5, n))
        self._signals = {
            "s": work[0],
            "z": self._state[0],
            "disturbance": self._state[4],
            "inertia_floor": self._state[6],
        }
        self._arguments = (
            self._joints,
            self._M0,
            self._h0,
            self._pack(
                g.A, g.lam, g.power, g.reach, g.theta, g.mu, g.integral, g.boundary_layer,
                g.observer, g.floor_share, g.floor_rate, g.floor_limit,
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
    """Return the gains with those filled in that follow from the arm and the period of a tick.

    A loop that acts `1.5 dt` late, by the hold and one tick of delay, bears rates in proportion to
    `1 / dt`: beyond 1.5 ms all rates are slowed by one factor.
    """
    slower = min(1.0, LONGEST_TICK_AT_FULL_SPEED / dt)
    defaults: dict[str, Any] = {
        "A": np.full(arm.nv, 25.0 * slower ** (1.0 + gains.alpha)),
        "theta": np.full(arm.nv, 12.0 * slower),
        "observer": np.full(arm.nv, 100.0 * slower),
        "floor_limit": largest_floor(arm),
    }
    missing = {name for name in defaults if getattr(gains, name) is None}
    return replace(gains, **{name: defaults[name] for name in missing})


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
    e, ed, v, a_d, tau = joints[E], joints[ED], joints[V], joints[A_D], joints[TAU]
    A, lam, r, reach, theta, mu, b, phi, K, share, floor_rate, largest = (
        gains[0], gains[1], gains[2], gains[3], gains[4], gains[5], gains[6], gains[7], gains[8],
        gains[9], gains[10], gains[11],
    )  # fmt: skip
    z, ed_a, y, last_v, d, mean_d, delta, started = (
        state[0], state[1], state[2], state[3], state[4], state[5], state[6], state[7],
    )  # fmt: skip
    S, w, a, u, excess = work[0], work[1], work[2], work[3], work[4]
    n = e.size

    # What the last tick did: the disturbance, and the floor under the inertia that it calls for.
    if started[0] == 0.0:
        started[0] = 1.0
        ed_a[:] = ed
    else:
        observe(dt, M0, h0, v, last_v, tau, OBSERVER_RATE, d)
        raise_floor(dt, e, M0, d, share, largest, mean_d, delta)
    last_v[:] = v

    # S = D^{α,σ} ė + A ς(e) + λ sig(e)^{p/q}
    advance(derivative, derivative_memory, ed, dt, S)
    for i in range(n):
        bend = 1.0 / math.sqrt(1.0 + (e[i] / reach[i]) ** 2)
        S[i] += A[i] * bend * e[i] + lam[i] * sig(e[i], r[i])
        w[i] = (
            theta[i] * (S[i] + sig(S[i], mu[i]))
            + A[i] * bend**3 * ed[i]
            + lam[i] * r[i] * abs(e[i]) ** (r[i] - 1.0) * ed[i]
            + z[i]
        )

    # a = a_d - I^{α,σ} w,   u = a + K (ė_a - ė),   τ = M0 u + δ y + C0 v + G0
    gain = predict(integral, integral_memory, dt, a)
    for i in range(n):
        a[i] = a_d[i] - a[i] - gain * w[i]
        u[i] = a[i] + K[i] * (ed_a[i] - ed[i])
        y[i] += floor_rate[i] * dt / (1.0 + floor_rate[i] * dt) * (u[i] - y[i])
        excess[i] = h0[i] + delta[i] * y[i]
    inverse_dynamics(M0, excess, u, joints[LIMIT], tau, excess)

    # What the actuator cannot follow does not enter the memories.
    for i in range(n):
        unfollowed = excess[i] if anti_windup else 0.0
        inertia = M0[i, i] + delta[i]
        if unfollowed != 0.0:
            w[i] = unwound(w[i], unfollowed, gain * inertia)
        x = S[i] / phi[i]
        z[i] = integrated(z[i], b[i] * x / (1.0 + x * x), dt, unfollowed)
        ed_a[i] += dt * (a[i] - a_d[i] - unfollowed / inertia)
    commit(integral, integral_memory, w, dt)
