"""A law in C, with what stands around its tick: its structs, its tables, its functions."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.control.arguments import ROUNDNESS
from fotsmc_pin.control.controller import LONGEST_TICK, SHORTEST_TICK
from fotsmc_pin.control.rows import Joints
from fotsmc_pin.export.addition import Addition, addition_of
from fotsmc_pin.export.dialect import comment, identifier, member_name
from fotsmc_pin.export.joints import Turning, joints_of
from fotsmc_pin.export.law import Law
from fotsmc_pin.export.layout import STATUSES, assigned, block, notes_of, numbers, struct_lines
from fotsmc_pin.export.learner import Learner
from fotsmc_pin.export.names import ERRORS, INIT, RESET, TAU, UPDATE, Names
from fotsmc_pin.learning import ModelLearning

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control import Controller
    from fotsmc_pin.export.program import Function, Program

LIGHTEST, HEAVIEST, STRONGEST = 1e-9, 1e8, 1e20
"""Bounds of a mass matrix's diagonal and entries, and of torques: beyond, a model is refused."""

GROUPS = {
    "joints": "What a tick brings, and the torque that it gives.",
    "memory": "What lives on from tick to tick.",
    "work": "What a tick fills anew.",
}
"""Structs of a law beside its gains."""


class BareLaw:
    """Writes a law.

    Attributes:
        arm: the arm.
        names: how its parts are called.
        program: where its functions are written.
        law: the translated law.
        turning: what its continuous joints need.
        around: what stands around its tick: friction that is known, or what learns.
    """

    def __init__(
        self, controller: Controller | ModelLearning, program: Program, *, wrapped: bool = False
    ) -> None:
        self.arm, self.program, self.dialect = controller.arm, program, program.dialect
        self.names = Names.of(self.arm, wrapped=wrapped)
        if isinstance(controller, ModelLearning):
            self.around: Addition = Learner(controller, program, self.names)
            law: Controller = controller.controller
        else:
            self.around, law = addition_of(controller, program), controller
        self.joints = joints_of(self.arm)
        self.turning = Turning(program)
        self.law = Law.of(law, program, self.names.prefix, self.names.state)
        self._update_text = self._update_lines()

    @property
    def meanings(self) -> Sequence[tuple[str, str]]:
        """The status codes of a tick, with what each means."""
        return STATUSES

    def public(self) -> list[tuple[str, str]]:
        """Return the public functions, with what a caller has to know."""
        heads = self.heads()
        return [
            (heads["init"], INIT),
            (heads["reset"], RESET),
            (heads["update"], self.update_note()),
        ]

    def update_note(self, *more: str, ends: Sequence[str] = ERRORS) -> str:
        """Return what a caller has to know of a tick."""
        model = []
        if not self.law.controller.uses_model:
            model = ["", "This law needs no model: M and h may be null pointers."]
        lines = [*UPDATE, *more, *TAU, *model, *self.around.note, "", *ends]
        return "\n".join(lines).replace("@", self.names.prefix.upper())

    def types(self) -> list[str]:
        """Return the structs."""
        law, real, lines = self.law, self.dialect.real, self._gains_type()
        for member, note in GROUPS.items():
            struct = law.structs[member]
            if struct.fields:
                notes = notes_of(struct.kind)
                lines += [*comment(note), *struct_lines(struct, notes, self.dialect)]
        lines += self.around.types()
        what = "A controller." if not self.names.scope else "The law."
        lines += [*comment(f"{what} A copy remembers everything too."), "typedef struct {"]
        for member in ("gains", *GROUPS):
            struct = law.structs[member]
            if struct.fields and (member != "gains" or law.live_gains):
                lines.append(f"    {struct.name} {member};")
        for name, memory in law.memories.items():
            note = "/* memory of a fractional operator */"
            lines.append(f"    {real} {name}_memory[{memory.size}]; {note}")
        lines += self.around.members()
        return [*lines, f"}} {self.names.state};", ""]

    def tables(self) -> list[str]:
        """Return the coefficients of the fractional operators."""
        lines = []
        for name, table in self.law.tables.items():
            lines += comment(f"Coefficients of the operator `{name}`, a row after the other.")
            lines += numbers(f"{identifier(name)}_table", table, self.dialect)
        return [*lines, *self.around.tables()]

    @property
    def roots(self) -> list[str]:
        """Translated functions that are called from outside of the translation."""
        own = [self.law.tick.name, self.law.read.name]
        return [*own, *self.turning.used, *self.around.roots]

    def heads(self) -> dict[str, str]:
        """Return the declarations of the law's functions."""
        state, name = (
            f"{self.names.state} *state",
            f"{self.names.scope}%s {self.names.functions}_%s",
        )
        return {
            "init": f"{name % ('void', 'init')}({state})",
            "reset": f"{name % ('void', 'reset')}({state})",
            "update": f"{name % ('int', 'update')}({self.arguments(state)})",
        }

    def arguments(self, state: str, *more: str) -> str:
        """Return the arguments of a tick, with `more` after those of the model."""
        real, n, nq = self.dialect.real, self.arm.nv, self.arm.nq
        sizes = {"q": nq, "v": n, "q_d": nq, "v_d": n, "a_d": n, "M": n * n, "h": n}
        given = [f"const {real} {name}[{size}]" for name, size in sizes.items()]
        return ", ".join([state, *given, *more, f"{real} dt", f"{real} tau[{n}]"])

    def functions(self) -> list[str]:
        """Return the functions."""
        heads = self.heads()
        lines = list(self._update_text)
        lines += block(heads["reset"], self._reset_lines(), "Forget everything but the gains.")
        return lines + block(heads["init"], self._init_lines(), "Fill in the gains, begin anew.")

    def _gains_type(self) -> list[str]:
        law = self.law
        notes: dict[str, str] = {}
        for base in reversed(type(law.gains).__mro__):
            notes |= notes_of(base)
        fixed = []
        for field in fields(law.gains):
            if field.name in law.live_gains:
                unit, choices = field.metadata.get("unit"), field.metadata.get("choices")
                more = f" [{unit}]" if unit else ""
                if choices:
                    more = ": " + ", ".join(f"{k} {word}" for k, word in enumerate(choices))
                notes[field.name] = notes.get(field.name, "").rstrip(".") + more
            else:
                value = getattr(law.gains, field.name)
                shown = value.tolist() if isinstance(value, np.ndarray) else value
                fixed.append(f"  {field.name} = {shown}")
        lines = []
        if fixed:
            lines += [*comment("\n".join(["Gains that stay as they were exported:", *fixed])), ""]
        if law.live_gains:
            lines += comment("Gains that may be changed between two ticks. Nothing checks them.")
            lines += struct_lines(law.structs["gains"], notes, self.dialect, law.live_gains)
        return lines

    def _init_lines(self) -> list[str]:
        law, n, lines = self.law, self.arm.nv, []
        by_name = {field.name: field for field in fields(law.gains)}
        for name in law.live_gains:
            metadata, value = by_name[name].metadata, getattr(law.gains, name)
            if isinstance(value, str):
                value = metadata["choices"].index(value)
            value = np.broadcast_to(value, n) if metadata["kind"] == "per joint" else float(value)
            lines += assigned(f"state->gains.{member_name(name)}", value, self.dialect)
        lines += assigned("state->joints.effort_limit", self.arm.effort_limit, self.dialect)
        return [*lines, f"{self.names.functions}_reset(state);"]

    def _reset_lines(self) -> list[str]:
        law, zero = self.law, self.dialect.number(0.0)
        cleared = [f"joints.{name}" for name in Joints._fields if name != "effort_limit"]
        for group in ("memory", "work"):
            cleared += [f"{group}.{member_name(name)}" for name in law.structs[group].fields]
        lines = [f"for (int i = 0; i < {self.arm.nv}; i++) {{"]
        lines += [*(f"    state->{target}[i] = {zero};" for target in cleared), "}"]
        for name, memory in law.memories.items():
            target = f"state->{name}_memory[i] = {zero};"
            lines.append(f"for (int i = 0; i < {memory.size}; i++) {{ {target} }}")
        for group, rows in law.first_rows().items():
            for name, row in rows.items():
                lines += assigned(f"state->{group}.{member_name(name)}", row, self.dialect)
        for name, memory in law.memories.items():
            flat = memory.ravel()
            for k in np.flatnonzero(flat):
                number = self.dialect.number(float(flat[k]))
                lines.append(f"state->{name}_memory[{k}] = {number};")
        return [*lines, *self.around.reset_lines()]

    def _update_lines(self) -> list[str]:
        law, real, n = self.law, self.dialect.real, self.arm.nv
        models = ["M", "h"] if law.controller.uses_model else []
        shape = law.structs["joints"].name
        pointers = ", ".join(f"const {real} *{name}" for name in (*_sizes(self.arm), *models))
        given = ", ".join([*_sizes(self.arm), *models])
        lines = block(
            f"static bool are_finite(const {real} *x, int size)",
            [
                "for (int i = 0; i < size; i++) {",
                "    if (!isfinite(x[i])) { return false; }",
                "}",
                "return true;",
            ],
            "Whether every number is finite.",
        )
        lines += block(
            f"static int understood({shape} *seen, {pointers}, {real} dt)",
            self._understood_lines(),
            "Read the arguments of a tick, each number kept within bounds; or say what is wrong.",
        )
        lines += self.around.functions()
        status = self.around.judged(f"understood(&seen, {given}, dt)")
        tick = self.around.around([f"{_call(law.tick, self._given())};"])
        update = [
            f"{shape} seen = state->joints;",
            f"const int status = {status};",
            f"if (status == {self.names.status('OK')}) {{",
            "    state->joints = seen;",
            *(f"    {line}" for line in tick),
            "}",
            f"for (int i = 0; i < {n}; i++) {{ tau[i] = {self.around.last_torque}; }}",
            *([] if models else ["(void)M;", "(void)h;"]),
            "return status;",
        ]
        return lines + block(self.heads()["update"], update, "One tick of the law.")

    def _understood_lines(self) -> list[str]:
        names, number = self.names, self.dialect.number
        lines = [
            f"{self.dialect.real} places[{2 * self.arm.nq}];",
            f"if (!{_call(self.law.read, {'table': 'seen', 'configurations': 'places'})}) {{",
        ]
        for name, count in _sizes(self.arm).items():
            bad = names.status(f"BAD_{name.upper()}")
            lines.append(f"    if (!are_finite({name}, {count})) {{ return {bad}; }}")
        lines.append("}")
        nq = self.arm.nq
        for place, name in ((0, "BAD_Q"), (nq, "BAD_Q_D")):
            pairs = self.turning.round_checks(self.joints, f"places + {place}", ROUNDNESS)
            lines += [f"if (!{pair}) {{ return {names.status(name)}; }}" for pair in pairs]
        if any(joint.turns_on for joint in self.joints):
            places = f"places + {nq}", "places"
            lines += self.turning.difference(self.joints, *places, "seen->e")
        dt = self.law.controller.dt
        shortest, longest = number(SHORTEST_TICK * dt), number(LONGEST_TICK * dt)
        bad_dt = f"return {names.status('BAD_DT')};"
        lines.append(f"if (!(dt >= {shortest} && dt <= {longest})) {{ {bad_dt} }}")
        if self.law.controller.uses_model:
            n, bad = self.arm.nv, f"return {names.status('BAD_MODEL')};"
            size = self.dialect.function("fabs")
            lines += [
                f"for (int i = 0; i < {n}; i++) {{",
                f"    if (!({size}(h[i]) <= {number(STRONGEST)})) {{ {bad} }}",
                f"    if (!(M[i * {n + 1}] >= {number(LIGHTEST)})) {{ {bad} }}",
                "}",
                f"for (int i = 0; i < {n * n}; i++) {{",
                f"    if (!({size}(M[i]) <= {number(HEAVIEST)})) {{ {bad} }}",
                "}",
            ]
        return [*lines, f"return {names.status('OK')};"]

    def _given(self) -> dict[str, str]:
        found = {"dt": "dt", "table": "state", "M0": "M", "h0": self.around.h}
        for name in self.law.tables:
            found[identifier(f"{name}_memory")] = f"state->{name}_memory"
        return found


def _sizes(arm: Arm) -> dict[str, int]:
    return {"q": arm.nq, "v": arm.nv, "q_d": arm.nq, "v_d": arm.nv, "a_d": arm.nv}


def _call(function: Function, names: dict[str, str]) -> str:
    given = [function.arguments[k][0] for k in function.kept]
    return f"{function.name}({', '.join(names.get(name, name) for name in given)})"
