"""What writes the functions of a guarded law: kernels by their names in C, loops, checks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fotsmc_pin.export.values import Array, Root, Scalar

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.control import Safeguard
    from fotsmc_pin.export.bare import BareLaw
    from fotsmc_pin.export.program import Program

EFFORT = "state->law.joints.effort_limit"


class GuardLines:
    """Writes lines of C.

    Attributes:
        roots: translated kernels that are called.
    """

    def __init__(self, guard: Safeguard, bare: BareLaw, program: Program) -> None:
        self.roots: list[str] = []
        self._guard, self._bare, self._program = guard, bare, program
        self._n, self._nq, self._real = guard.arm.nv, guard.arm.nq, program.dialect.real
        self._state = f"{bare.names.prefix}_state *state"

    def _kernel(self, kernel: Any, *ranks: int) -> str:
        """Return the name of a translated kernel.

        A rank is 0 for a number, 1 for a vector, 2 for a square matrix, and else, below zero, that
        of a table with so many rows.
        """
        shapes: dict[int, tuple[int, ...]] = {rank: (-rank, self._n) for rank in ranks}
        shapes |= {1: (self._n,), 2: (self._n, self._n)}
        values = [
            Array(f"x{k}", shapes[rank], Root()) if rank else Scalar("real", "x")
            for k, rank in enumerate(ranks)
        ]
        found = self._program.function(kernel, values, caller=None, node=None)
        assert len(found.kept) == len(ranks), f"{found.name} does not use all that it takes"
        self.roots.append(found.name)
        return found.name

    def _each(self, text: str, *words: str, size: int = 0) -> str:
        """Return a loop over the joints; `{0}` stands for the first of `words`."""
        for k, word in enumerate(words):
            text = text.replace(f"{{{k}}}", word)
        return f"for (int i = 0; i < {size or self._n}; i++) {{ {text} }}"

    def _difference(self, q0: str, q1: str, target: str) -> Sequence[str]:
        lines = self._bare.turning.difference(self._bare.joints, q0, q1, target)
        return [f"    {line}" for line in lines]

    def _unless(self, condition: str, code: str) -> str:
        return f"if (!{condition}) {{ return {self._status(code)}; }}"

    def _pointers(self, *names: str) -> str:
        return ", ".join(f"const {self._real} *{name}" for name in names)

    def _number(self, value: float) -> str:
        return self._program.dialect.number(value)

    def _status(self, name: str) -> str:
        return self._bare.names.status(name)
