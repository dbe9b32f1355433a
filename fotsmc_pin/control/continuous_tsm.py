"""`ContinuousTSM`: the integer-order terminal controller that the paper compares with, [45]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, NamedTuple, Unpack

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import Controller, SignalRows
from fotsmc_pin.control.functions import sig
from fotsmc_pin.control.gains import Gains, per_joint, scalar
from fotsmc_pin.control.rows import NoRows, rows
from fotsmc_pin.control.torque_limits import inverse_dynamics

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.gain_keywords import ContinuousTSMKeywords
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class ContinuousTSMGains(Gains):
    """Gains of `ContinuousTSM`. By default its stiffness is that of `LinearSMC`.

    Attributes:
        beta: gain `β` of the surface.
        gamma: power `γ` of the surface.
        K1: proportional part of the reaching law.
        K2: fractional-power part of the reaching law.
        rho: power `ρ` of the reaching law.
    """

    beta: Array = per_joint(0.3, "rad^(1-γ) s^γ", above=0.0)
    gamma: float = scalar(1.4, above=1.0, below=2.0)
    K1: Array = per_joint(100.0, "1/s²", at_least=0.0)
    K2: Array = per_joint(20.0, "rad^(1-ρ)/s²", at_least=0.0)
    rho: float = scalar(0.6, above=0.0, below=1.0)


class Work(NamedTuple):
    """Sliding variable [rad], commanded acceleration [rad/s²], torque cut off [N·m]."""

    s: Array
    a: Array
    excess: Array


class ContinuousTSM(Controller[ContinuousTSMGains]):
    """Continuous terminal sliding mode on `s = e + β sig(ė)^γ`, `1 < γ < 2`, [45].

        τ = C0 v + G0 + M0 a_d - M0 β^{-1} γ^{-1} sig(ė)^{2-γ} - M0 (K1 s + K2 sig(s)^ρ)

    Signals: "s".

    Source: Yu, Yu, Shirinzadeh and Man, Automatica, 2005.
    """

    Gains = ContinuousTSMGains
    Work = Work
    signal_rows: ClassVar[SignalRows] = {"s": "s"}

    if TYPE_CHECKING:

        def __init__(
            self,
            arm: Arm,
            dt: float,
            *,
            preset: str | None = None,
            **gains: Unpack[ContinuousTSMKeywords],
        ) -> None: ...

    @staticmethod
    @kernel
    def tick(dt: float, table: Array, M0: Array, h0: Array) -> None:
        """One tick of [45]."""
        x, g, _, w = rows(table, ContinuousTSMGains, NoRows, Work)
        for i in range(x.e.size):
            w.s[i] = x.e[i] + g.beta[i] * sig(x.e_dot[i], g.gamma)
            w.a[i] = (
                x.a_d[i]
                - sig(x.e_dot[i], 2.0 - g.gamma) / (g.beta[i] * g.gamma)
                - g.K1[i] * w.s[i]
                - g.K2[i] * sig(w.s[i], g.rho)
            )
        inverse_dynamics(M0, h0, w.a, x.effort_limit, x.tau, w.excess)
