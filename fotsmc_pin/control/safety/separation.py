"""`Separation`: distances that must stay open, between links and of the tool to a box's sides."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms.self_collision import SelfCollision
from fotsmc_pin.control.safety import limit_kernels
from fotsmc_pin.errors import ArgumentError, MissingDependencyError

if TYPE_CHECKING:
    from fotsmc_pin.control.safety.limits import Limits
    from fotsmc_pin.types import Array

MOST_ROWS = 6
"""So many pairs of links are kept apart at a time, the nearest."""
FARTHEST = 0.25
"""Pairs are looked at from this distance beyond the clearance on [m]."""
SHARE = 0.25
"""Share of the joints' decelerations that is counted on in the direction of a distance."""
LEAST_DECELERATION = 0.2
"""Deceleration of a distance in the least favourable direction [m/s²]."""
DRAWS, MOSTLY = 50, 0.5
"""Pairs whose convex hulls overlap in most of so many random configurations are left out."""
NARROW = 0.5
"""Links that are always near each other are kept apart by this share of their usual distance."""
TOLERANCE = 1e-3
UNBOUNDED = 1e30
SOFT = 8
"""The solver's mark of a constraint that may give way where all cannot be met."""
AXES = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


class Separation:
    """Keeps distances open by a quadratic program in the accelerations.

    A distance `d` that closes at `s = -J v` is treated as a joint's is to its end: `s ≤ V(d)`, with
    the deceleration that the joints have in its direction, `β = ¼ Σ |J_j| β_j`, which bounds
    `-J a`. Where the accelerations that keep the joints' limits break such a bound,

        min ½ (a - a_law)ᵀ M (a - a_law)   with   J a ≥ …,   lower ≤ a ≤ upper,   |M a + h| ≤ τ_max

    is solved (daqp); where not all can be met, torque limits come first, and distances last.

    Only pairs are measured that may have come near since they were measured last.
    """

    def __init__(self, limits: Limits, dt: float) -> None:
        """Look up the shapes and the box."""
        try:
            import daqp
        except ImportError:
            raise MissingDependencyError(
                "limits of distances need a solver: pip install daqp"
            ) from None
        self._solve = daqp.solve
        self._arm, self._dt, self._horizon = limits.arm, dt, (limits.delay + 3) * dt
        self._braking = np.asarray(limits.braking)
        self._late = limits.delay * dt
        self._box = None if limits.box is None else np.array(limits.box, dtype=np.float64)
        self._model, self._data = self._arm.model, self._arm.model.createData()
        self._shapes: SelfCollision | None = None
        if limits.clearance is not None:
            self._shapes = SelfCollision(self._arm, clearance=limits.clearance)
            self._data = self._shapes._data
            self._use_pairs(self._shapes, limits.clearance)
        self.reset()

    def reset(self) -> None:
        """Forget what was measured."""
        if self._shapes is not None:
            self._bounds = np.full(len(self._kept), -np.inf)

    def demand_start(self, q: Array) -> None:
        """Refuse a start where links are too close or the tool is outside the box.

        Raises:
            ArgumentError: naming the links, or the side of the box.
        """
        if self._box is not None:
            place = self._arm.tool_pose(q).translation
            for axis, letter in enumerate("xyz"):
                lower, upper = self._box[:, axis]
                if not lower <= place[axis] <= upper:
                    remedy = f"the tool starts at {letter} = {place[axis]:.3g} m, outside the box"
                    raise ArgumentError("q", q, remedy)
        if self._shapes is not None and self._kept.size:
            found = self._shapes.distances(q)[self._kept]
            k = int(np.argmin(found - self._clearance))
            if found[k] < self._clearance[k]:
                one, other = self._shapes.pairs[self._kept[k]]
                remedy = f"{one} and {other} start {found[k]:.3g} m apart, less than the clearance"
                raise ArgumentError("q", q, f"{remedy} of {self._clearance[k]:.3g} m")

    def accelerations(
        self, q: Array, v: Array, M: Array, h: Array, law: Array, table: Array
    ) -> tuple[Array, float] | None:
        """Return accelerations (nv,) that keep the distances, and the worst excess; None if kept.

        Args:
            q: configuration (nq,).
            v: velocity (nv,).
            M: mass matrix (nv, nv).
            h: `C v + G` (nv,).
            law: torque of the law (nv,).
            table: the joints' bounds, and the accelerations that keep them; see `limit_kernels`.
        """
        rows, gaps = self._near(q, v)
        if not len(gaps):
            return None
        closing = -(rows @ v)
        braking = np.maximum(SHARE * np.abs(rows) @ self._braking, LEAST_DECELERATION)
        least = -self._room(gaps - self._late * np.maximum(closing, 0.0), closing, braking)
        if (rows @ table[limit_kernels.A] >= least - TOLERANCE * braking).all():
            return None
        n = v.size
        f = -np.asarray(law - h)
        A = np.ascontiguousarray(np.vstack([M, rows]))
        upper = np.concatenate(
            [
                table[limit_kernels.MOST],
                table[limit_kernels.MOST_TORQUE] - h,
                np.full(len(gaps), UNBOUNDED),
            ]
        )
        lower = np.concatenate(
            [table[limit_kernels.LEAST], table[limit_kernels.LEAST_TORQUE] - h, least]
        )
        upper, lower = np.minimum(upper, UNBOUNDED), np.maximum(lower, -UNBOUNDED)
        sense = np.full(upper.size, SOFT, dtype=np.int32)
        sense[: 2 * n] = 0
        for firm in (2 * n, n):
            # The joints' own limits come before distances, and torque limits before all.
            sense[: 2 * n - firm] = SOFT
            a, _, flag, _ = self._solve(np.array(M), f, A, upper, lower, sense)
            if flag > 0:
                break
        else:
            return table[limit_kernels.A].copy(), np.inf
        short = (least - rows @ a) / braking
        return a, float(max(short.max(), 0.0))

    def _room(self, gap: Array, closing: Array, braking: Array) -> Array:
        """Return the most acceleration of each closing distance, as `limit_kernels.room` does."""
        slow = 4.0 * self._horizon
        bend = braking * slow * slow
        far = gap > bend
        root = np.sqrt(2.0 * braking * np.where(far, gap - 0.5 * bend, bend))
        allowed = np.where(far, root, gap / slow)
        slope = np.where(far, braking / root, 1.0 / slow)
        most: Array = (allowed - closing) / self._horizon - slope * np.maximum(closing, 0.0)
        return most

    def _near(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Return gradients (k, nv) of the distances that may close, and what is left of each."""
        rows: list[Array] = []
        gaps: list[float] = []
        pin.computeJointJacobians(self._model, self._data, q)
        if self._box is not None:
            place = pin.updateFramePlacement(self._model, self._data, self._arm.tool_frame_id)
            jacobian = pin.getFrameJacobian(self._model, self._data, self._arm.tool_frame_id, AXES)
            for side, sign in ((0, 1.0), (1, -1.0)):
                rows.extend(sign * jacobian[:3])
                gaps.extend(sign * (place.translation - self._box[side]))
        if self._shapes is not None and self._kept.size:
            self._add_pairs(q, v, rows, gaps)
        return np.array(rows).reshape(len(gaps), v.size), np.array(gaps)

    def _add_pairs(self, q: Array, v: Array, rows: list[Array], gaps: list[float]) -> None:
        shapes: Any = self._shapes
        speed = self._reach @ np.abs(v)
        self._bounds -= speed * self._dt
        way = 0.02 + speed * 5.0 * self._horizon + speed**2 / self._needs
        within = self._clearance + np.minimum(way, FARTHEST)
        near = np.flatnonzero(self._bounds < within)
        if not near.size:
            return
        hulls, data = shapes._hulls, shapes._hull_data
        pin.updateGeometryPlacements(self._model, self._data, hulls, data)
        for k in near:
            self._bounds[k] = pin.computeDistance(hulls, data, int(self._kept[k])).min_distance
        for k in near[np.argsort(self._bounds[near])[:MOST_ROWS]]:
            if self._bounds[k] < within[k]:
                rows.append(shapes.gradient(int(self._kept[k])))
                gaps.append(float(self._bounds[k] - self._clearance[k]))

    def _use_pairs(self, shapes: SelfCollision, clearance: float) -> None:
        """Keep the pairs that are apart somewhere; bound how fast each can close."""
        arm, rng = self._arm, np.random.default_rng(0)
        n = len(shapes.pairs)
        draws = [arm.random_configuration(rng) for _ in range(DRAWS)]
        found = np.array([shapes.distances(q) for q in draws]).reshape(DRAWS, n)
        self._kept = np.flatnonzero((found < 0.0).mean(axis=0) <= MOSTLY)
        usual = np.median(found[:, self._kept], axis=0)
        self._clearance = np.clip(NARROW * usual, 0.0, clearance)
        pairs = [shapes._hulls.collisionPairs[int(k)] for k in self._kept]
        objects = shapes._hulls.geometryObjects
        reach = [_extent(shape) for shape in objects]
        slopes = np.zeros((len(pairs), arm.nv))
        for q in draws:
            pin.computeJointJacobians(self._model, self._data, q)
            for k, pair in enumerate(pairs):
                speeds = np.zeros((2, arm.nv))
                for side, shape in enumerate((pair.first, pair.second)):
                    joint = objects[shape].parentJoint
                    if joint:
                        J = pin.getJointJacobian(self._model, self._data, joint, AXES)
                        turning = np.linalg.norm(J[3:], axis=0)
                        speeds[side] = np.linalg.norm(J[:3], axis=0) + reach[shape] * turning
                # A joint before both links moves them as one piece.
                alone = (speeds[0] > 0.0) != (speeds[1] > 0.0)
                slopes[k] = np.maximum(slopes[k], np.where(alone, speeds.sum(axis=0), 0.0))
        self._reach = slopes
        self._needs = 2.0 * np.maximum(SHARE * slopes @ self._braking, LEAST_DECELERATION)


def _extent(shape: Any) -> float:
    """Return how far a shape reaches from the origin of its joint [m]."""
    shape.geometry.computeLocalAABB()
    box = shape.geometry.aabb_local
    corner = np.maximum(np.abs(box.min_), np.abs(box.max_))
    return float(np.linalg.norm(shape.placement.translation) + np.linalg.norm(corner))
