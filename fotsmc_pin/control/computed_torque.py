"""`ComputedTorque`: inverse dynamics around PD or PID, the baseline that people use today."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Unpack

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.controller import Controller, SignalRows
from fotsmc_pin.control.gains import Gains, per_joint
from fotsmc_pin.control.rows import rows
from fotsmc_pin.control.torque_limits import integrated, inverse_dynamics

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control.gain_keywords import ComputedTorqueKeywords
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class ComputedTorqueGains(Gains):
    """Gains of `ComputedTorque`, in units of acceleration, so that they fit every arm.

    Attributes:
        kp: proportional gain.
        kd: derivative gain.
        ki: integral gain; 0 makes it PD.
    """

    kp: Array = per_joint(400.0, "1/s²", at_least=0.0)
    kd: Array = per_joint(40.0, "1/s", at_least=0.0)
    ki: Array = per_joint(0.0, "1/s³", at_least=0.0)


class State(NamedTuple):
    """`K_i ∫e dt` [rad/s²]."""

    z: Array


class Work(NamedTuple):
    """Commanded acceleration [rad/s²], torque cut off [N·m]."""

    a: Array
    excess: Array


class ComputedTorque(Controller[ComputedTorqueGains]):
    """Computed torque with a PD or PID loop.

        a = a_d - K_d ė - K_p e - K_i ∫e dt,   τ = M0 a + C0 v + G0

    Signals: "integral", `K_i ∫e dt`.

    Source: Siciliano, Sciavicco, Villani and Oriolo, Robotics, 2009, section 8.5.2.
    """

    Gains = ComputedTorqueGains
    State = State
    Work = Work
    signal_rows: ClassVar[SignalRows] = {"integral": "z"}
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = {
        "pd": {},
        "pid": {"kp": 300.0, "kd": 30.0, "ki": 1000.0},
    }

    if TYPE_CHECKING:

        def __init__(
            self,
            arm: Arm,
            dt: float,
            *,
            preset: str | None = None,
            **gains: Unpack[ComputedTorqueKeywords],
        ) -> None: ...

    @staticmethod
    @kernel
    def tick(dt: float, table: Array, M0: Array, h0: Array) -> None:
        """One tick of computed torque."""
        x, g, m, w = rows(table, ComputedTorqueGains, State, Work)
        for i in range(x.e.size):
            w.a[i] = x.a_d[i] - g.kd[i] * x.e_dot[i] - g.kp[i] * x.e[i] - m.z[i]
        inverse_dynamics(M0, h0, w.a, x.effort_limit, x.tau, w.excess)
        for i in range(x.e.size):
            m.z[i] = integrated(m.z[i], g.ki[i] * x.e[i], dt, w.excess[i])
