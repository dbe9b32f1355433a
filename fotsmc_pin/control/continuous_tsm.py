"""`ContinuousTSM`: the integer-order terminal controller that the paper compares with, [45]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.acceleration_law import AccelerationLaw
from fotsmc_pin.control.controller import A_D, ED, LIMIT, TAU, E
from fotsmc_pin.control.gains import Gains, per_joint, scalar
from fotsmc_pin.control.saturation import inverse_dynamics
from fotsmc_pin.control.switching import sig

if TYPE_CHECKING:
    from fotsmc_pin.compiled import Kernel
    from fotsmc_pin.control.gains import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class ContinuousTSMGains(Gains):
    """Gains of `ContinuousTSM`. By default its stiffness is that of `LinearSMC`.

    Attributes:
        beta: gain `β` of the surface.
        gamma: power `γ` of the surface.
        K1: proportional part of the reaching law.
        K2: fractional-power part of the reaching law.
        rho: power `ρ` of the reaching law.
    """

    beta: Array = per_joint(0.3, "rad^(1-γ) s^γ", above=0.0)
    gamma: float = scalar(1.4, above=1.0, below=2.0)
    K1: Array = per_joint(100.0, "1/s²", at_least=0.0)
    K2: Array = per_joint(20.0, "rad^(1-ρ)/s²", at_least=0.0)
    rho: float = scalar(0.6, above=0.0, below=1.0)


class ContinuousTSM(AccelerationLaw):
    """Continuous terminal sliding mode on `s = e + β sig(ė)^γ`, `1 < γ < 2`, [45].

        τ = C0 v + G0 + M0 a_d - M0 β^{-1} γ^{-1} sig(ė)^{2-γ} - M0 (K1 s + K2 sig(s)^ρ)

    Signals: "s".

    Source: Yu, Yu, Shirinzadeh and Man, Automatica, 2005.
    """

    Gains = ContinuousTSMGains

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
    """One tick of [45]."""
    e, ed, a_d = joints[E], joints[ED], joints[A_D]
    beta, gamma, K1, K2, rho = gains[0], gains[1], gains[2], gains[3], gains[4]
    s, a, excess = work[0], work[1], work[2]

    for i in range(e.size):
        s[i] = e[i] + beta[i] * sig(ed[i], gamma[i])
        a[i] = (
            a_d[i]
            - sig(ed[i], 2.0 - gamma[i]) / (beta[i] * gamma[i])
            - K1[i] * s[i]
            - K2[i] * sig(s[i], rho[i])
        )
    inverse_dynamics(M0, h0, a, joints[LIMIT], joints[TAU], excess)
