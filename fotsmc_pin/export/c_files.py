"""A bare law as two files of C."""

from __future__ import annotations

import inspect
from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

import fotsmc_pin
from fotsmc_pin.control.controller import LONGEST_TICK, ROUNDNESS, SHORTEST_TICK
from fotsmc_pin.control.rows import Joints
from fotsmc_pin.export.dialect import Dialect, comment, file_identifier, identifier, member_name
from fotsmc_pin.export.joints import is_round, joints_of, turned
from fotsmc_pin.export.law import Law
from fotsmc_pin.export.layout import STATUSES, assigned, block, notes_of, numbers, struct_lines
from fotsmc_pin.export.program import Program
from fotsmc_pin.export.values import Scalar

if TYPE_CHECKING:
    from fotsmc_pin.control import Controller

LARGEST_MODEL = 1e8
"""Entries of `M` beyond this are refused."""


class CFiles:
    """The header and the program of one controller.

    Attributes:
        prefix: what all public names begin with.
        law: the translated law.
        program: the translated functions.
    """

    def __init__(self, controller: Controller, *, single: bool = False) -> None:
        """Translate a controller.

        Args:
            controller: any controller.
            single: whether reals are `float`.
        """
        self.arm = controller.arm
        self.prefix = f"fotsmc_{file_identifier(self.arm.name)}"
        self.macro = self.prefix.upper()
        self.dialect = Dialect(single=single)
        self.joints = joints_of(self.arm)
        self.program = Program(self.dialect)
        self.law = Law.of(controller, self.program, self.prefix)

    def header(self) -> str:
        """Return the text of the header."""
        law, real, prefix = self.law, self.dialect.real, self.prefix
        guard = f"{self.macro}_H"
        lines = [
            *comment(self._about()),
            f"#ifndef {guard}",
            f"#define {guard}",
            "",
            "#ifdef __cplusplus",
            'extern "C" {',
            "#endif",
            "",
            f"#define {self.macro}_NQ {self.arm.nq} /* numbers of a configuration */",
            f"#define {self.macro}_NV {self.arm.nv} /* joints */",
            f"#define {self.macro}_DT {self.dialect.number(self.law.controller.dt)} /* nominal period [s] */",
            "",
            *comment("What a call reports."),
            "enum {",
            *self._status_lines(),
            "};",
            "",
            *self._gains_lines(),
        ]
        for member, note in (
            ("joints", "What a tick brings, and the torque that it gives."),
            ("memory", "What lives on from tick to tick."),
            ("work", "What a tick fills anew."),
        ):
            struct = law.structs[member]
            if struct.fields:
                lines += [
                    *comment(note),
                    *struct_lines(struct, notes_of(struct.kind), self.dialect),
                ]
        lines += [
            *comment("A controller. Copying it copies everything that it remembers."),
            "typedef struct {",
        ]
        for member in ("gains", "joints", "memory", "work"):
            struct = law.structs[member]
            if struct.fields and not (member == "gains" and not law.live_gains):
                lines.append(f"    {struct.name} {member};")
        for name, memory in law.memories.items():
            lines.append(
                f"    {real} {member_name(name)}[{memory.size}]; /* memory of a fractional operator */"
            )
        lines += [f"}} {prefix}_state;", ""]
        for head, note in self._public():
            lines += [*comment(note), f"{head};", ""]
        return "\n".join([*lines, "#ifdef __cplusplus", "}", "#endif", "", "#endif", ""])

    def source(self) -> str:
        """Return the text of the program."""
        law, dialect = self.law, self.dialect
        for_update = self._update_lines()
        lines = [
            *comment(f"{type(law.controller).__name__} for {self.arm.name}: see the header."),
            f'#include "{self.prefix}.h"',
            "",
            "#include <math.h>",
            "#include <stdbool.h>",
            "",
        ]
        for name, table in law.tables.items():
            lines += [
                *comment(f"Coefficients of the operator `{name}`, a row after the other."),
                *numbers(f"{identifier(name)}_table", table, dialect),
            ]
        roots = [law.tick.name, law.read.name]
        if any(joint.turns_on for joint in self.joints):
            roots += [self._turned().name, self._is_round().name]
        lines += self.program.text(*roots)
        (init, init_note), (reset, reset_note), (update, update_note) = self._public()
        del init_note, reset_note, update_note
        lines += block(init, self._init_lines(), "Fill in the gains and begin anew.")
        lines += block(reset, self._reset_lines(), "Forget everything.")
        lines += for_update
        return "\n".join(lines)

    def _about(self) -> str:
        law = self.law
        doc = inspect.cleandoc(type(law.controller).__doc__ or "")
        kind = type(law.controller).__name__
        return "\n".join(
            [
                f"{kind} for {self.arm.name}, {self.arm.nv} joints ({', '.join(self.arm.joint_names)}).",
                "",
                f"Written by fotsmc_pin {fotsmc_pin.__version__}; do not edit. C99 with math.h alone: no",
                "memory is allocated and nothing is kept outside of the state. Configurations",
                "are in rad or m, forces in N*m or N, times in s.",
                "",
                "The law:",
                "",
                doc,
            ]
        )

    def _status_lines(self) -> list[str]:
        return [
            f"    {self.macro}_{name} = {k}{',' if k < len(STATUSES) - 1 else ''} /* {meaning} */"
            for k, (name, meaning) in enumerate(STATUSES)
        ]

    def _gains_lines(self) -> list[str]:
        law = self.law
        struct, notes = law.structs["gains"], notes_of(law.controller.Gains)
        for base in type(law.gains).__mro__:
            notes = {**notes_of(base), **notes} if base.__doc__ else notes
        fixed = []
        for field in fields(law.gains):
            if field.name in law.live_gains:
                unit = field.metadata.get("unit")
                choices = field.metadata.get("choices")
                more = f" [{unit}]" if unit else ""
                if choices:
                    more = ": " + ", ".join(f"{k} {word}" for k, word in enumerate(choices))
                notes[field.name] = notes.get(field.name, "").rstrip(".") + more
            else:
                value = getattr(law.gains, field.name)
                shown = value.tolist() if isinstance(value, np.ndarray) else value
                fixed.append(f"{field.name} = {shown}")
        lines = []
        if fixed:
            lines += comment(
                "Gains that stay as they were exported:\n"
                + "\n".join(f"  {line}" for line in fixed)
            )
            lines.append("")
        if law.live_gains:
            lines += comment("Gains that may be changed between two ticks. Nothing checks them.")
            lines += struct_lines(struct, notes, self.dialect, law.live_gains)
        return lines

    def _public(self) -> list[tuple[str, str]]:
        prefix, real, n, nq = self.prefix, self.dialect.real, self.arm.nv, self.arm.nq
        state = f"{prefix}_state *state"
        model = ""
        if not self.law.controller.uses_model:
            model = "This law knows no model: M and h are not read, and may be null pointers."
        return [
            (
                f"void {prefix}_init({state})",
                "Fill in the gains as they were exported, and begin anew. Call it before all else.",
            ),
            (
                f"void {prefix}_reset({state})",
                "Forget everything but the gains: the next tick is the first.",
            ),
            (
                f"int {prefix}_update({state}, const {real} q[{nq}], const {real} v[{n}], "
                f"const {real} q_d[{nq}], const {real} v_d[{n}], const {real} a_d[{n}], "
                f"const {real} M[{n * n}], const {real} h[{n}], {real} dt, {real} tau[{n}])",
                "\n".join(
                    [
                        "Advance by one tick.",
                        "",
                        "  q, v           measured configuration and velocity",
                        "  q_d, v_d, a_d  reference: configuration, velocity, acceleration",
                        "  M              mass matrix at q, row by row, both triangles (Pinocchio's crba)",
                        "  h              C v + g at q and v (Pinocchio's nonLinearEffects)",
                        f"  dt             measured time since the last tick [s], or {self.macro}_DT",
                        "  tau            the torque, written: finite and within the effort limits",
                        "",
                        *([model, ""] if model else []),
                        f"Returns {self.macro}_OK. Any other status leaves the state as it was, and",
                        "writes the torque of the last tick; the next good tick goes on from there.",
                    ]
                ),
            ),
        ]

    def _init_lines(self) -> list[str]:
        law = self.law
        n = self.arm.nv
        lines = []
        for name in law.live_gains:
            field = next(f for f in fields(law.gains) if f.name == name)
            value = getattr(law.gains, name)
            if isinstance(value, str):
                value = field.metadata["choices"].index(value)
            whole = field.metadata["kind"] == "per joint"
            value = np.broadcast_to(value, n) if whole else float(value)
            lines += assigned(f"state->gains.{member_name(name)}", value, self.dialect)
        lines += assigned("state->joints.effort_limit", self.arm.effort_limit, self.dialect)
        return [*lines, f"{self.prefix}_reset(state);"]

    def _reset_lines(self) -> list[str]:
        law, zero, n = self.law, self.dialect.number(0.0), self.arm.nv
        cleared = [(f"joints.{name}", n) for name in Joints._fields if name != "effort_limit"]
        for group in ("memory", "work"):
            cleared += [(f"{group}.{member_name(name)}", n) for name in law.structs[group].fields]
        lines = [f"for (int i = 0; i < {n}; i++) {{"]
        lines += [f"    state->{target}[i] = {zero};" for target, _ in cleared]
        lines.append("}")
        for name, memory in law.memories.items():
            lines.append(
                f"for (int i = 0; i < {memory.size}; i++) {{ state->{member_name(name)}[i] = {zero}; }}"
            )
        for group, rows in law.first_rows().items():
            for name, row in rows.items():
                lines += assigned(f"state->{group}.{member_name(name)}", row, self.dialect)
        for name, memory in law.memories.items():
            flat = memory.ravel()
            for k in np.flatnonzero(flat):
                lines.append(
                    f"state->{member_name(name)}[{k}] = {self.dialect.number(float(flat[k]))};"
                )
        return lines

    def _turned(self):  # type: ignore[no-untyped-def]
        four = [Scalar("real", name) for name in ("c0", "s0", "c1", "s1")]
        return self.program.function(turned, four, caller=None, node=None)

    def _is_round(self):  # type: ignore[no-untyped-def]
        three = [Scalar("real", name) for name in ("c", "s", "roundness")]
        return self.program.function(is_round, three, caller=None, node=None)

    def _update_lines(self) -> list[str]:
        law, real, n, nq = self.law, self.dialect.real, self.arm.nv, self.arm.nq
        number, macro = self.dialect.number, self.macro
        sizes = {"q": nq, "v": n, "q_d": nq, "v_d": n, "a_d": n}
        checks = [
            f"if (!are_finite({name}, {size})) {{ return {macro}_BAD_{name.upper()}; }}"
            for name, size in sizes.items()
        ]
        shape = law.structs["joints"].name
        inner = [
            f"{real} places[{2 * nq}];",
            f"if (!{self._call(law.read, {'table': 'seen', 'configurations': 'places'})}) {{",
            *(f"    {line}" for line in checks),
            "}",
        ]
        if any(joint.turns_on for joint in self.joints):
            inner += self._difference_lines()
        shortest, longest = SHORTEST_TICK * law.controller.dt, LONGEST_TICK * law.controller.dt
        inner += [
            f"if (!(dt >= {number(shortest)} && dt <= {number(longest)})) {{ return {macro}_BAD_DT; }}",
        ]
        if law.controller.uses_model:
            inner += [
                f"if (!are_finite(h, {n})) {{ return {macro}_BAD_MODEL; }}",
                f"for (int i = 0; i < {n * n}; i++) {{",
                f"    if (!({self.dialect.function('fabs')}(M[i]) <= {number(LARGEST_MODEL)})) {{ return {macro}_BAD_MODEL; }}",
                "}",
            ]
        inner.append(f"return {macro}_OK;")
        arguments = ", ".join(f"const {real} *{name}" for name in sizes)
        if law.controller.uses_model:
            arguments += f", const {real} *M, const {real} *h"
        given = ", ".join([*sizes, *(["M", "h"] if law.controller.uses_model else [])])
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
            f"static int understood({shape} *seen, {arguments}, {real} dt)",
            inner,
            "Read the arguments of a tick, each number kept within bounds; or say what is wrong.",
        )
        update = [
            f"{shape} seen = state->joints;",
            f"const int status = understood(&seen, {given}, dt);",
            f"if (status == {macro}_OK) {{",
            "    state->joints = seen;",
            f"    {self._call(law.tick, self._tick_arguments())};",
            "}",
            f"for (int i = 0; i < {n}; i++) {{ tau[i] = state->joints.tau[i]; }}",
        ]
        if not law.controller.uses_model:
            update += ["(void)M;", "(void)h;"]
        return lines + block(
            self._public()[2][0], [*update, "return status;"], "One tick: see the header."
        )

    def _tick_arguments(self) -> dict[str, str]:
        found = {"dt": "dt", "table": "state", "M0": "M", "h0": "h"}
        for name in self.law.tables:
            found[name] = f"{identifier(name)}_table"
            found[f"{name}_memory"] = f"state->{member_name(name)}"
        return {identifier(name): code for name, code in found.items()}

    def _call(self, function, names):  # type: ignore[no-untyped-def]
        given = [function.arguments[k][0] for k in function.kept]
        return f"{function.name}({', '.join(names.get(name, name) for name in given)})"

    def _difference_lines(self) -> list[str]:
        nq, macro = self.arm.nq, self.macro
        roundness = self.dialect.number(ROUNDNESS)
        lines = []
        for place, name in ((0, "Q"), (nq, "Q_D")):
            for joint in self.joints:
                if joint.turns_on:
                    c, s = place + joint.q, place + joint.q + 1
                    lines.append(
                        f"if (!is_round(places[{c}], places[{s}], {roundness})) {{ return {macro}_BAD_{name}; }}"
                    )
        for joint in self.joints:
            q, d = joint.q, nq + joint.q
            value = f"places[{q}] - places[{d}]"
            if joint.turns_on:
                value = f"turned(places[{d}], places[{d + 1}], places[{q}], places[{q + 1}])"
            lines.append(f"seen->e[{joint.v}] = {value};")
        return lines
