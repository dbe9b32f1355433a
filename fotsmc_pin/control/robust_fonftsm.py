"""`RobustFONFTSM`: the fractional terminal law made robust, one set of gains for every arm."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Unpack

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import Controller, SignalRows, Streams
from fotsmc_pin.control.functions import sig
from fotsmc_pin.control.gains import DERIVED, Gains, flag, per_joint, scalar
from fotsmc_pin.control.inertia_floor import OBSERVER_RATE, largest_floor, raise_floor
from fotsmc_pin.control.momentum_observer import observe
from fotsmc_pin.control.rows import rows
from fotsmc_pin.control.torque_limits import integrated, inverse_dynamics, unwound
from fotsmc_pin.fractional import FractionalDerivative, FractionalIntegral
from fotsmc_pin.fractional.advance import advance, commit, predict

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.gain_keywords import RobustFONFTSMKeywords
    from fotsmc_pin.types import Array

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
    A: Array = per_joint(DERIVED, "s^-(1+α)", above=0.0)
    lam: Array = per_joint(2.0, "rad^(1-p/q) s^-(1+α)", at_least=0.0)
    power: float = scalar(1.1, above=1.0, below=2.0)
    reach: Array = per_joint(0.3, "rad", above=0.0)
    theta: Array = per_joint(DERIVED, "1/s", above=0.0)
    mu: float = scalar(0.99, above=0.0, below=1.0)
    integral: Array = per_joint(50.0, "rad s^-(3-α)", at_least=0.0)
    boundary_layer: Array = per_joint(0.05, "rad s^-(1+α)", above=0.0)
    observer: Array = per_joint(DERIVED, "rad/s", at_least=0.0)
    floor_share: Array = per_joint(0.16, "s²/rad", at_least=0.0)
    floor_rate: Array = per_joint(25.0, "rad/s", above=0.0)
    floor_limit: Array = per_joint(DERIVED, "kg·m²", at_least=0.0, unlimited=True)
    anti_windup: bool = flag(True)
    memory_horizon: float = scalar(1e3, "s", above=0.0, tuned=False)

    @classmethod
    def derive(cls, arm: Arm, dt: float, known: Mapping[str, Any]) -> dict[str, Any]:
        """Return the rates that the tick bears and the floor that the motors bear.

        A loop that acts `1.5 dt` late, by the hold and one tick of delay, bears rates in proportion
        to `1 / dt`: beyond 1.5 ms all rates are slowed by one factor.
        """
        slower = min(1.0, LONGEST_TICK_AT_FULL_SPEED / dt)
        return {
            "A": np.full(arm.nv, 25.0 * slower ** (1.0 + known["alpha"])),
            "theta": np.full(arm.nv, 12.0 * slower),
            "observer": np.full(arm.nv, 100.0 * slower),
            "floor_limit": largest_floor(arm),
        }


class State(NamedTuple):
    """What lives on from tick to tick.

    Attributes:
        z: integral in place of the sign [rad s^-(2-α)].
        e_dot_a: speed error `ė_a` that was commanded [rad/s].
        y: commanded acceleration below `ω_f` [rad/s²].
        last_v: velocity of the last tick [rad/s].
        d: disturbance that the momentum observer sees [N·m].
        mean_d: lasting part of it [N·m].
        delta: floor `δ` under the inertia [kg·m²].
        ticks: how many there were.
    """

    z: Array
    e_dot_a: Array
    y: Array
    last_v: Array
    d: Array
    mean_d: Array
    delta: Array
    ticks: Array


class Work(NamedTuple):
    """What one tick fills.

    Attributes:
        S: sliding variable [rad s^-(1+α)].
        w: integrand of the fractional integral.
        a: commanded acceleration [rad/s²].
        u: acceleration that is asked for, with what is missing [rad/s²].
        excess: torque beside `M0 u`; then what was cut off [N·m].
    """

    S: Array
    w: Array
    a: Array
    u: Array
    excess: Array


def derivative(g: RobustFONFTSMGains, dt: float) -> FractionalDerivative:
    """Return `D^{α,σ}`."""
    return FractionalDerivative(
        order=g.alpha, dt=dt, horizon=g.memory_horizon, tempering=g.tempering
    )


def integral(g: RobustFONFTSMGains, dt: float) -> FractionalIntegral:
    """Return `I^{α,σ}`."""
    return FractionalIntegral(order=g.alpha, dt=dt, horizon=g.memory_horizon, tempering=g.tempering)


class RobustFONFTSM(Controller[RobustFONFTSMGains]):
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
    State = State
    Work = Work
    streams: ClassVar[Streams] = {
        "derivative": derivative,
        "integral": integral,
    }
    signal_rows: ClassVar[SignalRows] = {
        "s": "S",
        "z": "z",
        "disturbance": "d",
        "inertia_floor": "delta",
    }

    if TYPE_CHECKING:

        def __init__(
            self,
            arm: Arm,
            dt: float,
            *,
            preset: str | None = None,
            **gains: Unpack[RobustFONFTSMKeywords],
        ) -> None: ...

    @staticmethod
    @kernel
    def tick(
        dt: float,
        table: Array,
        M0: Array,
        h0: Array,
        derivative: Array,
        derivative_memory: Array,
        integral: Array,
        integral_memory: Array,
    ) -> None:
        """One tick; `tau` still holds the torque of the last one."""
        x, g, m, w = rows(table, RobustFONFTSMGains, State, Work)
        n = x.e.size

        # What the last tick did: the disturbance, and the floor under the inertia it calls for.
        if m.ticks[0] == 0.0:
            for i in range(n):
                m.e_dot_a[i] = x.e_dot[i]
        else:
            observe(dt, M0, h0, x.v, m.last_v, x.tau, OBSERVER_RATE, m.d)
            raise_floor(dt, x.e, M0, m.d, g.floor_share, g.floor_limit, m.mean_d, m.delta)
        for i in range(n):
            m.last_v[i] = x.v[i]
            m.ticks[i] += 1.0

        # S = D^{α,σ} ė + A ς(e) + λ sig(e)^{p/q}
        advance(derivative, derivative_memory, x.e_dot, dt, w.S)
        for i in range(n):
            bend = 1.0 / math.sqrt(1.0 + (x.e[i] / g.reach[i]) ** 2)
            w.S[i] += g.A[i] * bend * x.e[i] + g.lam[i] * sig(x.e[i], g.power)
            w.w[i] = (
                g.theta[i] * (w.S[i] + sig(w.S[i], g.mu))
                + g.A[i] * bend**3 * x.e_dot[i]
                + g.lam[i] * g.power * abs(x.e[i]) ** (g.power - 1.0) * x.e_dot[i]
                + m.z[i]
            )

        # a = a_d - I^{α,σ} w,   u = a + K (ė_a - ė),   τ = M0 u + δ y + C0 v + G0
        gain = predict(integral, integral_memory, dt, w.a)
        for i in range(n):
            w.a[i] = x.a_d[i] - w.a[i] - gain * w.w[i]
            w.u[i] = w.a[i] + g.observer[i] * (m.e_dot_a[i] - x.e_dot[i])
            share = g.floor_rate[i] * dt / (1.0 + g.floor_rate[i] * dt)
            m.y[i] += share * (w.u[i] - m.y[i])
            w.excess[i] = h0[i] + m.delta[i] * m.y[i]
        inverse_dynamics(M0, w.excess, w.u, x.effort_limit, x.tau, w.excess)

        # What the actuator cannot follow does not enter the memories.
        for i in range(n):
            unfollowed = w.excess[i] if g.anti_windup else 0.0
            inertia = M0[i, i] + m.delta[i]
            if unfollowed != 0.0:
                w.w[i] = unwound(w.w[i], unfollowed, gain * inertia)
            ratio = w.S[i] / g.boundary_layer[i]
            rate = g.integral[i] * ratio / (1.0 + ratio * ratio)
            m.z[i] = integrated(m.z[i], rate, dt, unfollowed)
            m.e_dot_a[i] += dt * (w.a[i] - x.a_d[i] - unfollowed / inertia)
        commit(integral, integral_memory, w.w, dt)
