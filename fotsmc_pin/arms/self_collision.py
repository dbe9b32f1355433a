"""`SelfCollision`: where the links of an arm come too close to each other, or to a floor."""

from __future__ import annotations

import copy
import warnings
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms.markup import urdf_text
from fotsmc_pin.arms.visuals import find_mesh

if TYPE_CHECKING:
    from fotsmc_pin.arms.arm import Arm
    from fotsmc_pin.types import Array

FLOOR = "floor"
SIDE, THICKNESS = 100.0, 1.0
"""Size of the floor, a flat box [m]."""
DRAWS, MOSTLY = 50, 0.5
"""Two links that touch at neutral are taken for one piece where they touch in more than this share
of so many random configurations too."""


class SelfCollision:
    """Distances between the links of an arm, by the collision shapes of its URDF.

    Two answers are given. `distances` are those of the convex hulls of the shapes, which are quick,
    have gradients, and are never larger than the true ones. `collides` asks the shapes themselves
    wherever the hulls come too close.

    Pairs of one link, and of links that a joint connects, are left out, as their shapes overlap by
    design; so are pairs that touch at `arm.neutral` and in most random configurations. Two links
    that touch at neutral and hardly elsewhere are a real collision, and are kept. Pairs that are
    nearer than the clearance there, by design, need not keep it: they must not touch.

    Args:
        arm: the arm; without collision shapes it never collides.
        clearance: distance that counts as a collision [m].
        floor: height of a floor in the frame of the world [m] below which no moving link may come;
            None for none.

    Attributes:
        clearances: distance of each pair that counts as a collision (n,) [m]: the clearance, or 0.
        pairs: names of the shapes of each pair that is looked at.
        left_out: those that touch always.
    """

    def __init__(self, arm: Arm, *, clearance: float = 0.01, floor: float | None = None) -> None:
        self.arm = arm
        self._model, self._data = arm.model, arm.model.createData()
        self._shapes = collision_model(arm)
        if floor is not None:
            self._add_floor(floor)
        self._add_pairs()
        self.left_out = self._drop(self._mostly_nearer_than(0.0))
        near = self._mostly_nearer_than(clearance)
        self.clearances = np.where(near, 0.0, clearance)
        self._exact = self._shapes.createData()
        for request, least in zip(self._exact.collisionRequests, self.clearances, strict=True):
            request.security_margin = float(least)

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """Names of the shapes of each pair."""
        objects = self._shapes.geometryObjects
        return tuple(
            (objects[p.first].name, objects[p.second].name) for p in self._shapes.collisionPairs
        )

    def distances(self, q: Array) -> Array:
        """Return the distance of the hulls of each pair, (n,) [m], negative where they overlap."""
        pin.computeDistances(self._model, self._data, self._hulls, self._hull_data, q)
        return np.array([result.min_distance for result in self._hull_data.distanceResults])

    def gradient(self, pair: int) -> Array:
        """Return how the distance of a pair changes with the joints, (nv,), at the last `q`."""
        found = self._hull_data.distanceResults[pair]
        sides = self._hulls.collisionPairs[pair]
        points = found.getNearestPoint1(), found.getNearestPoint2()
        normal = np.asarray(found.normal)
        slope: Array = normal @ (
            self._point_jacobian(sides.second, points[1])
            - self._point_jacobian(sides.first, points[0])
        )
        return slope

    def collides(self, q: Array) -> bool:
        """Return whether any pair of shapes is closer than the clearance."""
        if not len(self._shapes.collisionPairs):
            return False
        near = np.flatnonzero(self.distances(q) < self.clearances)
        if not near.size:
            return False
        pin.updateGeometryPlacements(self._model, self._data, self._shapes, self._exact, q)
        return any(pin.computeCollision(self._shapes, self._exact, int(k)) for k in near)

    def prepare_gradients(self, q: Array) -> Array:
        """Return `distances(q)`, and make `gradient` ready."""
        pin.computeJointJacobians(self._model, self._data, q)
        return self.distances(q)

    @cached_property
    def _hulls(self) -> pin.GeometryModel:
        hulls = self._shapes.copy()
        for shape in hulls.geometryObjects:
            if hasattr(shape.geometry, "buildConvexHull"):
                # A hull of its own: the geometry is shared with the original.
                body = shape.geometry.clone()
                body.buildConvexHull(False, "Qt")
                shape.geometry = body.convex
        return hulls

    @cached_property
    def _hull_data(self) -> Any:
        return self._hulls.createData()

    def _point_jacobian(self, shape: int, point: Any) -> Array:
        joint = self._hulls.geometryObjects[shape].parentJoint
        if joint == 0:
            return np.zeros((3, self._model.nv))
        frame = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        jacobian = pin.getJointJacobian(self._model, self._data, joint, frame)
        arm = np.asarray(point) - self._data.oMi[joint].translation
        moved: Array = jacobian[:3] - pin.skew(arm) @ jacobian[3:]
        return moved

    def _add_floor(self, height: float) -> None:
        import coal  # type: ignore[import-untyped]

        place = pin.SE3(np.eye(3), np.array([0.0, 0.0, height - 0.5 * THICKNESS]))
        box = coal.Box(SIDE, SIDE, THICKNESS)
        self._shapes.addGeometryObject(pin.GeometryObject(FLOOR, 0, 0, place, box))

    def _add_pairs(self) -> None:
        shapes, parents = self._shapes, self._model.parents
        joints = [shape.parentJoint for shape in shapes.geometryObjects]
        for first, a in enumerate(joints):
            for second in range(first + 1, len(joints)):
                b = joints[second]
                connected = parents[a] == b or parents[b] == a
                if a != b and not connected:
                    shapes.addCollisionPair(pin.CollisionPair(first, second))

    def _mostly_nearer_than(self, distance: float) -> np.ndarray:
        """Return which pairs are nearer than a distance at neutral and in most configurations."""
        shapes = self._shapes
        data = shapes.createData()
        for request in data.collisionRequests:
            request.security_margin = distance

        def near(q: Array) -> np.ndarray:
            pin.computeCollisions(self._model, self._data, shapes, data, q, False)
            return np.array([found.isCollision() for found in data.collisionResults], dtype=bool)

        at_neutral = near(self.arm.neutral)
        if not at_neutral.any():
            return at_neutral
        rng = np.random.default_rng(0)
        draws = [near(self.arm.random_configuration(rng)) for _ in range(DRAWS)]
        found: np.ndarray = at_neutral & (np.mean(draws, axis=0) > MOSTLY)
        return found

    def _drop(self, which: np.ndarray) -> tuple[tuple[str, str], ...]:
        names = tuple(self.pairs[k] for k in np.flatnonzero(which))
        pairs = [self._shapes.collisionPairs[int(k)] for k in np.flatnonzero(which)]
        for pair in [pin.CollisionPair(pair.first, pair.second) for pair in pairs]:
            self._shapes.removeCollisionPair(pair)
        return names


def collision_model(arm: Arm) -> pin.GeometryModel:
    """Return the collision shapes of an arm, without the meshes that cannot be found.

    Warns:
        UserWarning: names each mesh that is not there.
    """
    robot = copy.deepcopy(arm.tree.robot)
    for link in robot.findall("link"):
        for shape in link.findall("collision"):
            mesh = shape.find("geometry/mesh")
            if mesh is not None and find_mesh(mesh.get("filename", ""), arm.package_dirs) is None:
                link.remove(shape)
                warnings.warn(
                    f"{arm.name}: mesh {mesh.get('filename')!r} of link {link.get('name')!r} "
                    "is not there: collisions of this shape go unseen; package_dirs says where "
                    "packages are",
                    UserWarning,
                    stacklevel=2,
                )
    return pin.buildGeomFromUrdfString(
        arm.model,
        urdf_text(robot),
        pin.GeometryType.COLLISION,
        package_dirs=list(arm.package_dirs),
    )
