"""A control law of one's own in one file: gains, equations, and nothing else.

Sliding mode with a reaching law of two powers (Polyakov 2012). On `s = ė + Λ e`,

    a = a_d - Λ ė - k_1 sig(s)^p_1 - k_2 sig(s)^p_2,   τ = M0 a + C0 v + G0,   p_1 < 1 < p_2.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.acceleration_law import AccelerationLaw
from fotsmc_pin.control.controller import A_D, ED, LIMIT, TAU, E
from fotsmc_pin.control.gains import Gains, per_joint
from fotsmc_pin.control.saturation import inverse_dynamics
from fotsmc_pin.control.switching import sig

if TYPE_CHECKING:
    from fotsmc_pin.compiled import Kernel
    from fotsmc_pin.control.gains import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class TwoPowerGains(Gains):
    """Gains of `TwoPowerSMC`: slope of the surface, and both terms of the reaching law."""

    Lambda: Array = per_joint(10.0, "1/s", above=0.0)
    k_1: Array = per_joint(10.0, "rad^(1-p_1) s^(p_1-2)", above=0.0)
    k_2: Array = per_joint(10.0, "rad^(1-p_2) s^(p_2-2)", above=0.0)
    p_1: Array = per_joint(0.6, above=0.0)
    p_2: Array = per_joint(1.4, above=1.0)


class TwoPowerSMC(AccelerationLaw):
    """Sliding mode on `s = ė + Λ e` with a reaching law of two powers. Signals: "s"."""

    Gains = TwoPowerGains

    @property
    def _kernel(self) -> Kernel:
        return control_law


@kernel
def control_law(
    dt: float, joints: Array, M0: Array, h0: Array, gains: Array, kind: int, z: Array, work: Array
) -> None:  # fmt: skip
    """One tick; the arguments are those that `AccelerationLaw` describes."""
    e, ed, a_d = joints[E], joints[ED], joints[A_D]
    Lambda, k_1, k_2, p_1, p_2 = gains[0], gains[1], gains[2], gains[3], gains[4]
    s, a, excess = work[0], work[1], work[2]
    for i in range(e.size):
        s[i] = ed[i] + Lambda[i] * e[i]
        a[i] = a_d[i] - Lambda[i] * ed[i] - k_1[i] * sig(s[i], p_1[i]) - k_2[i] * sig(s[i], p_2[i])
    inverse_dynamics(M0, h0, a, joints[LIMIT], joints[TAU], excess)


def main(out: Path = Path("out/own_controller"), duration: float = 6.0) -> fp.Recording:
    """Run the new law on a UR5 whose links are 20 % heavier than it believes."""
    nominal = fp.load_arm("ur5")
    true = fp.perturb(nominal, mass_scale=1.2)
    law = TwoPowerSMC(nominal, dt=1e-3, Lambda=15.0)
    reference = fp.references.Sinusoid.inside_limits(nominal)
    q0 = nominal.integrate(reference(0.0)[0], np.full(nominal.nv, 0.2))
    rec = fp.simulate(true, law, reference, duration, q0=q0)
    print(f"{law}\nkeeps {1e3 * fp.summarize(rec).tail_rms_error:.2f} mrad RMS")
    fp.export_html(rec, out / "own_controller.html")
    return rec


if __name__ == "__main__":
    main()
