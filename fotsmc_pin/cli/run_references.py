"""What an arm is asked to do in `fotsmc simulate`: the reference by its word, or from a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.references import Quintic
    from fotsmc_pin.types import Array, Reference

WORDS = ("sine", "move", "hold", "paper")
EFFORT_SHARE = 0.5
"""Share of the effort limits that a move may use."""
DURATION = 10.0
"""Simulated time where neither the user nor the reference says one [s]."""


def complete_reference(incomplete: str) -> list[str]:
    """Return the words that begin like this, for the shell's completion."""
    return [word for word in WORDS if word.startswith(incomplete)]


@dataclass(frozen=True, kw_only=True, eq=False)
class Task:
    """What the arm is to do.

    Attributes:
        reference: `t -> (q_d, v_d, a_d)`.
        words: what it is, in plain words.
        q_start: configuration at the start, (nq,), before any start error.
        duration: how long it is run where nothing else is asked for [s].
    """

    reference: Reference
    words: str
    q_start: Array
    duration: float = DURATION


def task(word: str, arm: Arm) -> Task:
    """Return what a word of `--reference` stands for.

    Args:
        word: "sine", "move", "hold", "paper", or the path of a CSV file.
        arm: the nominal arm.

    Raises:
        ArgumentError: an unknown word, or one that does not fit the arm.
        FileNotFoundError: no such CSV file.
    """
    from fotsmc_pin.checks import did_you_mean
    from fotsmc_pin.references import Hold, Sinusoid, Spline

    if word == "sine":
        sine = Sinusoid.inside_limits(arm)
        return Task(reference=sine, words="sine in every joint", q_start=sine(0.0)[0])
    if word == "hold":
        center = Sinusoid.inside_limits(arm).center
        return Task(reference=Hold(arm, center), words="hold one pose", q_start=center)
    if word == "move":
        path = point_to_point(arm)
        words = f"move for {path.duration:.3g} s, then rest"
        return Task(reference=path, words=words, q_start=path(0.0)[0])
    if word == "paper":
        return _paper(arm)
    if not Path(word).suffix:
        known = f"{did_you_mean(word, WORDS)}choose {', '.join(WORDS)}, or give a CSV file"
        raise ArgumentError("--reference", word, known)
    spline = Spline.from_csv(arm, word)
    return Task(
        reference=spline,
        words=f"samples of {word}",
        q_start=spline(0.0)[0],
        duration=spline.duration,
    )


def point_to_point(arm: Arm) -> Quintic:
    """Return one move of all joints from rest to rest, inside the limits of the arm.

    It goes from one end of the arm's sinusoids (`Sinusoid.inside_limits`) to the other, as fast as
    half of the velocity limits allow, in 2 s at the least, and slower or shorter where the effort
    would exceed half of a limit.
    """
    from fotsmc_pin.references import Quintic, Sinusoid, broken_limits

    sine = Sinusoid.inside_limits(arm)
    reach, seconds = sine.amplitude, 2.0
    for attempt in range(12):
        ends = [arm.integrate(sine.center, side * reach) for side in (-1.0, 1.0)]
        fastest = 0.5 * arm.velocity_limit
        speed = 1.875 * 2.0 * float((reach / fastest).max())  # The quintic's peak is 15/8.
        path = Quintic.through(arm, ends, times=[0.0, max(seconds, speed)])
        if not broken_limits(arm, path, samples=200, effort_share=EFFORT_SHARE):
            return path
        reach, seconds = 0.8 * reach, seconds * (1.25 if attempt < 6 else 1.0)
    raise ArgumentError("--reference", "move", "the effort limits leave no room for one; try hold")


def _paper(arm: Arm) -> Task:
    import numpy as np

    from fotsmc_pin.paper.two_link import DURATION as PAPER_DURATION
    from fotsmc_pin.paper.two_link import Q_START, reference

    if (arm.nq, arm.nv) != (2, 2):
        raise ArgumentError("--reference", "paper", f"is for two joints; {arm.name} has {arm.nv}")
    return Task(
        reference=reference,
        words="the paper's [39]",
        q_start=np.array(Q_START),
        duration=PAPER_DURATION,
    )
