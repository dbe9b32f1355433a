"""What `ModelLearning` adds to a law in C: the estimator, and what it asks of a rigid-body library.

The arithmetic is that of the kernels in `learning`; here is when each is called. The regressor and
the terms of the learnt arm come from the caller, as `M` and `h` do without a learner.
"""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

from fotsmc_pin.control.arguments import LARGEST
from fotsmc_pin.control.functions import clip
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.export.dialect import comment
from fotsmc_pin.export.layout import assigned, block, notes_of, numbers, struct_lines
from fotsmc_pin.export.names import DUE, GIVE, LEARNED
from fotsmc_pin.export.values import Array, Root, Scalar, Struct, Table
from fotsmc_pin.learning.estimator import WINDOW, JointRows
from fotsmc_pin.learning.model_learning import MIDDLE
from fotsmc_pin.learning.parameters import Beliefs, shared_columns
from fotsmc_pin.learning.tick import Whole, learn
from fotsmc_pin.learning.trust import add_friction

if TYPE_CHECKING:
    from fotsmc_pin.export.names import Names
    from fotsmc_pin.export.program import Function, Program
    from fotsmc_pin.learning import ModelLearning

STRONGEST = 1e20
"""Bound of a regressor's entries: beyond, it is refused."""

BODIES = "unit_bodies_table"


