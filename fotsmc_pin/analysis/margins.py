"""`margins`: what a law's loop bears, computed and not searched."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.analysis.linearization import linearize
from fotsmc_pin.analysis.sampled_loop import (
    closed_loop,
    edge,
    is_stable,
    noise_gain,
    open_loop,
)
from fotsmc_pin.control import TaskSpace
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.analysis.linearization import LinearLaw
    from fotsmc_pin.control import Controller, SpringObserver
    from fotsmc_pin.types import Array


LIGHTEST, HEAVIEST = 1e-3, 1e3
"""Ratios of inertia beyond which no edge is looked for."""
RATES = 400
AMPLITUDE = 1e-4
"""Error at which slopes are taken [rad, m]."""
ALIKE = 1e-4
"""Difference of two joints' laws, relative to the largest entry, that is one of rounding only."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Margins:
    """What the loop of a law bears near its equilibrium; the worst joint counts.

    Attributes:
        delay: ticks of delay that were assumed.
        lowest: true over nominal inertia down to which the loop is stable, from 1.
        highest: the same, upward.
        delay_margin: ticks by which the torque may come later still, in parts of a tick.
        sensitivity: largest ratio of the error with the loop to that without; 2 is a common bound.
        slowest: decay of the slowest mode [1/s].
        damping: smallest damping ratio of an oscillating mode; 1 where none oscillates.
        damping_rate: rate of that mode [rad/s].
        position_noise: torque per position noise, both RMS, at the neutral configuration (nv,)
            [N·m/rad].
        velocity_noise: torque per velocity noise (nv,) [N·m·s/rad].
        laws: the linear systems, one per joint.
    """

    delay: int
    lowest: float
    highest: float
    delay_margin: float
    sensitivity: float
    slowest: float
    damping: float
    damping_rate: float
    position_noise: Array
    velocity_noise: Array
    laws: tuple[LinearLaw, ...]

    def __str__(self) -> str:
        """Say the range in words."""
        return (
            f"bears a true inertia of {self.lowest:.3g} to {self.highest:.3g} times the nominal one"
            f" with {self.delay} tick(s) of delay, and {self.delay_margin:.2g} more ticks"
        )

    def bears(self, lowest: float, highest: float) -> bool:
        """Whether the range of ratios, such as that of `inertia_ratios`, lies inside."""
        return self.lowest < lowest and highest < self.highest


def margins(
    controller: Controller | SpringObserver | TaskSpace,
    delay: int = 1,
    *,
    amplitude: float = AMPLITUDE,
) -> Margins:
    """Return what the loop of a law bears near its surface.

    A law that multiplies a commanded acceleration with the nominal mass matrix, `τ = M0 u + h0`,
    falls apart on a true arm into scalar loops `m ë = u + disturbance`, in which `m` is an
    eigenvalue of `(M, M0)` (`inertia_ratios`). Every operator is a sum of exponentials with a known
    update, so the sampled loop with its hold and its delay is a finite linear system, and what is
    returned is read off its matrices: no simulation, no fit.

    **Linearised** are the law's functions of the error, by central differences of its real tick at
    `amplitude`: powers (`|S|^μ`, `|e|^{p/q}`), bounded functions, boundary layers. The integral `z`
    of `RobustFONFTSM` is taken at its slope at zero, `b/φ`, as it acts where the reference moves
    or the error is negligible; elsewhere at rest it is off, and `highest` is that of
    `integral=0`. **Left out** are torque limits, dry friction (which damps), gravity and Coriolis
    forces of the true arm (both slow), and what adapts: an inertia floor or a rotor found later
    shows as another `m`. Where the loop is conditionally stable, as with an integral it is at
    large `m`, a large error may lose what a small one does not.

    With a `TaskSpace` the loops are those of its law, for directions in place of joints.
    With a `SpringObserver`, `m` is that of the link's side alone: spring and rotor are known.

    Args:
        controller: the law; it is left as it was.
        delay: whole ticks from a torque to the drive; the hold comes on top.
        amplitude: error at which slopes are taken [rad, m].

    Raises:
        ArgumentError: a law of another form (`TDEFONTSM`), one whose joints are coupled beyond
            `M0`, or a loop that is not even stable with the nominal inertia.
    """
    delay = checks.count("delay", delay, at_least=0)
    controller = alone(controller)
    amplitude = checks.finite_number("amplitude", amplitude, above=0.0)
    laws = linearize(controller, amplitude)
    place, kinds = distinct(laws)
    lowest, highest = _range(controller, kinds, delay)
    dampings = [_damping(law, delay) for law in kinds]
    damping, rate = min(dampings)
    M0 = controller.arm.mass_matrix(controller.arm.neutral)
    noise = [[noise_gain(law, law.joint, delay, channel) for law in kinds] for channel in (0, 1)]
    position, velocity = (np.sqrt(M0**2 @ np.array(gain)[place] ** 2) for gain in noise)
    responses = [_response(law, delay) for law in kinds]
    return Margins(
        delay=delay,
        lowest=lowest,
        highest=highest,
        delay_margin=min(late for late, _ in responses),
        sensitivity=max(peak for _, peak in responses),
        slowest=min(_slowest(law, delay) for law in kinds),
        damping=damping,
        damping_rate=rate,
        position_noise=position,
        velocity_noise=velocity,
        laws=laws,
    )


