"""`FONFTSM`: fractional-order non-singular fast terminal sliding mode, bounds known, [19]-[21]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import A_D, ED, LIMIT, TAU, Controller, E, V
from fotsmc_pin.control.gains import Gains, option, per_joint, scalar
from fotsmc_pin.control.norm import norm
from fotsmc_pin.control.paper_condition import warn_of_power
from fotsmc_pin.control.saturation import inverse_dynamics, unwound
from fotsmc_pin.control.switching import SWITCHING, sig, switch
from fotsmc_pin.fractional import FractionalDerivative, FractionalIntegral
from fotsmc_pin.fractional.advance import advance, commit, predict

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.compiled import Kernel
    from fotsmc_pin.control.gains import Array

INERTIA = ("inside", "outside")
START = ("caputo", "from_rest")

PRACTICAL: dict[str, Any] = {
    "inertia": "outside",
    "alpha": 0.3,
    "A": 20.0,
    "power": 1.1,
    "theta": 10.0,
    "switching": "tanh",
    "boundary_layer": 0.05,
    "tempering": 3.0,
    "start": "from_rest",
}
"""Gains that need no tuning to the arm's inertia, and obey `1 < p/q < 2`."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SurfaceGains(Gains):
    """The surface [19] and the reaching law of [21], shared by the known-bound and adaptive laws.

    Attributes:
        alpha: order `α` of the surface and of the law's integral.
        A: linear gain of the surface.
        lam: gain `λ` of the terminal term.
        power: `p/q`. The paper demands `1 < p/q < 2` and simulates 0.9 (reading R2).
        error_floor: `|e|` is taken as at least this in `|e|^{p/q-1}`, singular at 0 for `p/q < 1`.
        theta: gain `Θ` of the reaching law.
        mu: power `μ` of the reaching law; the paper's "≈ 1" is 0.99 (reading R6).
        switching: stands for `sign(S)`; one of `SWITCHING`.
        boundary_layer: width `φ` of the continuous switching functions, in units of `S`.
        inertia: "inside", `M0` under the fractional integral as printed; or "outside", the law is a
            commanded acceleration followed by inverse dynamics, so that gains do not depend on the
            arm (reading R5). Then `B0 + B1 ‖v‖` bounds an acceleration.
        tempering: `σ`; both operators fade with `e^{-σt}`. 0 is the paper's.
        start: "caputo", `ė(0)` does not enter `D^α ė`, which leaves an error of about
            `ė(0) t^{-α} / (A Γ(1-α))` after a start in motion (reading R7; the paper starts at
            rest); or "from_rest", `ė` is taken to have been 0 a tick before the first.
        memory_horizon: time over which the operators' memory is certified [s].
    """

    alpha: float = scalar(0.1, at_least=0.0, below=1.0)
    A: Array = per_joint(10.0, "s^-(1+α)", above=0.0)
    lam: Array = per_joint(2.0, "rad^(1-p/q) s^-(1+α)", at_least=0.0)
    power: float = scalar(0.9, above=0.0, below=2.0)
    error_floor: float = scalar(1e-3, "rad", above=0.0, tuned=False)
    theta: Array = per_joint(5.0, "1/s", above=0.0)
    mu: float = scalar(0.99, above=0.0, below=1.0)
    switching: str = option("sign", SWITCHING)
    boundary_layer: Array = per_joint(0.1, "rad s^-(1+α)", above=0.0)
    inertia: str = option("inside", INERTIA)
    tempering: float = scalar(0.0, "1/s", at_least=0.0)
    start: str = option("caputo", START)
    memory_horizon: float = scalar(1e3, "s", above=0.0, tuned=False)


@dataclass(frozen=True, kw_only=True, eq=False)
class FONFTSMGains(SurfaceGains):
    """Gains of `FONFTSM`: the surface's, and the bounds `‖F‖ < B0 + B1 ‖v‖` of [18].

    Attributes:
        B0: constant part of the bound.
        B1: part that grows with the speed.
    """

    B0: float = scalar(5.0, "N·m", at_least=0.0)
    B1: float = scalar(5.0, "N·m·s/rad", at_least=0.0)


