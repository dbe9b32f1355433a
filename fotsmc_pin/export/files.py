"""The two files of an exported controller: the header and the program."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

import fotsmc_pin
from fotsmc_pin.control import Safeguard
from fotsmc_pin.export.bare import BareLaw
from fotsmc_pin.export.dialect import Dialect, comment
from fotsmc_pin.export.guard import GuardedLaw
from fotsmc_pin.export.layout import block, statuses
from fotsmc_pin.export.program import Program

if TYPE_CHECKING:
    from fotsmc_pin.control import Controller
    from fotsmc_pin.learning import ModelLearning


class Files:
    """Writes the header and the program.

    Attributes:
        prefix: what all public names begin with.
    """

    def __init__(
        self, controller: Controller | ModelLearning | Safeguard, *, single: bool = False
    ) -> None:
        """Translate a controller.

        Args:
            controller: any controller.
            single: whether reals are `float`.
        """
        program = Program(Dialect(single=single))
        self._written: Any
        if isinstance(controller, Safeguard):
            self._written = GuardedLaw(controller, program)
        else:
            self._written = BareLaw(controller, program)
        self._program, self._controller = program, controller
        bare: BareLaw = getattr(self._written, "bare", self._written)
        self._law, self._around = bare.law.controller, bare.around
        self.prefix: str = self._written.names.prefix

    def header(self) -> str:
        """Return the text of the header."""
        arm, macro = self._controller.arm, self.prefix.upper()
        period = self._program.dialect.number(self._controller.dt)
        lines = [
            *comment(self._about()),
            f"#ifndef {macro}_H",
            f"#define {macro}_H",
            "",
            "#ifdef __cplusplus",
            'extern "C" {',
            "#endif",
            "",
            f"#define {macro}_NQ {arm.nq} /* numbers of a configuration */",
            f"#define {macro}_NV {arm.nv} /* joints */",
            f"#define {macro}_DT {period} /* nominal period of a tick [s] */",
            "",
            *statuses(macro, self._written.meanings),
            *self._written.types(),
        ]
        more = [(head, note) for head, note, _ in self._more()]
        for head, note in (*self._written.public(), *more):
            lines += [*comment(note), f"{head};", ""]
        return "\n".join([*lines, "#ifdef __cplusplus", "}", "#endif", "", "#endif", ""])

    def source(self) -> str:
        """Return the text of the program."""
        written = self._written
        lines = [
            *comment(f"{type(self._law).__name__} for {self._law.arm.name}: see the header."),
            f'#include "{self.prefix}.h"',
            "",
            "#include <math.h>",
            "#include <stdbool.h>",
            "",
            *written.tables(),
            *self._program.text(*written.roots),
            *written.functions(),
        ]
        for head, _, text in self._more():
            lines += block(head, text, "See the header.")
        return "\n".join(lines)

    def _more(self) -> list[tuple[str, str, list[str]]]:
        guarded = isinstance(self._controller, Safeguard)
        return self._around.public(f"{self.prefix}_state", "&state->law" if guarded else "state")

    def _about(self) -> str:
        arm, kind = self._law.arm, type(self._law)
        wrapped = " that learns its model" if self._more() else ""
        wrapped += " in a Safeguard" if isinstance(self._controller, Safeguard) else ""
        return "\n".join(
            [
                f"{kind.__name__}{wrapped} for {arm.name}: {arm.nv} joints.",
                "",
                *(f"  {k} {name}" for k, name in enumerate(arm.joint_names)),
                "",
                f"Written by fotsmc_pin {fotsmc_pin.__version__}; do not edit. C99 that needs",
                "math.h alone: nothing is allocated, and nothing is kept outside of the state.",
                "Angles are in rad, ways in m, torques in N*m, forces in N, times in s.",
                "",
                "The law:",
                "",
                inspect.cleandoc(kind.__doc__ or ""),
            ]
        )
