"""What the URDF of an arm says in numbers of each joint: limits, friction, armature, units."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.arms.properties import read_properties

if TYPE_CHECKING:
    from fotsmc_pin.arms.tree import UrdfTree
    from fotsmc_pin.types import Array


class JointNumbers(ABC):
    """Numbers per degree of freedom, in the order of `joint_names`, read from the tree once."""

    @property
    @abstractmethod
    def tree(self) -> UrdfTree:
        """The URDF."""

    @property
    @abstractmethod
    def joint_names(self) -> tuple[str, ...]:
        """Names of the moving joints."""

    @cached_property
    def position_units(self) -> tuple[str, ...]:
        """Unit of each joint's position: "rad", or "m" for a prismatic joint."""
        kinds = [self.tree.joints[name].type for name in self.joint_names]
        return tuple("m" if kind == "prismatic" else "rad" for kind in kinds)

    @cached_property
    def effort_units(self) -> tuple[str, ...]:
        """Unit of each joint's effort: "N·m", or "N" for a prismatic joint."""
        return tuple("N" if unit == "m" else "N·m" for unit in self.position_units)

    @cached_property
    def effort_limit(self) -> Array:
        """Largest effort of each joint, (nv,) [N·m or N], inf where not given."""
        return self._per_joint("effort_limit")

    @cached_property
    def velocity_limit(self) -> Array:
        """Largest speed of each joint, (nv,) [rad/s or m/s], inf where not given."""
        return self._per_joint("velocity_limit")

    @cached_property
    def lower_position_limit(self) -> Array:
        """Lowest position of each joint, (nv,) [rad or m], -inf where not given."""
        return self._per_joint("lower_position_limit")

    @cached_property
    def upper_position_limit(self) -> Array:
        """Highest position of each joint, (nv,) [rad or m], inf where not given."""
        return self._per_joint("upper_position_limit")

    @cached_property
    def armature(self) -> Array:
        """Motor inertia seen from each joint, (nv,) [kg·m² or kg]; part of the mass matrix."""
        return self._per_joint("armature")

    @cached_property
    def friction(self) -> Array:
        """Coulomb friction of each joint, (nv,) [N·m or N]; not part of the terms here."""
        return self._per_joint("friction")

    @cached_property
    def damping(self) -> Array:
        """Viscous friction of each joint, (nv,) [N·m·s/rad or N·s/m]; not part of the terms."""
        return self._per_joint("damping")

    @cached_property
    def stiction(self) -> Array:
        """Force of breakaway over Coulomb friction of each joint, (nv,), 1 where not given."""
        return self._per_joint("stiction")

    @cached_property
    def stribeck_velocity(self) -> Array:
        """Speed at which the excess of breakaway fades, (nv,) [rad/s or m/s]; see `perturb`."""
        return self._per_joint("stribeck_velocity")

    @cached_property
    def joint_stiffness(self) -> Array:
        """Stiffness between motor and link, (nv,) [N·m/rad or N/m], inf for a rigid joint."""
        return self._per_joint("joint_stiffness")

    @cached_property
    def joint_damping(self) -> Array:
        """Damping between motor and link, (nv,) [N·m·s/rad or N·s/m]."""
        return self._per_joint("joint_damping")

    def _per_joint(self, name: str) -> Array:
        joints = (self.tree.joints[joint] for joint in self.joint_names)
        return frozen(
            np.array([getattr(read_properties(self.tree, joint), name) for joint in joints])
        )


def frozen(vector: Array) -> Array:
    """Return the vector, from now on read-only."""
    vector.flags.writeable = False
    return vector
