"""`TDEFONTSM`: time-delay estimation with a fractional terminal surface (stands for [50])."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import A_D, ED, LIMIT, TAU, Controller, E, V
from fotsmc_pin.control.gains import Gains, per_joint, scalar
from fotsmc_pin.control.saturation import clip
from fotsmc_pin.control.switching import sig
from fotsmc_pin.fractional import FractionalDerivative, FractionalIntegral
from fotsmc_pin.fractional.advance import advance

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.compiled import Kernel
    from fotsmc_pin.control.gains import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class TDEFONTSMGains(Gains):
    """Gains of `TDEFONTSM`.

    Attributes:
        inertia: constant inertia `M̄`. By default `settling_inertia` of the arm.
        Lambda: linear gain `Λ` of the surface.
        k: gain of the fractional terminal term.
        power: power `r` of the terminal term.
        alpha: order `α` of the terminal term; where `r + α < 1`, `D^{1-α} sig(e)^r` has no bound at
            `e = 0`.
        K1: proportional part of the reaching law.
        K2: fractional-power part of the reaching law.
        rho: power of the reaching law.
        filter_rate: cut-off of the low-pass that the delayed torque and acceleration pass.
    """

    inertia: Array | None = per_joint(None, "kg·m²", above=0.0)
    Lambda: Array = per_joint(5.0, "1/s", above=0.0)
    k: Array = per_joint(2.5, "rad^(1-r)/s^(1+α)", at_least=0.0)
    power: float = scalar(0.9, above=0.0, below=1.0)
    alpha: float = scalar(0.5, at_least=0.0, below=1.0)
    K1: Array = per_joint(5.0, "1/s", at_least=0.0)
    K2: Array = per_joint(2.5, "rad^(1-ρ)/s^(2-ρ)", at_least=0.0)
    rho: float = scalar(0.6, above=0.0, below=1.0)
    filter_rate: float = scalar(500.0, "rad/s", above=0.0)


class TDEFONTSM(Controller):
    """Model-free: what the arm did one tick ago stands for its model. Representative of [50].

    With the surface `s = ė + Λ e + k D^{-α} sig(e)^r`, whose derivative is free of singularities,

        u = a_d - Λ ė - k D^{1-α} sig(e)^r - K1 s - K2 sig(s)^ρ
        τ = τ_f - M̄ a_f + M̄ u

    where `τ_f` and `a_f` are the last torque and the last acceleration, from a backward difference
    of the speed, both through the same low-pass, so that their difference is `M̄ a - τ` of a moment
    ago. No model is evaluated; only `M̄` is needed.

    The estimate starts at zero and errs by the factor `1 - c M0^{-1} M̄` from tick to tick, with
    `c = 1 - e^{-rate dt}`: the loop is stable where all eigenvalues of `c M0^{-1} M̄` lie between 0
    and 2, and it is slow in the directions where they are small, as a diagonal `M̄` makes them on
    arms whose joints are strongly coupled. The arm may sag until the estimate has converged, so the
    gains must stay below the slowest rate of convergence; the default ones are moderate for that.
    On the Panda the default inertia holds the error to a few mrad. On arms with very light wrists
    and high friction it does worse (20 mrad on the z1), and slow oscillations remain in some poses.

    Signals: "s"; "delay_estimate", `τ_f - M̄ a_f`.

    Source: the estimate, Hsia and Gao, IEEE International Conference on Robotics and Automation,
    1990; the rest stands for [50], which is not printed.
    """

    Gains = TDEFONTSMGains
    representative: ClassVar[bool] = True

    def _prepare(self) -> None:
        n = self.arm.nv
        if self.gains.inertia is None:
            share = 1.0 - math.exp(-self.gains.filter_rate * self.dt)
            self.gains = replace(self.gains, inertia=settling_inertia(self.arm, share))
        g = self.gains
        integral = FractionalIntegral(order=g.alpha, dt=self.dt).stream(n)
        derivative = FractionalDerivative(order=1.0 - g.alpha, dt=self.dt).stream(n)
        self._streams = [integral, derivative]
        # Rows: speed of the last tick, filtered estimate, and, in its first entry, whether there
        # was a last tick.
        self._state = np.zeros((3, n))
        work = np.zeros((5, n))
        self._signals = {"s": work[0], "delay_estimate": work[1]}
        self._arguments = (
            self._joints,
            self._pack(g.inertia, g.Lambda, g.k, g.power, g.K1, g.K2, g.rho, g.filter_rate),
            integral.coefficients,
            integral.memory,
            derivative.coefficients,
            derivative.memory,
            self._state,
            work,
        )

    def _model_terms(self) -> None:
        """Evaluate nothing: the law has no model."""

    @property
    def _kernel(self) -> Kernel:
        return control_law


def settling_inertia(arm: Arm, share: float) -> Array:
    """Return the diagonal `M̄` (nv,) [kg·m²] whose estimate settles in one tick where it is fastest.

    `M̄` is in proportion to `1 / diag(M0^{-1})`, the inertia that each joint shows while the others
    are free, at the arm's neutral configuration; the largest eigenvalue of `share M0^{-1} M̄` is 1.
    The true inertia may then fall to half of that before the estimate becomes unstable. In folded
    poses it falls further than that on some arms (2.5 times on the Panda, 6 times on the UR5, over
    random configurations): for work there, give an inertia of your own.

    Args:
        arm: the nominal arm.
        share: how much of a new sample the low-pass lets in at a tick, in (0, 1].
    """
    inverse = np.linalg.inv(arm.mass_matrix(arm.neutral))
    lightest: Array = 1.0 / np.diag(inverse)
    fastest = float(np.linalg.eigvals(inverse * lightest).real.max())
    return lightest / (share * fastest)


@kernel
def control_law(
    dt: float,
    joints: Array,
    gains: Array,
    integral: Array,
    integral_memory: Array,
    derivative: Array,
    derivative_memory: Array,
    state: Array,
    work: Array,
) -> None:
    """One tick of time-delay estimation; `tau` still holds the torque of the last tick."""
    e, ed, v, a_d, tau = joints[E], joints[ED], joints[V], joints[A_D], joints[TAU]
    inertia, Lambda, k, r, K1, K2, rho, rate = (
        gains[0], gains[1], gains[2], gains[3], gains[4], gains[5], gains[6], gains[7],
    )  # fmt: skip
    last_v, estimate, started = state[0], state[1], state[2]
    s, delay_estimate, terminal, terminal_rate, terminal_integral = (
        work[0], work[1], work[2], work[3], work[4],
    )  # fmt: skip
    n = e.size

    for i in range(n):
        terminal[i] = sig(e[i], r[i])
    advance(integral, integral_memory, terminal, dt, terminal_integral)
    advance(derivative, derivative_memory, terminal, dt, terminal_rate)
    for i in range(n):
        if started[0] > 0.0:
            fresh = tau[i] - inertia[i] * (v[i] - last_v[i]) / dt
            estimate[i] += (1.0 - math.exp(-rate[i] * dt)) * (fresh - estimate[i])
        delay_estimate[i] = estimate[i]
        last_v[i] = v[i]
        s[i] = ed[i] + Lambda[i] * e[i] + k[i] * terminal_integral[i]
        u = (
            a_d[i]
            - Lambda[i] * ed[i]
            - k[i] * terminal_rate[i]
            - K1[i] * s[i]
            - K2[i] * sig(s[i], rho[i])
        )
        tau[i] = clip(estimate[i] + inertia[i] * u, joints[LIMIT, i])
    started[0] = 1.0
