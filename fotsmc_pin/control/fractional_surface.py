"""The fractional terminal surface [19] and its reaching law [21], which the paper's laws share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol, TypeVar

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.conditions import warn_of_power
from fotsmc_pin.control.controller import Controller, SignalRows, Streams
from fotsmc_pin.control.functions import SWITCHING, sig, switch
from fotsmc_pin.control.gains import Gains, codes, option, per_joint, scalar
from fotsmc_pin.control.torque_limits import inverse_dynamics, unwound
from fotsmc_pin.fractional import FractionalDerivative, FractionalIntegral
from fotsmc_pin.fractional.advance import commit, predict

if TYPE_CHECKING:
    from fotsmc_pin.control.rows import Joints
    from fotsmc_pin.types import Array

INERTIA = ("inside", "outside")
START = ("caputo", "from_rest")

INSIDE, OUTSIDE = codes(INERTIA)

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


G = TypeVar("G", bound=SurfaceGains)


class Work(NamedTuple):
    """What one tick of the laws on this surface fills.

    Attributes:
        S: sliding variable [rad s^-(1+α)].
        w: integrand of the law's fractional integral.
        x: the part of `w` that `M0` multiplies where it stands inside.
        y: the fractional integral of `w`; then what is added to `M0 a`.
        a: commanded acceleration [rad/s²].
        excess: torque cut off [N·m].
    """

    S: Array
    w: Array
    x: Array
    y: Array
    a: Array
    excess: Array


class OperatorGains(Protocol):
    """What both operators of a surface are made from."""

    alpha: float
    tempering: float
    memory_horizon: float


def derivative(g: OperatorGains, dt: float) -> FractionalDerivative:
    """Return `D^{α,σ}`."""
    return FractionalDerivative(
        order=g.alpha, dt=dt, horizon=g.memory_horizon, tempering=g.tempering
    )


def integral(g: OperatorGains, dt: float) -> FractionalIntegral:
    """Return `D^{-α,σ}`."""
    return FractionalIntegral(order=g.alpha, dt=dt, horizon=g.memory_horizon, tempering=g.tempering)


class FractionalSurfaceLaw(Controller[G]):
    """Frame of the laws on the surface [19]: its operators, its start, its condition."""

    streams: ClassVar[Streams] = {
        "derivative": derivative,
        "integral": integral,
    }
    Work = Work
    signal_rows: ClassVar[SignalRows] = {"s": "S", "w": "w"}

    def review(self) -> None:
        """Warn where `1 < p/q < 2` does not hold, and of all that concerns every law."""
        super().review()
        warn_of_power(self.gains.power, self.gains.error_floor, self)

    def start(self) -> None:
        """Where the law starts from rest, let the derivative begin with `ė = 0`."""
        if self.gains.start == "from_rest":
            self.memories["derivative"].update(np.zeros(self.arm.nv))


@kernel(is_part=True)
def slide(x: Joints, g: SurfaceGains, w: Work) -> None:
    """[19] `S = D^α ė + A e + λ sig(e)^{p/q}`; `S` comes in as `D^α ė`."""
    for i in range(x.e.size):
        w.S[i] += g.A[i] * x.e[i] + g.lam[i] * sig(x.e[i], g.power)


@kernel(is_part=True)
def reach(x: Joints, g: SurfaceGains, w: Work, M0: Array, bound: float) -> None:
    """[21] the integrand `w`: `M0` multiplies `x` where it stands inside, never the switching."""
    n = x.e.size
    for i in range(n):
        w.x[i] = (
            g.theta[i] * w.S[i]
            + g.theta[i] * sig(w.S[i], g.mu)
            + g.A[i] * x.e_dot[i]
            + g.lam[i] * g.power * max(abs(x.e[i]), g.error_floor) ** (g.power - 1.0) * x.e_dot[i]
        )
    for i in range(n):
        w.w[i] = bound * switch(w.S[i], g.switching, g.boundary_layer[i])
        if g.inertia == INSIDE:
            for j in range(n):
                w.w[i] += M0[i, j] * w.x[j]
        else:
            w.w[i] += w.x[i]


@kernel(is_part=True)
def act(
    dt: float,
    x: Joints,
    g: SurfaceGains,
    w: Work,
    M0: Array,
    h0: Array,
    integral: Array,
    integral_memory: Array,
) -> bool:
    """[21] the torque, `τ = C0 v + G0 + M0 a_d - D^{-α} w`, or `C0 v + G0 + M0 (a_d - D^{-α} w)`.

    What the actuator cannot follow does not enter the memory. Returns whether a torque was clipped.
    """
    n, inside = x.e.size, g.inertia == INSIDE
    gain = predict(integral, integral_memory, dt, w.y)
    for i in range(n):
        w.y[i] += gain * w.w[i]
        w.a[i] = x.a_d[i] if inside else x.a_d[i] - w.y[i]
        w.y[i] = h0[i] - w.y[i] if inside else h0[i]
    inverse_dynamics(M0, w.y, w.a, x.effort_limit, x.tau, w.excess)
    clipped = False
    for i in range(n):
        if w.excess[i] != 0.0:
            clipped = True
            inertia = 1.0 if inside else M0[i, i]
            w.w[i] = unwound(w.w[i], w.excess[i], gain * inertia)
    commit(integral, integral_memory, w.w, dt)
    return clipped
