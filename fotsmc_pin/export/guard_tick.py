"""A tick of a guarded law in C: from a measurement to what is commanded.

It is what `control.safety.Safeguard` does; its arithmetic is that of the same kernels.
"""

from __future__ import annotations

from fotsmc_pin.control.arguments import ROUNDNESS
from fotsmc_pin.control.friction_compensation import add_friction
from fotsmc_pin.control.safety.brake import braked
from fotsmc_pin.control.safety.steps import (
    averaged,
    faded,
    finite_or_last,
    slowed,
    too_fast,
    within_limits,
)
from fotsmc_pin.export.guard_lines import EFFORT
from fotsmc_pin.export.guard_stop import GuardStop
from fotsmc_pin.export.layout import block


class GuardTick(GuardStop):
    """Writes the functions of a guarded law that run at a tick."""

    @property
    def adds_friction(self) -> bool:
        """Whether friction is compensated here."""
        return self._guard._friction is not None and not self._guard._output.drives.hides_friction

    def functions(self) -> list[str]:
        """Return the functions, each before its caller."""
        return [*self.stop_functions(), *self._lead(), *self._unusable(), *self._send()]

    def tick(self) -> list[str]:
        """Return the lines of the public tick."""
        n, real, number, ok = self._n, self._real, self._number, self._status("OK")
        fast, slow = self._kernel(too_fast, 1, 1), self._kernel(slowed, 1, 1)
        brake = self._kernel(braked, *[1] * 4, 2, 1, -4, 1, 0, 0, 0, *[1] * 5)
        where = "q, speed, M, believed ? h : g, g"
        rate = number(self._guard._stop.brake.rate)
        friction = [f"{real} friction[{n}];", self._each("friction[i] = {0};", number(0.0))]
        return [
            f"{real} period = dt;",
            f"if (!(dt > {number(0.0)} && dt <= state->watchdog)) {{",
            f"    guard_begin_stop(state, {self._status('TOO_LATE')}, 1);",
            f"    period = {self._bare.names.prefix.upper()}_DT;",
            "}",
            "int status = guard_unusable(q, v, M, h, g);",
            f"const bool seen = status == {ok};",
            "if (!seen) { guard_begin_stop(state, status, 0); }",
            "bool believed = seen;",
            f"{real} speed[{n}];",
            self._each("speed[i] = v[i];"),
            f"if (seen && {fast}(v, state->fastest)) {{",
            f"    const bool wild = state->stopped == {ok} && state->placed;",
            "    believed = false;",
            f"    guard_begin_stop(state, {self._status('TOO_FAST')}, 0);",
            f"    {slow}(speed, state->fastest);",
            f"    if (wild) {{ {self._each('speed[i] = state->seen_v[i];')} }}",
            "}",
            f"if (seen && !state->placed) {{ guard_see(state, {where}); }}",
            f"{real} led_q[{self._nq}], led_v[{n}], led_a[{n}];",
            f"if (state->stopped == {ok}) {{",
            "    status = guard_lead(state, q, speed, q_d, v_d, a_d, period, led_q, led_v, led_a);",
            f"    if (status != {ok}) {{ guard_begin_stop(state, status, 0); }}",
            "}",
            f"const bool follows = state->stopped == {ok};",
            f"if (!follows) {{ guard_brake_on(state, seen, {where}, period); }}",
            f"{real} wanted[{n}];",
            self._each("wanted[i] = state->tau[i];"),
            "bool by_law = false;",
            "if (seen && (follows || state->by_law)) {",
            "    status = law_update(&state->law, q, speed, follows ? led_q : state->target_q,",
            "        follows ? led_v : state->target_v, follows ? led_a : state->target_a,",
            "        M, h, period, wanted);",
            f"    by_law = status == {ok};",
            "    if (!by_law) {",
            "        guard_begin_stop(state, status, 0);",
            f"        if (follows) {{ guard_brake_on(state, seen, {where}, period); }}",
            "    }",
            "}",
            "if (!state->placed) {",
            f"    {self._each('tau[i] = {0};', number(0.0))}",
            "    return state->stopped;",
            "}",
            f"if (seen) {{ guard_see(state, {where}); }}",
            *friction,
            "if (by_law && follows) { guard_want(state, led_q, led_v, led_a); }",
            "if (by_law) {",
            *self._friction_lines(),
            "} else {",
            f"    const {real} *at = seen ? state->seen_q : state->target_q;",
            f"    const {real} *moves = seen ? state->seen_v : state->target_v;",
            f"    {real} e[{n}];",
            *self._difference("state->target_q", "at", "e"),
            f"    {brake}(e, moves, state->target_v, state->target_a, state->M, state->h,",
            f"        state->recent, state->drive, {rate}, period, seen, state->load,",
            "        state->inertia, state->last, state->left, wanted);",
            "}",
            "guard_send(state, wanted, seen ? speed : state->target_v, period);",
            self._each("tau[i] = state->tau[i];"),
            "if (by_law) {",
            f"    {self._each(' '.join(self._bare.around.noted('state->law')))}",
            "}",
            "return state->stopped;",
        ]

    def _friction_lines(self) -> list[str]:
        if not self.adds_friction:
            return []
        ahead = self._kernel(add_friction, 1, 1, 1, 0, 1)
        given = "state->target_v, state->friction, state->damping, state->friction_width"
        return [
            f"    {ahead}({given}, friction);",
            f"    {self._each('wanted[i] += friction[i];')}",
        ]

    def _lead(self) -> list[str]:
        n, nq, real, bare = self._n, self._nq, self._real, self._bare
        fade = self._kernel(faded, 0, 0, *[1] * 5)
        checks = [("q_d", nq, "BAD_Q_D"), ("v_d", n, "BAD_V_D"), ("a_d", n, "BAD_A_D")]
        pairs = bare.turning.round_checks(bare.joints, "q_d", ROUNDNESS)
        led = ", ".join(f"{real} *led_{part}" for part in "qva")
        given = self._pointers("q", "v", "q_d", "v_d", "a_d")
        return block(
            f"static int guard_lead({self._state}, {given}, {real} dt, {led})",
            [
                *(self._unless(f"are_finite({name}, {k})", code) for name, k, code in checks),
                *(self._unless(pair, "BAD_Q_D") for pair in pairs),
                "if (!state->started) {",
                *self._difference("q_d", "q", "state->offset"),
                f"    {self._each('state->offset_dot[i] = v[i] - v_d[i];')}",
                "    state->started = 1;",
                "} else {",
                "    state->t += dt;",
                "}",
                self._each("led_q[i] = q_d[i];", size=nq),
                self._each("led_v[i] = v_d[i]; led_a[i] = a_d[i];"),
                "if (state->t < state->soft_start) {",
                f"    {real} way[{n}];",
                f"    {fade}(state->t, state->soft_start, state->offset, state->offset_dot, "
                "led_v, led_a, way);",
                *(f"    {x}" for x in bare.turning.sum(bare.joints, "q_d", "way", "led_q")),
                "}",
                f"return {self._status('OK')};",
            ],
            "Lead softly into the reference; or say what of it is not usable.",
        )

    def _unusable(self) -> list[str]:
        n, bare = self._n, self._bare
        return block(
            f"static int guard_unusable({self._pointers('q', 'v', 'M', 'h', 'g')})",
            [
                self._unless(f"are_finite(q, {self._nq})", "BAD_Q"),
                *(
                    self._unless(pair, "BAD_Q")
                    for pair in bare.turning.round_checks(bare.joints, "q", ROUNDNESS)
                ),
                self._unless(f"are_finite(v, {n})", "BAD_V"),
                self._unless(f"are_finite(M, {n * n})", "BAD_MODEL"),
                self._unless(f"are_finite(h, {n})", "BAD_MODEL"),
                self._unless(f"are_finite(g, {n})", "BAD_MODEL"),
                f"return {self._status('OK')};",
            ],
            "What of a measurement is not usable.",
        )

    def _send(self) -> list[str]:
        finite, limit = self._kernel(finite_or_last, 1, 1), self._kernel(within_limits, *[1] * 7, 0)
        average, n = self._kernel(averaged, 1, 1, 1, 0, -4), self._n
        firsts = ("state->tau[i] - state->h[i]", "v[i]")
        averages = [f"state->recent[{k * n} + i] = {firsts[k % 2]};" for k in range(4)]
        return block(
            f"static void guard_send({self._state}, {self._real} *wanted, const {self._real} *v, "
            f"{self._real} dt)",
            [
                f"{self._real} added[{self._n}];",
                self._each(f"added[i] = {self._added()};"),
                "const int is_first = !state->has_sent;",
                f"if (is_first) {{ {self._each('state->tau[i] = added[i];')} }}",
                "state->has_sent = 1;",
                f"{finite}(wanted, state->tau);",
                f"{limit}(wanted, state->tau, state->sent, added, state->torque_rate, {EFFORT},",
                "    state->lag, dt);",
                self._each("state->tau[i] = wanted[i]; state->sent[i] = wanted[i] - added[i];"),
                f"if (is_first) {{ {self._each(' '.join(averages))} }}",
                f"{average}(state->tau, state->h, v, dt, state->recent);",
            ],
            "Bring the torque within all limits, and note it and what of it is commanded.",
        )

    def _added(self) -> str:
        words = self._guard.compensates
        if "coriolis" not in words:
            return "state->g[i]" if "gravity" in words else self._number(0.0)
        return "state->h[i]" if "gravity" in words else "state->h[i] - state->g[i]"
