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
from fotsmc_pin.control.shared_torque import accelerated
from fotsmc_pin.control.standstill import NEAR, follow_rest, watch_standstill
from fotsmc_pin.control.torque_limits import integrated, inverse_dynamics, unwound
from fotsmc_pin.fractional.advance import advance, commit, predict

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.gain_keywords import RobustFONFTSMKeywords
    from fotsmc_pin.types import Array

FADING = 20.0
"""Rate at which the second integral is emptied where the reference rests [1/s]."""
URGENT = 6e-4
"""Error as on which the integral works at least where a joint sticks off its goal [rad]."""
LASTING = 1.0 / 1500.0
"""Rate over `K` at which what the observer adds becomes a torque that does not turn with `M0`."""
STILLING = 20.0
"""Rate at which the torque that a held joint would get is brought to the one that it has [1/s]."""


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
        ż = (1 - η) b x / (1 + x²) - 20 η z,   x = S/φ,   η = ρ (1 - κ)
        a = a_d - I^{α,σ} w,   ḃ = K (π (a - a_d) - ë) - β b,   u̇ = ȧ + K (π (a - a_d) - ë)

    Without `β`, `b` is `K (ė_a - ė)` with `ë_a = π (a - a_d)`: a disturbance observer of bandwidth
    `K` in units of acceleration, and the loop's first integral. `z` is the second, in place of a
    sign. Two integrals hunt against dry friction and bear less inertia; so `z` is emptied where the
    reference rests (`ρ = 1`), unless the error has been below 10 µrad ever since (`κ = 1`), and at
    once on a joint that sticks. The torque:

        τ = M0 (a + b) + T + C0 v + G0,   Ṫ = β M0 b + J ∘ u̇ + δ ∘ ẏ,   ẏ = ω_f (u - y)

    `J` is what the nominal inertia lacks where a joint oscillates or brakes (`rotor_search`). The
    floor `δ` rises where the momentum observer meets friction (`inertia_floor`). Both multiply
    changes of the command only: while they move themselves, no torque does. What lasts, such as
    weight, is taken over by the torque `T` at the rate `β = K/1500`, and does not turn with the arm
    from then on.

    At rest, a joint that dry friction holds near its goal (`h = 1`) is left in peace
    (`standstill`): its integral stops (`π = 1 - ρ h`) and its torque stays as it was. On one that
    sticks off its goal the integral works as on 0.6 mrad at least. Where a torque limit cuts in,
    the fractional integral, `z` and `b` take in only what was followed. Where another law's
    torque acts too, `b` takes in the acceleration that this adds (`accelerated`).

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
    torque_rows: ClassVar[tuple[str, ...]] = ("T",)

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
        accelerated(M0, x.tau_extra, m, w)
        for i in range(n):
            first = m.ticks[0] == 0.0
            gained = 0.0 if first else w.near_dot[i] - m.last_near_dot[i]
            w.missed[i] = g.observer[i] * (m.step[i] + dt * w.more[i] - gained)
            m.a_e[i] = 0.0 if first else (x.e_dot[i] - m.last_e_dot[i]) / dt
        if m.ticks[0] > 0.0:
            unexplained(dt, M0, h0, m.J, x.v, m.last_v, x.tau, m.lacking)
            smooth(dt, OBSERVER_RATE, m.lacking, m.d)
            raise_floor(dt, w.passing, M0, m.d, g.floor_share, g.floor_limit, m.mean_d, m.delta)
            search_rotor(dt, x, g.rotor_limit, g.rotor_doubt, m)
        for i in range(n):
            m.last_v[i], m.last_e_dot[i], m.last_near_dot[i] = x.v[i], x.e_dot[i], w.near_dot[i]
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

        # a = a_d - I^{α,σ} w,   b = K (ė_a - ė),   τ = M0 (a + b) + T + C0 v + G0
        gain = predict(integral, integral_memory, dt, w.a)
        for i in range(n):
            w.a[i] = w.near_a_d[i] - w.a[i] - gain * w.w[i]
            change = w.a[i] - m.last_a[i] + w.missed[i]
            share = g.floor_rate[i] * dt / (1.0 + g.floor_rate[i] * dt)
            slow = share * (m.fast[i] + change)
            m.fast[i] += change - slow
            m.T[i] += m.J[i] * change + m.delta[i] * slow
            m.last_a[i] = w.a[i]
            m.b[i] += w.missed[i]
            pace = LASTING * g.observer[i] * dt
            w.missed[i] = pace / (1.0 + pace) * m.b[i]
            m.b[i] = clip(m.b[i] - w.missed[i], LARGEST)
            w.u[i] = w.a[i] + m.b[i]
        for i in range(n):
            for j in range(n):
                m.T[i] += M0[i, j] * w.missed[j]
            m.T[i] = clip(m.T[i], LARGEST)
            w.excess[i] = h0[i] + m.T[i]
        inverse_dynamics(M0, w.excess, w.u, x.effort_limit, x.tau, w.excess)
        for i in range(n):
            # A joint that friction holds: its torque stays, whatever noise and its neighbours ask.
            still = m.rest[i] * m.held[i] * (m.smooth_u[i] + h0[i] - x.tau[i])
            m.T[i] += STILLING * dt * still
            x.tau[i] = clip(x.tau[i] + still, x.effort_limit[i])
            w.push[i] = x.tau[i] + w.excess[i] - h0[i]
            w.inertia[i] = M0[i, i] + m.J[i] + m.delta[i]
        watch_standstill(dt, x, w.push, w.inertia, m)

        # What the actuator cannot follow does not enter the memories; nor what friction holds.
        for i in range(n):
            unfollowed = w.excess[i] if g.anti_windup else 0.0
            if unfollowed != 0.0:
                w.w[i] = unwound(w.w[i], unfollowed, gain * w.inertia[i])
            ratio, idle = w.S[i] / g.boundary_layer[i], m.rest[i] * (1.0 - m.kept[i])
            rate = (1.0 - idle) * g.integral[i] * ratio / (1.0 + ratio * ratio)
            rate -= FADING * idle * m.z[i]
            z = integrated(m.z[i], rate, dt, unfollowed)
            m.z[i] = (1.0 - m.rest[i] * m.stuck[i]) * z
            # No more than brings the command back to the limit, or fast loops swing up behind it.
            share = min(1.0, 1.0 / max(g.observer[i] * dt, 1e-9))
            followed = w.a[i] - w.near_a_d[i] - share * (unfollowed / w.inertia[i])
            haste = max(URGENT / max(abs(m.smooth_e[i]), NEAR), 1.0) - 1.0
            pace = m.stuck[i] * haste * (1.0 - m.held[i]) - m.held[i]
            m.step[i] = dt * (1.0 + m.rest[i] * pace) * followed
        commit(integral, integral_memory, w.w, dt)
