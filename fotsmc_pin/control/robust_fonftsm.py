"""`RobustFONFTSM`: the fractional terminal law made robust, one set of gains for every arm."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar, Unpack

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.approach import lead
from fotsmc_pin.control.arguments import LARGEST
from fotsmc_pin.control.controller import Controller, SignalRows, Streams
from fotsmc_pin.control.fractional_surface import derivative, integral
from fotsmc_pin.control.functions import clip, sig
from fotsmc_pin.control.inertia_floor import OBSERVER_RATE, raise_floor
from fotsmc_pin.control.momentum_observer import smooth, unexplained
from fotsmc_pin.control.robust_gains import RobustFONFTSMGains, scaled
from fotsmc_pin.control.robust_rows import State, Work
from fotsmc_pin.control.rotor_search import search_rotor
from fotsmc_pin.control.rows import rows
from fotsmc_pin.control.standstill import follow_rest, watch_standstill
from fotsmc_pin.control.torque_limits import integrated, inverse_dynamics, unwound
from fotsmc_pin.fractional.advance import advance, commit, predict

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.gain_keywords import RobustFONFTSMKeywords
    from fotsmc_pin.types import Array

FADING = 5.0
"""Rate at which the second integral is emptied where the reference rests [1/s]."""


class RobustFONFTSM(Controller[RobustFONFTSMGains]):
    """Fractional terminal sliding mode control that needs no tuning to the arm.

    Surface, with the tempered Caputo derivative `D^{α,σ}` and `ς(e) = e / √(1 + (e/ē)²)`:

        S = D^{α,σ} ė + A ς(e) + λ sig(ς(e))^{p/q}

    Far away `ė` ends at `(A ē + λ ē^{p/q}) / σ^α`: `ē` follows from the velocity limits. Beyond
    `v_a / 100 s`, with 0.8 of them as `v_a`, the rest of the error is a way `e_g` on which a point
    leads the joint home and waits for it (`approach`): `e`, `ė` and `a_d` below are those to that
    point, so that nothing winds up on the way, whatever friction and inertia the joint has.
    The law is a commanded acceleration:

        w = Θ S + Θ sig(S)^μ + (A + λ (p/q) |ς|^{p/q-1}) ς'(e) ė + z
        ż = (1 - η) b x / (1 + x²) - 5 η z,   x = S/φ,   η = ρ (1 - κ)
        a = a_d - I^{α,σ} w,   ë_a = (1 - ρ h) (a - a_d),   u = a + K (ė_a - ė)

    `K (ė_a - ė)` is a disturbance observer of bandwidth `K` in units of acceleration, and the
    loop's first integral. `z` is the second, in place of a sign. Two integrals hunt against dry
    friction and bear less inertia; so `z` is emptied where the reference rests (`ρ = 1`), unless
    the error has been below 10 µrad ever since (`κ = 1`). A joint that dry friction holds near its
    goal (`h = 1`) is left in peace (`standstill`). The torque:

        τ = (M0 + J) u + δ ∘ y + c + C0 v + G0,   ẏ = ω_f (u - y),   ċ = -J̇ ∘ y

    `J` is what the nominal inertia lacks where a joint oscillates or brakes (`rotor_search`); `c`
    keeps the torque continuous while `J` moves. The floor `δ` rises where the momentum observer
    meets friction (`inertia_floor`). Where a torque limit cuts in, the fractional integral, `z` and
    `ė_a` take in only what was followed.

    With `J = 0` the loop bears true inertias from 0.136 to 4.97 times the nominal one in motion
    and to 12.6 times at rest (1 kHz, one tick of delay; `fotsmc_pin.analysis.margins`). Above, a
    joint oscillates for about a second until `J` is found; below, it is lost.

    Warns:
        GravityWarning: gravity asks the arm for more than its effort limits.

    Signals: "s"; "z"; "disturbance", the torque that the model does not explain, low-passed;
    "inertia_floor", `δ`; "rest", `ρ`; "rotor", `J`.

    Source: the surface and the reaching law are [19] and [21] of Nojavanzadeh and Badamchizadeh,
    IET Control Theory & Applications, 2016; the integral is that of the super-twisting of Levant,
    International Journal of Control, 1993, smoothed.
    """

    Gains = RobustFONFTSMGains
    State = State
    Work = Work
    streams: ClassVar[Streams] = {"derivative": derivative, "integral": integral}
    signal_rows: ClassVar[SignalRows] = {
        "s": "S",
        "z": "z",
        "disturbance": "d",
        "inertia_floor": "delta",
        "rest": "rest",
        "rotor": "J",
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

    def effective_gains(self) -> RobustFONFTSMGains:
        """Return the gains with every rate scaled by `bandwidth` and slowed for long ticks."""
        return scaled(self.gains, self.dt)

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
        lead(dt, x, M0, h0, g.approach, g.approach_rate, m, w)

        # What the last tick did: the disturbance, the floor that it calls for, the rotors.
        if m.ticks[0] == 0.0:
            for i in range(n):
                m.e_dot_a[i] = w.near_dot[i]
        else:
            unexplained(dt, M0, h0, m.J, x.v, m.last_v, x.tau, m.lacking)
            smooth(dt, OBSERVER_RATE, m.lacking, m.d)
            raise_floor(dt, w.passing, M0, m.d, g.floor_share, g.floor_limit, m.mean_d, m.delta)
            for i in range(n):
                m.a_e[i] = (x.e_dot[i] - m.last_e_dot[i]) / dt
                m.c[i] += m.J[i] * m.y[i]
            search_rotor(dt, x, g.rotor_limit, g.rotor_doubt, m)
            for i in range(n):
                m.c[i] -= m.J[i] * m.y[i]  # The torque stays what it was.
        for i in range(n):
            m.last_v[i], m.last_e_dot[i] = x.v[i], x.e_dot[i]
            m.ticks[i] += 1.0
        follow_rest(dt, x, m.rest)

        # S = D^{α,σ} ė + A ς(e) + λ sig(ς(e))^{p/q}
        advance(derivative, derivative_memory, w.near_dot, dt, w.S)
        for i in range(n):
            bend = 1.0 / math.sqrt(1.0 + (w.near[i] / g.reach[i]) ** 2)
            bent = bend * w.near[i]
            w.S[i] += g.A[i] * bent + g.lam[i] * sig(bent, g.power)
            slope = g.A[i] + g.lam[i] * g.power * abs(bent) ** (g.power - 1.0)
            w.w[i] = (
                g.theta[i] * (w.S[i] + sig(w.S[i], g.mu)) + slope * bend**3 * w.near_dot[i] + m.z[i]
            )

        # a = a_d - I^{α,σ} w,   u = a + K (ė_a - ė),   τ = (M0 + J) u + δ y + c + C0 v + G0
        gain = predict(integral, integral_memory, dt, w.a)
        for i in range(n):
            w.a[i] = w.near_a_d[i] - w.a[i] - gain * w.w[i]
            w.u[i] = w.a[i] + g.observer[i] * (m.e_dot_a[i] - w.near_dot[i])
            share = g.floor_rate[i] * dt / (1.0 + g.floor_rate[i] * dt)
            m.y[i] += share * (w.u[i] - m.y[i])
            w.excess[i] = h0[i] + m.c[i] + m.J[i] * w.u[i] + m.delta[i] * m.y[i]
        inverse_dynamics(M0, w.excess, w.u, x.effort_limit, x.tau, w.excess)
        for i in range(n):
            w.push[i] = (x.tau[i] + w.excess[i] - h0[i]) / (M0[i, i] + m.J[i] + m.delta[i])
        watch_standstill(dt, x, w.push, m)

        # What the actuator cannot follow does not enter the memories; nor what friction holds.
        for i in range(n):
            unfollowed = w.excess[i] if g.anti_windup else 0.0
            inertia = M0[i, i] + m.J[i] + m.delta[i]
            if unfollowed != 0.0:
                w.w[i] = unwound(w.w[i], unfollowed, gain * inertia)
            ratio, idle = w.S[i] / g.boundary_layer[i], m.rest[i] * (1.0 - m.kept[i])
            rate = (1.0 - idle) * g.integral[i] * ratio / (1.0 + ratio * ratio)
            rate -= FADING * idle * m.z[i]
            m.z[i] = integrated(m.z[i], rate, dt, unfollowed)
            # No more than brings the command back to the limit, or fast loops swing up behind it.
            share = min(1.0, 1.0 / max(g.observer[i] * dt, 1e-9))
            followed = w.a[i] - w.near_a_d[i] - share * (unfollowed / inertia)
            step = dt * (1.0 - m.rest[i] * m.held[i]) * followed
            m.e_dot_a[i] = clip(m.e_dot_a[i] + step, LARGEST)
        commit(integral, integral_memory, w.w, dt)
