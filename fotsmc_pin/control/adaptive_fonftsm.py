"""`AdaptiveFONFTSM`: the paper's own controller, [22]-[24]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Unpack

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.adaptation import ADAPTATION, RATES, Estimates, adapt
from fotsmc_pin.control.fractional_surface import (
    PRACTICAL,
    FractionalSurfaceLaw,
    SurfaceGains,
    Work,
    act,
    reach,
    slide,
)
from fotsmc_pin.control.functions import norm
from fotsmc_pin.control.gains import option, scalar
from fotsmc_pin.control.rows import rows
from fotsmc_pin.fractional.advance import advance

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.controller import SignalRows
    from fotsmc_pin.control.gain_keywords import AdaptiveFONFTSMKeywords
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class AdaptiveFONFTSMGains(SurfaceGains):
    """Gains of `AdaptiveFONFTSM`: the surface's, and those of the adaptation.

    Attributes:
        upsilon_0: `υ0` of [23].
        upsilon_1: `υ1` of [24].
        adaptation_rate: "inverse", the rate is `υ^{-1}` as printed; "direct", it is `υ` (reading
            R1).
        B0_start: `B̂0` at the start.
        B1_start: `B̂1` at the start.
        adaptation: one of `ADAPTATION`.
        dead_zone: `‖S‖` below which the dead zone rests.
        leakage: rate at which leakage forgets.
        largest_bound: where leakage and projection hold `B̂0` and `B̂1`. Inside the boundary layer
            the switching term is a gain of up to `B̂/φ` on the speed, which the tick must carry:
            keep it well below `φ/dt`.
    """

    upsilon_0: float = scalar(0.05, above=0.0)
    upsilon_1: float = scalar(0.05, above=0.0)
    adaptation_rate: str = option("inverse", RATES)
    B0_start: float = scalar(5.0, "N·m", at_least=0.0)
    B1_start: float = scalar(5.0, "N·m·s/rad", at_least=0.0)
    adaptation: str = option("printed", ADAPTATION)
    dead_zone: float = scalar(0.05, "rad s^-(1+α)", at_least=0.0)
    leakage: float = scalar(1.0, "1/s", at_least=0.0)
    largest_bound: float = scalar(50.0, "N·m", above=0.0)


class AdaptiveFONFTSM(FractionalSurfaceLaw[AdaptiveFONFTSMGains]):
    """Adaptive fractional-order non-singular fast terminal sliding mode control, [22]-[24].

    The law [21] of `FONFTSM` with estimates in place of the bounds,

        dB̂0/dt = υ0^{-1} ‖S‖,   dB̂1/dt = υ1^{-1} ‖S‖ ‖v‖.

    While a torque is clipped the estimates rest: an error that the actuators cannot remove says
    nothing of the uncertainty.

    Signals: "s" and "w" of `FONFTSM`; "b_hat", the estimates `(B̂0, B̂1)` after the tick.

    Source: Nojavanzadeh and Badamchizadeh, IET Control Theory & Applications, 2016.

    Warns:
        PaperConditionWarning: `1 < p/q < 2` does not hold (as in the paper's own simulation).
    """

    Gains = AdaptiveFONFTSMGains
    State = Estimates
    signal_rows: ClassVar[SignalRows] = {"s": "S", "w": "w", "b_hat": ("B0_hat", "B1_hat")}
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = {
        "paper": {},
        "practical": PRACTICAL
        | {
            "adaptation": "leakage",
            "upsilon_0": 0.01,
            "upsilon_1": 0.1,
            "B1_start": 0.0,
            "largest_bound": 30.0,
        },
    }

    if TYPE_CHECKING:

        def __init__(
            self,
            arm: Arm,
            dt: float,
            *,
            preset: str | None = None,
            **gains: Unpack[AdaptiveFONFTSMKeywords],
        ) -> None: ...

    def start(self) -> None:
        """Let the estimates begin where the gains say."""
        super().start()
        self.state.B0_hat[:], self.state.B1_hat[:] = self.gains.B0_start, self.gains.B1_start

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
        """One tick of [22]-[24]: that of [19]-[21] with the estimates, and their adaptation."""
        x, g, m, w = rows(table, AdaptiveFONFTSMGains, Estimates, Work)
        advance(derivative, derivative_memory, x.e_dot, dt, w.S)
        slide(x, g, w)
        reach(x, g, w, M0, m.B0_hat[0] + m.B1_hat[0] * norm(x.v))
        if not act(dt, x, g, w, M0, h0, integral, integral_memory):
            adapt(dt, g, m, norm(w.S), norm(x.v))
