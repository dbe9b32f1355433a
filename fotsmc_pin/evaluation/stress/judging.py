"""`StressRow`: what a run of the suite came to, in motion and at rest."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.analysis import pose_errors, summarize
from fotsmc_pin.analysis.metrics import torque_variation
from fotsmc_pin.analysis.rest_windows import arrival_time, inside, overshoot, swing_in
from fotsmc_pin.errors import DivergenceError
from fotsmc_pin.evaluation.stress.courses import lasting

if TYPE_CHECKING:
    from fotsmc_pin.control import Controller, SpringObserver
    from fotsmc_pin.evaluation.stress.courses import Course, Rest
    from fotsmc_pin.evaluation.stress.scenario import Scenario
    from fotsmc_pin.learning import ModelLearning
    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.types import Array

INFINITE = float("inf")
LOST = 0.5
"""RMS error from which a run counts as diverged though its speeds stayed bounded [rad]."""


@dataclass(frozen=True, kw_only=True)
class StressRow:
    """What a run of the suite came to.

    The tail is the span of the course in which the error counts: of a sinusoid and of a hold the
    last half, of moves all from the first one on. Swings and torque variation at rest are taken
    over the last half of each rest. What a course does not have is None.

    Attributes:
        arm: name of the arm.
        controller: name of the controller, with what was changed in it.
        scenario: name of the scenario.
        variant: which of the scenario's cases it is.
        tail_rms_error: RMS of the norm of the error in the tail [rad].
        max_tail_error: largest norm of the error in the tail [rad].
        settling_time: to 10 mrad for good [s].
        torque_variation: in the tail [N·m/s].
        saturation_fraction: share of ticks at which some joint is at its effort limit.
        diverged: a joint left every bound, or the tail RMS error is above 0.5 rad.
        swing: of each joint (nv,), the largest of all rests [rad, m].
        arrival_time: until each joint stays below 1 mrad of error and 2 mrad/s of speed, from the
            end of the reference's motion, the longest of all rests [s]; inf where the calm lasts
            less than 0.5 s.
        overshoot: of any joint beyond the end of a move [rad, m].
        rest_torque_variation: the largest of all rests [N·m/s].
        variation_without_friction: the same of the same run on the arm without friction [N·m/s].
        motor_rms_error: `tail_rms_error` of the motors of elastic joints [rad].
        deflection: RMS of the norm of the springs' deflection in the tail [rad]; the links' error
            is that of the motors and this.
        static_deflection: what it would be if each spring stood under the torque that the true
            links need along the reference [rad].
        bandwidth: at which a law ran on elastic joints; None for rigid ones, or a law without it.
        tool_way_error: RMS distance of the tool from the pose that a task asks for [m].
        tool_turn_error: RMS of the turn between the two [rad].
        text: plant and course in words.
    """

    arm: str
    controller: str
    scenario: str = "sine"
    variant: str = "raw"
    tail_rms_error: float = INFINITE
    max_tail_error: float = INFINITE
    settling_time: float = INFINITE
    torque_variation: float = INFINITE
    saturation_fraction: float = 1.0
    diverged: bool = True
    swing: tuple[float, ...] | None = None
    arrival_time: float | None = None
    overshoot: float | None = None
    rest_torque_variation: float | None = None
    variation_without_friction: float | None = None
    motor_rms_error: float | None = None
    deflection: float | None = None
    static_deflection: float | None = None
    bandwidth: float | None = None
    tool_way_error: float | None = None
    tool_turn_error: float | None = None
    text: str = ""

    @property
    def label(self) -> str:
        """Scenario and variant: the column of the table."""
        return f"{self.scenario} {self.variant}".rstrip()

    @property
    def largest_swing(self) -> float | None:
        """Swing of the joint that swings most [rad, m]."""
        return None if self.swing is None else max(self.swing)

    @property
    def friction_ratio(self) -> float | None:
        """Torque variation at rest over that of the same run without friction."""
        ours, other = self.rest_torque_variation, self.variation_without_friction
        if ours is None or other is None or not 0.0 < other < math.inf:
            return None
        return ours / other

    def as_dict(self) -> dict[str, Any]:
        """Return the row as plain data."""
        return asdict(self)


def run_row(
    scenario: Scenario,
    controller: Controller[Any] | ModelLearning | SpringObserver,
    label: str,
    duration: float | None = None,
) -> StressRow:
    """Run a controller in a scenario and judge it; a divergence is a result too.

    Args:
        scenario: what to run.
        controller: of the scenario's nominal arm and tick.
        label: what to call it.
        duration: simulated time [s]; None for the course's.
    """
    course = scenario.course if duration is None else lasting(scenario.course, duration)
    elastic = bool(np.isfinite(scenario.true.joint_stiffness).any())
    lost = StressRow(
        arm=scenario.arm.name,
        controller=label,
        scenario=scenario.name,
        variant=scenario.variant,
        text=scenario.text,
        bandwidth=getattr(controller.gains, "bandwidth", None) if elastic else None,
    )
    try:
        rec = scenario.run(controller, course.duration)
    except DivergenceError:
        return lost
    row = replace(
        judge(rec, lost.arm, label, course),
        scenario=lost.scenario,
        variant=lost.variant,
        text=lost.text,
        bandwidth=lost.bandwidth,
    )
    if scenario.twin is None:
        return row
    without = run_row(scenario.twin, controller, label, duration).rest_torque_variation
    return replace(row, variation_without_friction=without)


def judge(rec: Recording, arm: str, label: str, course: Course | None = None) -> StressRow:
    """Return the row of a run of the controller `label` on `arm`.

    Args:
        rec: the run.
        arm: name of the arm.
        label: name of the controller.
        course: where to judge it; None for the last half.
    """
    summary = summarize(rec)
    row = StressRow(
        arm=arm,
        controller=label,
        tail_rms_error=summary.tail_rms_error,
        max_tail_error=summary.max_tail_error,
        settling_time=summary.settling_time,
        torque_variation=summary.tail_torque_variation,
        saturation_fraction=summary.saturation_fraction,
        diverged=summary.tail_rms_error > LOST,
    )
    if course is None:
        return row
    tail = inside(rec.t, course.judged)
    error = _rms(rec.error_norm[tail])
    row = replace(
        row,
        tail_rms_error=error,
        max_tail_error=float(rec.error_norm[tail].max()),
        torque_variation=torque_variation(rec.t[tail], rec.tau[tail]),
        diverged=error > LOST,
    )
    if "pose_d" in rec.signals:
        e = pose_errors(rec, tail)
        row = replace(
            row,
            tool_way_error=_rms(np.linalg.norm(e[:, :3], axis=1)),
            tool_turn_error=_rms(np.linalg.norm(e[:, 3:], axis=1)),
        )
    if "deflection" in rec.signals:
        row = replace(
            row,
            motor_rms_error=_rms(np.linalg.norm(rec.e_motor[tail], axis=1)),
            deflection=_rms(np.linalg.norm(rec.signals["deflection"][tail], axis=1)),
            static_deflection=_static_deflection(rec, tail, course),
        )
    return _at_rest(row, rec, course.rests) if course.rests else row


def _at_rest(row: StressRow, rec: Recording, rests: tuple[Rest, ...]) -> StressRow:
    t, halves = rec.t, [(0.5 * (rest.start + rest.end), rest.end) for rest in rests]
    swings = np.max([swing_in(t, rec.e, half) for half in halves], axis=0)
    times = [arrival_time(t, rec.e, rec.v, rest[:2]) for rest in rests]
    still = [inside(t, half) for half in halves]
    beyond = [
        overshoot(t, _to_go(rec, rest), (rest.move_start, rest.end)).max()
        for rest in rests
        if rest.move_start is not None
    ]
    return replace(
        row,
        swing=tuple(swings.tolist()),
        arrival_time=max(times),
        rest_torque_variation=max(torque_variation(t[rows], rec.tau[rows]) for rows in still),
        overshoot=float(max(beyond)) if beyond else None,
    )


def _to_go(rec: Recording, rest: Rest) -> Array:
    """Return the end of a move minus the joints' positions, (N, nv)."""
    arm = rec.arm
    last = int(np.flatnonzero(inside(rec.t, rest[:2]))[-1])
    to_come = [arm.difference(q_d, rec.q_d[last]) for q_d in rec.q_d]
    return np.asarray(np.array(to_come) - rec.e)


def _static_deflection(rec: Recording, tail: Array, course: Course) -> float:
    """Return the RMS of the norm of what springs yield to the torque of the links, [rad].

    The motor's inertia is not behind the spring: its share of the inverse dynamics is taken off.
    """
    arm, norms = rec.arm, []
    for t in rec.t[tail][::10].tolist():
        q_d, v_d, a_d = course.reference(t)
        through = arm.inverse_dynamics(q_d, v_d, a_d) - arm.armature * a_d
        norms.append(np.linalg.norm(through / arm.joint_stiffness))
    return _rms(np.array(norms))


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
