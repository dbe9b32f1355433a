"""What stands around the tick of a law in C: nothing, friction that is known, or what learns."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.control.friction_terms import FrictionTerms, add_friction
from fotsmc_pin.export.dialect import comment
from fotsmc_pin.export.layout import numbers
from fotsmc_pin.export.values import Array, Root

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.control import Controller
    from fotsmc_pin.export.program import Program

FRICTION = "known_friction"
"""Name of the numbers of the friction that is known."""


class Addition:
    """Nothing.

    Attributes:
        roots: translated functions that are called from outside of the translation.
        h: the torque that a tick of the law is given for `h`.
        note: what a caller has to know of it.
    """

    h = "h"
    note: Sequence[str] = ()

    def __init__(self) -> None:
        self.roots: list[str] = []

    @property
    def last_torque(self) -> str:
        """The torque that was sent last, entry `i`."""
        return "state->joints.tau[i]"

    def types(self) -> list[str]:
        """Return its structs."""
        return []

    def members(self) -> list[str]:
        """Return what it keeps in the state of the law."""
        return []

    def tables(self) -> list[str]:
        """Return its constants."""
        return []

    def reset_lines(self) -> list[str]:
        """Return what forgets."""
        return []

    def functions(self) -> list[str]:
        """Return what stands before a tick of the law."""
        return []

    def judged(self, status: str) -> str:
        """Return the status of a tick whose arguments have this one."""
        return status

    def around(self, tick: Sequence[str]) -> list[str]:
        """Return the call of the law's tick, and what stands around it."""
        return [*tick]

    def noted(self, law: str) -> list[str]:
        """Return what takes note of a torque that acts in place of the tick's own, entry `i`.

        Args:
            law: the law's state; `tau` and `friction` are the torque and what of it was added
                against friction.
        """
        return [f"{law}.joints.tau[i] = tau[i] - friction[i];"]

    def public(self, outer: str, place: str) -> list[tuple[str, str, list[str]]]:
        """Return its public functions: declaration, what a caller has to know, and text.

        Args:
            outer: type of the state that a caller has.
            place: pointer to the law's state in it.
        """
        del outer, place
        return []


class KnownFriction(Addition):
    """The friction of an arm's file, fed forward as in `FrictionTerms`."""

    h = "ahead"
    note = ("", "The friction of the arm's file, which says that it is known, is added to h here.")

    def __init__(self, terms: FrictionTerms, program: Program) -> None:
        super().__init__()
        self._numbers, self._dialect = terms._numbers, program.dialect
        self._n = n = self._numbers.shape[1]
        table = Array(FRICTION, (4, n), Root(), data=self._numbers)
        values = [Array("v_d", (n,), Root()), table, Array("h", (n,), Root())]
        self._add = program.function(add_friction, values, caller=None, node=None).name
        self.roots = [self._add]

    def tables(self) -> list[str]:
        """Return the numbers of the friction."""
        note = "By joint: viscous, Coulomb, what breakaway has more, and the speed of its fall."
        return [*comment(note), *numbers(FRICTION, np.array(self._numbers), self._dialect)]

    def around(self, tick: Sequence[str]) -> list[str]:
        """Return the call of the law's tick behind what adds the friction."""
        return [
            f"{self._dialect.real} ahead[{self._n}];",
            f"for (int i = 0; i < {self._n}; i++) {{ ahead[i] = h[i]; }}",
            f"{self._add}(state->joints.v_d, ahead);",
            *tick,
        ]


def addition_of(controller: Controller, program: Program) -> Addition:
    """Return what stands around the tick of a law that nothing wraps."""
    terms = controller._terms
    if controller.uses_model and isinstance(terms, FrictionTerms):
        return KnownFriction(terms, program)
    return Addition()
