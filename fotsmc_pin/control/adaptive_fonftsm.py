"""`AdaptiveFONFTSM`: the paper's own controller, [22]-[24]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.adaptation import ADAPTATION, adapt
from fotsmc_pin.control.controller import V
from fotsmc_pin.control.fonftsm import FONFTSM, PRACTICAL, SurfaceGains, control_law
from fotsmc_pin.control.gains import option, scalar

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.compiled import Kernel
    from fotsmc_pin.control.gains import Array

RATES = ("inverse", "direct")


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


class AdaptiveFONFTSM(FONFTSM):
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

    def _prepare(self) -> None:
        super()._prepare()
        g = self.gains
        self._state = self._signals["b_hat"] = self._bounds
        upsilon = np.array([g.upsilon_0, g.upsilon_1])
        rates = 1.0 / upsilon if g.adaptation_rate == "inverse" else upsilon
        self._arguments += (
            ADAPTATION.index(g.adaptation),
            np.array([*rates, g.dead_zone, g.leakage, g.largest_bound, *self._bounds]),
        )

    def _first_bounds(self) -> Array:
        return np.array([self.gains.B0_start, self.gains.B1_start])

    @property
    def _kernel(self) -> Kernel:
        return adaptive_control_law


@kernel
def adaptive_control_law(
    dt: float,
    joints: Array,
    M0: Array,
    h0: Array,
    gains: Array,
    bounds: Array,
    kind: int,
    inside: bool,
    derivative: Array,
    derivative_memory: Array,
    integral: Array,
    integral_memory: Array,
    work: Array,
    adaptation_kind: int,
    adaptation: Array,
) -> None:
    """One tick of [22]-[24]; `bounds` holds the estimates `B̂0, B̂1`."""
    clipped = control_law(
        dt,
        joints,
        M0,
        h0,
        gains,
        bounds,
        kind,
        inside,
        derivative,
        derivative_memory,
        integral,
        integral_memory,
        work,
    )
    if not clipped:
        start = adaptation[-2:]
        adapt(dt, bounds, start, work[0], joints[V], adaptation_kind, adaptation)
