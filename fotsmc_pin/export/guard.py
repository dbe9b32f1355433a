"""A law in a `Safeguard` in C: soft start, limits, watchdog and safe stop around the bare law.

The arithmetic is that of the kernels in `control.safety.steps`; here is when each is called.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.control.controller import ROUNDNESS
from fotsmc_pin.control.friction_compensation import add_friction
from fotsmc_pin.control.safety.steps import faded, stopping, too_fast, within_limits, within_rate
from fotsmc_pin.export.bare import BareLaw
from fotsmc_pin.export.dialect import comment
from fotsmc_pin.export.layout import STATUSES, assigned, block
from fotsmc_pin.export.names import GRAVITY, GUARDED_INIT, GUARDED_RESET, RESULT, STOP, STOPS
from fotsmc_pin.export.values import Array, Root, Scalar

if TYPE_CHECKING:
    from fotsmc_pin.control import Safeguard
    from fotsmc_pin.export.program import Program


class GuardedLaw:
    """Writes a law in a safeguard.

    Attributes:
        bare: the law.
        names: how its parts are called; what is public is the safeguard's.
    """

    def __init__(self, guard: Safeguard, program: Program) -> None:
        self.bare = BareLaw(guard.controller, program, wrapped=True)  # type: ignore[arg-type]
        self.names, self.guard, self.program = self.bare.names, guard, program
        self.dialect, self.arm = program.dialect, guard.arm
        self._n = guard.arm.nv
        self._roots: list[str] = []
        self._update_text = self._update_lines()

    @property
    def meanings(self) -> list[tuple[str, str]]:
        """The status codes of a tick, with what each means."""
        return [*STATUSES, *STOPS]

    @property
    def roots(self) -> list[str]:
        """Translated functions that are called from outside of the translation."""
        return [*self.bare.roots, *self._roots]

    def tables(self) -> list[str]:
        """Return the coefficients of the fractional operators."""
        return self.bare.tables()

    def types(self) -> list[str]:
        """Return the structs."""
        real, vector = self.dialect.real, f"[{self._n}];"
        members = [
            f"{self.names.prefix}_law law;",
            "/* What may be changed between two ticks: */",
            f"{real} soft_start; /* time over which the start error is faded out [s] */",
            f"{real} watchdog; /* longest time between two ticks [s] */",
            f"{real} stop_ramp; /* time in which a safe stop takes over [s] */",
            f"{real} fastest{vector} /* speed at which a safe stop begins [rad/s, m/s] */",
            f"{real} torque_rate{vector} /* largest rate of the torque [N*m/s, N/s] */",
        ]
        if self._has_friction:
            members += [
                f"{real} friction{vector} /* Coulomb friction [N*m, N] */",
                f"{real} damping{vector} /* viscous friction [N*m*s/rad, N*s/m] */",
                f"{real} friction_width; /* speed over which it turns its sign [rad/s, m/s] */",
            ]
        members += [
            "/* What lives on from tick to tick: */",
            f"{real} t; /* since the start [s] */",
            f"{real} offset{vector} /* from the reference at the start [rad, m] */",
            f"{real} offset_dot{vector} /* its rate [rad/s, m/s] */",
            f"{real} tau{vector} /* last torque [N*m, N] */",
            f"{real} before_stop{vector} /* torque before the stop [N*m, N] */",
            f"{real} ramp; /* how much of the way to the float is done */",
            f"{real} weight{vector} /* gravity where the arm was last seen [N*m, N] */",
            f"{real} inertia{vector} /* diagonal of the mass matrix there [kg*m^2, kg] */",
            "int started; /* whether there was a tick */",
            "int placed; /* whether the arm was seen */",
            "int stopped; /* status: why a safe stop is on */",
        ]
        lines = [
            *comment("A guarded controller. A copy remembers everything too."),
            "typedef struct {",
        ]
        return [
            *self.bare.types(),
            *lines,
            *(f"    {member}" for member in members),
            f"}} {self.names.prefix}_state;",
            "",
        ]

    def public(self) -> list[tuple[str, str]]:
        """Return the public functions, with what a caller has to know."""
        prefix, real = self.names.prefix, self.dialect.real
        state = f"{prefix}_state *state"
        arguments = self.bare.arguments(state, f"const {real} g[{self._n}]")
        return [
            (f"void {prefix}_init({state})", GUARDED_INIT),
            (f"void {prefix}_reset({state})", GUARDED_RESET),
            (f"void {prefix}_stop({state})", STOP),
            (f"int {prefix}_update({arguments})", self.bare.update_note(GRAVITY, ends=RESULT)),
        ]

    def functions(self) -> list[str]:
        """Return the functions."""
        prefix = self.names.prefix
        init, reset, stop, update = (head for head, _ in self.public())
        ok = self.names.status("OK")
        begin = [
            f"if (state->stopped != {ok}) {{ return; }}",
            "state->stopped = status;",
            f"state->ramp = {self.dialect.number(0.0)};",
            f"for (int i = 0; i < {self._n}; i++) {{ state->before_stop[i] = state->tau[i]; }}",
        ]
        return [
            *self.bare.functions(),
            *block(
                f"static void begin_stop({prefix}_state *state, int status)",
                begin,
                "Begin a safe stop, unless one is on.",
            ),
            *self._update_text,
            *block(reset, self._reset_lines(), "Begin anew."),
            *block(init, self._init_lines(), "Fill in gains and limits."),
            *block(stop, [f"begin_stop(state, {self.names.status('STOPPED')});"], "Stop."),
            *block(update, self._tick_lines(), "One tick: see the header."),
        ]

    @property
    def _has_friction(self) -> bool:
        return self.guard._friction is not None

    def _init_lines(self) -> list[str]:
        guard, dialect = self.guard, self.dialect
        rate = np.full(self._n, np.inf) if guard._rate is None else guard._rate
        values: dict[str, Any] = {
            "soft_start": guard._lead.duration,
            "watchdog": guard.watchdog,
            "stop_ramp": guard.stop_ramp,
            "fastest": guard._fastest,
            "torque_rate": rate,
        }
        if guard._friction is not None:
            ahead = guard._friction
            values |= {"friction": ahead.friction, "damping": ahead.damping}
            values["friction_width"] = ahead.width
        lines = ["law_init(&state->law);"]
        for name, value in values.items():
            lines += assigned(f"state->{name}", value, dialect)
        return [*lines, f"{self.names.prefix}_reset(state);"]

    def _reset_lines(self) -> list[str]:
        zero = self.dialect.number(0.0)
        vectors = ("offset", "offset_dot", "tau", "before_stop", "weight", "inertia")
        cleared = " ".join(f"state->{name}[i] = {zero};" for name in vectors)
        return [
            "law_reset(&state->law);",
            f"state->t = {zero};",
            f"state->ramp = {zero};",
            "state->started = 0;",
            "state->placed = 0;",
            f"state->stopped = {self.names.status('OK')};",
            f"for (int i = 0; i < {self._n}; i++) {{ {cleared} }}",
        ]

    def _function(self, kernel: Any, *arguments: str | int) -> str:
        """Return the name of a translated kernel; "real" stands for a number."""
        values = [
            Scalar("real", "x") if a == "real" else Array(f"x{k}", (self._n,), Root())
            for k, a in enumerate(arguments)
        ]
        found = self.program.function(kernel, values, caller=None, node=None)
        assert len(found.kept) == len(arguments)
        self._roots.append(found.name)
        return found.name

    def _update_lines(self) -> list[str]:
        n, real, status, bare = self._n, self.dialect.real, self.names.status, self.bare
        lead = self._function(faded, "real", "real", *["vector"] * 5)
        fast = self._function(too_fast, "vector", "vector")
        self._stopping = self._function(stopping, "real", *["vector"] * 6)
        self._rate = self._function(within_rate, "vector", "vector", "vector", "real")
        self._limit = self._function(within_limits, "vector", "vector")

        def stop_unless(condition: str, reason: str) -> str:
            stop = f"begin_stop(state, {status(reason)}); return;"
            return f"if (!{condition}) {{ {stop} }}"

        lines = [
            stop_unless(f"are_finite(v, {n})", "BAD_V"),
            stop_unless(f"!{fast}(v, state->fastest)", "TOO_FAST").replace("!!", ""),
            stop_unless(f"are_finite(q, {self.arm.nq})", "BAD_Q"),
            stop_unless(f"are_finite(q_d, {self.arm.nq})", "BAD_Q_D"),
            stop_unless(f"are_finite(g, {n})", "BAD_MODEL"),
        ]
        for name in ("q", "q_d"):
            pairs = bare.turning.round_checks(bare.joints, name, ROUNDNESS)
            lines += [stop_unless(pair, f"BAD_{name.upper()}") for pair in pairs]
        offset = bare.turning.difference(bare.joints, "q_d", "q", "state->offset")
        moved = bare.turning.sum(bare.joints, "q_d", "way", "led_q")
        lines += [
            "if (!state->started) {",
            *(f"    {line}" for line in offset),
            f"    for (int i = 0; i < {n}; i++) {{ state->offset_dot[i] = v[i] - v_d[i]; }}",
            "    state->started = 1;",
            "} else {",
            "    state->t += dt;",
            "}",
            f"{real} led_q[{self.arm.nq}], led_v[{n}], led_a[{n}];",
            f"for (int i = 0; i < {self.arm.nq}; i++) {{ led_q[i] = q_d[i]; }}",
            f"for (int i = 0; i < {n}; i++) {{ led_v[i] = v_d[i]; led_a[i] = a_d[i]; }}",
            "if (state->t < state->soft_start) {",
            f"    {real} way[{n}];",
            f"    {lead}(state->t, state->soft_start, state->offset, state->offset_dot, "
            "led_v, led_a, way);",
            *(f"    {line}" for line in moved),
            "}",
            "const int status =",
            "    law_update(&state->law, q, v, led_q, led_v, led_a, M, h, dt, sent);",
            f"if (status != {status('OK')}) {{ begin_stop(state, status); return; }}",
        ]
        if self._has_friction:
            ahead = self._function(add_friction, "vector", "vector", "vector", "real", "vector")
            friction = "state->friction, state->damping, state->friction_width"
            lines.append(f"{ahead}(led_v, {friction}, sent);")
        lines.append("see(state, M, g);")
        pointers = ", ".join(
            f"const {real} *{name}" for name in ("q", "v", "q_d", "v_d", "a_d", "M", "h", "g")
        )
        state = f"{self.names.prefix}_state *state"
        return [
            *block(
                f"static void see({state}, const {real} *M, const {real} *g)",
                [
                    f"for (int i = 0; i < {n}; i++) {{",
                    "    state->weight[i] = g[i];",
                    f"    state->inertia[i] = M[i * {n + 1}];",
                    "}",
                    "state->placed = 1;",
                ],
                "Remember what a safe stop needs to know of the place.",
            ),
            *block(
                f"static void follow({state}, {pointers}, {real} dt, {real} *sent)",
                lines,
                "One tick of the law behind the soft start; or the beginning of a stop.",
            ),
        ]

    def _tick_lines(self) -> list[str]:
        n, real, number, status = self._n, self.dialect.real, self.dialect.number, self.names.status
        one, zero, bare = number(1.0), number(0.0), self.bare
        seen = [
            f"are_finite(q, {self.arm.nq})",
            f"are_finite(v, {n})",
            f"are_finite(g, {n})",
            f"are_finite(M, {n * n})",
            *bare.turning.round_checks(bare.joints, "q", ROUNDNESS),
        ]
        more = f"(state->stop_ramp > {zero} ? period / state->stop_ramp : {one})"
        ok = status("OK")
        return [
            f"{real} period = dt;",
            f"if (!(dt > {zero} && dt <= state->watchdog)) {{",
            f"    begin_stop(state, {status('TOO_LATE')});",
            f"    period = {self.names.prefix.upper()}_DT;",
            "}",
            f"{real} sent[{n}];",
            f"for (int i = 0; i < {n}; i++) {{ sent[i] = state->tau[i]; }}",
            f"if (state->stopped == {ok}) {{",
            "    follow(state, q, v, q_d, v_d, a_d, M, h, g, dt, sent);",
            "}",
            f"if (state->stopped != {ok}) {{",
            f"    const bool seen = {' && '.join(seen)};",
            f"    {real} speed[{n}];",
            f"    for (int i = 0; i < {n}; i++) {{ speed[i] = seen ? v[i] : {zero}; }}",
            "    if (seen) { see(state, M, g); }",
            "    if (state->placed) {",
            f"        const {real} ramp = state->ramp + {more};",
            f"        state->ramp = ramp < {one} ? ramp : {one};",
            f"        {self._stopping}(state->ramp, state->before_stop, state->weight, "
            "state->inertia, speed, state->fastest, sent);",
            "    } else {",
            f"        for (int i = 0; i < {n}; i++) {{ sent[i] = {zero}; }}",
            "    }",
            "}",
            f"{self._rate}(sent, state->tau, state->torque_rate, period);",
            f"{self._limit}(sent, state->law.joints.effort_limit);",
            f"for (int i = 0; i < {n}; i++) {{ state->tau[i] = sent[i]; tau[i] = sent[i]; }}",
            "return state->stopped;",
        ]
