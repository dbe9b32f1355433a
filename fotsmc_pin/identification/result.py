"""What identification found: the arm, its parameters, and how well they explain the torque."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from os import PathLike
    from pathlib import Path

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

KNOWN = 0.5
"""Share of the standard deviation beforehand below which a parameter counts as known."""


@dataclass(frozen=True, kw_only=True)
class IdentifiedParameter:
    """One number of the arm, or one sum of them.

    Attributes:
        group: kind: "mass", "first moment", "inertia", "armature", "damping", "friction", "offset",
            "stribeck", or "base".
        of: the body or joint and the symbol, or the sum.
        value: the estimate; of the arm that is returned, so its bodies can exist.
        deviation: standard deviation of what the log and the nominal file tell together.
        nominal: of the file.
        doubt: standard deviation beforehand.
        unit: of all four.
    """

    group: str
    of: str
    value: float
    deviation: float
    nominal: float
    doubt: float
    unit: str

    @property
    def known(self) -> bool:
        """Whether the log has taken at least half of the doubt."""
        return self.deviation < KNOWN * self.doubt

    @property
    def interval(self) -> tuple[float, float]:
        """Confidence interval of 95 %."""
        return self.value - 1.96 * self.deviation, self.value + 1.96 * self.deviation


@dataclass(frozen=True, kw_only=True, eq=False)
class TorqueCheck:
    """Measured against predicted torque of one log.

    Attributes:
        label: the log.
        t: time (N,) [s].
        measured: torque, averaged over some hundredths of a second (N, nv) [N·m, N].
        predicted: by the identified arm, averaged alike (N, nv).
        by_nominal: by the nominal arm with its own friction, averaged alike (N, nv).
        used: whether a row says something of the model: not where the joint stuck (N, nv).
        error: RMS of measured minus predicted torque, sample by sample (nv,).
        nominal_error: the same of the nominal arm (nv,).
        floor: RMS of what no smooth motion explains: the noise of the torque (nv,).
        delay: by which torque was recorded later than motion [s].
    """

    label: str
    t: Array
    measured: Array
    predicted: Array
    by_nominal: Array
    used: np.ndarray
    error: Array
    nominal_error: Array
    floor: Array
    delay: float

    @property
    def averaged_error(self) -> Array:
        """RMS of the averaged difference (nv,) [N·m, N], which holds less of the noise."""
        return _rms(self.measured - self.predicted, self.used)

    @property
    def averaged_nominal_error(self) -> Array:
        """The same of the nominal arm (nv,)."""
        return _rms(self.measured - self.by_nominal, self.used)

    @property
    def torque(self) -> Array:
        """RMS of the measured torque (nv,)."""
        return _rms(self.measured, self.used)


@dataclass(frozen=True, kw_only=True, eq=False)
class Identification:
    """An arm from logs.

    Attributes:
        arm: the identified arm, ready for any controller.
        nominal: the arm that it began with.
        parameters: ten of each body and those of each joint, each with its standard deviation.
        base_parameters: the sums that the torque depends on: all that any motion can tell.
        unidentifiable: in words, what could not be told, or not apart.
        fits: measured against predicted torque of the logs that were used.
        validation: the same of logs that were not.
        noise: standard deviation of each joint's averaged torque (nv,) [N·m, N].
        offset: constant torque of each joint, where it was asked for, else zero (nv,) [N·m, N].
        notes: what was decided, in plain words.
        theta: parameters in the order of `regressor.Parameters` (p,).
        covariance: of `theta` (p, p), of the log and the nominal file together.
    """

    arm: Arm
    nominal: Arm
    parameters: tuple[IdentifiedParameter, ...]
    base_parameters: tuple[IdentifiedParameter, ...]
    unidentifiable: tuple[str, ...]
    fits: tuple[TorqueCheck, ...]
    validation: tuple[TorqueCheck, ...]
    noise: Array
    offset: Array
    notes: tuple[str, ...]
    theta: Array
    covariance: Array

    def write_urdf(self, path: str | PathLike[str]) -> Path:
        """Write the identified arm as a URDF; see `Arm.write_urdf`."""
        return self.arm.write_urdf(path)

    def group(self, name: str) -> list[IdentifiedParameter]:
        """Return the parameters of one kind, in the order of the joints."""
        return [row for row in self.parameters if row.group == name]

    def __repr__(self) -> str:
        """Name the arm and say how much is known; the numbers would fill pages."""
        told = sum(row.known for row in self.base_parameters)
        return (
            f"<Identification of {self.nominal.name}: {told} of {len(self.base_parameters)} base "
            f"parameters known>"
        )

    def __str__(self) -> str:
        """Return the errors of the torque by joint, and what could not be told."""
        lines = []
        for title, checks in (("fitted", self.fits), ("validation", self.validation)):
            for check in checks:
                lines.append(f"{title}: {check.label}")
                for j, name in enumerate(self.arm.joint_names):
                    unit = self.arm.effort_units[j]
                    lines.append(
                        f"  {name}: {check.error[j]:.4g} {unit} of {check.torque[j]:.4g}, "
                        f"noise {check.floor[j]:.4g}, nominal {check.nominal_error[j]:.4g}"
                    )
        return "\n".join([*lines, *self.unidentifiable])


def _rms(table: Array, used: np.ndarray) -> Array:
    count = np.maximum(np.count_nonzero(used, axis=0), 1)
    return np.asarray(np.sqrt(np.sum(np.where(used, table, 0.0) ** 2, axis=0) / count))
