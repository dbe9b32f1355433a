"""`SuperTwistingSMC`: second-order sliding mode on a linear surface (representative of [49])."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, NamedTuple, Unpack

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import Controller, SignalRows
from fotsmc_pin.control.functions import SIGN_OR_LAYER, SWITCHING, sig, switch
from fotsmc_pin.control.gains import Gains, option, per_joint
from fotsmc_pin.control.rows import rows
from fotsmc_pin.control.torque_limits import integrated, inverse_dynamics

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.gain_keywords import SuperTwistingSMCKeywords
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class SuperTwistingSMCGains(Gains):
    """Gains of `SuperTwistingSMC`.

    Attributes:
        Lambda: slope `Λ` of the surface.
        k1: gain of the square root.
        k2: gain of the integrated sign.
        switching: stands for `sign(s)` under the integral; one of `SWITCHING`.
        boundary_layer: width `φ` of the continuous switching functions.
    """

    Lambda: Array = per_joint(10.0, "1/s", above=0.0)
    k1: Array = per_joint(10.0, "rad^½/s^(3/2)", at_least=0.0)
    k2: Array = per_joint(20.0, "rad/s³", at_least=0.0)
    switching: str = option("sign", SWITCHING)
    boundary_layer: Array = per_joint(0.1, "rad/s", above=0.0)


class State(NamedTuple):
    """Integral of the switching function [rad/s²]."""

    z: Array


class Work(NamedTuple):
    """Sliding variable [rad/s], commanded acceleration [rad/s²], torque cut off [N·m]."""

    s: Array
    a: Array
    excess: Array


class SuperTwistingSMC(Controller[SuperTwistingSMCGains]):
    """Super-twisting on `s = ė + Λ e`; representative: the law of [49] is not printed in the paper.

        a = a_d - Λ ė - k1 sig(s)^{1/2} - z,   dz/dt = k2 sign(s),   τ = M0 a + C0 v + G0

    Signals: "s"; "z", the integral, at rest while it would push a clipped torque further.

    Source: Levant, International Journal of Control, 1993.
    """

    Gains = SuperTwistingSMCGains
    State = State
    Work = Work
    signal_rows: ClassVar[SignalRows] = {"s": "s", "z": "z"}
    presets = SIGN_OR_LAYER
    representative = True

    if TYPE_CHECKING:

        def __init__(
            self,
            arm: Arm,
            dt: float,
            *,
            preset: str | None = None,
            **gains: Unpack[SuperTwistingSMCKeywords],
        ) -> None: ...

    @staticmethod
    @kernel
    def tick(dt: float, table: Array, M0: Array, h0: Array) -> None:
        """One tick of super-twisting."""
        x, g, m, w = rows(table, SuperTwistingSMCGains, State, Work)
        for i in range(x.e.size):
            w.s[i] = x.e_dot[i] + g.Lambda[i] * x.e[i]
            w.a[i] = x.a_d[i] - g.Lambda[i] * x.e_dot[i] - g.k1[i] * sig(w.s[i], 0.5) - m.z[i]
        inverse_dynamics(M0, h0, w.a, x.effort_limit, x.tau, w.excess)
        for i in range(x.e.size):
            sign = switch(w.s[i], g.switching, g.boundary_layer[i])
            m.z[i] = integrated(m.z[i], g.k2[i] * sign, dt, w.excess[i])
