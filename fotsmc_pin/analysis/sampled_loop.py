"""The sampled loop of a linear law: a mass, or two with a spring, behind a hold and a delay."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from fotsmc_pin.analysis.linearization import LinearLaw
    from fotsmc_pin.types import Array


DOUBLINGS, NEGLIGIBLE = 60, 1e-12


@dataclass(frozen=True, kw_only=True, eq=False)
class Joint:
    """What a law's commanded acceleration `u` moves, in units of its nominal inertia.

    With a stiffness it is Spong's model, `m_l ë_l = -k (e_l - e_m) - d (ė_l - ė_m)` and
    `m_m ë_m = u + k (e_l - e_m) + d (ė_l - ė_m)`.

    Attributes:
        mass: true over nominal inertia `m`, of the whole joint.
        rotor: share of it that sits on the motor's side; used where there is a stiffness.
        stiffness: `k` over the nominal inertia [1/s²]; inf for a rigid joint.
        damping: `d` over the nominal inertia [1/s].
        link_side: whether position and velocity are measured on the link's side.
    """

    mass: float = 1.0
    rotor: float = 1.0
    stiffness: float = np.inf
    damping: float = 0.0
    link_side: bool = False

    def loaded(self, ratio: float) -> Joint:
        """Return the joint `ratio` times as heavy; of an elastic one, its link alone."""
        if np.isinf(self.stiffness):
            return replace(self, mass=ratio * self.mass)
        rotor = self.mass * self.rotor
        mass = rotor + ratio * (self.mass - rotor)
        return replace(self, mass=mass, rotor=rotor / mass)

    def sampled(self, dt: float) -> tuple[Array, Array, Array]:
        """Return `F`, `G`, `H` of `x⁺ = F x + G u`, `(e, ė) = H x` under a zero-order hold."""
        if np.isinf(self.stiffness):
            A, B = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([0.0, 1.0 / self.mass])
            H = np.eye(2)
        else:
            motor, link = self.mass * self.rotor, self.mass * (1.0 - self.rotor)
            k, d = self.stiffness, self.damping
            A = np.zeros((4, 4))  # e_m, ė_m, e_l, ė_l
            A[0, 1] = A[2, 3] = 1.0
            spring = np.array([-k, -d, k, d])
            A[1], A[3] = spring / motor, -spring / link
            B = np.array([0.0, 1.0 / motor, 0.0, 0.0])
            H = np.eye(4)[2:] if self.link_side else np.eye(4)[:2]
        n = len(B)
        block = np.zeros((n + 1, n + 1))
        block[:n, :n], block[:n, n] = A * dt, B * dt
        from scipy.linalg import expm  # takes a noticeable part of a start

        moved = expm(block)
        return moved[:n, :n], moved[:n, n], H


def closed_loop(law: LinearLaw, joint: Joint, delay: int) -> Array:
    """Return the matrix of one tick of the loop.

    States: the law's, the joint's, the torques on their way.

    Args:
        law: the law.
        joint: what it moves.
        delay: ticks from a torque to the drive.
    """
    F, G, H = joint.sampled(law.dt)
    n, p = len(law.A), len(G)
    loop = np.zeros((n + p + delay, n + p + delay))
    loop[:n, :n], loop[:n, n : n + p] = law.A, law.B @ H
    loop[n : n + p, n : n + p] = F
    u = np.zeros(len(loop))
    u[:n], u[n : n + p] = law.C, law.D @ H
    if delay == 0:
        loop[n : n + p] += np.outer(G, u)
    else:
        loop[n : n + p, -1] += G
        loop[n + p] = u
        for k in range(1, delay):
            loop[n + p + k, n + p + k - 1] = 1.0
    return loop


def is_stable(law: LinearLaw, joint: Joint, delay: int) -> bool:
    """Whether every mode of the loop decays."""
    return bool(np.abs(np.linalg.eigvals(closed_loop(law, joint, delay))).max() < 1.0)


def edge(
    stable: Callable[[float], bool],
    start: float,
    end: float,
    steps: int = 40,
    bisections: int = 24,
) -> float:
    """Return where `stable` ends on the way from `start` to `end`, in equal ratios.

    `end` if it never ends; NaN where it is not stable at `start`.
    """
    if not stable(start):
        return float("nan")
    points = np.geomspace(start, end, steps)
    for inside, outside in pairwise(points):
        if not stable(float(outside)):
            good, bad = float(inside), float(outside)
            for _ in range(bisections):
                middle = float(np.sqrt(good * bad))
                good, bad = (middle, bad) if stable(middle) else (good, middle)
            return good
    return end


def open_loop(law: LinearLaw, joint: Joint, delay: int, rates: Array) -> Array:
    """Return the loop's frequency response with the sign of a return ratio, (k,) complex.

    Args:
        law: the law.
        joint: what it moves.
        delay: ticks from a torque to the drive.
        rates: below `π / dt` [rad/s], (k,).
    """
    F, G, H = joint.sampled(law.dt)
    z = np.exp(1j * rates * law.dt)
    ratio = []
    for zk in z:
        measured = H @ np.linalg.solve(zk * np.eye(len(F)) - F, G.astype(complex))
        command = law.D @ measured
        if len(law.A):
            states = np.linalg.solve(zk * np.eye(len(law.A)) - law.A, law.B @ measured)
            command = command + law.C @ states
        ratio.append(-command * zk**-delay)
    return np.array(ratio)


def noise_gain(law: LinearLaw, joint: Joint, delay: int, channel: int) -> float:
    """RMS of `u` per standard deviation of white noise on `e` (channel 0) or `ė` (channel 1)."""
    loop = closed_loop(law, joint, delay)
    _, G, H = joint.sampled(law.dt)
    n, p = len(law.A), len(G)
    into = np.zeros(len(loop))
    into[:n] = law.B[:, channel]
    if delay == 0:
        into[n : n + p] = G * law.D[channel]
    else:
        into[n + p] = law.D[channel]
    u = np.zeros(len(loop))
    u[:n], u[n : n + p] = law.C, law.D @ H
    covariance = _sum_of_powers(loop, np.outer(into, into))
    return float(np.sqrt(max(u @ covariance @ u, 0.0) + law.D[channel] ** 2))


def _sum_of_powers(A: Array, Q: Array) -> Array:
    """Return `Σ A^k Q (A^k)ᵀ` of a stable `A`, by doubling."""
    total, power = Q, A
    for _ in range(DOUBLINGS):
        total = total + power @ total @ power.T
        power = power @ power
        if np.abs(power).max() < NEGLIGIBLE:
            break
    return total
