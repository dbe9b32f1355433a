"""What a motion shows of an arm's dynamic parameters: regressor, base parameters, information."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array

OF_LINK = ("m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
"""Parameters of a link in the frame of its joint, in the order of Pinocchio's regressor: mass [kg],
first moments [kg·m], inertia about the joint's origin [kg·m²]."""
OF_JOINT = ("armature", "viscous", "Coulomb")
"""Parameters of a joint: rotor inertia [kg·m²], viscous friction [N·m·s/rad], Coulomb [N·m]."""

NOISE = 0.005
"""Noise of a torque reading, as a share of full scale."""
LEAST_RADIUS, LEAST_MASS = 0.05, 0.05
"""A link is taken to be at least so large [m], and at least this share of the mean link's mass."""
ROTOR, VISCOUS, COULOMB = 0.005, 0.02, 0.02
"""What a joint's parameters are compared with: full scale times so many kg·m² for each N·m, and
shares of full scale (viscous friction at the velocity limit)."""
WELL = 0.1
"""A parameter is visible if its standard deviation is below this share of its size."""
SAMPLES = 60
"""Random states for each parameter of a joint's link that tell which sums torque depends on."""
SMALLEST = 1e-5
"""Singular values below this share of the largest belong to sums that torque does not depend on, or
only as the file's angles are rounded: 3.14159 in place of π makes 3e-6."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scales:
    """Sizes that make torques and parameters comparable, all above 0.

    Attributes:
        velocity: largest speed in use (nv,) [rad/s, m/s].
        effort: full scale of a torque reading (nv,) [N·m, N].
        parameters: what a change of each parameter is measured by (13 nv,): for a link its mass,
            its mass times its radius and times the square of it; for a joint typical values of a
            geared drive.
    """

    velocity: Array
    effort: Array
    parameters: Array

    @classmethod
    def of(cls, arm: Arm, velocity: Array, effort: Array) -> Scales:
        """Return the scales of an arm."""
        links = [arm.model.inertias[j + 1] for j in range(arm.nv)]
        least = LEAST_MASS * max(float(np.mean([link.mass for link in links])), 1e-3)
        sizes = []
        for link in links:
            mass = max(float(link.mass), least)
            second_moment = 0.5 * float(link.toDynamicParameters()[[4, 6, 9]].sum())
            radius = max(np.sqrt(max(second_moment, 0.0) / mass), LEAST_RADIUS)
            sizes.append([mass, *[mass * radius] * 3, *[mass * radius**2] * 6])
        joints = [ROTOR * effort, VISCOUS * effort / velocity, COULOMB * effort]
        return cls(
            velocity=velocity,
            effort=effort,
            parameters=np.concatenate([np.ravel(sizes), *joints]),
        )


class Regressor:
    """`τ = Y(q, v, a) θ` of an arm with rotors and friction, in scaled parameters and torques.

    `θ` holds ten parameters of each link, then armature, viscous and Coulomb friction of all
    joints, each divided by its scale; rows are divided by the noise of a torque reading. `sign(v)`
    is smoothed, which makes the design differentiable.

    Args:
        arm: the arm.
        scales: sizes.
    """

    def __init__(self, arm: Arm, scales: Scales) -> None:
        self.arm, self.scales = arm, scales
        self.rows = 1.0 / (NOISE * scales.effort)
        n = arm.nv
        self.columns = scales.parameters[: 10 * n]
        self.of_joints = scales.parameters[10 * n :].reshape(3, n)
        self.smooth = 0.05 * scales.velocity
        self._model, self._data = arm.model, arm.model.createData()

    @property
    def size(self) -> int:
        """Number of parameters."""
        return 13 * self.arm.nv

    def links(self, q: Array, v: Array, a: Array) -> Array:
        """Return Pinocchio's regressor as it is, (10 nv, nv): transposed, a view."""
        table: Array = pin.computeJointTorqueRegressor(self._model, self._data, q, v, a).T
        return table

    def joints(self, v: Array, a: Array) -> Array:
        """Return the columns of rotors and friction on each joint, (N, 3, nv), unscaled."""
        return np.stack([a, v, np.tanh(v / self.smooth)], axis=1)

    def table(self, q: Array, v: Array, a: Array) -> Array:
        """Return the scaled regressor of N states, (N, nv, 13 nv)."""
        n, total = self.arm.nv, len(q)
        out = np.zeros((total, n, self.size))
        for k in range(total):
            out[k, :, : 10 * n] = self.links(q[k], v[k], a[k]).T
        out[:, :, : 10 * n] *= self.columns
        scaled = self.joints(v, a) * self.of_joints
        diagonal = np.arange(n)
        for kind in range(3):
            out[:, diagonal, (10 + kind) * n + diagonal] = scaled[:, kind]
        out *= self.rows[:, None]
        return out

    @cached_property
    def nominal(self) -> Array:
        """Parameters of the arm itself, (13 nv,), scaled."""
        arm = self.arm
        links = [arm.model.inertias[j + 1].toDynamicParameters() for j in range(arm.nv)]
        joints = [arm.armature, arm.damping, arm.friction]
        nominal: Array = np.concatenate([*links, *joints]) / self.scales.parameters
        return nominal

    @cached_property
    def base(self) -> Array:
        """Orthonormal basis of the sums of parameters that torque depends on, (13 nv, rank).

        What is orthogonal to it changes no torque in any motion.
        """
        rng = np.random.default_rng(0)
        n = self.arm.nv
        q = np.array([self.arm.random_configuration(rng) for _ in range(SAMPLES + 10 * n)])
        v = self.scales.velocity * rng.uniform(-1.0, 1.0, (len(q), n))
        a = 5.0 * self.scales.velocity * rng.uniform(-1.0, 1.0, (len(q), n))
        stacked = self.table(q, v, a).reshape(-1, self.size)
        _, sizes, directions = np.linalg.svd(stacked, full_matrices=False)
        found: Array = directions[sizes > SMALLEST * sizes[0]].T
        return np.ascontiguousarray(found)


