"""The law at the tool beside pink's inverse kinematics with computed torque, on one stress case.

    python -m tests.benchmarks.task_space panda ur5

For each arm: errors of the tool over the last half of the course, and the processor time of a tick
over that of the bare calls, `crba`, Coriolis matrix, gravity and Jacobian, in the same run: of the
least times, and of the medians.
"""

from __future__ import annotations

import sys
import time

import numpy as np
import pink
import pinocchio as pin
from pink.tasks import FrameTask, PostureTask

import fotsmc_pin as fp
from fotsmc_pin.analysis import pose_errors
from fotsmc_pin.evaluation.stress import stress_scenario

ROUNDS, TICKS, FIRST = 40, 100, 2000
"""Rounds, ticks in each, and the tick of the course from which they are taken."""


class PinkAndComputedTorque:
    """Differential inverse kinematics at 1 kHz, whose configuration computed torque follows."""

    follows_poses = True

    def __init__(self, arm, dt, preset):
        self.arm, self.dt = arm, dt
        self.law = fp.ComputedTorque(arm, dt, preset=preset)
        self._pose, self._pose_d = np.zeros(7), np.zeros(7)
        self.live_signals = {"pose": self._pose, "pose_d": self._pose_d, "pose_f": np.zeros(7)}
        self.resolved = np.zeros(arm.nq), np.zeros(arm.nv)
        self._model = pin.Model(arm.model)
        self._model.frames[arm.tool_frame_id].name = "tool of the task"
        self.reset()

    @property
    def signals(self):
        return {name: signal.copy() for name, signal in self.live_signals.items()}

    def reset(self):
        self.law.reset()
        self._configuration = None

    def update(self, q, v, T, V, A, dt=None):
        if self._configuration is None:
            data = self._model.createData()
            self._configuration = pink.Configuration(self._model, data, np.array(q))
            self._tasks = [
                FrameTask("tool of the task", position_cost=1.0, orientation_cost=1.0),
                PostureTask(cost=1e-3),
            ]
            self._tasks[1].set_target(np.array(q))
            self._v_d = np.zeros(self.arm.nv)
        self._tasks[0].set_target(T)
        v_d = pink.solve_ik(
            self._configuration, self._tasks, self.dt, solver="daqp", damping=1e-9, limits=[]
        )
        self._configuration.integrate_inplace(v_d, self.dt)
        a_d, self._v_d = (v_d - self._v_d) / self.dt, v_d
        a_d = np.clip(a_d, -20.0, 20.0)
        self._pose_d[:] = pin.SE3ToXYZQUAT(T)
        self.resolved[0][:], self.resolved[1][:] = self._configuration.q, v_d
        return self.law.update(q, v, self._configuration.q, v_d, a_d)


def bare_calls(arm):
    model, data = arm.model, arm.model.createData()
    frame, local = arm.tool_frame_id, pin.ReferenceFrame.LOCAL

    def call(q, v, *_):
        pin.crba(model, data, q)
        pin.computeCoriolisMatrix(model, data, q, v)
        pin.computeGeneralizedGravity(model, data, q)
        pin.computeFrameJacobian(model, data, q, frame, local)

    return call


def tick_times(arm, controllers, reference, rec):
    """Least and median times of a tick [µs] along the course, all in turns: load is shared."""
    states = [
        (np.array(rec.q[k]), np.array(rec.v[k]), *reference(rec.t[k]))
        for k in range(FIRST, FIRST + TICKS)
    ]
    calls = {"bare calls": bare_calls(arm)}
    for name, controller in controllers.items():
        controller.reset()
        calls[name] = controller.update
    times = {name: [] for name in calls}
    for _ in range(ROUNDS):
        for name, call in calls.items():
            if name != "bare calls":
                controllers[name].reset()
            call(*states[0])
            started = time.thread_time_ns()
            for state in states:
                call(*state)
            times[name].append((time.thread_time_ns() - started) / (1e3 * TICKS))
    return {name: (min(found), float(np.median(found))) for name, found in times.items()}


def main(names):
    print("| arm | controller | way [mm] | turn [mrad] | tick [µs] | over bare calls | median |")
    print("| --- | --- | ---: | ---: | ---: | ---: | ---: |")
    for name in names:
        scenario = stress_scenario(fp.load_arm(name), "task raw")
        arm = scenario.arm
        controllers = {
            "TaskSpace, RobustFONFTSM": fp.TaskSpace(arm, scenario.dt),
            "pink, computed torque PD": PinkAndComputedTorque(arm, scenario.dt, "pd"),
            "pink, computed torque PID": PinkAndComputedTorque(arm, scenario.dt, "pid"),
        }
        errors, course = {}, None
        for label, controller in controllers.items():
            try:
                e = pose_errors(rec := scenario.run(controller), slice(len(rec) // 2, None))
                course = rec if course is None else course
                parts = np.linalg.norm(e[:, :3], axis=1), np.linalg.norm(e[:, 3:], axis=1)
                errors[label] = [1e3 * float(np.sqrt(np.mean(part**2))) for part in parts]
            except fp.errors.DivergenceError:
                errors[label] = [np.inf, np.inf]
        times = tick_times(arm, controllers, scenario.reference, course)
        for label, (way, turn) in errors.items():
            least, median = (a / b for a, b in zip(times[label], times["bare calls"], strict=True))
            print(
                f"| {name} | {label} | {way:.3g} | {turn:.3g} | {times[label][0]:.1f} | "
                f"{least:.2f} | {median:.2f} |"
            )


if __name__ == "__main__":
    main(sys.argv[1:] or ["panda", "ur5"])
