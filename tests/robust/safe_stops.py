"""Safe stops from full speed with an unknown payload, under every convention of a robot's drives.

    python -m tests.robust.safe_stops [ARM...] [--motions N] [--first N] [--payload KG]
        [--rotors SHARE] [--delay TICKS] [--torque-rate R] [--distrust] [--least]

Each run moves all joints of a MuJoCo robot at their speed limits at once, stops it there, and
watches it for a second. Motions differ in place and direction. A stop that exceeds 1 s, 0.3 rad or
1.02 times its speed is printed by itself; with `--least` beside the shortest way on which an arm of
which all is known could stop there, if each joint only slows down, and if none gets faster than it
was (`tests.robust.least_stop`).
"""

import argparse
import functools
from dataclasses import dataclass
from itertools import chain, combinations

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.realtime import MujocoRobot

DT = 1e-3
ARMS = ("panda", "ur5", "kinova")
WORDS = ("gravity", "coriolis", "friction")
CONVENTIONS = tuple(chain.from_iterable(combinations(WORDS, k) for k in range(4)))
SETTLING, QUARTER = 1.0, 1.0
"""Time at rest before the motion, in which the law finds the payload; time to full speed [s]."""
SHARE = 0.85
"""Share of the effort limits that a motion may take, payload included."""
WATCHED = 1.2
"""Time that a stop is watched [s]."""
REST = 0.01
"""Speed below which a joint is at rest [rad/s]."""
BEYOND = 0.4
"""Way from the point of full speed to the joints' ends, at least [rad]."""
TRIES = 20000


class Clock:
    """Time that the program tells."""

    t = 0.0

    def __call__(self):
        return self.t


@dataclass(frozen=True)
class Stop:
    """What a stop did.

    Attributes:
        broke: why the run stopped itself before full speed; None where it did not.
        rest: time until every joint stayed at rest [s].
        way: largest way of a joint from where the stop began [rad].
        speed: largest speed of a joint over its speed at the start.
        sag: largest way of a joint after half a second [rad].
        by_law: whether the law braked to the end.
        planned: way of the joint that moves farthest, as the braking path began [rad].
    """

    broke: str | None
    rest: float
    way: float
    speed: float
    sag: float
    by_law: bool
    planned: float

    @property
    def is_kept(self):
        """Whether it is at rest within a second and 0.3 rad, and never faster than at the start."""
        return self.rest <= 1.0 and self.way <= 0.3 and self.speed <= 1.02

    def __str__(self):
        return f"rest {self.rest:.3f}, way {self.way:.3f}, speed {self.speed:.3f}"


def full_speed(arm, true, seed):
    """A motion that the drives can make, at whose end all joints have their largest speed."""
    rng = np.random.default_rng(seed)
    turn = 0.5 * np.pi / QUARTER
    times = SETTLING + np.linspace(0.0, QUARTER, 50)
    for _ in range(TRIES):
        direction = rng.choice([-1.0, 1.0], arm.nv)
        middle, swing = arm.random_configuration(rng), direction * arm.velocity_limit / turn

        def reference(t, middle=middle, swing=swing):
            phase = turn * max(t - SETTLING, 0.0)
            a = turn**2 * swing * np.cos(phase) * (t >= SETTLING)
            q = arm.integrate(middle, -swing * np.cos(phase))
            return q, turn * swing * np.sin(phase), a

        ends = [arm.integrate(middle, -swing), arm.integrate(middle, BEYOND * direction)]
        places = np.array([arm.to_joint_positions(q) for q in ends])
        low, high = arm.lower_position_limit, arm.upper_position_limit
        if not ((low < places) & (places < high)).all():
            continue
        needed = [np.abs(true.inverse_dynamics(*reference(t))) for t in times]
        if (np.array(needed) <= SHARE * arm.effort_limit).all():
            return reference
    raise SystemExit(f"no motion of {arm.name} fits its limits")