@dataclass(frozen=True, kw_only=True, eq=False)
class Seen:
    """What is known of a parameter after a motion.

    Attributes:
        body: name of the joint, whose link's or own parameter it is.
        parameter: one of `OF_LINK` and `OF_JOINT`.
        share: part of it that torque depends on, 0 to 1; 1 where it can be told by itself, less
            where only a sum of it with parameters of other links acts.
        deviation: standard deviation of that part, over the size of such a parameter.
    """

    body: str
    parameter: str
    share: float
    deviation: float

    @property
    def alone(self) -> bool:
        """Whether it can be told by itself."""
        return self.share > 1.0 - 1e-6

    @property
    def well(self) -> bool:
        """Whether what can be told of it is told to a tenth of its size."""
        return self.acts and self.deviation < WELL

    @property
    def acts(self) -> bool:
        """Whether torque depends on it at all."""
        return self.share > 1e-6


def seen_in(regressor: Regressor, information: Array) -> tuple[Seen, ...]:
    """Return what a motion tells of each parameter.

    Args:
        regressor: of the arm.
        information: `BᵀYᵀYB` summed over independent readings, (rank, rank), `B` the base.
    """
    base, names = regressor.base, regressor.arm.joint_names
    covariance = np.linalg.pinv(information, rcond=1e-14, hermitian=True)
    shares = np.linalg.norm(base, axis=1)
    spread = np.sqrt(np.einsum("ij,jk,ik->i", base, covariance, base))
    labels = [(name, parameter) for name in names for parameter in OF_LINK]
    labels += [(name, parameter) for parameter in OF_JOINT for name in names]
    return tuple(
        Seen(body=body, parameter=parameter, share=float(share), deviation=float(deviation))
        for (body, parameter), share, deviation in zip(labels, shares, spread, strict=True)
    )
