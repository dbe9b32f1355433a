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
from fotsmc_pin.export.addition import Addition
from fotsmc_pin.export.layout import block
from fotsmc_pin.export.learner_state import BODIES, LearnerState
from fotsmc_pin.export.names import DUE, GIVE, LEARNED, LEARNING
from fotsmc_pin.export.values import Array, Root, Scalar, Table
from fotsmc_pin.learning.estimator import WINDOW
from fotsmc_pin.learning.model_learning import MIDDLE
from fotsmc_pin.learning.parameters import shared_columns
from fotsmc_pin.learning.tick import learn
from fotsmc_pin.learning.trust import add_friction

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.export.names import Names
    from fotsmc_pin.export.program import Function, Program
    from fotsmc_pin.learning import ModelLearning

STRONGEST = 1e20
"""Bound of a regressor's entries: beyond, it is refused."""
PLACE = "state->learner"


class Learner(Addition):
    """Writes what learns.

    Attributes:
        layout: what it remembers.
    """

    def __init__(self, owner: ModelLearning, program: Program, names: Names) -> None:
        """Translate a learner.

        Raises:
            ArgumentError: it is to be in single precision.
            TranslationError: a kernel contains what is not translated.
        """
        if program.dialect.single:
            remedy = "export what learns in double precision: a float counts its ticks to 2^24 only"
            raise ArgumentError("controller", owner.label, remedy)
        super().__init__()
        self._owner = copy.deepcopy(owner)
        self._owner.reset()
        self._program, self._dialect, self._names = program, program.dialect, names
        self._n, self._nq = owner.arm.nv, owner.arm.nq
        self.layout = LearnerState(self._owner, program.dialect, names.prefix)
        self._learn, self._ahead = self._translated_tick(), self._translated_friction()
        reals = [Scalar("real", "x"), Scalar("real", "limit")]
        self._clip = program.function(clip, reals, caller=None, node=None).name
        self.roots = [self._learn.name, self._clip]
        if owner._feeds:
            self.roots.append(self._ahead.name)

        adds = owner._feeds and owner.controller.uses_model
        self.h = "ahead" if adds else "h"
        self.note = ("", *LEARNING[self._loop])

    def types(self) -> list[str]:
        """Return its structs."""
        return self.layout.types()

    def tables(self) -> list[str]:
        """Return its constants."""
        return self.layout.tables()

    def reset_lines(self) -> list[str]:
        """Return what forgets all that was learnt."""
        return self.layout.reset_lines()

    def members(self) -> list[str]:
        """Return what it keeps in the state of the law."""
        return [f"    {self.layout.type_name} learner;"]

    def judged(self, status: str) -> str:
        """Return the status of a tick whose arguments have this one."""
        return f"ready(state, {status})"

    @property
    def _loop(self) -> str:
        """What the loop is closed with, and what is fed forward: a key of `names.LEARNING`."""
        if not self._owner.controller.uses_model:
            return "none"
        if self._owner._in_loop:
            return "learnt"
        return "ahead" if self._owner._feeds else "nominal"

    @property
    def last_torque(self) -> str:
        """The torque that was sent last, entry `i`."""
        return f"{PLACE}.sent[{self._owner.delay * self._n} + i]"

    def functions(self) -> list[str]:
        """Return what stands before a tick of the law."""
        state, names, n = f"const {self._names.state} *state", self._names, self._n
        ok, bad, size = names.status("OK"), names.status("BAD_MODEL"), self.layout.sizes
        due = [
            f"const long long ticks = (long long){PLACE}.whole.ticks[0];",
            f"return ticks > 0 && ticks % {WINDOW} == 0 && !{PLACE}.given;",
        ]
        where = [
            "if (!is_due(state)) { return 0; }",
            f"for (int i = 0; i < {self._nq}; i++) {{ q[i] = {PLACE}.middle[i]; }}",
            f"for (int i = 0; i < {n}; i++) {{",
            f"    v[i] = {PLACE}.rows.mean_speed[i];",
            f"    a[i] = {PLACE}.rows.acceleration[i];",
            "}",
            "return 1;",
        ]
        within = f"{self._dialect.function('fabs')}(regressor[i]) <= "
        give = [
            f"for (int i = 0; i < {size['regressor']}; i++) {{",
            f"    if (!({within}{self._dialect.number(STRONGEST)})) {{ return {bad}; }}",
            "}",
            f"for (int i = 0; i < {size['regressor']}; i++) {{",
            f"    {PLACE}.regressor[i] = regressor[i];",
            "}",
            f"{PLACE}.given = 1;",
            f"return {ok};",
        ]
        tell = [
            f"for (int i = 0; i < {10 * n}; i++) {{ links[i] = {PLACE}.written[i]; }}",
            f"const {self._dialect.real} *rotors = {PLACE}.beliefs.used + {shared_columns(n)};",
            f"for (int i = 0; i < {n}; i++) {{ armature[i] = rotors[i]; }}",
        ]
        ready = f"return status == {ok} && is_due(state) ? {bad} : status;"
        texts = zip(self._heads().values(), (where, give, tell), strict=True)
        return [
            *block(f"static bool is_due({state})", due, "Whether the regressor is due."),
            *block(
                f"static int ready({state}, int status)",
                [ready],
                "Refuse a good tick that lacks what is due.",
            ),
            *(line for head, text in texts for line in block(head, text, "See the header.")),
        ]

    def around(self, tick: Sequence[str]) -> list[str]:
        """Return what stands around the call of the law's tick: friction, and learning from it."""
        n, real, zero = self._n, self._dialect.real, self._dialect.number(0.0)
        before, after = [], []
        friction = [f"{real} ahead[{n}];", f"for (int i = 0; i < {n}; i++) {{ ahead[i] = @; }}"]
        friction.append(f"{self._call(self._ahead, self._friction_arguments())};")
        if self.h == "ahead":
            before = [line.replace("@", "h[i]") for line in friction]
        elif self._owner._feeds:
            limited = f"{self._clip}(torque[i] + ahead[i], state->joints.effort_limit[i])"
            after = [line.replace("@", zero) for line in friction]
            after.append(f"for (int i = 0; i < {n}; i++) {{ torque[i] = {limited}; }}")
            after.append(f"for (int i = 0; i < {n}; i++) {{ {PLACE}.ahead[i] = ahead[i]; }}")
        largest = self._dialect.number(LARGEST)
        middle = f"{PLACE}.middle[i] = {self._clip}(q[i], {largest});"
        return [
            *before,
            *tick,
            f"{real} torque[{n}];",
            f"for (int i = 0; i < {n}; i++) {{ torque[i] = state->joints.tau[i]; }}",
            *after,
            f"if ((long long){PLACE}.whole.ticks[0] % {WINDOW} == {MIDDLE}) {{",
            f"    for (int i = 0; i < {self._nq}; i++) {{ {middle} }}",
            "}",
            f"{self._call(self._learn, self._tick_arguments())};",
            f"{PLACE}.given = 0;",
        ]

    def noted(self, law: str) -> list[str]:
        """Return what takes note of another torque: it is learnt from, and observed."""
        learner = PLACE.replace("state->", f"{law}.")
        ahead = f" - {learner}.ahead[i]" if "ahead" in self.layout.sizes else ""
        return [
            f"{law}.joints.tau[i] = tau[i] - friction[i]{ahead};",
            f"{learner}.sent[{self._owner.delay * self._n} + i] = tau[i];",
        ]

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
            head = head.replace("static ", "").replace(f"{self._names.state} *", f"{outer} *")
            head = head.replace(f" {name}(", f" {self._names.prefix}_{name}(")
            note = note.replace("@", self._names.prefix.upper())
            found.append((head, note, [text.replace("@", place)]))
        return found

    def _heads(self) -> dict[str, str]:
        real, n, state = self._dialect.real, self._n, f"{self._names.state} *state"
        where = f"{real} q[{self._nq}], {real} v[{n}], {real} a[{n}]"
        regressor = f"const {real} regressor[{10 * n * n}]"
        links = f"{real} links[{10 * n}], {real} armature[{n}]"
        return {
            "regressor_due": f"static int regressor_due(const {state}, {where})",
            "give_regressor": f"static int give_regressor({state}, {regressor})",
            "learned_model": f"static void learned_model(const {state}, {links})",
        }

    def _call(self, function: Function, given: Sequence[str]) -> str:
        return f"{function.name}({', '.join(given[k] for k in function.kept)})"

    def _friction_arguments(self) -> list[str]:
        fall = self._dialect.number(self._owner.prior.stribeck_velocity)
        learnt = [f"{PLACE}.rows.direction", f"{PLACE}.beliefs.used"]
        return ["state->joints.v_d", *learnt, fall, "ahead"]

    def _translated_friction(self) -> Function:
        n, p = self._n, self._owner._layout.size
        values: list[Any] = [Array(f"x{size}", (size,), Root()) for size in (n, n, p)]
        values += [Scalar("real", "fall"), Array("h", (n,), Root())]
        return self._program.function(add_friction, values, caller=None, node=None)

    def _tick_arguments(self) -> list[str]:
        rows = [f"&{PLACE}.{name}" for name in ("whole", "rows", "beliefs")]
        given = ["dt", "torque", "state->joints.v", "state->joints.v_d", rows[0]]
        given += [f"{PLACE}.sent", *rows[1:]]
        given += [f"{PLACE}.{name}" for name in ("P", "Y", "regressor")]
        return [*given, BODIES, f"{PLACE}.written"]

    def _translated_tick(self) -> Function:
        owner, n = self._owner, self._n

        def table(name: str, width: int) -> Table:
            struct = self.layout.structs[name]
            return Table(name, struct.name, (("", struct),), width, Root())

        def array(name: str, shape: tuple[int, ...], data: Any = None) -> Array:
            return Array(name, shape, Root(), data=data)

        values: list[Any] = [
            Scalar("real", "dt"),
            *(array(name, (n,)) for name in ("tau", "v", "v_d")),
            table("whole", 1),
            array("sent", owner._sent.shape),
            table("rows", n),
            table("beliefs", owner._layout.size),
            array("P", owner._P.shape),
            array("Y", owner._Y.shape),
            array("regressor", (n, 10 * n)),
            array(BODIES, owner._bodies.shape, owner._bodies),
            array("written", owner._written.shape),
        ]
        return self._program.function(learn, values, caller=None, node=None)
