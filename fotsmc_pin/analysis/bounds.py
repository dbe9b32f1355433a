"""Theoretical bounds on the time until a sliding variable is zero: [44], and Lemma 1 with [37]."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def reaching_time_bound(S_start: ArrayLike, theta: float, mu: float) -> float:
    """Return the bound [44] on the time in which `S` reaches zero [s].

        t_r ≤ ln(1 + ‖S(0)‖₁^{1-μ}) / (θ (1-μ))

    It follows from `dV/dt ≤ -θ V - θ V^μ` with `V = ‖S‖₁`, which holds for the reaching law in
    continuous time while the uncertainty stays below its bound. At the paper's `μ = 0.99` it is
    about 14 s, and not the "under 1 s" of the text (reading R6).

    Args:
        S_start: `S(0)` (nv,).
        theta: gain `θ` of the reaching law, the smallest if joints differ [1/s].
        mu: power `μ` of the reaching law, in (0, 1).

    Raises:
        ArgumentError: an argument is out of its range.
    """
    S = np.atleast_1d(np.asarray(S_start, dtype=np.float64))
    norm = float(np.abs(checks.finite_vector("S_start", S, S.size)).sum())
    theta = checks.finite_number("theta", theta, above=0.0)
    mu = checks.finite_number("mu", mu, above=0.0, below=1.0)
    return math.log1p(norm ** (1.0 - mu)) / (theta * (1.0 - mu))


def settling_time_bound(V_start: float, rate: float, eta: float = 0.5) -> float:
    """Return the bound of Lemma 1 on the time in which a Lyapunov function reaches zero [s].

        dV/dt ≤ -rate V^η   ⇒   t ≤ V(0)^{1-η} / (rate (1-η))

    With `η = 1/2` and `rate = β_c` this is [37], `t_1 = 2 V(0)^{1/2} / β_c`.

    Args:
        V_start: `V(0)`, at least 0.
        rate: `β_c` of [37], `α` of Lemma 1 [V^{1-η}/s].
        eta: `η`, in (0, 1).

    Raises:
        ArgumentError: an argument is out of its range.
    """
    V = checks.finite_number("V_start", V_start, at_least=0.0)
    rate = checks.finite_number("rate", rate, above=0.0)
    eta = checks.finite_number("eta", eta, above=0.0, below=1.0)
    return float(V ** (1.0 - eta) / (rate * (1.0 - eta)))
