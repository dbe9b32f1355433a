"""`TDEFONTSM`: time-delay estimation with a fractional terminal surface (stands for [50])."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Unpack

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import Controller, SignalRows, Streams
from fotsmc_pin.control.functions import clip, sig
from fotsmc_pin.control.gains import DERIVED, Gains, per_joint, scalar
from fotsmc_pin.control.rows import rows
from fotsmc_pin.fractional import FractionalDerivative, FractionalIntegral
from fotsmc_pin.fractional.advance import advance

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.gain_keywords import TDEFONTSMKeywords
    from fotsmc_pin.types import Array


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

    inertia: Array = per_joint(DERIVED, "kg·m²", above=0.0)
    Lambda: Array = per_joint(5.0, "1/s", above=0.0)
    k: Array = per_joint(2.5, "rad^(1-r)/s^(1+α)", at_least=0.0)
    power: float = scalar(0.9, above=0.0, below=1.0)
    alpha: float = scalar(0.5, at_least=0.0, below=1.0)
    K1: Array = per_joint(5.0, "1/s", at_least=0.0)
    K2: Array = per_joint(2.5, "rad^(1-ρ)/s^(2-ρ)", at_least=0.0)
    rho: float = scalar(0.6, above=0.0, below=1.0)
    filter_rate: float = scalar(500.0, "rad/s", above=0.0)

    @classmethod
    def derive(cls, arm: Arm, dt: float, known: Mapping[str, Any]) -> dict[str, Any]:
        """Return the inertia with which the estimate settles."""
        return {"inertia": settling_inertia(arm, 1.0 - math.exp(-known["filter_rate"] * dt))}


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


class State(NamedTuple):
    """What lives on from tick to tick.

    Attributes:
        last_v: velocity of the last tick [rad/s].
        estimate: `τ_f - M̄ a_f` [N·m].
        ticks: how many there were.
    """

    last_v: Array
    estimate: Array
    ticks: Array


class Work(NamedTuple):
    """What one tick fills.

    Attributes:
        s: sliding variable [rad/s].
        terminal: `sig(e)^r`.
        terminal_rate: `D^{1-α} sig(e)^r`.
        terminal_integral: `D^{-α} sig(e)^r`.
    """

    s: Array
    terminal: Array
    terminal_rate: Array
    terminal_integral: Array


def integral(g: TDEFONTSMGains, dt: float) -> FractionalIntegral:
    """Return `D^{-α}`."""
    return FractionalIntegral(order=g.alpha, dt=dt)


def derivative(g: TDEFONTSMGains, dt: float) -> FractionalDerivative:
    """Return `D^{1-α}`."""
    return FractionalDerivative(order=1.0 - g.alpha, dt=dt)


class TDEFONTSM(Controller[TDEFONTSMGains]):
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
    State = State
    Work = Work
    streams: ClassVar[Streams] = {
        "integral": integral,
        "derivative": derivative,
    }
    signal_rows: ClassVar[SignalRows] = {"s": "s", "delay_estimate": "estimate"}
    representative = True
    uses_model = False

    if TYPE_CHECKING:

        def __init__(
            self,
            arm: Arm,
            dt: float,
            *,
            preset: str | None = None,
            **gains: Unpack[TDEFONTSMKeywords],
        ) -> None: ...

    @staticmethod
    @kernel
    def tick(
        dt: float,
        table: Array,
        M0: Array,
        h0: Array,
        integral: Array,
        integral_memory: Array,
        derivative: Array,
        derivative_memory: Array,
    ) -> None:
        """One tick of time-delay estimation; `tau` still holds the torque of the last one."""
        x, g, m, w = rows(table, TDEFONTSMGains, State, Work)
        for i in range(x.e.size):
            w.terminal[i] = sig(x.e[i], g.power)
        advance(integral, integral_memory, w.terminal, dt, w.terminal_integral)
        advance(derivative, derivative_memory, w.terminal, dt, w.terminal_rate)
        for i in range(x.e.size):
            if m.ticks[i] > 0.0:
                fresh = x.tau[i] - g.inertia[i] * (x.v[i] - m.last_v[i]) / dt
                m.estimate[i] += (1.0 - math.exp(-g.filter_rate * dt)) * (fresh - m.estimate[i])
            m.last_v[i] = x.v[i]
            m.ticks[i] += 1.0
            w.s[i] = x.e_dot[i] + g.Lambda[i] * x.e[i] + g.k[i] * w.terminal_integral[i]
            u = (
                x.a_d[i]
                - g.Lambda[i] * x.e_dot[i]
                - g.k[i] * w.terminal_rate[i]
                - g.K1[i] * w.s[i]
                - g.K2[i] * sig(w.s[i], g.rho)
            )
            x.tau[i] = clip(m.estimate[i] + g.inertia[i] * u, x.effort_limit[i])
