"""`TerminalSMC`: the singular terminal surface, guarded; it shows why the others exist."""

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
class TerminalSMCGains(Gains):
    """Gains of `TerminalSMC`.

    Attributes:
        beta: gain `β` of the surface.
        power: `q/p` of the surface.
        error_floor: `|e|` is taken as at least this in `|e|^{q/p-1}`, which is infinite at 0.
        K: proportional part of the reaching law.
        eta: switching part of the reaching law.
        switching: stands for `sign(s)`; one of `SWITCHING`.
        boundary_layer: width `φ` of the continuous switching functions.
    """

    beta: Array = per_joint(2.0, "rad^(1-q/p)/s", above=0.0)
    power: float = scalar(0.6, above=0.0, below=1.0)
    error_floor: float = scalar(1e-2, "rad", above=0.0, tuned=False)
    K: Array = per_joint(10.0, "1/s", at_least=0.0)
    eta: Array = per_joint(5.0, "rad/s²", at_least=0.0)
    switching: str = option("sign", SWITCHING)
    boundary_layer: Array = per_joint(0.1, "rad/s", above=0.0)


class TerminalSMC(AccelerationLaw):
    """Sliding mode on the terminal surface `s = ė + β sig(e)^{q/p}`, `0 < q/p < 1`.

        a = a_d - β (q/p) |e|^{q/p-1} ∘ ė - K s - η sign(s),   τ = M0 a + C0 v + G0

    `|e|^{q/p-1}` has no bound at `e = 0`: where the error passes through zero with speed, the law
    asks for infinite torque. The floor on `|e|` only hides that.

    Signals: "s".

    Source: Man, Paplinski and Wu, IEEE Transactions on Automatic Control, 1994.
    """

    Gains = TerminalSMCGains
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
    """One tick of sliding mode on the terminal surface."""
    e, ed, a_d = joints[E], joints[ED], joints[A_D]
    beta, r, floor, K, eta, phi = gains[0], gains[1], gains[2], gains[3], gains[4], gains[5]
    s, a, excess = work[0], work[1], work[2]

    for i in range(e.size):
        s[i] = ed[i] + beta[i] * sig(e[i], r[i])
        slope = beta[i] * r[i] * max(abs(e[i]), floor[i]) ** (r[i] - 1.0)
        a[i] = a_d[i] - slope * ed[i] - K[i] * s[i] - eta[i] * switch(s[i], kind, phi[i])
    inverse_dynamics(M0, h0, a, joints[LIMIT], joints[TAU], excess)
