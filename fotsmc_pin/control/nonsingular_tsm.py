"""`NonsingularTSM`: the non-singular terminal surface with a switching law."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, NamedTuple, Unpack

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import Controller, SignalRows
from fotsmc_pin.control.functions import SIGN_OR_LAYER, SWITCHING, sig, switch
from fotsmc_pin.control.gains import Gains, option, per_joint, scalar
from fotsmc_pin.control.rows import NoRows, rows
from fotsmc_pin.control.torque_limits import inverse_dynamics

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.gain_keywords import NonsingularTSMKeywords
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class NonsingularTSMGains(Gains):
    """Gains of `NonsingularTSM`. By default its stiffness is that of `LinearSMC`.

    Attributes:
        beta: gain `β` of the surface.
        gamma: power `γ` of the surface.
        K: proportional part of the reaching law.
        eta: switching part of the reaching law.
        switching: stands for `sign(s)`; one of `SWITCHING`.
        boundary_layer: width `φ` of the continuous switching functions.
    """

    beta: Array = per_joint(0.3, "rad^(1-γ) s^γ", above=0.0)
    gamma: float = scalar(1.4, above=1.0, below=2.0)
    K: Array = per_joint(100.0, "1/s²", at_least=0.0)
    eta: Array = per_joint(5.0, "rad/s²", at_least=0.0)
    switching: str = option("sign", SWITCHING)
    boundary_layer: Array = per_joint(0.01, "rad", above=0.0)


class Work(NamedTuple):
    """Sliding variable [rad], commanded acceleration [rad/s²], torque cut off [N·m]."""

    s: Array
    a: Array
    excess: Array


class NonsingularTSM(Controller[NonsingularTSMGains]):
    """Sliding mode on the non-singular terminal surface `s = e + β sig(ė)^γ`, `1 < γ < 2`.

        a = a_d - β^{-1} γ^{-1} sig(ė)^{2-γ} - K s - η sign(s),   τ = M0 a + C0 v + G0

    Signals: "s".

    Source: Feng, Yu and Man, Automatica, 2002.
    """

    Gains = NonsingularTSMGains
    Work = Work
    signal_rows: ClassVar[SignalRows] = {"s": "s"}
    presets = SIGN_OR_LAYER

    if TYPE_CHECKING:

        def __init__(
            self,
            arm: Arm,
            dt: float,
            *,
            preset: str | None = None,
            **gains: Unpack[NonsingularTSMKeywords],
        ) -> None: ...

    @staticmethod
    @kernel
    def tick(dt: float, table: Array, M0: Array, h0: Array) -> None:
        """One tick of sliding mode on the non-singular terminal surface."""
        x, g, _, w = rows(table, NonsingularTSMGains, NoRows, Work)
        for i in range(x.e.size):
            w.s[i] = x.e[i] + g.beta[i] * sig(x.e_dot[i], g.gamma)
            slope = sig(x.e_dot[i], 2.0 - g.gamma) / (g.beta[i] * g.gamma)
            sign = switch(w.s[i], g.switching, g.boundary_layer[i])
            w.a[i] = x.a_d[i] - slope - g.K[i] * w.s[i] - g.eta[i] * sign
        inverse_dynamics(M0, h0, w.a, x.effort_limit, x.tau, w.excess)
