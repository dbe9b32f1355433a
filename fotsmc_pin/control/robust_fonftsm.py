"""`RobustFONFTSM`: the fractional terminal law made robust, one set of gains for every arm."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import A_D, ED, LIMIT, TAU, V_D, Controller, E, V
from fotsmc_pin.control.gravity_check import warn_of_gravity
from fotsmc_pin.control.inertia_floor import OBSERVER_RATE, raise_floor
from fotsmc_pin.control.momentum_observer import smooth, unexplained
from fotsmc_pin.control.robust_gains import RobustFONFTSMGains, complete_gains, scaled
from fotsmc_pin.control.rotor_search import search_rotor
from fotsmc_pin.control.saturation import integrated, inverse_dynamics, unwound
from fotsmc_pin.control.standstill import follow_rest, watch_standstill
from fotsmc_pin.control.switching import sig
from fotsmc_pin.fractional import FractionalDerivative, FractionalIntegral
from fotsmc_pin.fractional.advance import advance, commit, predict

if TYPE_CHECKING:
    from fotsmc_pin.compiled import Kernel
    from fotsmc_pin.control.gains import Array

FADING = 5.0
"""Rate at which the second integral is emptied where the reference rests [1/s]."""


class RobustFONFTSM(Controller):
    """Fractional terminal sliding mode control that needs no tuning to the arm.

    Surface, with the tempered Caputo derivative `D^{α,σ}` and `ς(e) = e / √(1 + (e/ē)²)`:

        S = D^{α,σ} ė + A ς(e) + λ sig(ς(e))^{p/q}

    Far away `ė` ends at `(A ē + λ ē^{p/q}) / σ^α`: `ē` follows from the velocity limits.
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

    `J` is what the nominal inertia lacks where a joint oscillates (`rotor_search`); `c` keeps the
    torque continuous while `J` moves. The floor `δ` rises where the momentum observer meets
    friction (`inertia_floor`). Where a torque limit cuts in, the fractional integral, `z` and
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
        # Rows: z, ė_a, y, last v, d, mean of d, δ, ρ, last ė, J, c, and
        # whether there was a tick; then the rows of `watch_standstill` and of `search_rotor`.
        self._state = np.zeros((34, n))
        work = np.zeros((6, n))
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
    S, w, a, u, excess, effort = work[0], work[1], work[2], work[3], work[4], work[5]
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
    for i in range(n):
        effort[i] = u[i] + offset[i] / (M0[i, i] + J[i])
    watch_standstill(dt, e, effort, rest, watch)

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
