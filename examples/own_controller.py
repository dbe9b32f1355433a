"""A control law of one's own in one file: gains, equations, and nothing else.

Sliding mode with a reaching law of two powers (Polyakov 2012). On `s = ė + Λ e`,

    a = a_d - Λ ė - k_1 sig(s)^p_1 - k_2 sig(s)^p_2,   τ = M0 a + C0 v + G0,   p_1 < 1 < p_2.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, NamedTuple

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.control import law
from fotsmc_pin.control.law import Array, inverse_dynamics, per_joint, rows, sig


@dataclass(frozen=True, kw_only=True, eq=False)
class TwoPowerGains(law.Gains):
    """Gains of `TwoPowerSMC`: slope of the surface, and both terms of the reaching law."""

    Lambda: Array = per_joint(10.0, "1/s", above=0.0)
    k_1: Array = per_joint(10.0, "rad^(1-p_1) s^(p_1-2)", above=0.0)
    k_2: Array = per_joint(10.0, "rad^(1-p_2) s^(p_2-2)", above=0.0)
    p_1: Array = per_joint(0.6, above=0.0)
    p_2: Array = per_joint(1.4, above=1.0)


class Work(NamedTuple):
    """Sliding variable [rad/s], commanded acceleration [rad/s²], torque cut off [N·m]."""

    s: Array
    a: Array
    excess: Array


class TwoPowerSMC(fp.Controller[TwoPowerGains]):
    """Sliding mode on `s = ė + Λ e` with a reaching law of two powers. Signals: "s"."""

    Gains = TwoPowerGains
    Work = Work
    signal_rows: ClassVar[law.SignalRows] = {"s": "s"}

    @staticmethod
    @law.kernel
    def tick(dt: float, table: Array, M0: Array, h0: Array) -> None:
        """One tick: equations joint by joint, then the torque within its limits."""
        x, g, _, w = rows(table, TwoPowerGains, law.NoRows, Work)
        for i in range(x.e.size):
            w.s[i] = x.e_dot[i] + g.Lambda[i] * x.e[i]
            reach = g.k_1[i] * sig(w.s[i], g.p_1[i]) + g.k_2[i] * sig(w.s[i], g.p_2[i])
            w.a[i] = x.a_d[i] - g.Lambda[i] * x.e_dot[i] - reach
        inverse_dynamics(M0, h0, w.a, x.effort_limit, x.tau, w.excess)


def main(out: Path = Path("out/own_controller"), duration: float = 6.0) -> fp.Recording:
    """Run the new law on a UR5 whose links are 20 % heavier than it believes."""
    nominal = fp.load_arm("ur5")
    true = fp.perturb(nominal, mass_scale=1.2)
    controller = TwoPowerSMC(nominal, dt=1e-3, Lambda=15.0)
    reference = fp.references.Sinusoid.inside_limits(nominal)
    q0 = nominal.integrate(reference(0.0)[0], np.full(nominal.nv, 0.2))
    rec = fp.simulate(true, controller, reference, duration, q0=q0)
    print(f"{controller}\nkeeps {1e3 * fp.summarize(rec).tail_rms_error:.2f} mrad RMS")
    fp.export_html(rec, out / "own_controller.html", title="A law of its own on a UR5")
    return rec


if __name__ == "__main__":
    main()
