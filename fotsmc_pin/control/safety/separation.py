"""`Separation`: distances that must stay open, between links and of the tool to a box's sides."""

from __future__ import annotations

from bisect import insort
from operator import itemgetter
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from fotsmc_pin.arms.self_collision import SelfCollision
from fotsmc_pin.control.safety import limit_bounds
from fotsmc_pin.control.safety import separation_kernels as kernels
from fotsmc_pin.control.safety.shape_speeds import farthest, speeds
from fotsmc_pin.errors import ArgumentError, MissingDependencyError

if TYPE_CHECKING:
    from fotsmc_pin.control.safety.limits import Limits
    from fotsmc_pin.types import Array

MOST_ROWS = 6
"""So many pairs of links are kept apart at a time, the nearest."""
MOST_MEASURED = 8
"""So many distances are measured in a tick at most; those of the others come in the next ones."""
SIDES = 6
"""Distances of the tool to the sides of its box."""
DRAWS, MOSTLY = 50, 0.5
"""Pairs whose convex hulls overlap in most of so many random configurations are left out."""
NARROW = 0.5
"""Links that are always near each other are kept apart by this share of their usual distance."""
SOFT = 8
"""The solver's mark of a constraint that may give way where all cannot be met."""
AXES = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


class Separation:
    """Keeps distances open by a quadratic program in the accelerations.

    A distance `d` that closes at `s = -J v` is treated as a joint's is to its end: `s ≤ V(d)`, with
    the deceleration that the joints have in its direction, `β = ¼ Σ |J_j| β_j`, which bounds
    `-J a`. Where the accelerations that keep the joints' limits break such a bound,

        min ½ (a - a_law)ᵀ M (a - a_law)   with   J a ≥ …,   lower ≤ a ≤ upper,   |M a + h| ≤ τ_max

    is solved (daqp); where not all can be met, distances give way: a bound of a joint that cannot
    be kept is exceeded no further than without them.

    A pair is measured only where it may have come near: each distance that was measured shrinks
    from tick to tick by the most that the joints' speeds allow, and those that may be the least
    are measured first.
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
        self._braking = np.array(limits.braking)
        self._late = limits.delay * dt
        self._box = None if limits.box is None else np.array(limits.box, dtype=np.float64)
        self._model, self._data = self._arm.model, self._arm.model.createData()
        self._shapes: SelfCollision | None = None
        n, most = self._arm.nv, SIDES + MOST_ROWS
        self._rows, self._gaps = np.zeros((most, n)), np.zeros(most)
        self._least, self._own = np.zeros((2, most))
        self._matrix, self._limits = np.zeros((n + most, n)), np.zeros((3, 2 * n + most))
        self._found, self._sides = np.zeros((MOST_ROWS, 7)), np.zeros((MOST_ROWS, n))
        self._nearest = np.zeros(MOST_MEASURED, dtype=np.int64)
        if limits.clearance is not None:
            self._shapes = SelfCollision(self._arm, clearance=limits.clearance)
            self._data = self._shapes._data
            self._use_pairs(self._shapes, limits.clearance)
        self._compile()
        self.reset()

    def reset(self) -> None:
        """Forget what was measured."""
        if self._shapes is not None:
            self._pairs[kernels.BOUND] = -np.inf

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
            gaps, clearance = self.gaps(q), self._pairs[kernels.CLEARANCE]
            k = int(np.argmin(gaps))
            if gaps[k] < 0.0:
                one, other = self._shapes.pairs[self._kept[k]]
                apart = f"{gaps[k] + clearance[k]:.3g} m apart"
                remedy = f"{one} and {other} start {apart}, less than the clearance"
                raise ArgumentError("q", q, f"{remedy} of {clearance[k]:.3g} m")

    def gaps(self, q: Array) -> Array:
        """Return by how much the distance of each pair exceeds its clearance at `q` [m]."""
        if self._shapes is None:
            return np.zeros(0)
        gaps: Array = self._shapes.distances(q)[self._kept] - self._pairs[kernels.CLEARANCE]
        return gaps

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
            table: the joints' bounds, and the accelerations that keep them; see `limit_bounds`.
        """
        count = self._near(q, v)
        if not count:
            return None
        rows, gaps = self._rows[:count], self._gaps[:count]
        least, own = self._least[:count], self._own[:count]
        far = (self._late, self._horizon)
        if kernels.distances_are_kept(v, rows, gaps, self._braking, *far, least, own, table):
            return None
        n = v.size
        kernels.fill_program(M, h, law, rows, least, table, self._matrix, self._limits)
        matrix, limits = self._matrix[: n + count], self._limits[:, : 2 * n + count]
        sense = np.full(2 * n + count, SOFT, dtype=np.int32)
        sense[: 2 * n] = 0
        f, lower, upper = limits[0, :n], limits[1], limits[2]
        a, _, flag, _ = self._solve(np.array(M), f, matrix, upper, lower, sense)
        if flag <= 0:
            return table[limit_bounds.A].copy(), np.inf
        short = (least - rows @ a) / own
        return a, float(max(short.max(), 0.0))

    def _near(self, q: Array, v: Array) -> int:
        """Write gradients of the distances that may close and what is left; return how many."""
        count = 0
        if self._box is not None:
            pin.computeJointJacobians(self._model, self._data, q)
            place = pin.updateFramePlacement(self._model, self._data, self._arm.tool_frame_id)
            jacobian = pin.getFrameJacobian(self._model, self._data, self._arm.tool_frame_id, AXES)
            for side, sign in ((0, 1.0), (1, -1.0)):
                self._rows[count : count + 3] = sign * jacobian[:3]
                gaps = sign * (place.translation - self._box[side])
                self._gaps[count : count + 3] = gaps
                count += 3
        if self._shapes is not None and self._kept.size:
            count += self._add_pairs(q, v, count)
        return count

    def _add_pairs(self, q: Array, v: Array, start: int) -> int:
        """Write the nearest pairs from the row `start` on; return how many."""
        shapes: Any = self._shapes
        pairs, nearest = self._pairs, self._nearest
        more = kernels.nearest_pairs(v, self._dt, self._horizon, self._tables, pairs, nearest)
        if not more:
            return 0
        hulls, data, bounds = shapes._hulls, shapes._hull_data, pairs[kernels.BOUND]
        pin.computeJointJacobians(self._model, self._data, q)
        pin.updateGeometryPlacements(self._model, self._data, hulls, data)
        measured: list[tuple[float, int, Any]] = []
        for k in nearest[:more].tolist():
            if len(measured) >= MOST_ROWS and bounds[k] > measured[MOST_ROWS - 1][0]:
                break  # The six nearest are known: all others are farther.
            found = pin.computeDistance(hulls, data, self._numbers[k])
            bounds[k] = distance = found.min_distance
            insort(measured, (distance, k, found), key=itemgetter(0))
        chosen = measured[:MOST_ROWS]
        for row, (distance, k, found) in enumerate(chosen):
            self._found[row, :3] = found.normal
            self._found[row, 3:6] = found.getNearestPoint1()
            self._found[row, 6] = distance - pairs[kernels.CLEARANCE, k]
            self._sides[row] = self._moved[k]
        count = len(chosen)
        end = start + count
        places = (self._rows[start:end], self._gaps[start:end])
        kernels.gradients(self._data.J, self._found[:count], self._sides[:count], *places)
        return count

    def _compile(self) -> None:
        """Compile the kernels, so that no tick has to wait."""
        n = self._arm.nv
        table, M = np.zeros((limit_bounds.PENDING, n)), np.eye(n)
        none, rows = np.zeros(n), self._rows
        places, numbers = (self._least, self._own), (self._late, self._horizon)
        kernels.gradients(
            self._data.J, self._found, self._sides, rows[:MOST_ROWS], self._gaps[:MOST_ROWS]
        )
        kernels.distances_are_kept(none, rows, self._gaps, self._braking, *numbers, *places, table)
        kernels.fill_program(M, none, none, rows, self._least, table, self._matrix, self._limits)

    def _use_pairs(self, shapes: SelfCollision, clearance: float) -> None:
        """Keep the pairs that are apart somewhere; bound how fast each can close."""
        arm, rng = self._arm, np.random.default_rng(0)
        n = len(shapes.pairs)
        draws = [arm.random_configuration(rng) for _ in range(DRAWS)]
        found = np.array([shapes.distances(q) for q in draws]).reshape(DRAWS, n)
        self._kept = np.flatnonzero((found < 0.0).mean(axis=0) <= MOSTLY)
        self._numbers: list[int] = self._kept.tolist()
        self._pairs = np.zeros((3, self._kept.size))
        usual = np.median(found[:, self._kept], axis=0)
        self._pairs[kernels.CLEARANCE] = np.clip(NARROW * usual, 0.0, clearance)
        objects = shapes._hulls.geometryObjects
        reach = np.array([farthest(arm, shape) for shape in objects])
        pairs = [shapes._hulls.collisionPairs[k] for k in self._numbers]
        first, second = (
            np.array([getattr(pair, side) for pair in pairs], dtype=int)
            for side in ("first", "second")
        )
        # A joint before both links moves them as one piece.
        self._moved = (reach[second] > 0.0) * 1.0 - (reach[first] > 0.0)
        alone = np.abs(self._moved)
        usually = np.zeros_like(reach)
        for q in draws:
            usually = np.maximum(usually, speeds(arm, q, objects))
        tables = [alone * (table[first] + table[second]) for table in (reach, usually)]
        self._tables = np.array(tables)
        strength = kernels.SHARE * self._tables[kernels.SLOPE] @ self._braking
        self._pairs[kernels.NEEDS] = 2.0 * np.maximum(strength, kernels.LEAST_DECELERATION)
