"""`LinearSMC`: conventional sliding mode on a linear surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, NamedTuple, Unpack

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import Controller, SignalRows
from fotsmc_pin.control.functions import SIGN_OR_LAYER, SWITCHING, switch
from fotsmc_pin.control.gains import Gains, option, per_joint
from fotsmc_pin.control.rows import NoRows, rows
from fotsmc_pin.control.torque_limits import inverse_dynamics

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.gain_keywords import LinearSMCKeywords
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class LinearSMCGains(Gains):
    """Gains of `LinearSMC`.

    Attributes:
        Lambda: slope `Λ` of the surface.
        K: proportional part of the reaching law.
        eta: switching part of the reaching law.
        switching: stands for `sign(s)`; one of `SWITCHING`.
        boundary_layer: width `φ` of the continuous switching functions.
    """

    Lambda: Array = per_joint(10.0, "1/s", above=0.0)
    K: Array = per_joint(10.0, "1/s", at_least=0.0)
    eta: Array = per_joint(5.0, "rad/s²", at_least=0.0)
    switching: str = option("sign", SWITCHING)
    boundary_layer: Array = per_joint(0.1, "rad/s", above=0.0)


class Work(NamedTuple):
    """Sliding variable [rad/s], commanded acceleration [rad/s²], torque cut off [N·m]."""

    s: Array
    a: Array
    excess: Array


class LinearSMC(Controller[LinearSMCGains]):
    """Sliding mode on `s = ė + Λ e`, with the sign or a boundary layer.

        a = a_d - Λ ė - K s - η sign(s),   τ = M0 a + C0 v + G0

    Signals: "s".

    Source: Slotine and Li, Applied Nonlinear Control, 1991, chapter 7.
    """

    Gains = LinearSMCGains
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
            **gains: Unpack[LinearSMCKeywords],
        ) -> None: ...

    @staticmethod
    @kernel
    def tick(dt: float, table: Array, M0: Array, h0: Array) -> None:
        """One tick of sliding mode on a linear surface."""
        x, g, _, w = rows(table, LinearSMCGains, NoRows, Work)
        for i in range(x.e.size):
            w.s[i] = x.e_dot[i] + g.Lambda[i] * x.e[i]
            sign = switch(w.s[i], g.switching, g.boundary_layer[i])
            w.a[i] = x.a_d[i] - g.Lambda[i] * x.e_dot[i] - g.K[i] * w.s[i] - g.eta[i] * sign
        inverse_dynamics(M0, h0, w.a, x.effort_limit, x.tau, w.excess)
