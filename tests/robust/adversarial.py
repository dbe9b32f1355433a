"""Adversarial runs against the limits of a safeguard; `python -m tests.robust.adversarial [RUNS]`.

Random torques of full size, which change at each tick, every 30, 200 or 800 ticks; a delay of 0 to
5 ticks; a start anywhere. What is printed of each arm is the worst of all runs.
"""

import sys
import warnings

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.arms.self_collision import SelfCollision
from fotsmc_pin.control.safety.separation import Separation
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation.actuators import TickDelay

DT = 1e-3
PERIODS = (1, 30, 200, 800)
"""How many ticks a random torque lasts."""


class Wild:
    """Random torques of full size."""

    gains = None

    def __init__(self, arm, seed, nan_from=None):
        self.arm, self.dt, self.signals, self._seed, self._nan = arm, DT, {}, seed, nan_from
        self.reset()

    def reset(self):
        self._rng, self._tick = np.random.default_rng(self._seed), 0

    def save_state(self):
        return {}

    def restore_state(self, arrays):
        pass

    def note_applied(self, *told):
        pass

    def update(self, q, v, q_d, v_d, a_d, dt=None):
        if self._tick % PERIODS[self._seed % len(PERIODS)] == 0:
            whole = self._seed % 3 > 0
            draw = self._rng.choice([-1.0, 1.0], self.arm.nv) if whole else None
            draw = self._rng.uniform(-1.0, 1.0, self.arm.nv) if draw is None else draw
            self._tau = draw * self.arm.effort_limit
        self._tick += 1
        return self._tau * np.nan if self._tick == self._nan else self._tau.copy()


def start_of(arm, rng, apart=None):
    """Return a configuration well inside the limits, links apart where that is asked."""
    lower, upper = 0.9 * arm.lower_position_limit, 0.9 * arm.upper_position_limit
    while True:
        x = np.clip(arm.to_joint_positions(arm.random_configuration(rng)), lower, upper)
        q = arm.from_joint_positions(x)
        if apart is None:
            return q
        try:
            apart.demand_start(q)
        except ValueError:
            continue
        return q


def run(arm, seed, *, seconds=1.5, plant=None, nan_from=None, **limits):
    """Return how far joints went beyond their ends, their speeds over the limits, and the rest."""
    given = fp.Limits(arm, **limits)
    apart = Separation(given, DT) if given.clearance is not None else None
    start = start_of(arm, np.random.default_rng(seed), apart)
    guard = fp.Safeguard(Wild(arm, seed, nan_from), soft_start=0.0, limits=given)
    rec = fp.simulate(
        plant or arm,
        guard,
        Hold(arm, start),
        seconds,
        actuator=TickDelay(seed % 6),
        end_stops=True,
        substeps=2,
    )
    x = np.array([arm.to_joint_positions(q) for q in rec.q])
    beyond = np.maximum(x - arm.upper_position_limit, arm.lower_position_limit - x)
    beyond = beyond[:, np.isfinite(arm.upper_position_limit)]
    return beyond.max(), (np.abs(rec.v) / arm.velocity_limit).max(), guard, rec


def main(runs=200):
    warnings.simplefilter("ignore")
    for name in ("panda", "ur5", "kinova"):
        arm = fp.load_arm(name)
        shapes = SelfCollision(arm, clearance=0.0)
        for clearance in (None, 0.03):
            worst, fastest, stops, hits = -np.inf, 0.0, 0, 0
            for seed in range(runs):
                beyond, speed, guard, rec = run(arm, seed, clearance=clearance)
                worst, fastest = max(worst, beyond), max(fastest, speed)
                stops += guard.stopped is not None
                hits += clearance is not None and any(shapes.collides(q) for q in rec.q[::20])
            told = "not looked at" if clearance is None else hits
            print(
                f"{name}, clearance {clearance}: beyond an end {worst:.4f}, speed {fastest:.3f} "
                f"of its limit, {stops} safe stops, runs with a collision: {told}"
            )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
