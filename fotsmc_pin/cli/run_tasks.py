"""What the tool is asked to do in `fotsmc simulate --task`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fotsmc_pin.cli.run_references import Task

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm

WORDS = ("swing", "circle", "line", "hold")
REST = 2.0
"""Rest after a motion that ends, beyond its own time [s]."""


def complete_task(incomplete: str) -> list[str]:
    """Return the words that begin like this, for the shell's completion."""
    return [word for word in WORDS if word.startswith(incomplete)]


def pose_task(word: str, arm: Arm) -> Task:
    """Return what a word of `--task` stands for, where the arm has room for it.

    Args:
        word: "swing", the circle and swing of the stress suite; "circle" or "line", from rest to
            rest within the limits of tool and joints; "hold", one pose.
        arm: the nominal arm.

    Raises:
        ArgumentError: an unknown word, or an arm with fewer than six joints, or without room.
    """
    import numpy as np

    from fotsmc_pin.checks import choice
    from fotsmc_pin.evaluation.stress.task_course import task
    from fotsmc_pin.references import PoseArc, PoseHold, PoseLine, PoseMotion

    choice("--task", word, WORDS)
    course = task(arm, arm)
    swing: Any = course.reference
    center, radius, q = swing.center, swing.radius, swing.q_start
    if word == "swing":
        return Task(reference=swing, words=course.text, q_start=q, duration=course.duration)
    if word == "hold":
        held: Any = PoseHold(pose=center, q_start=q)
        return Task(reference=held, words="hold one pose", q_start=q)
    ends = [center.copy(), center.copy()]
    for side, end in zip((-1.0, 1.0), ends, strict=True):
        end.translation = center.translation + side * radius * center.rotation[:, 0]
    if word == "line":
        path: Any = PoseLine(*ends)
    else:
        path = PoseArc(ends[1], center.translation, center.rotation[:, 2], 2.0 * np.pi)
    motion: Any = PoseMotion.timed(path, arm, q=q)
    words = f"move the tool along a {word} for {motion.duration:.3g} s, then rest"
    return Task(
        reference=motion, words=words, q_start=motion.q_start, duration=motion.duration + REST
    )
