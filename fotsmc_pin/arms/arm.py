"""`Arm`: a robot arm from a URDF, its limits and the terms of its equation of motion."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms.joint_numbers import JointNumbers, frozen
from fotsmc_pin.arms.known_friction import friction_is_known
from fotsmc_pin.arms.markup import parse_urdf
from fotsmc_pin.arms.model import build_model
from fotsmc_pin.arms.mounting import base_gravity
from fotsmc_pin.arms.singular import joint_without_inertia, no_inertia
from fotsmc_pin.arms.tree import UrdfTree
from fotsmc_pin.arms.visuals import visual_model
from fotsmc_pin.checks import finite_vector
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.files import write_text
from fotsmc_pin.notebook import page_of

if TYPE_CHECKING:
    from collections.abc import Mapping
    from os import PathLike

    from numpy.typing import ArrayLike

    from fotsmc_pin.types import Array


@dataclass(frozen=True, kw_only=True)
class Arm(JointNumbers):
    """A robot arm: `M(q) a + C(q, v) v + G(q) = τ`.

    Make one with `load_arm` or `perturb`. An arm never changes. It is its URDF: everything else
    follows from that text. Two arms are equal when all that is listed below is, and an arm goes
    to another process or into a file as text (`to_dict`, pickle).

    The terms include the armature (the motors' inertia seen from the joint). They leave out joint
    friction and damping, as all of Pinocchio's algorithms do: whatever moves the arm adds
    `-damping ∘ v - friction ∘ sign(v)`.

    `q` has `nq` entries, `v`, `a` and `τ` have `nv`. For a continuous joint `q` holds the cosine
    and the sine of the angle, so never subtract configurations: use `difference`. The methods
    that take `q` share one scratch memory; do not call them on one arm from several threads.

    Attributes:
        urdf: the whole arm as URDF text; locked joints are fixed ones, overrides are written in.
        name: what to call it.
        package_dirs: folders in which `package://` addresses of meshes are looked up.
        tool_frame: name of the link at the tool.
        changes: what `perturb` did, in plain words.
        notes: what loading decided, in plain words (joints locked, numbers filled in).
    """

    urdf: str
    name: str
    tool_frame: str
    package_dirs: tuple[str, ...] = ()
    changes: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Build the model now, so that a bad URDF fails here."""
        _ = self.friction_is_known
        if not self.model.existFrame(self.tool_frame, pin.FrameType.BODY):
            known = ", ".join(self.tree.links)
            raise ArgumentError("tool_frame", self.tool_frame, f"choose one of {known}")

    def __repr__(self) -> str:
        """Name and size; the URDF itself would fill pages."""
        return f"Arm({self.name!r}, nq={self.nq}, nv={self.nv}, tool_frame={self.tool_frame!r})"

    _repr_html_ = page_of

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as text: Pinocchio's objects are rebuilt when it is loaded."""
        return Arm.from_dict, (self.to_dict(),)

    def to_dict(self) -> dict[str, Any]:
        """Return what `from_dict` needs to rebuild the arm, ready for JSON."""
        return {
            "urdf": self.urdf,
            "name": self.name,
            "tool_frame": self.tool_frame,
            "package_dirs": list(self.package_dirs),
            "changes": list(self.changes),
            "notes": list(self.notes),
        }

    @classmethod
    def from_dict(cls, parts: Mapping[str, Any]) -> Arm:
        """Rebuild an arm from `to_dict`."""
        lists = ("package_dirs", "changes", "notes")
        return cls(**{**parts, **{name: tuple(parts[name]) for name in lists}})

    @cached_property
    def tree(self) -> UrdfTree:
        """The URDF as links and joints by name; to be read, not changed."""
        return UrdfTree(parse_urdf(self.urdf, self.name), self.name)

    @cached_property
    def model(self) -> pin.Model:
        """Pinocchio's model, with armature and limits filled in; never change it."""
        return build_model(self.tree)

    @cached_property
    def _data(self) -> pin.Data:
        return self.model.createData()

    # Shape

    @property
    def nq(self) -> int:
        """Number of position coordinates."""
        return int(self.model.nq)

    @property
    def nv(self) -> int:
        """Number of degrees of freedom."""
        return int(self.model.nv)

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the moving joints, one per degree of freedom."""
        return tuple(self.model.names)[1:]

    @property
    def is_euclidean(self) -> bool:
        """Whether `q - q_d` is the position error: no continuous joints."""
        return self.nq == self.nv

    @cached_property
    def tool_frame_id(self) -> int:
        """Index of the tool frame among `model.frames`; a joint may bear the same name."""
        return int(self.model.getFrameId(self.tool_frame, pin.FrameType.BODY))

    @cached_property
    def base_gravity(self) -> Array:
        """Gravity that the arm feels, in the frame of its base, (3,) [m/s²]."""
        return frozen(base_gravity(self.tree))

    @cached_property
    def friction_is_known(self) -> bool:
        """Whether the file's friction is that of the real arm, which laws then feed forward.

        So it is in arms of `identify` and `ModelLearning.learned_arm`, and where
        `<fotsmc_pin friction="known"/>` stands below `<robot>`. Without it friction is taken for
        what the plant may have, and no law counts on it: what makers write is often invented.
        """
        return friction_is_known(self.tree)

    @cached_property
    def idle_joint(self) -> str | None:
        """Name of a joint that moves no inertia wherever the arm is, None where all move some."""
        return joint_without_inertia(self)

    # Terms of the equation of motion

    def mass_matrix(self, q: ArrayLike) -> Array:
        """Return `M(q)`, (nv, nv) [kg·m²], with the armature on its diagonal."""
        return np.array(pin.crba(self.model, self._data, self._configuration(q)))

    def coriolis(self, q: ArrayLike, v: ArrayLike) -> Array:
        """Return `C(q, v)`, (nv, nv), such that `Ṁ - 2C` is skew-symmetric."""
        q, v = self._configuration(q), self._tangent("v", v)
        return np.array(pin.computeCoriolisMatrix(self.model, self._data, q, v))

    def gravity(self, q: ArrayLike) -> Array:
        """Return `G(q)`, (nv,) [N·m or N]: the effort that holds the arm still."""
        return np.array(
            pin.computeGeneralizedGravity(self.model, self._data, self._configuration(q))
        )

    def inverse_dynamics(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Array:
        """Return `τ = M a + C v + G`, (nv,) [N·m or N]."""
        q, v, a = self._configuration(q), self._tangent("v", v), self._tangent("a", a)
        return np.array(pin.rnea(self.model, self._data, q, v, a))

    def forward_dynamics(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike) -> Array:
        """Return `a = M⁻¹ (τ - C v - G)`, (nv,) [rad/s² or m/s²].

        Raises:
            UrdfError: a joint moves no inertia, as `demand_dynamics` says.
        """
        self.demand_dynamics()
        q, v, tau = self._configuration(q), self._tangent("v", v), self._tangent("tau", tau)
        return np.array(pin.aba(self.model, self._data, q, v, tau))

    def demand_dynamics(self) -> None:
        """Refuse an arm that has no forward dynamics: its mass matrix is singular everywhere.

        Kinematics, gravity and inverse dynamics of such an arm are sound.

        Raises:
            UrdfError: naming the joint that moves no inertia, and the remedy.
        """
        if self.idle_joint is not None:
            raise no_inertia(self, self.idle_joint)

    # Configurations

    @cached_property
    def neutral(self) -> Array:
        """A plain configuration, (nq,): zero, or mid-range for joints whose limits exclude zero."""
        lower, upper = self.lower_position_limit, self.upper_position_limit
        outside, bounded = (lower > 0.0) | (upper < 0.0), np.isfinite(lower) & np.isfinite(upper)
        middle = 0.5 * (np.where(bounded, lower, 0.0) + np.where(bounded, upper, 0.0))
        nearest = np.where(bounded, middle, np.clip(0.0, lower, upper))
        return frozen(self.from_joint_positions(np.where(outside, nearest, 0.0)))

    def difference(self, q_d: ArrayLike, q: ArrayLike) -> Array:
        """Return the tangent error `e = q ⊖ q_d`, (nv,) [rad or m].

        Plain joints give `q - q_d`; continuous joints the shortest turn from `q_d` to `q`.
        """
        return np.array(
            pin.difference(self.model, self._configuration(q_d, "q_d"), self._configuration(q))
        )

    def integrate(self, q: ArrayLike, dv: ArrayLike) -> Array:
        """Return `q ⊕ dv`, (nq,): the configuration reached from `q` by the tangent step `dv`."""
        return np.array(pin.integrate(self.model, self._configuration(q), self._tangent("dv", dv)))

    def from_joint_positions(self, positions: ArrayLike) -> Array:
        """Return the configuration, (nq,), of one angle or travel per joint, (nv,) [rad or m]."""
        positions = self._tangent("positions", positions)
        return np.array(pin.integrate(self.model, pin.neutral(self.model), positions))

    def to_joint_positions(self, q: ArrayLike) -> Array:
        """Return one angle or travel per joint, (nv,) [rad or m]; continuous ones in [-π, π]."""
        return np.array(pin.difference(self.model, pin.neutral(self.model), self._configuration(q)))

    def random_configuration(self, rng: np.random.Generator) -> Array:
        """Return a configuration, (nq,), uniform inside the limits.

        A joint without limits turns within [-π, π] or slides within [-1, 1] m.
        """
        span = np.where(np.array(self.position_units) == "m", 1.0, np.pi)
        lower, upper = self.lower_position_limit, self.upper_position_limit
        low = np.where(np.isfinite(lower), lower, np.where(np.isfinite(upper), upper, 0.0) - span)
        high = np.where(np.isfinite(upper), upper, np.where(np.isfinite(lower), lower, 0.0) + span)
        return self.from_joint_positions(rng.uniform(low, high))

    def tool_pose(self, q: ArrayLike) -> pin.SE3:
        """Return where the tool frame is at `q`, in the frame of the world.

        `.translation` (3,) [m] is its origin, `.rotation` (3, 3) has its axes as columns.
        """
        pin.framesForwardKinematics(self.model, self._data, self._configuration(q))
        return self._data.oMf[self.tool_frame_id].copy()

    # Looks and files

    def write_urdf(self, path: str | PathLike[str]) -> Path:
        """Write the arm as a URDF that loads to the same dynamics, and return its path.

        Meshes and unknown tags of the original are kept; a comment states the changes. The file
        appears whole or not at all, and replaces one of that name.

        Raises:
            OSError: the file cannot be written.
        """
        write_text(path, self.urdf)
        return Path(path)

    def visual_model(self) -> pin.GeometryModel:
        """Return what the arm looks like; its meshes are read on the first call.

        Warns:
            UserWarning: a mesh is not there; the arm is drawn without it.
        """
        return self._visual_model

    @cached_property
    def _visual_model(self) -> pin.GeometryModel:
        return visual_model(self.tree, self.model, self.package_dirs)

    def _configuration(self, q: ArrayLike, name: str = "q") -> Array:
        return finite_vector(name, q, self.nq)

    def _tangent(self, name: str, vector: ArrayLike) -> Array:
        return finite_vector(name, vector, self.nv)
