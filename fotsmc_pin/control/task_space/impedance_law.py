"""The law of `CartesianImpedance`: a spring and a damper between the tool and its reference."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import Controller, SignalRows
from fotsmc_pin.control.functions import clip
from fotsmc_pin.control.gains import Gains, per_joint, scalar
from fotsmc_pin.control.momentum_observer import unexplained
from fotsmc_pin.control.rows import rows
from fotsmc_pin.control.task_space.mobility import eigen

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class ImpedanceGains(Gains):
    """Gains of `CartesianImpedance`, per direction.

    Attributes:
        stiffness: `K`.
        damping_ratio: `ζ`; 1 does not overshoot.
        inertia: `M_d` that the tool is to have; inf, the default, leaves it its own.
        observer: bandwidth of the contact force that shaping the inertia needs.
    """

    stiffness: Array = per_joint(500.0, "N/m, N·m/rad", above=0.0)
    damping_ratio: Array = per_joint(1.0, "", at_least=0.0)
    inertia: Array = per_joint(math.inf, "kg, kg·m²", above=0.0, unlimited=True)
    observer: float = scalar(200.0, "rad/s", above=0.0)


class State(NamedTuple):
    """What lives on: speed [m/s], force of the contact [N] and a row per entry of the inertia."""

    last_v: Array
    contact: Array
    ticks: Array
    M_1: Array
    M_2: Array
    M_3: Array
    M_4: Array
    M_5: Array
    M_6: Array


class Work(NamedTuple):
    """What a tick fills: force of spring and damper, force that is not explained [N], zero."""

    force: Array
    lacking: Array
    zero: Array


class ImpedanceLaw(Controller[ImpedanceGains]):
    """Spring and damper, with the damping that belongs to the inertia of the tool.

        F = Λ a_d + h - ½ Λ̇ ė - D ė - K e
        D = 2 K^½ U diag(ζ √λ) Uᵀ K^½,   K^{-½} Λ K^{-½} = U diag(λ) Uᵀ

    With the term in `Λ̇`, which Coriolis forces leave where they are not cancelled, the energy
    `½ ėᵀ Λ ė + ½ eᵀ K e` changes by `ėᵀ F_ext - ėᵀ D ė`: what pushes at the tool meets something
    passive. `D` damps each of the modes of `Λ` and `K` by `ζ`. Where `inertia` is finite, the tool
    is given it: `F = Λ M_d⁻¹ (F_ext - D ė - K e) - F_ext + Λ a_d + h`, with the contact force
    `F_ext` that a momentum observer sees, and `D` that belongs to `M_d`.

    Signals: "spring", `-D ė - K e` [N, N·m]; "contact", the force that is observed [N, N·m].

    Source: Albu-Schäffer, Ott, Frese and Hirzinger, IEEE International Conference on Robotics and
    Automation, 2003, the double diagonalisation.
    """

    Gains = ImpedanceGains
    State = State
    Work = Work
    signal_rows: ClassVar[SignalRows] = {"spring": "force", "contact": "contact"}

    @staticmethod
    @kernel
    def tick(dt: float, table: Array, M0: Array, h0: Array) -> None:
        """One tick; `tau` still holds the force of the last one."""
        x, g, m, w = rows(table, ImpedanceGains, State, Work)
        n = x.e.size
        last = (m.M_1, m.M_2, m.M_3, m.M_4, m.M_5, m.M_6)
        shapes = math.isfinite(g.inertia[0])
        scaled, U, mode = np.zeros((n, n)), np.zeros((n, n)), np.zeros(n)
        if m.ticks[0] > 0.0:
            unexplained(dt, M0, h0, w.zero, x.v, m.last_v, x.tau, w.lacking)
            share = g.observer * dt / (1.0 + g.observer * dt)
            for i in range(n):
                m.contact[i] -= share * (w.lacking[i] + m.contact[i])
        for i in range(n):
            m.last_v[i] = x.v[i]
            for j in range(n):
                found = (g.inertia[i] if i == j else 0.0) if shapes else M0[i, j]
                scaled[i, j] = found / math.sqrt(g.stiffness[i] * g.stiffness[j])
        eigen(scaled, n, U)
        for k in range(n):
            for j in range(n):
                mode[k] += U[j, k] * math.sqrt(g.stiffness[j]) * x.e_dot[j]
            mode[k] *= 2.0 * g.damping_ratio[k] * math.sqrt(max(scaled[k, k], 0.0))
        for i in range(n):
            w.force[i] = -g.stiffness[i] * x.e[i]
            for k in range(n):
                w.force[i] -= math.sqrt(g.stiffness[i]) * U[i, k] * mode[k]
        for i in range(n):
            wanted = h0[i]
            for j in range(n):
                if shapes:
                    pushed = (m.contact[j] + w.force[j]) / g.inertia[j]
                    wanted += M0[i, j] * (x.a_d[j] + pushed)
                else:
                    rate = 0.0 if m.ticks[0] == 0.0 else (M0[i, j] - last[j][i]) / dt
                    wanted += M0[i, j] * x.a_d[j] - 0.5 * rate * x.e_dot[j]
            wanted += -m.contact[i] if shapes else w.force[i]
            x.tau[i] = clip(wanted, x.effort_limit[i])
        for i in range(n):
            m.ticks[i] += 1.0
            for j in range(n):
                last[j][i] = M0[i, j]
