"""`inspect_arm`: the properties of an arm, what it can carry, and what looks wrong."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms.demand import demand_arm
from fotsmc_pin.arms.rotors import rotor_remark
from fotsmc_pin.arms.suspicions import suspicions
from fotsmc_pin.checks import count

if TYPE_CHECKING:
    from fotsmc_pin.arms.arm import Arm
    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Inspection:
    """Properties of an arm, over random configurations inside its limits.

    Attributes:
        arm: the arm.
        total_mass: of all links that move [kg].
        gravity_load: largest effort that gravity asks of each joint, (nv,) [N·m or N].
        inertia_range: smallest and largest diagonal entry of `M` of each joint, (nv, 2).
        condition: median and largest condition number of `M`, (2,).
        payload: mass at the tool frame that the effort limits can still hold in every one of the
            configurations [kg]; inf without effort limits, 0 where the arm cannot hold itself.
        warnings: what looks wrong, in plain words.
        remarks: what is right in the file and worth knowing all the same, in plain words.
    """

    arm: Arm
    total_mass: float
    gravity_load: Array
    inertia_range: Array
    condition: tuple[float, float]
    payload: float
    warnings: tuple[str, ...]
    remarks: tuple[str, ...] = ()

    @property
    def gravity_share(self) -> Array:
        """Gravity load over effort limit, (nv,); 0 where no limit is given."""
        return np.asarray(self.gravity_load / self.arm.effort_limit)


def inspect_arm(arm: Arm, *, samples: int = 200, seed: int = 0) -> Inspection:
    """Measure an arm at random configurations and look for what is wrong with it.

    Args:
        arm: the arm.
        samples: how many configurations.
        seed: where they are drawn from.
    """
    demand_arm(arm)
    rng = np.random.default_rng(seed)
    configurations = [arm.random_configuration(rng) for _ in range(count("samples", samples))]
    gravity = np.array([arm.gravity(q) for q in configurations])
    masses = np.array([arm.mass_matrix(q) for q in configurations])
    conditions = np.linalg.cond(masses)
    diagonals = np.diagonal(masses, axis1=1, axis2=2)
    load = np.abs(gravity).max(axis=0)
    return Inspection(
        arm=arm,
        total_mass=sum(inertia.mass for inertia in arm.model.inertias[1:]),
        gravity_load=load,
        inertia_range=np.stack([diagonals.min(axis=0), diagonals.max(axis=0)], axis=1),
        condition=(float(np.median(conditions)), float(conditions.max())),
        payload=_payload(arm, configurations, gravity),
        warnings=tuple(suspicions(arm, gravity_load=load, condition=float(conditions.max()))),
        remarks=tuple(remark for remark in (rotor_remark(arm),) if remark is not None),
    )


def _payload(arm: Arm, configurations: list[Array], gravity: Array) -> float:
    """Largest mass at the tool frame with `|G + m Jᵀ g| ≤ effort limit` everywhere sampled."""
    data = arm.model.createData()
    least = np.inf
    for q, load in zip(configurations, gravity, strict=True):
        jacobian = pin.computeFrameJacobian(
            arm.model, data, q, arm.tool_frame_id, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        )
        per_kilogram = -jacobian[:3].T @ arm.model.gravity.linear
        heavier = np.abs(per_kilogram) > 1e-9
        # The load grows towards the limit in its direction.
        margin = arm.effort_limit - np.sign(per_kilogram) * load
        least = min(least, np.min(margin[heavier] / np.abs(per_kilogram[heavier]), initial=np.inf))
    return max(0.0, float(least))
