"""`FONFTSM`: fractional-order non-singular fast terminal sliding mode, bounds known, [19]-[21]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Unpack

from fotsmc_pin.compiled import kernel
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
from fotsmc_pin.control.gains import scalar
from fotsmc_pin.control.rows import NoRows, rows
from fotsmc_pin.fractional.advance import advance

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.gain_keywords import FONFTSMKeywords
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class FONFTSMGains(SurfaceGains):
    """Gains of `FONFTSM`: the surface's, and the bounds `‖F‖ < B0 + B1 ‖v‖` of [18].

    Attributes:
        B0: constant part of the bound.
        B1: part that grows with the speed.
    """

    B0: float = scalar(5.0, "N·m", at_least=0.0)
    B1: float = scalar(5.0, "N·m·s/rad", at_least=0.0)


class FONFTSM(FractionalSurfaceLaw[FONFTSMGains]):
    """Fractional-order non-singular fast terminal sliding mode control, [19]-[21].

    Surface `S = D^{α+1} e + A e + λ sig(e)^{p/q}`, with `D^{α+1} e` read as the Caputo derivative
    `D^α ė` (reading R7), and law

        τ = C0 v + G0 + M0 a_d - D^{-α}( M0 Θ S + M0 Θ sig(S)^μ + M0 A ė
              + λ (p/q) M0 |e|^{p/q-1} ∘ ė + (B0 + B1 ‖v‖) sign(S) ).

    Signals: "s", the sliding variable `S`; "w", the integrand of `D^{-α}`.

    Source: Nojavanzadeh and Badamchizadeh, IET Control Theory & Applications, 2016.

    Warns:
        PaperConditionWarning: `1 < p/q < 2` does not hold (as in the paper's own simulation).
    """

    Gains = FONFTSMGains
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = {"paper": {}, "practical": PRACTICAL}

    if TYPE_CHECKING:

        def __init__(
            self,
            arm: Arm,
            dt: float,
            *,
            preset: str | None = None,
            **gains: Unpack[FONFTSMKeywords],
        ) -> None: ...

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
        """One tick of [19]-[21]."""
        x, g, _, w = rows(table, FONFTSMGains, NoRows, Work)
        advance(derivative, derivative_memory, x.e_dot, dt, w.S)
        slide(x, g, w)
        reach(x, g, w, M0, g.B0 + g.B1 * norm(x.v))
        act(dt, x, g, w, M0, h0, integral, integral_memory)