class FONFTSM(Controller):
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

    Gains: ClassVar[type[SurfaceGains]] = FONFTSMGains
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = {"paper": {}, "practical": PRACTICAL}

    def _prepare(self) -> None:
        g, n = self.gains, self.arm.nv
        warn_of_power(g.power, g.error_floor, stacklevel=4)
        memory = {
            "order": g.alpha,
            "dt": self.dt,
            "horizon": g.memory_horizon,
            "tempering": g.tempering,
        }
        self._derivative = FractionalDerivative(**memory).stream(n)
        self._integral = FractionalIntegral(**memory).stream(n)
        self._streams = [self._derivative, self._integral]
        self._work = np.zeros((6, n))
        self._signals = {"s": self._work[0], "w": self._work[1]}
        self._bounds = self._first_bounds()
        self._arguments = (
            self._joints,
            self._M0,
            self._h0,
            self._pack(g.A, g.lam, g.power, g.error_floor, g.theta, g.mu, g.boundary_layer),
            self._bounds,
            SWITCHING.index(g.switching),
            g.inertia == "inside",
            self._derivative.coefficients,
            self._derivative.memory,
            self._integral.coefficients,
            self._integral.memory,
            self._work,
        )

        self._take_start()

    def reset(self) -> None:
        """Forget everything: the controller is as it was when it was made."""
        super().reset()
        self._take_start()

    def _take_start(self) -> None:
        if self.gains.start == "from_rest":
            self._derivative.update(np.zeros(self.arm.nv))

    def _first_bounds(self) -> Array:
        return np.array([self.gains.B0, self.gains.B1])

    @property
    def _kernel(self) -> Kernel:
        return control_law


@kernel
def control_law(
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
) -> bool:
    """One tick of [19]-[21]; `bounds` holds `B0, B1`. Return whether a torque was clipped."""
    e, ed, v, a_d = joints[E], joints[ED], joints[V], joints[A_D]
    A, lam, r, floor, theta, mu, phi = (
        gains[0], gains[1], gains[2], gains[3], gains[4], gains[5], gains[6],
    )  # fmt: skip
    S, w, x, y, a, excess = work[0], work[1], work[2], work[3], work[4], work[5]
    n = e.size

    # [19] S = D^α ė + A e + λ sig(e)^{p/q}
    advance(derivative, derivative_memory, ed, dt, S)
    for i in range(n):
        S[i] += A[i] * e[i] + lam[i] * sig(e[i], r[i])

    # [21] the integrand w: M0 multiplies x where it stands inside, and never the switching term
    speed = norm(v)
    for i in range(n):
        x[i] = (
            theta[i] * S[i]
            + theta[i] * sig(S[i], mu[i])
            + A[i] * ed[i]
            + lam[i] * r[i] * max(abs(e[i]), floor[i]) ** (r[i] - 1.0) * ed[i]
        )
    for i in range(n):
        w[i] = (bounds[0] + bounds[1] * speed) * switch(S[i], kind, phi[i])
        if inside:
            for j in range(n):
                w[i] += M0[i, j] * x[j]
        else:
            w[i] += x[i]

    # [21] τ = C0 v + G0 + M0 a_d - D^{-α} w, or with M0 outside: C0 v + G0 + M0 (a_d - D^{-α} w)
    gain = predict(integral, integral_memory, dt, y)
    for i in range(n):
        y[i] += gain * w[i]
        a[i] = a_d[i] if inside else a_d[i] - y[i]
        y[i] = h0[i] - y[i] if inside else h0[i]
    inverse_dynamics(M0, y, a, joints[LIMIT], joints[TAU], excess)

    # What the actuator cannot follow does not enter the memory.
    clipped = False
    for i in range(n):
        if excess[i] != 0.0:
            clipped = True
            inertia = 1.0 if inside else M0[i, i]
            w[i] = unwound(w[i], excess[i], gain * inertia)
    commit(integral, integral_memory, w, dt)
    return clipped