class Learner:
    """Writes what learns.

    Attributes:
        owner: the wrapped controller, a copy, freshly reset.
        roots: translated functions that are called from outside of the translation.
    """

    def __init__(self, owner: ModelLearning, program: Program, names: Names) -> None:
        if program.dialect.single:
            remedy = "leave out single precision: its covariance needs more digits than a float has"
            raise ArgumentError("controller", owner.label, remedy)
        self.owner = copy.deepcopy(owner)
        self.owner.reset()
        self.program, self.dialect, self.names = program, program.dialect, names
        self._n, self._nq, self._p = owner.arm.nv, owner.arm.nq, owner._layout.size
        self._columns, self._type = owner._layout.columns, f"{names.prefix}_learner"
        self._structs = {
            "whole": Struct(f"{names.prefix}_whole", Whole, _sized(Whole, 1)),
            "rows": Struct(f"{names.prefix}_rows", JointRows, _sized(JointRows, self._n)),
            "beliefs": Struct(f"{names.prefix}_beliefs", Beliefs, _sized(Beliefs, self._p)),
        }
        self._sizes = {
            "sent": owner._sent.size,
            "P": owner._P.size,
            "Y": owner._Y.size,
            "regressor": 10 * self._n**2,
            "written": 10 * self._n,
            "middle": self._nq,
        }
        self._learn = self._translated_tick()
        self._ahead, self._clip = self._translated_friction(), self._translated_clip()
        self.roots = [self._learn.name, self._ahead, self._clip]

    @property
    def _feeds(self) -> bool:
        return self.owner._feeds

    def types(self) -> list[str]:
        """Return the structs; that of the learner has the others as members."""
        real, n = self.dialect.real, self._n
        notes = {
            "sent": f"torques that were sent, the oldest first ({self.owner.delay + 1}, {n})",
            "P": f"covariance of the parameters ({self._p}, {self._p})",
            "Y": f"low-passed rows (2, {n}, {self._columns})",
            "regressor": f"of the last window ({n}, {10 * n})",
            "written": f"dynamic parameters of the learnt links ({n}, 10)",
            "middle": "configuration that stands for a window [rad, m]",
        }
        lines = []
        for struct, note in zip(
            self._structs.values(),
            (
                "Numbers of the whole arm.",
                "What the estimator knows of each joint.",
                "\n".join(["What is believed of each parameter:", "", *self._parameters()]),
            ),
            strict=True,
        ):
            lines += [*comment(note), *struct_lines(struct, notes_of(struct.kind), self.dialect)]
        lines += [*comment("What learns the arm."), "typedef struct {"]
        lines += [f"    {struct.name} {member};" for member, struct in self._structs.items()]
        for name, size in self._sizes.items():
            lines.append(f"    {real} {name}[{size}]; /* {notes[name]} */")
        given = "int given; /* whether the regressor of the last window is there */"
        return [*lines, f"    {given}", f"}} {self._type};", ""]

    @property
    def loop(self) -> str:
        """What the loop is closed with, and what is fed forward: a key of `names.LEARNING`."""
        if not self.owner.controller.uses_model:
            return "none"
        if self.owner._in_loop:
            return "learnt"
        return "ahead" if self._feeds else "nominal"

    @property
    def member(self) -> str:
        """Return the declaration of the learner in the state of the law."""
        return f"{self._type} learner;"

    def tables(self) -> list[str]:
        """Return the constants: of the links, and what is believed beforehand."""
        lines = comment("Dynamic parameters per unit of each shared parameter, ten in a row.")
        lines += numbers(BODIES, self.owner._bodies, self.dialect)
        for name in ("mean", "deviation", "lowest", "highest"):
            note = notes_of(Beliefs)[name]
            lines += comment(f"Of each parameter: {note}")
            lines += numbers(f"first_{name}", getattr(self.owner._b, name), self.dialect)
        return lines

    def reset_lines(self) -> list[str]:
        """Return what forgets all that was learnt."""
        zero, p, place = self.dialect.number(0.0), self._p, "state->learner"
        lines = [
            f"for (int i = 0; i < {size}; i++) {{ {place}.{name}[i] = {zero}; }}"
            for name, size in self._sizes.items()
            if name != "written"
        ]
        written = f"{place}.written[i] = {BODIES}[i];"
        lines.append(f"for (int i = 0; i < {self._sizes['written']}; i++) {{ {written} }}")
        rows = {"whole": self.owner._a, "rows": self.owner._x}
        for member, values in rows.items():
            for name, value in values._asdict().items():
                lines += assigned(f"{place}.{member}.{name}", value, self.dialect)
        beliefs = {name: f"first_{name}[i]" for name in ("mean", "deviation", "lowest", "highest")}
        beliefs |= {"estimate": "first_mean[i]", "used": "first_mean[i]"}
        beliefs |= {"sigma": "first_deviation[i]", "work": zero}
        lines += [
            f"for (int i = 0; i < {p}; i++) {{",
            *(f"    {place}.beliefs.{name}[i] = {value};" for name, value in beliefs.items()),
            f"    {place}.P[i * {p + 1}] = first_deviation[i] * first_deviation[i];",
            "}",
            f"{place}.given = 0;",
        ]
        return lines

    def functions(self) -> list[str]:
        """Return what stands before a tick of the law."""
        state, bad = f"{self.names.state} *state", self.names.status("BAD_MODEL")
        asked, n = "state->learner.whole.ticks[0]", self._n
        asks = [
            f"const long long ticks = (long long){asked};",
            f"return ticks > 0 && ticks % {WINDOW} == 0 && !state->learner.given;",
        ]
        ready = [f"return is_asked(state) ? {bad} : {self.names.status('OK')};"]
        place = "state->learner"
        where = [
            "if (!is_asked(state)) { return 0; }",
            f"for (int i = 0; i < {self._nq}; i++) {{ q[i] = {place}.middle[i]; }}",
            f"for (int i = 0; i < {n}; i++) {{",
            f"    v[i] = {place}.rows.mean_speed[i];",
            f"    a[i] = {place}.rows.acceleration[i];",
            "}",
            "return 1;",
        ]
        size, number = self._sizes["regressor"], self.dialect.number(STRONGEST)
        give = [
            f"for (int i = 0; i < {size}; i++) {{",
            f"    if (!({self.dialect.function('fabs')}(regressor[i]) <= {number})) "
            f"{{ return {bad}; }}",
            "}",
            f"for (int i = 0; i < {size}; i++) {{ {place}.regressor[i] = regressor[i]; }}",
            f"{place}.given = 1;",
            f"return {self.names.status('OK')};",
        ]
        rotors = shared_columns(n)
        tell = [
            f"for (int i = 0; i < {10 * n}; i++) {{ links[i] = {place}.written[i]; }}",
            f"for (int i = 0; i < {n}; i++) {{",
            f"    armature[i] = {place}.beliefs.used[{rotors} + i];",
            "}",
        ]
        heads = self._heads()
        return [
            *block(f"static bool is_asked(const {state})", asks, "Whether a regressor is due."),
            *block(f"static int ready(const {state})", ready, "Whether a tick has what it needs."),
            *block(heads["regressor_due"], where, "See the header."),
            *block(heads["give_regressor"], give, "See the header."),
            *block(heads["learned_model"], tell, "See the header."),
        ]

    def before_tick(self) -> list[str]:
        """Return what adds to `h` the friction that is fed forward, as `ahead`."""
        n, real = self._n, self.dialect.real
        if not self._feeds or not self.owner.controller.uses_model:
            return []
        return [
            f"{real} ahead[{n}];",
            f"for (int i = 0; i < {n}; i++) {{ ahead[i] = h[i]; }}",
            f"{self._friction('ahead')};",
        ]

    @property
    def h(self) -> str:
        """The torque that a tick of the law is given for `h`."""
        return "ahead" if self.before_tick() else "h"

    def after_tick(self) -> list[str]:
        """Return what learns from a tick."""
        n, real, learner = self._n, self.dialect.real, "state->learner"
        lines = [
            f"{real} torque[{n}];",
            f"for (int i = 0; i < {n}; i++) {{ torque[i] = state->joints.tau[i]; }}",
        ]
        if self._feeds and not self.owner.controller.uses_model:
            limit = "state->joints.effort_limit[i]"
            lines += [
                f"{real} ahead[{n}] = {{{self.dialect.number(0.0)}}};",
                f"{self._friction('ahead')};",
                f"for (int i = 0; i < {n}; i++) {{",
                f"    torque[i] = {self._clip}(torque[i] + ahead[i], {limit});",
                "}",
            ]
        largest = self.dialect.number(LARGEST)
        middle = f"{learner}.middle[i] = {self._clip}(q[i], {largest});"
        return [
            *lines,
            f"if ((long long){learner}.whole.ticks[0] % {WINDOW} == {MIDDLE}) {{",
            f"    for (int i = 0; i < {self._nq}; i++) {{ {middle} }}",
            "}",
            f"{self._call_of_learn()};",
            f"{learner}.given = 0;",
        ]

    @property
    def last_torque(self) -> str:
        """The torque that was sent last, entry `i`."""
        return f"state->learner.sent[{self.owner.delay * self._n} + i]"

    def public(self, outer: str, place: str) -> list[tuple[str, str, list[str]]]:
        """Return the public functions: declaration, what a caller has to know, and text.

        Args:
            outer: type of the state that a caller has.
            place: pointer to the law's state in it.
        """
        calls = {
            "regressor_due": ("return regressor_due(@, q, v, a);", DUE),
            "give_regressor": ("return give_regressor(@, regressor);", GIVE),
            "learned_model": ("learned_model(@, links, armature);", LEARNED),
        }
        found = []
        for name, head in self._heads().items():
            text, note = calls[name]
            head = head.replace("static ", "").replace(name, f"{self.names.prefix}_{name}")
            head = head.replace(f"{self.names.state} *", f"{outer} *")
            note = note.replace("@", self.names.prefix.upper())
            found.append((head, note, [text.replace("@", place)]))
        return found

    def _heads(self) -> dict[str, str]:
        real, n, state = self.dialect.real, self._n, f"{self.names.state} *state"
        where = f"{real} q[{self._nq}], {real} v[{n}], {real} a[{n}]"
        links = f"{real} links[{10 * n}], {real} armature[{n}]"
        return {
            "regressor_due": f"static int regressor_due(const {state}, {where})",
            "give_regressor": f"static int give_regressor({state}, const {real} "
            f"regressor[{10 * n * n}])",
            "learned_model": f"static void learned_model(const {state}, {links})",
        }

    def _parameters(self) -> list[str]:
        return [
            f"{k:3d} {row.group} {row.of}{f' [{row.unit}]' if row.unit else ''}"
            for k, row in enumerate(self.owner.estimates())
        ]

    def _friction(self, target: str) -> str:
        learner = "state->learner"
        fall = self.dialect.number(self.owner.prior.stribeck_velocity)
        given = [f"{learner}.rows.direction", f"{learner}.beliefs.used", fall, target]
        given = ["state->joints.v_d", *given]
        return f"{self._ahead}({', '.join(given[k] for k in self._friction_kept)})"

    def _call_of_learn(self) -> str:
        learner = "state->learner"
        given = ["dt", "torque", "state->joints.v", "state->joints.v_d"]
        given += [f"&{learner}.whole", f"{learner}.sent"]
        given += [f"&{learner}.rows", f"&{learner}.beliefs"]
        given += [f"{learner}.{name}" for name in ("P", "Y", "regressor")]
        given += [BODIES, f"{learner}.written"]
        return f"{self._learn.name}({', '.join(given[k] for k in self._learn.kept)})"

    def _translated_tick(self) -> Function:
        owner, n = self.owner, self._n

        def table(name: str, width: int) -> Table:
            struct = self._structs[name]
            return Table(name, struct.name, (("", struct),), width, Root())

        def array(name: str, shape: tuple[int, ...], data: Any = None) -> Array:
            return Array(name, shape, Root(), data=data)

        values = [
            Scalar("real", "dt"),
            *(array(name, (n,)) for name in ("tau", "v", "v_d")),
            table("whole", 1),
            array("sent", owner._sent.shape),
            table("rows", n),
            table("beliefs", self._p),
            array("P", owner._P.shape),
            array("Y", owner._Y.shape),
            array("regressor", (n, 10 * n)),
            array(BODIES, owner._bodies.shape, owner._bodies),
            array("written", owner._written.shape),
        ]
        return self.program.function(learn, values, caller=None, node=None)

    def _translated_friction(self) -> str:
        n, root = self._n, Root()
        sizes = [n, n, self._p]
        values: list[Any] = [Array(f"x{k}", (size,), Root()) for k, size in enumerate(sizes)]
        values += [Scalar("real", "x"), Array("h", (n,), root)]
        found = self.program.function(add_friction, values, caller=None, node=None)
        self._friction_kept = found.kept
        return found.name

    def _translated_clip(self) -> str:
        reals = [Scalar("real", "x"), Scalar("real", "limit")]
        return self.program.function(clip, reals, caller=None, node=None).name


def _sized(names: Any, size: int) -> dict[str, tuple[int, ...]]:
    return dict.fromkeys(names._fields, (size,))
