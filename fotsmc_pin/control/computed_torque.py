"""`ComputedTorque`: inverse dynamics around PD or PID, the baseline that people use today."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from fotsmc_pin.compiled import kernel
from fotsmc_pin.control.acceleration_law import AccelerationLaw
from fotsmc_pin.control.controller import A_D, ED, LIMIT, TAU, E
from fotsmc_pin.control.gains import Gains, per_joint
from fotsmc_pin.control.saturation import integrated, inverse_dynamics

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fotsmc_pin.compiled import Kernel
    from fotsmc_pin.control.gains import Array


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


class ComputedTorque(AccelerationLaw):
    """Computed torque with a PD or PID loop.

        a = a_d - K_d ė - K_p e - K_i ∫e dt,   τ = M0 a + C0 v + G0

    Signals: "integral", `K_i ∫e dt`.

    Source: Siciliano, Sciavicco, Villani and Oriolo, Robotics, 2009, section 8.5.2.
    """

    Gains = ComputedTorqueGains
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = {
        "pd": {},
        "pid": {"kp": 300.0, "kd": 30.0, "ki": 1000.0},
    }

    def _prepare(self) -> None:
        super()._prepare()
        self._signals = {"integral": self._state}

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
    """One tick of computed torque; `z` is the integral."""
    e, ed, a_d = joints[E], joints[ED], joints[A_D]
    kp, kd, ki = gains[0], gains[1], gains[2]
    a, excess = work[1], work[2]

    for i in range(e.size):
        a[i] = a_d[i] - kd[i] * ed[i] - kp[i] * e[i] - z[i]
    inverse_dynamics(M0, h0, a, joints[LIMIT], joints[TAU], excess)
    for i in range(e.size):
        z[i] = integrated(z[i], ki[i] * e[i], dt, excess[i])
