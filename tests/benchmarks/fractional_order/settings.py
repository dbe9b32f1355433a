"""The settings in which gains are searched and judged: a plant and a motion, drawn from a seed.

Every arm has one nominal model, with rotors by rule where its file gives none. A setting draws the
true arm and what it is to do:

- each link's mass by a factor of 0.8 to 1.5, its centre of mass up to 10 mm away; a payload up to
  the rated one; each joint's Coulomb and viscous friction at 0.4 to 1.6 times those of the stress
  suite, with breakaway at 1 to 1.3 times; each rotor from effort limit / 400 to / 75, evenly in its
  logarithm;
- a start error of ±0.1 rad in each joint; and a sinusoid in each joint, or a move from rest to rest
  in all of them.

Noise (1e-5 rad, 1e-3 rad/s) and one tick of delay are those of the stress suite. The paper's case
is as printed, with neither noise nor delay nor friction; its other draws change the masses, the
disturbance, the motion and the start.
"""

from __future__ import annotations

import math
import zlib
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.arms.random_numbers import Uniform
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.evaluation.stress.payloads import stress_payload
from fotsmc_pin.evaluation.stress.plants import joint_friction, true_armature, with_rotors
from fotsmc_pin.paper import two_link
from fotsmc_pin.references import Quintic, Sinusoid, broken_limits

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array, Reference

ARMS = ("panda", "two_link", "ur5", "so100", "kinova", "z1", "asr_twodof", "ur10", "xarm7", "ur3")
PAPER = "the paper's case"
PROBLEMS = (PAPER, *ARMS)
"""In the order in which they are run."""

