"""`LinearSMC`: conventional sliding mode on a linear surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.acceleration_law import AccelerationLaw
from fotsmc_pin.control.controller import A_D, ED, LIMIT, TAU, E
from fotsmc_pin.control.gains import Gains, option, per_joint
from fotsmc_pin.control.saturation import inverse_dynamics
from fotsmc_pin.control.switching import SIGN_OR_LAYER, SWITCHING, switch

if TYPE_CHECKING:
    from fotsmc_pin.compiled import Kernel
    from fotsmc_pin.control.gains import Array


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


class LinearSMC(AccelerationLaw):
    """Sliding mode on `s = ė + Λ e`, with the sign or a boundary layer.

        a = a_d - Λ ė - K s - η sign(s),   τ = M0 a + C0 v + G0

    Signals: "s".

    Source: Slotine and Li, Applied Nonlinear Control, 1991, chapter 7.
    """

    Gains = LinearSMCGains
    presets = SIGN_OR_LAYER

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
    z: Array,
    work: Array,
) -> None:
    """One tick of sliding mode on a linear surface."""
    e, ed, a_d = joints[E], joints[ED], joints[A_D]
    Lambda, K, eta, phi = gains[0], gains[1], gains[2], gains[3]
    s, a, excess = work[0], work[1], work[2]

    for i in range(e.size):
        s[i] = ed[i] + Lambda[i] * e[i]
        a[i] = a_d[i] - Lambda[i] * ed[i] - K[i] * s[i] - eta[i] * switch(s[i], kind, phi[i])
    inverse_dynamics(M0, h0, a, joints[LIMIT], joints[TAU], excess)
