"""The shortest way on which an arm's torque limits can stop it, its true model known.

    python -m tests.robust.least_stop [ARM] [--motion N] [--starts N] [--seconds T] [--kept WHAT]

It is what a safe stop is to be measured against: the motion is that of `safe_stops`, payload and
friction are known, every torque may be at its limit, and nothing is late. Accelerations that are
constant over intervals are sought which bring all joints to rest so that the one that moves
farthest moves least,

    min w   with   |q_j(t) - q_j(0)| ≤ w,   |τ(q, v, a)| ≤ τ_max,   v(T) = 0,

by linear programs around the last trajectory, within a trust region, from several starts. Position
and velocity are linear in the accelerations; the torque is linearized by Pinocchio's derivatives.
`--kept speed` besides keeps every joint no faster than at its start, `direction` also lets none
turn around, and `slowing` lets none become faster at any time. Each start ends in a local minimum:
the least of many is an estimate from above.
"""

import argparse

import numpy as np
import pinocchio as pin
from scipy.optimize import linprog

import fotsmc_pin as fp
from tests.robust.safe_stops import QUARTER, SETTLING, full_speed

PENALTY = 50.0
"""Weight of the largest torque beyond its limit, as a share of it, against the way [rad]."""
WIDTH = 0.02
"""Speed over which friction turns its sign [rad/s]."""
TRIALS, RADIUS, LEAST_RADIUS, LEAST_GAIN = 40, 20.0, 0.05, 2e-5
"""Linear programs of a start at most, size of the trust region at first and in the end [rad/s²],
and the gain that ends the search [rad]."""


KEPT = ("torque", "speed", "direction", "slowing")
"""What is kept, each with what stands before it."""


