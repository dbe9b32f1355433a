"""What disturbs a run, sorted out: functions of time, and wrenches, which depend on the arm."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.simulation.faults import flaw
from fotsmc_pin.simulation.wrench import Wrench

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Disturbance


Disturbances: TypeAlias = "Disturbance | Wrench | Sequence[Disturbance | Wrench] | None"
"""One disturbance, several that add up, or none."""


def sorted_out(
    arm: Arm, given: Disturbances, duration: float
) -> tuple[Disturbance | None, tuple[Wrench, ...]]:
    """Return the sum of all functions of time, checked at each call, and the wrenches.

    Raises:
        ArgumentError: neither a callable nor a wrench, a wrench that begins after the run, or a
            function whose value at time 0 is unusable.
    """
    several = isinstance(given, Sequence)
    parts = [] if given is None else [*given] if isinstance(given, Sequence) else [given]
    functions: list[Callable[[float], ArrayLike]] = []
    wrenches: list[Wrench] = []
    for k, part in enumerate(parts):
        name = f"disturbance[{k}]" if several else "disturbance"
        if isinstance(part, Wrench):
            if part.start >= duration:
                remedy = f"it begins at {part.start:g} s and the run ends at {duration:g} s"
                raise ArgumentError(name, part.words, f"{remedy}; let it begin before")
            wrenches.append(part)
        elif callable(part):
            checks.finite_vector(name, part(0.0), arm.nv)
            functions.append(_checked(name, part, arm.nv))
        else:
            raise ArgumentError(name, part, "give a callable t -> (nv,), an fp.Wrench, or a list")
    if len(functions) < 2:
        return next(iter(functions), None), tuple(wrenches)

    def total(t: float) -> ArrayLike:
        acting: ArrayLike = np.array([function(t) for function in functions]).sum(axis=0)
        return acting

    return total, tuple(wrenches)


def _checked(name: str, disturbance: Disturbance, size: int) -> Disturbance:
    def checked(t: float) -> ArrayLike:
        """Refuse what would be spread over the joints in silence."""
        value = disturbance(t)
        if np.shape(value) != (size,):
            raise ArgumentError(name, value, f"at t = {t:.6g} s it {flaw(value, (size,))}")
        return value

    return checked
