"""What a learner in C remembers: its structs, its constants, and how it begins."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fotsmc_pin.export.dialect import comment
from fotsmc_pin.export.layout import assigned, notes_of, numbers, struct_lines
from fotsmc_pin.export.values import Struct
from fotsmc_pin.learning.estimator import JointRows
from fotsmc_pin.learning.parameters import Beliefs
from fotsmc_pin.learning.tick import Whole

if TYPE_CHECKING:
    from fotsmc_pin.export.dialect import Dialect
    from fotsmc_pin.learning import ModelLearning

BODIES = "unit_bodies_table"
"""Name of the dynamic parameters per unit of each shared parameter."""
FIRST = ("mean", "deviation", "lowest", "highest")
"""What is believed beforehand, which never changes."""


class LearnerState:
    """Writes the memory of a learner.

    Attributes:
        owner: the wrapped controller, freshly reset.
        type_name: of its struct.
        structs: those of named rows in it, by their member.
        sizes: number of entries of each other array in it.
    """

    def __init__(self, owner: ModelLearning, dialect: Dialect, prefix: str) -> None:
        self.owner, self._dialect, self.type_name = owner, dialect, f"{prefix}_learner"
        n = owner.arm.nv
        self.structs = {
            "whole": Struct(f"{prefix}_whole", Whole, _sized(Whole, 1)),
            "rows": Struct(f"{prefix}_rows", JointRows, _sized(JointRows, n)),
            "beliefs": Struct(f"{prefix}_beliefs", Beliefs, _sized(Beliefs, owner._layout.size)),
        }
        self.sizes = {
            "sent": owner._sent.size,
            "P": owner._P.size,
            "Y": owner._Y.size,
            "regressor": 10 * n**2,
            "written": 10 * n,
            "middle": owner.arm.nq,
        }
        if owner._feeds and not owner.controller.uses_model:
            self.sizes["ahead"] = n

    def types(self) -> list[str]:
        """Return the structs; that of the learner has the others as members."""
        owner, n = self.owner, self.owner.arm.nv
        p, columns = owner._layout.size, owner._layout.columns
        notes = {
            "sent": f"torques that were sent, the oldest first ({owner.delay + 1}, {n}) [N*m, N]",
            "P": f"covariance of the parameters ({p}, {p})",
            "Y": f"rows of the estimator after one and after both low-passes (2, {n}, {columns})",
            "regressor": f"of the last window ({n}, {10 * n})",
            "written": f"dynamic parameters of the learnt links ({n}, 10)",
            "middle": "configuration that stands for a window [rad, m]",
            "ahead": "friction that was added to the torque [N*m, N]",
        }
        about = (
            "Numbers of the whole arm.",
            "What the estimator knows of each joint.",
            "\n".join(["What is believed of each parameter:", "", *self._parameters()]),
        )
        lines = []
        for struct, note in zip(self.structs.values(), about, strict=True):
            lines += [*comment(note), *struct_lines(struct, notes_of(struct.kind), self._dialect)]
        lines += [*comment("What learns the arm."), "typedef struct {"]
        lines += [f"    {struct.name} {member};" for member, struct in self.structs.items()]
        for name, size in self.sizes.items():
            lines.append(f"    {self._dialect.real} {name}[{size}]; /* {notes[name]} */")
        given = "int given; /* whether the regressor of the last window is there */"
        return [*lines, f"    {given}", f"}} {self.type_name};", ""]

    def tables(self) -> list[str]:
        """Return the constants: of the links, and what is believed beforehand."""
        lines = comment("Dynamic parameters per unit of each shared parameter, ten in a row.")
        lines += numbers(BODIES, self.owner._bodies, self._dialect)
        for name in FIRST:
            lines += comment(f"Of each parameter: {notes_of(Beliefs)[name]}")
            lines += numbers(f"first_{name}", getattr(self.owner._b, name), self._dialect)
        return lines

    def reset_lines(self) -> list[str]:
        """Return what forgets all that was learnt."""
        zero, p, place = self._dialect.number(0.0), self.owner._layout.size, "state->learner"
        lines = []
        for name, size in self.sizes.items():
            first = f"{BODIES}[i]" if name == "written" else zero
            lines.append(f"for (int i = 0; i < {size}; i++) {{ {place}.{name}[i] = {first}; }}")
        for member, rows in (("whole", self.owner._a), ("rows", self.owner._x)):
            for name in self.structs[member].fields:
                lines += assigned(f"{place}.{member}.{name}", getattr(rows, name), self._dialect)
        beliefs = {name: f"first_{name}[i]" for name in FIRST}
        beliefs |= dict.fromkeys(("estimate", "used"), "first_mean[i]")
        beliefs |= {"sigma": "first_deviation[i]", "work": zero}
        return [
            *lines,
            f"for (int i = 0; i < {p}; i++) {{",
            *(f"    {place}.beliefs.{name}[i] = {value};" for name, value in beliefs.items()),
            f"    {place}.P[i * {p + 1}] = first_deviation[i] * first_deviation[i];",
            "}",
            f"{place}.given = 0;",
        ]

    def _parameters(self) -> list[str]:
        return [
            f"{k:3d} {row.group} {row.of}{f' [{row.unit}]' if row.unit else ''}"
            for k, row in enumerate(self.owner.estimates())
        ]


def _sized(names: Any, size: int) -> dict[str, tuple[int, ...]]:
    return dict.fromkeys(names._fields, (size,))