DT = 1e-3
SEARCH_TIME, JUDGED_TIME = (0.8, 1.4), (1.0, 2.0)
"""Spans in which the error counts, in searches and held out; the run ends with it [s]."""
PAPER_TIME = (1.2, 2.0)
LONG_TIME = (3.0, 4.0)
LONG = 100
"""From this number on held-out settings are those from 0 on, run for longer."""
START_ERROR = 0.1
EFFORT_SHARE = 0.8
TRIES = 60
SEARCHED, HELD_OUT = 1, 2
"""Streams of random numbers: a setting of one is never one of the other."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Setting:
    """A closed loop that waits for a controller.

    Attributes:
        nominal: the arm that a law knows.
        true: the arm that moves.
        kind: "sine", "move" or "paper".
        reference: `t -> (q_d, v_d, a_d)`.
        q0: configuration at the start (nq,).
        span: in which the error counts [s]; the run ends with it.
        disturbance: `t -> (nv,)` [N·m], or None.
        noise: seed of the noise; None for perfect sensors and no delay.
    """

    nominal: Arm
    true: Arm
    kind: str
    reference: Reference
    q0: Array
    span: tuple[float, float]
    disturbance: Any = None
    noise: int | None = None


@cache
def nominal_arm(problem: str) -> Arm:
    """Return the arm that the laws know."""
    return two_link.nominal_arm() if problem == PAPER else with_rotors(fp.load_arm(problem))


def search_setting(problem: str, seed: int) -> Setting:
    """Return the setting in which the search with this seed tries its gains."""
    if problem == PAPER:
        return _printed() if seed == 1 else _redrawn(_rng(problem, SEARCHED, seed), PAPER_TIME)
    return _draw(problem, "sine", _rng(problem, SEARCHED, seed), SEARCH_TIME)


def held_out_setting(problem: str, number: int) -> Setting:
    """Return a setting that no search has seen: with an even number sinusoids, else a move."""
    if number >= LONG:
        return replace(held_out_setting(problem, number - LONG), span=LONG_TIME)
    rng = _rng(problem, HELD_OUT, number)
    if problem == PAPER:
        return _redrawn(rng, PAPER_TIME)
    return _draw(problem, "move" if number % 2 else "sine", rng, JUDGED_TIME)


def _rng(problem: str, stream: int, number: int) -> np.random.Generator:
    return np.random.default_rng([zlib.crc32(problem.encode()), stream, number])


def _draw(problem: str, kind: str, rng: np.random.Generator, span: tuple[float, float]) -> Setting:
    nominal = nominal_arm(problem)
    friction = np.array(joint_friction(nominal))
    true = fp.perturb(
        nominal,
        mass_scale=Uniform(0.8, 1.5),
        com_shift=Uniform(0.0, 0.01),
        payload=Uniform(0.0, stress_payload(nominal)),
        friction=friction * rng.uniform(0.4, 1.6, nominal.nv),
        damping=friction * rng.uniform(0.4, 1.6, nominal.nv),
        stiction=Uniform(1.0, 1.3),
        armature=true_armature(
            nominal, np.exp(rng.uniform(math.log(75.0), math.log(400.0), nominal.nv))
        ),
        seed=int(rng.integers(2**31)),
    )
    reference = (_sine if kind == "sine" else _move)(nominal, true, rng, span)
    error = START_ERROR * rng.choice([-1.0, 1.0], nominal.nv)
    return Setting(
        nominal=nominal,
        true=true,
        kind=kind,
        reference=reference,
        q0=nominal.integrate(reference(0.0)[0], error),
        span=span,
        noise=int(rng.integers(2**31)),
    )


def _sine(nominal: Arm, true: Arm, rng: np.random.Generator, span: tuple[float, float]) -> Sinusoid:
    """Return sinusoids with periods of 1 to 2 s around a pose near the usual centre."""
    usual = nominal.to_joint_positions(Sinusoid.inside_limits(nominal).center)
    wide, size, periods = 0.4, rng.uniform(0.15, 0.3, nominal.nv), rng.uniform(1.0, 2.0, nominal.nv)
    for _ in range(TRIES):
        center = _inside(nominal, usual + wide * rng.uniform(-1.0, 1.0, nominal.nv), 0.2)
        room = np.minimum(center - nominal.lower_position_limit, _upper(nominal) - center)
        speed = 0.5 * nominal.velocity_limit / (2.0 * np.pi / periods + 15.0 / 8.0 / 0.6)
        reference = Sinusoid(
            arm=nominal,
            center=nominal.from_joint_positions(center),
            amplitude=np.minimum(np.minimum(size, 0.9 * room), speed),
            period=periods,
            ramp=0.6,
        )
        if _bears(true, reference, span[1]):
            return reference
        wide, size = 0.95 * wide, 0.93 * size
    raise ArgumentError("arm", nominal.name, "no sinusoid was found that its motors can follow")


def _move(nominal: Arm, true: Arm, rng: np.random.Generator, span: tuple[float, float]) -> Quintic:
    """Return a rest, a move of 0.2 to 0.5 rad from 0.7 to 1.5 s, and a rest."""
    usual = nominal.to_joint_positions(Sinusoid.inside_limits(nominal).center)
    times, wide = (0.0, 0.7, 1.5, span[1]), 0.4
    longest = 0.5 * nominal.velocity_limit * (times[2] - times[1]) * 8.0 / 15.0
    way = np.minimum(rng.uniform(0.2, 0.5, nominal.nv), longest)
    way *= rng.choice([-1.0, 1.0], nominal.nv)
    for _ in range(TRIES):
        start = _inside(nominal, usual + wide * rng.uniform(-1.0, 1.0, nominal.nv), 0.2)
        end = _inside(nominal, start + way, 0.1)
        first, last = (nominal.from_joint_positions(x) for x in (start, end))
        reference = Quintic.through(nominal, np.array([first, first, last, last]), times=times)
        if _bears(true, reference, span[1]):
            return reference
        wide, way = 0.95 * wide, 0.93 * way
    raise ArgumentError("arm", nominal.name, "no move was found that its motors can follow")


def _upper(arm: Arm) -> Array:
    return np.asarray(arm.upper_position_limit)


def _inside(arm: Arm, x: Array, margin: float) -> Array:
    """Return joint positions moved inside the limits, at least `margin` or half the range [rad]."""
    lower, upper = arm.lower_position_limit, arm.upper_position_limit
    finite = np.isfinite(lower) & np.isfinite(upper)
    kept = np.minimum(margin, np.where(finite, 0.5 * (upper - lower), np.inf))
    return np.asarray(np.clip(x, lower + kept, upper - kept))


def _bears(true: Arm, reference: Reference, duration: float) -> bool:
    return not broken_limits(
        true, reference, duration=duration, samples=60, effort_share=EFFORT_SHARE
    )


def _printed() -> Setting:
    return Setting(
        nominal=two_link.nominal_arm(),
        true=two_link.true_arm(),
        kind="paper",
        reference=two_link.reference,
        q0=np.array(two_link.Q_START),
        span=PAPER_TIME,
        disturbance=two_link.disturbance,
    )


def _redrawn(rng: np.random.Generator, span: tuple[float, float]) -> Setting:
    """Return the paper's case with other masses, disturbance, motion and start."""
    true = fp.perturb(
        two_link.true_arm(), mass_scale=Uniform(0.5, 3.0), seed=int(rng.integers(2**31))
    )
    size, rate, shift = rng.uniform(0.5, 2.0, 4), rng.uniform(0.5, 2.0, 3), rng.uniform(0.0, 6.3, 3)
    ways = rng.uniform(-1.5, 1.5, 2)

    def disturbance(t: float) -> Array:
        hum = 0.5 * size[2] * math.sin(200.0 * math.pi * t * rate[2] ** 0.5 + shift[2])
        return np.array(
            [
                2.0 * size[0] * math.sin(rate[0] * t + shift[0]) + hum,
                size[1] * math.cos(2.0 * rate[1] * t + shift[1]) + hum,
            ]
        )

    def reference(t: float) -> tuple[Array, Array, Array]:
        """`q_d = 1.25 + w (-e^{-t} + e^{-4t} / 4)`, as [39] with other ways `w`."""
        slow, fast = math.exp(-t), math.exp(-4.0 * t)
        return (
            1.25 + ways * (-slow + 0.25 * fast),
            ways * (slow - fast),
            ways * (-slow + 4.0 * fast),
        )

    error = size[3] * np.array([0.8, 0.5]) * rng.choice([-1.0, 1.0], 2)
    return Setting(
        nominal=two_link.nominal_arm(),
        true=true,
        kind="paper",
        reference=reference,
        q0=reference(0.0)[0] + 0.6 * error,
        span=span,
        disturbance=disturbance,
    )
