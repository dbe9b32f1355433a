"""`FractionalSwitchingSMC`: the sign passes through a fractional integral (stands for [34])."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, NamedTuple, Unpack

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import Controller, SignalRows, Streams
from fotsmc_pin.control.functions import SIGN_OR_LAYER, SWITCHING, switch
from fotsmc_pin.control.gains import Gains, option, per_joint, scalar
from fotsmc_pin.control.rows import NoRows, rows
from fotsmc_pin.control.torque_limits import inverse_dynamics, unwound
from fotsmc_pin.fractional import FractionalIntegral
from fotsmc_pin.fractional.advance import commit, predict

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.gain_keywords import FractionalSwitchingSMCKeywords
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class FractionalSwitchingSMCGains(Gains):
    """Gains of `FractionalSwitchingSMC`.

    Attributes:
        Lambda: slope `Λ` of the surface.
        K: proportional part of the reaching law.
        eta: switching part of the reaching law.
        alpha: order `α` of the integral of the sign.
        tempering: `σ` of the integral's memory; 0 is the pure operator.
        switching: stands for `sign(s)`; one of `SWITCHING`.
        boundary_layer: width `φ` of the continuous switching functions.
    """

    Lambda: Array = per_joint(10.0, "1/s", above=0.0)
    K: Array = per_joint(10.0, "1/s", at_least=0.0)
    eta: Array = per_joint(10.0, "rad/s^(2+α)", at_least=0.0)
    alpha: float = scalar(0.5, at_least=0.0, below=1.0)
    tempering: float = scalar(0.0, "1/s", at_least=0.0)
    switching: str = option("sign", SWITCHING)
    boundary_layer: Array = per_joint(0.1, "rad/s", above=0.0)


class Work(NamedTuple):
    """What one tick fills.

    Attributes:
        s: sliding variable [rad/s].
        switched: `D^{-α} sign(s)` [s^α].
        sign: the switching function.
        a: commanded acceleration [rad/s²].
        excess: torque cut off [N·m].
    """

    s: Array
    switched: Array
    sign: Array
    a: Array
    excess: Array


def integral(g: FractionalSwitchingSMCGains, dt: float) -> FractionalIntegral:
    """Return `D^{-α,σ}`."""
    return FractionalIntegral(order=g.alpha, dt=dt, tempering=g.tempering)


class FractionalSwitchingSMC(Controller[FractionalSwitchingSMCGains]):
    """Sliding mode whose sign passes through `D^{-α}`; representative: [34] is not printed.

        a = a_d - Λ ė - K s - η D^{-α} sign(s),   τ = M0 a + C0 v + G0,   s = ė + Λ e

    Signals: "s"; "switched", `D^{-α} sign(s)`. What a clipped torque cannot follow does not enter
    the memory of `D^{-α}`.
    """

    Gains = FractionalSwitchingSMCGains
    Work = Work
    streams: ClassVar[Streams] = {"integral": integral}
    signal_rows: ClassVar[SignalRows] = {"s": "s", "switched": "switched"}
    presets = SIGN_OR_LAYER
    representative = True

    if TYPE_CHECKING:

        def __init__(
            self,
            arm: Arm,
            dt: float,
            *,
            preset: str | None = None,
            **gains: Unpack[FractionalSwitchingSMCKeywords],
        ) -> None: ...

    @staticmethod
    @kernel
    def tick(
        dt: float, table: Array, M0: Array, h0: Array, integral: Array, integral_memory: Array
    ) -> None:
        """One tick of sliding mode with a fractional switching term."""
        x, g, _, w = rows(table, FractionalSwitchingSMCGains, NoRows, Work)
        gain = predict(integral, integral_memory, dt, w.switched)
        for i in range(x.e.size):
            w.s[i] = x.e_dot[i] + g.Lambda[i] * x.e[i]
            w.sign[i] = switch(w.s[i], g.switching, g.boundary_layer[i])
            w.switched[i] += gain * w.sign[i]
            reach = g.K[i] * w.s[i]
            w.a[i] = x.a_d[i] - g.Lambda[i] * x.e_dot[i] - reach - g.eta[i] * w.switched[i]
        inverse_dynamics(M0, h0, w.a, x.effort_limit, x.tau, w.excess)
        for i in range(x.e.size):
            if w.excess[i] != 0.0 and g.eta[i] > 0.0:
                w.sign[i] = unwound(w.sign[i], w.excess[i], gain * g.eta[i] * M0[i, i])
        commit(integral, integral_memory, w.sign, dt)
