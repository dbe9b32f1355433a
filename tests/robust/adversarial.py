"""Adversarial runs against the limits of a safeguard.

    python -m tests.robust.adversarial [ARM...] [--runs N] [--first N] [--clearance D]

The runs take turns: random torques of full size, which change at each tick, every 30, 200 or 800
ticks; a law whose targets jump far outside of the joints' ranges; measurements and torques that are
no numbers; live targets far outside that go stale. Each with a delay of 0 to 5 ticks, and a start
anywhere that keeps the limits. What is printed of each arm is the worst of all runs.
"""

import argparse
import functools
import time
import warnings
from dataclasses import dataclass

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.arms import self_collision
from fotsmc_pin.arms.self_collision import SelfCollision
from fotsmc_pin.control.safety.separation import Separation
from fotsmc_pin.references import Hold, LiveTarget
from fotsmc_pin.simulation.actuators import TickDelay

DT = 1e-3
PERIODS = (1, 30, 200, 800)
"""How many ticks a random torque lasts."""
KINDS = ("torques", "targets", "no numbers", "stale targets")
FAR = 6.0
"""Targets lie within so many radians or metres of zero."""


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


class Jumps:
    """Targets that jump far outside of the joints' ranges, five times a second."""

    def __init__(self, arm, seed):
        self.arm, self._seed = arm, seed

    def __call__(self, t):
        rng = np.random.default_rng([self._seed, int(5.0 * t + 1e-9)])
        q = self.arm.from_joint_positions(rng.uniform(-FAR, FAR, self.arm.nv))
        return q, np.zeros(self.arm.nv), np.zeros(self.arm.nv)


class Stream:
    """Live targets far outside, at 50 Hz, which stop coming for a third of the time."""

    is_live = True

    def __init__(self, arm, seed, start):
        limit = np.where(np.isfinite(arm.velocity_limit), arm.velocity_limit, 1.0)
        self._live = LiveTarget(arm, q0=start, velocity=limit, timeout=0.1)
        self._rng, self.arm, self._tick = np.random.default_rng(seed), arm, 0

    def __call__(self, t):
        if self._tick % 20 == 0 and self._tick // 20 % 24 < 16:
            far = self._rng.uniform(-FAR, FAR, self.arm.nv)
            self._live.set_q(self.arm.from_joint_positions(far))
        self._tick += 1
        return self._live(t)


class Gaps:
    """A sensor whose readings are no numbers: at single ticks at first, then for a while."""

    def __init__(self, seed):
        self._rng, self._tick = np.random.default_rng(seed), 0
        self._first, self._length = self._rng.integers(200, 600), self._rng.integers(1, 60)

    def __call__(self, t, q, v):
        self._tick += 1
        blind = self._first <= self._tick < self._first + self._length
        return (np.full_like(q, np.nan), v) if blind else (q, v)


@dataclass(frozen=True)
class Outcome:
    """What a run did.

    Attributes:
        kind: of attack.
        beyond: how far a joint went beyond its end, at most [rad, m]; below 0 where none did.
        speed: largest speed of a joint over its limit.
        stopped: why a safe stop began; None where none did.
        collided: whether links touched, where that was looked at.
    """

    kind: str
    beyond: float
    speed: float
    stopped: str | None
    collided: bool | None


def start_of(arm, rng, apart=None):
    """Return a configuration well inside the limits, links apart where that is asked."""
    lower, upper = 0.9 * arm.lower_position_limit, 0.9 * arm.upper_position_limit
    while True:
        x = np.clip(arm.to_joint_positions(arm.random_configuration(rng)), lower, upper)
        q = arm.from_joint_positions(x)
        if apart is None or (apart.gaps(q) > 0.0).all():
            return q


def run(arm, seed, *, seconds=1.5, plant=None, nan_from=None, kind="torques", **limits):
    """Return how far joints went beyond their ends, their speeds over the limits, and the rest."""
    given = fp.Limits(arm, **limits)
    apart = Separation(given, DT) if given.clearance is not None else None
    start = start_of(arm, np.random.default_rng(seed), apart)
    reference, sensor, law = Hold(arm, start), None, Wild(arm, seed, nan_from)
    if kind == "no numbers":
        sensor = Gaps(seed)
    elif kind != "torques":
        law = (fp.RobustFONFTSM, fp.ComputedTorque)[seed // len(KINDS) % 2](arm, DT)
        reference = Jumps(arm, seed) if kind == "targets" else Stream(arm, seed, start)
    guard = fp.Safeguard(law, soft_start=0.0, limits=given)
    rec = fp.simulate(
        plant or arm,
        guard,
        reference,
        seconds,
        q0=start,
        v0=np.zeros(arm.nv),
        sensor=sensor,
        actuator=TickDelay(seed % 6),
        end_stops=True,
        substeps=2,
    )
    x = np.array([arm.to_joint_positions(q) for q in rec.q])
    beyond = np.maximum(x - arm.upper_position_limit, arm.lower_position_limit - x)
    beyond = beyond[:, np.isfinite(arm.upper_position_limit)]
    return beyond.max(), (np.abs(rec.v) / arm.velocity_limit).max(), guard, rec


def attack(arm, seed, *, shapes=None, **options):
    """Return the `Outcome` of the run of this number."""
    kind = KINDS[seed % len(KINDS)]
    nan_from = 700 if kind == "no numbers" and seed % 8 > 3 else None
    beyond, speed, guard, rec = run(arm, seed, kind=kind, nan_from=nan_from, **options)
    collided = None if shapes is None else any(shapes.collides(q) for q in rec.q[::20])
    return Outcome(kind, float(beyond), float(speed), guard.stopped, collided)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("arms", nargs="*", default=("panda", "ur5", "kinova"))
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--clearance", type=float, default=0.03)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    parsed = functools.cache(self_collision.collision_model)  # meshes are most of a run's time
    self_collision.collision_model = lambda arm: parsed(arm).copy()
    for name in given.arms:
        arm, began = fp.load_arm(name), time.perf_counter()
        shapes = SelfCollision(arm, clearance=0.0)
        found = []
        for seed in range(given.first, given.first + given.runs):
            found.append(attack(arm, seed, shapes=shapes, clearance=given.clearance))
            worst = found[-1]
            if seed % 20 == 19:
                print(f"  {name} {seed}: {time.process_time():.0f} s", flush=True)
            if worst.beyond > 0.0 or worst.speed > 1.02 or worst.collided:
                print(f"  {name} {seed}: {worst}", flush=True)
        for kind in KINDS:
            rows = [row for row in found if row.kind == kind]
            if rows:
                print(
                    f"{name}, {kind}: {len(rows)} runs, beyond an end "
                    f"{max(r.beyond for r in rows):.4f}, speed "
                    f"{max(r.speed for r in rows):.3f} of its limit, "
                    f"{sum(r.stopped is not None for r in rows)} safe stops, "
                    f"{sum(bool(r.collided) for r in rows)} collisions"
                )
        print(f"  in {time.perf_counter() - began:.0f} s", flush=True)


if __name__ == "__main__":
    main()
