"""`TerminalSMC`: the singular terminal surface, guarded; it shows why the others exist."""

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
    from fotsmc_pin.control.gain_keywords import TerminalSMCKeywords
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class TerminalSMCGains(Gains):
    """Gains of `TerminalSMC`.

    Attributes:
        beta: gain `β` of the surface.
        power: `q/p` of the surface.
        error_floor: `|e|` is taken as at least this in `|e|^{q/p-1}`, which is infinite at 0.
        K: proportional part of the reaching law.
        eta: switching part of the reaching law.
        switching: stands for `sign(s)`; one of `SWITCHING`.
        boundary_layer: width `φ` of the continuous switching functions.
    """

    beta: Array = per_joint(2.0, "rad^(1-q/p)/s", above=0.0)
    power: float = scalar(0.6, above=0.0, below=1.0)
    error_floor: float = scalar(1e-2, "rad", above=0.0, tuned=False)
    K: Array = per_joint(10.0, "1/s", at_least=0.0)
    eta: Array = per_joint(5.0, "rad/s²", at_least=0.0)
    switching: str = option("sign", SWITCHING)
    boundary_layer: Array = per_joint(0.1, "rad/s", above=0.0)


class Work(NamedTuple):
    """Sliding variable [rad/s], commanded acceleration [rad/s²], torque cut off [N·m]."""

    s: Array
    a: Array
    excess: Array


class TerminalSMC(Controller[TerminalSMCGains]):
    """Sliding mode on the terminal surface `s = ė + β sig(e)^{q/p}`, `0 < q/p < 1`.

        a = a_d - β (q/p) |e|^{q/p-1} ∘ ė - K s - η sign(s),   τ = M0 a + C0 v + G0

    `|e|^{q/p-1}` has no bound at `e = 0`: where the error passes through zero with speed, the law
    asks for infinite torque. The floor on `|e|` only hides that.

    Signals: "s".

    Source: Man, Paplinski and Wu, IEEE Transactions on Automatic Control, 1994.
    """

    Gains = TerminalSMCGains
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
            **gains: Unpack[TerminalSMCKeywords],
        ) -> None: ...

    @staticmethod
    @kernel
    def tick(dt: float, table: Array, M0: Array, h0: Array) -> None:
        """One tick of sliding mode on the terminal surface."""
        x, g, _, w = rows(table, TerminalSMCGains, NoRows, Work)
        for i in range(x.e.size):
            w.s[i] = x.e_dot[i] + g.beta[i] * sig(x.e[i], g.power)
            slope = g.beta[i] * g.power * max(abs(x.e[i]), g.error_floor) ** (g.power - 1.0)
            sign = switch(w.s[i], g.switching, g.boundary_layer[i])
            w.a[i] = x.a_d[i] - slope * x.e_dot[i] - g.K[i] * w.s[i] - g.eta[i] * sign
        inverse_dynamics(M0, h0, w.a, x.effort_limit, x.tau, w.excess)