class Stopping:
    """The problem: an arm, the state that it is stopped in, the intervals, and what is kept."""

    def __init__(self, arm, q, v, *, friction, seconds, intervals, kept):
        self.arm, self.q, self.v, self.friction = arm, q, v, friction
        self.level, self.forward = KEPT.index(kept), np.tile(np.sign(v), intervals)
        self.count, step = intervals, seconds / intervals
        until = np.tril(np.ones((intervals, intervals)))
        own, before = np.eye(intervals), np.tril(np.ones((intervals, intervals)), -1)
        age = np.subtract.outer(np.arange(intervals), np.arange(intervals))
        self.ends, self.middles = step * (1.0 + np.arange(intervals)), step * 0.5
        self.middles = self.ends - self.middles
        self.gain_end, self.gain_middle = step * until, step * (until - 0.5 * own)
        self.way_end = step**2 * until * (age + 0.5)
        self.way_middle = step**2 * (before * age + own / 8.0)

    def ways(self, a):
        """Return how far each joint is from its start at each interval's end."""
        return np.outer(self.ends, self.v) + self.way_end @ a

    def torques(self, a, *, slopes=False):
        """Return the torques over their limits, and how they change with all accelerations."""
        model, n, limit = self.arm.model, self.arm.nv, self.arm.effort_limit
        data, size = model.createData(), self.count
        v = self.v + self.gain_middle @ a
        step = np.outer(self.middles, self.v) + self.way_middle @ a
        share, change = np.zeros((size, n)), np.zeros((size, n, size, n))
        for k in range(size):
            q = pin.integrate(model, self.q, step[k])
            share[k] = pin.rnea(model, data, q, v[k], a[k])
            if slopes:
                by_q, by_v, by_a = pin.computeRNEADerivatives(model, data, q, v[k], a[k])
                way, gain = self.way_middle[k], self.gain_middle[k]
                change[k] = np.einsum("ij,k->ikj", by_q, way) + np.einsum("ij,k->ikj", by_v, gain)
                change[k, :, k] += np.triu(by_a) + np.triu(by_a, 1).T
        share += self.friction * np.tanh(v / WIDTH)
        return share / limit, change / limit[None, :, None, None]

    def cost(self, a):
        """Return the way of the joint that moves farthest, and what is beyond the limits."""
        beyond = np.maximum(np.abs(self.torques(a)[0]) - 1.0, 0.0).max()
        return np.abs(self.ways(a)).max() + PENALTY * beyond

    def improve(self, a):
        """Return the accelerations of a local minimum near `a`, and its cost."""
        n, size = self.arm.nv, self.count * self.arm.nv
        joints, one, none = np.eye(n), np.ones((size, 1)), np.zeros((size, 1))
        way, radius, cost = np.kron(self.way_end, joints), RADIUS, self.cost(a)
        gain, start = np.kron(self.gain_end, joints), np.tile(np.abs(self.v), self.count)
        gain = self.forward[:, None] * gain
        rest = np.hstack([np.kron(self.gain_end[-1:], joints), np.zeros((n, 2))])
        price = np.r_[np.zeros(size), 1.0, PENALTY]
        share, change = self.torques(a, slopes=True)
        for _ in range(TRIALS):
            J, t, x = change.reshape(size, size), share.ravel(), self.ways(a).ravel()
            rows = [[J, none, -one], [-J, none, -one], [way, -one, none], [-way, -one, none]]
            ends = [1.0 - t, 1.0 + t, -x, x]
            if self.level >= KEPT.index("speed"):
                speed = self.forward * (self.v + self.gain_end @ a).ravel()
                slowest = start if self.level == KEPT.index("speed") else 0.0
                rows += [[gain, none, none], [-gain, none, none]]
                ends += [start - speed, slowest + speed]
            found = linprog(
                price,
                A_ub=np.block(rows),
                b_ub=np.concatenate(ends),
                A_eq=rest,
                b_eq=-(self.v + self.gain_end[-1] @ a),
                bounds=[*self.steps(a, radius), (0.0, None), (0.0, None)],
            )
            if found.status != 0:  # no rest within the trust region
                radius *= 2.0
                continue
            other = a + found.x[:size].reshape(a.shape)
            better = cost - self.cost(other)
            if better > 0.0:
                a, cost, radius = other, cost - better, 1.5 * radius
                share, change = self.torques(a, slopes=True)
            else:
                radius *= 0.4
            if radius < LEAST_RADIUS or 0.0 < better < LEAST_GAIN:
                break
        return a, cost

    def steps(self, a, radius):
        """Return the bounds of the steps: the trust region, and none that speeds up where kept."""
        most = np.full(a.size, radius)
        if self.level == KEPT.index("slowing"):
            most = np.clip(-self.forward * a.ravel(), -radius, radius)
        least = np.minimum(-radius, most)
        return [
            (lo, hi) if f > 0.0 else (-hi, -lo)
            for lo, hi, f in zip(least, most, self.forward, strict=True)
        ]

    def start(self, rng):
        """Return accelerations that stop each joint in a time of its own, disturbed."""
        n, seconds = self.arm.nv, self.ends[-1]
        left = rng.uniform(0.3 * seconds, seconds, n)[None] - (self.ends - self.ends[0])[:, None]
        weight = np.clip(left / self.ends[0], 0.0, 1.0)
        a = -self.v * weight / (weight.sum(axis=0) * self.ends[0])
        noise = np.cumsum(rng.normal(0.0, 2.0, a.shape), axis=0)
        return a + noise - noise.mean(axis=0)


def least_way(
    name, motion, *, payload=2.0, friction=0.5, seconds=0.4, intervals=25, starts=20, kept="torque"
):
    """Return the ways that were found [rad], the least first."""
    arm = fp.load_arm(name)
    true = fp.perturb(arm, payload=payload, friction=friction)
    q, v, _ = full_speed(arm, true, motion)(SETTLING + QUARTER)
    problem = Stopping(
        true, q, v, friction=friction, seconds=seconds, intervals=intervals, kept=kept
    )
    rng = np.random.default_rng(0)
    found = [problem.improve(problem.start(rng)) for _ in range(starts)]
    feasible = [
        np.abs(problem.ways(a)).max()
        for a, _ in found
        if np.abs(problem.torques(a)[0]).max() < 1.001
    ]
    return sorted(float(way) for way in feasible)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("arm", nargs="?", default="ur5")
    parser.add_argument("--motion", type=int, default=2)
    parser.add_argument("--starts", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=0.4)
    parser.add_argument("--kept", choices=KEPT, default=KEPT[0])
    given = parser.parse_args()
    ways = least_way(
        given.arm, given.motion, starts=given.starts, seconds=given.seconds, kept=given.kept
    )
    least = ", ".join(f"{way:.4f}" for way in ways[:5])
    print(f"{given.arm}, motion {given.motion}: {len(ways)} of {given.starts} starts, {least} rad")


if __name__ == "__main__":
    main()