def inertia_range(
    controller: Controller | SpringObserver | TaskSpace, delay: int = 1
) -> tuple[float, float]:
    """Return `lowest` and `highest` of `margins` alone, which takes a part of the time.

    Raises:
        ArgumentError: as `margins`.
    """
    controller = alone(controller)
    _, kinds = distinct(linearize(controller, AMPLITUDE))
    return _range(controller, kinds, delay)


def alone(controller: Controller | SpringObserver | TaskSpace) -> Controller | SpringObserver:
    """Return the law of a task on a body of its own, and any other controller as it is.

    A law that multiplies with `Λ` in a task has the loops that it has with `M0` on joints: on
    directions as many as joints, `(J M⁻¹ Jᵀ)⁻¹` and `Λ` have the eigenvalues of `(M, M0)`.
    """
    return controller.law_alone() if isinstance(controller, TaskSpace) else controller


def _range(
    controller: Controller | SpringObserver, laws: Sequence[LinearLaw], delay: int
) -> tuple[float, float]:
    """Return the edges between which the loop of every law is stable; it has to be so at 1."""
    if not all(is_stable(law, law.joint, delay) for law in laws):
        remedy = "its loop is unstable with the nominal inertia; lower its gains or the delay"
        raise ArgumentError("controller", type(controller).__name__, remedy)
    lowest = max(_edge(law, delay, LIGHTEST) for law in laws)
    return lowest, min(_edge(law, delay, HEAVIEST) for law in laws)


def _edge(law: LinearLaw, delay: int, end: float) -> float:
    return edge(lambda m: is_stable(law, law.joint.loaded(m), delay), 1.0, end)


def _same(one: LinearLaw, two: LinearLaw) -> bool:
    pairs = zip((one.A, one.B, one.C, one.D), (two.A, two.B, two.C, two.D), strict=True)
    return one.joint == two.joint and all(
        a.shape == b.shape
        and bool(np.abs(a - b).max(initial=0.0) <= ALIKE * np.abs(a).max(initial=0.0))
        for a, b in pairs
    )


def distinct(laws: Sequence[LinearLaw]) -> tuple[list[int], list[LinearLaw]]:
    """Return for each law the index of the first like it in the list of those that differ."""
    place: list[int] = []
    kinds: list[LinearLaw] = []
    for law in laws:
        like = next((k for k, kind in enumerate(kinds) if _same(law, kind)), len(kinds))
        if like == len(kinds):
            kinds.append(law)
        place.append(like)
    return place, kinds


def _rates(law: LinearLaw, delay: int) -> Array:
    """Rates `ln(z)/dt` of the loop's modes, (n,) complex, less those that are gone in a tick."""
    z = np.linalg.eigvals(closed_loop(law, law.joint, delay))
    return np.array(np.log(z[np.abs(z) > 1e-3].astype(complex)) / law.dt)


def _slowest(law: LinearLaw, delay: int) -> float:
    return float(-_rates(law, delay).real.max())


def _damping(law: LinearLaw, delay: int) -> tuple[float, float]:
    rates = _rates(law, delay)
    swinging = rates[np.abs(rates.imag) > 1e-6 * np.abs(rates)]
    if not swinging.size:
        return 1.0, 0.0
    ratio = -swinging.real / np.abs(swinging)
    worst = int(ratio.argmin())
    return float(ratio[worst]), float(np.abs(swinging[worst]))


def _response(law: LinearLaw, delay: int) -> tuple[float, float]:
    """Delay margin [ticks] and largest sensitivity."""
    rates = np.geomspace(0.1, 0.999 * np.pi / law.dt, RATES)
    ratio = open_loop(law, law.joint, delay, rates)
    peak = float((1.0 / np.abs(1.0 + ratio)).max())
    size = np.abs(ratio)
    crossings = np.flatnonzero((size[:-1] - 1.0) * (size[1:] - 1.0) < 0.0)
    late = np.inf
    for k in crossings:
        part = np.log(size[k]) / np.log(size[k] / size[k + 1])
        rate = rates[k] * (rates[k + 1] / rates[k]) ** part
        at = complex(open_loop(law, law.joint, delay, np.array([rate]))[0])
        phase = float(np.angle(-at)) % (2.0 * np.pi)
        late = min(late, phase / (rate * law.dt))
    return float(late), peak