def stop_once(
    name,
    compensates,
    *,
    seed=0,
    payload=2.0,
    rotors=0.0,
    delay=1,
    friction=0.0,
    torque_rate=None,
    trust_law=True,
):
    """Return the `Stop` of one run.

    The drives believe the nominal arm. `rotors` is the armature of both arms over the effort limit.
    """
    arm = fp.load_arm(name)
    if rotors:
        arm = fp.load_arm(name, armature=rotors * arm.effort_limit)
    true = fp.perturb(arm, payload=payload, friction=friction)
    reference, clock = full_speed(arm, true, seed), Clock()
    start = reference(0.0)[0]
    robot = MujocoRobot(
        true, start, compensates=compensates, believed=arm, delay=delay, clock=clock
    )
    controller = fp.Safeguard(
        fp.RobustFONFTSM(arm, DT), soft_start=0.0, speed_margin=1.3, torque_rate=torque_rate
    )
    controller.compensates = compensates
    for _ in range(delay):
        robot.write(arm.gravity(start) * ("gravity" not in compensates))
    began, broke, ways, speeds, planned = None, None, [], [], 0.0
    for k in range(round((SETTLING + QUARTER + WATCHED) / DT)):
        clock.t = k * DT
        q, v = robot.read()
        if k * DT >= SETTLING + QUARTER - 1e-9 and began is None:
            began, broke = q, controller.stopped
            controller.stop(trust_law=trust_law)
        if began is not None:
            ways.append(arm.difference(began, q))
            speeds.append(v)
        controller.update(q, v, *reference(k * DT))
        robot.write(controller.sent)
        if began is not None and not planned:
            planned = controller._stop.path.bound
    way, speed = np.abs(ways), np.abs(speeds)
    moving = np.nonzero((speed > REST).any(axis=1))[0]
    return Stop(
        broke=broke,
        rest=DT * (int(moving[-1]) + 1) if len(moving) else 0.0,
        way=float(way.max()),
        speed=float((speed.max(axis=0) / speed[0]).max()),
        sag=float(np.abs(np.array(ways)[500:] - ways[500]).max()),
        by_law=bool(controller._stop.by_law),
        planned=planned,
    )


def table(given):
    """Yield a line per arm and convention."""
    for name in given.arms:
        for words in CONVENTIONS[: given.conventions]:
            options = {"rotors": given.rotors, "friction": given.friction, "delay": given.delay}
            options |= {"torque_rate": given.torque_rate, "payload": given.payload}
            seeds = range(given.first, given.first + given.motions)
            rows = [
                stop_once(name, words, seed=seed, trust_law=not given.distrust, **options)
                for seed in seeds
            ]
            missed = [k for k, row in enumerate(rows) if row.broke is None and not row.is_kept]
            notes = [f"  motion {seeds[k]}: {rows[k]}" for k in missed]
            if given.least:
                load = (given.payload, given.friction, given.rotors)
                notes = [
                    f"{note}, least way {least(name, seeds[k], *load)}"
                    for k, note in zip(missed, notes, strict=True)
                ]
            broken = sum(row.broke is not None for row in rows)
            rows = [row for row in rows if row.broke is None]
            if not rows:
                yield f"{name:7} {'+'.join(words) or 'nothing':25}  not reached {broken}"
                continue
            cells = [f"{name:7} {'+'.join(words) or 'nothing':25}"]
            for field in ("rest", "way", "speed", "sag", "planned"):
                values = [getattr(row, field) for row in rows]
                cells.append(f"{field} {np.median(values):.3f} {max(values):.3f}")
            kept = sum(row.is_kept for row in rows)
            cells.append(f"kept {kept} of {len(rows)}, by law {sum(r.by_law for r in rows)}")
            cells.append(f"not reached {broken}")
            yield "\n".join(["  ".join(cells), *notes])


@functools.cache
def least(name, seed, payload, friction, rotors):
    """The shortest ways on which this motion can be stopped, in words."""
    from tests.robust.least_stop import least_way

    if rotors:
        return "not sought with rotors"
    found = [
        least_way(name, seed, payload=payload, friction=friction, starts=6, seconds=0.5, kept=kept)
        for kept in ("slowing", "speed")
    ]
    return " and ".join(f"{ways[0]:.3f}" if ways else "none" for ways in found)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("arms", nargs="*", default=ARMS)
    parser.add_argument("--motions", type=int, default=5)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--payload", type=float, default=2.0)
    parser.add_argument("--rotors", type=float, default=0.0)
    parser.add_argument("--friction", type=float, default=0.5)
    parser.add_argument("--delay", type=int, default=1)
    parser.add_argument("--torque-rate", type=float)
    parser.add_argument("--conventions", type=int, default=len(CONVENTIONS))
    parser.add_argument("--distrust", action="store_true", help="stop without the law")
    parser.add_argument("--least", action="store_true", help="seek the least ways of misses")
    for line in table(parser.parse_args()):
        print(line, flush=True)


if __name__ == "__main__":
    main()
