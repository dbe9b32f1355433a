"""`NonsingularTSM`: the non-singular terminal surface with a switching law."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.acceleration_law import AccelerationLaw
from fotsmc_pin.control.controller import A_D, ED, LIMIT, TAU, E
from fotsmc_pin.control.gains import Gains, option, per_joint, scalar
from fotsmc_pin.control.saturation import inverse_dynamics
from fotsmc_pin.control.switching import SIGN_OR_LAYER, SWITCHING, sig, switch

if TYPE_CHECKING:
    from fotsmc_pin.compiled import Kernel
    from fotsmc_pin.control.gains import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class NonsingularTSMGains(Gains):
    """Gains of `NonsingularTSM`. By default its stiffness is that of `LinearSMC`.

    Attributes:
        beta: gain `β` of the surface.
        gamma: power `γ` of the surface.
        K: proportional part of the reaching law.
        eta: switching part of the reaching law.
        switching: stands for `sign(s)`; one of `SWITCHING`.
        boundary_layer: width `φ` of the continuous switching functions.
    """

    beta: Array = per_joint(0.3, "rad^(1-γ) s^γ", above=0.0)
    gamma: float = scalar(1.4, above=1.0, below=2.0)
    K: Array = per_joint(100.0, "1/s²", at_least=0.0)
    eta: Array = per_joint(5.0, "rad/s²", at_least=0.0)
    switching: str = option("sign", SWITCHING)
    boundary_layer: Array = per_joint(0.01, "rad", above=0.0)


class NonsingularTSM(AccelerationLaw):
    """Sliding mode on the non-singular terminal surface `s = e + β sig(ė)^γ`, `1 < γ < 2`.

        a = a_d - β^{-1} γ^{-1} sig(ė)^{2-γ} - K s - η sign(s),   τ = M0 a + C0 v + G0

    Signals: "s".

    Source: Feng, Yu and Man, Automatica, 2002.
    """

    Gains = NonsingularTSMGains
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
    """One tick of sliding mode on the non-singular terminal surface."""
    e, ed, a_d = joints[E], joints[ED], joints[A_D]
    beta, gamma, K, eta, phi = gains[0], gains[1], gains[2], gains[3], gains[4]
    s, a, excess = work[0], work[1], work[2]

    for i in range(e.size):
        s[i] = e[i] + beta[i] * sig(ed[i], gamma[i])
        a[i] = (
            a_d[i]
            - sig(ed[i], 2.0 - gamma[i]) / (beta[i] * gamma[i])
            - K[i] * s[i]
            - eta[i] * switch(s[i], kind, phi[i])
        )
    inverse_dynamics(M0, h0, a, joints[LIMIT], joints[TAU], excess)
