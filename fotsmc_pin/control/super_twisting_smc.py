"""`SuperTwistingSMC`: second-order sliding mode on a linear surface (representative of [49])."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.acceleration_law import AccelerationLaw
from fotsmc_pin.control.controller import A_D, ED, LIMIT, TAU, E
from fotsmc_pin.control.gains import Gains, option, per_joint
from fotsmc_pin.control.saturation import integrated, inverse_dynamics
from fotsmc_pin.control.switching import SIGN_OR_LAYER, SWITCHING, sig, switch

if TYPE_CHECKING:
    from fotsmc_pin.compiled import Kernel
    from fotsmc_pin.control.gains import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class SuperTwistingSMCGains(Gains):
    """Gains of `SuperTwistingSMC`.

    Attributes:
        Lambda: slope `Λ` of the surface.
        k1: gain of the square root.
        k2: gain of the integrated sign.
        switching: stands for `sign(s)` under the integral; one of `SWITCHING`.
        boundary_layer: width `φ` of the continuous switching functions.
    """

    Lambda: Array = per_joint(10.0, "1/s", above=0.0)
    k1: Array = per_joint(10.0, "rad^½/s^(3/2)", at_least=0.0)
    k2: Array = per_joint(20.0, "rad/s³", at_least=0.0)
    switching: str = option("sign", SWITCHING)
    boundary_layer: Array = per_joint(0.1, "rad/s", above=0.0)


class SuperTwistingSMC(AccelerationLaw):
    """Super-twisting on `s = ė + Λ e`; representative: the law of [49] is not printed in the paper.

        a = a_d - Λ ė - k1 sig(s)^{1/2} - z,   dz/dt = k2 sign(s),   τ = M0 a + C0 v + G0

    Signals: "s"; "z", the integral, at rest while it would push a clipped torque further.

    Source: Levant, International Journal of Control, 1993.
    """

    Gains = SuperTwistingSMCGains
    presets = SIGN_OR_LAYER
    representative = True

    def _prepare(self) -> None:
        super()._prepare()
        self._signals["z"] = self._state

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
    """One tick of super-twisting; `z` is the integral."""
    e, ed, a_d = joints[E], joints[ED], joints[A_D]
    Lambda, k1, k2, phi = gains[0], gains[1], gains[2], gains[3]
    s, a, excess = work[0], work[1], work[2]

    for i in range(e.size):
        s[i] = ed[i] + Lambda[i] * e[i]
        a[i] = a_d[i] - Lambda[i] * ed[i] - k1[i] * sig(s[i], 0.5) - z[i]
    inverse_dynamics(M0, h0, a, joints[LIMIT], joints[TAU], excess)
    for i in range(e.size):
        z[i] = integrated(z[i], k2[i] * switch(s[i], kind, phi[i]), dt, excess[i])
