"""`FractionalSwitchingSMC`: the sign passes through a fractional integral (stands for [34])."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import A_D, ED, LIMIT, TAU, Controller, E
from fotsmc_pin.control.gains import Gains, option, per_joint, scalar
from fotsmc_pin.control.saturation import inverse_dynamics, unwound
from fotsmc_pin.control.switching import SIGN_OR_LAYER, SWITCHING, switch
from fotsmc_pin.fractional import FractionalIntegral
from fotsmc_pin.fractional.advance import commit, predict

if TYPE_CHECKING:
    from fotsmc_pin.compiled import Kernel
    from fotsmc_pin.control.gains import Array


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


class FractionalSwitchingSMC(Controller):
    """Sliding mode whose sign passes through `D^{-α}`; representative: [34] is not printed.

        a = a_d - Λ ė - K s - η D^{-α} sign(s),   τ = M0 a + C0 v + G0,   s = ė + Λ e

    Signals: "s"; "switched", `D^{-α} sign(s)`. What a clipped torque cannot follow does not enter
    the memory of `D^{-α}`.
    """

    Gains = FractionalSwitchingSMCGains
    presets = SIGN_OR_LAYER
    representative = True

    def _prepare(self) -> None:
        g = self.gains
        integral = FractionalIntegral(order=g.alpha, dt=self.dt, tempering=g.tempering)
        stream = integral.stream(self.arm.nv)
        self._streams = [stream]
        work = np.zeros((5, self.arm.nv))
        self._signals = {"s": work[0], "switched": work[1]}
        self._arguments = (
            self._joints,
            self._M0,
            self._h0,
            self._pack(g.Lambda, g.K, g.eta, g.boundary_layer),
            SWITCHING.index(g.switching),
            stream.coefficients,
            stream.memory,
            work,
        )

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
    kind: int,
    integral: Array,
    integral_memory: Array,
    work: Array,
) -> None:
    """One tick of sliding mode with a fractional switching term."""
    e, ed, a_d = joints[E], joints[ED], joints[A_D]
    Lambda, K, eta, phi = gains[0], gains[1], gains[2], gains[3]
    s, switched, sign, a, excess = work[0], work[1], work[2], work[3], work[4]

    gain = predict(integral, integral_memory, dt, switched)
    for i in range(e.size):
        s[i] = ed[i] + Lambda[i] * e[i]
        sign[i] = switch(s[i], kind, phi[i])
        switched[i] += gain * sign[i]
        a[i] = a_d[i] - Lambda[i] * ed[i] - K[i] * s[i] - eta[i] * switched[i]
    inverse_dynamics(M0, h0, a, joints[LIMIT], joints[TAU], excess)
    for i in range(e.size):
        if excess[i] != 0.0 and eta[i] > 0.0:
            sign[i] = unwound(sign[i], excess[i], gain * eta[i] * M0[i, i])
    commit(integral, integral_memory, sign, dt)
