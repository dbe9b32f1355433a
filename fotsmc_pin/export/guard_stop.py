"""The safe stop of a guarded law in C: when it calls which kernel.

It is what `control.safety.SafeStop` does; its arithmetic is that of the same kernels.
"""

from __future__ import annotations

from fotsmc_pin.control.safety.brake import begun, unexplained
from fotsmc_pin.control.safety.braking_kernels import (
    FIRST,
    LEARNT,
    RATE,
    ROWS,
    SPEED,
    UNKNOWN,
    WAY,
    advanced,
    drawn,
    is_faster,
    speed_left,
)
from fotsmc_pin.control.safety.safe_stop import ALIKE, ASTRAY, LOST, NEAR
from fotsmc_pin.control.safety.steps import caught_up, is_kept
from fotsmc_pin.export.guard_lines import EFFORT, GuardLines
from fotsmc_pin.export.layout import block


class GuardStop(GuardLines):
    """Writes the functions of the safe stop."""

    def stop_functions(self) -> list[str]:
        """Return the functions, each before its caller."""
        return [
            *self._begin_stop(),
            *self._see(),
            *self._advance(),
            *self._begin_braking(),
            *self._brake_on(),
        ]

    def _begin_stop(self) -> list[str]:
        return block(
            f"static void guard_begin_stop({self._state}, int status, int trusts_law)",
            [
                f"if (state->stopped == {self._status('OK')}) {{ state->stopped = status; }}",
                "if (!trusts_law) { state->by_law = 0; }",
            ],
            "Begin a safe stop, unless one is on. A law that is in doubt does not brake.",
        )

    def _see(self) -> list[str]:
        places = self._pointers("q", "v", "M", "h", "g")
        targets = self._pointers("q", "v", "a")
        return [
            *block(
                f"static void guard_see({self._state}, {places})",
                [
                    self._each("state->seen_q[i] = q[i];", size=self._nq),
                    self._each("state->seen_v[i] = v[i]; state->h[i] = h[i]; state->g[i] = g[i];"),
                    self._each("state->turning[i] = h[i] - g[i];"),
                    self._each("state->M[i] = M[i];", size=self._n**2),
                    "state->placed = 1;",
                ],
                "Remember where the arm was seen, and its model there.",
            ),
            *block(
                f"static void guard_want({self._state}, {targets})",
                [
                    self._each("state->target_q[i] = q[i];", size=self._nq),
                    self._each("state->target_v[i] = v[i]; state->target_a[i] = a[i];"),
                    "state->wanted = 1;",
                ],
                "Remember what is followed.",
            ),
        ]

    def _advance(self) -> list[str]:
        draw = self._kernel(drawn, 2, 1, 1, 1, 0, 0, -ROWS)
        advance = self._kernel(advanced, 2, *[1] * 4, *[0] * 4, -ROWS)
        turning, joints, real = self._bare.turning, self._bare.joints, self._real
        zero, one, learnt = (self._number(value) for value in (0.0, 1.0, LEARNT))
        begin, size = self._kernel(begun, *[1] * 6), self._program.dialect.function("fabs")
        weight = f"learns ? ({learnt} * dt < {one} ? {learnt} * dt : {one}) : {zero}"
        moved = " ".join(
            f"state->target_{name}[i] = state->path[{self._n * row} + i];"
            for name, row in (("v", SPEED), ("a", RATE))
        )
        return [
            *block(
                f"static void guard_draw({self._state}, const {real} *unknown)",
                [
                    self._each(
                        f"state->path[{self._n * UNKNOWN} + i] = unknown[i]; "
                        f"state->path[{self._n * FIRST} + i] = {size}(state->seen_v[i]);"
                    ),
                    f"state->path_bound = {draw}(state->M, state->h, {EFFORT},",
                    "    state->torque_rate, state->stop_ramp, !state->by_law, state->path);",
                    f"{begin}(unknown, state->drive, state->load, state->inertia, state->last,",
                    "    state->left);",
                    "state->under_way = 1;",
                ],
                "Draw a braking path from where it begins.",
            ),
            *block(
                f"static void guard_advance({self._state}, bool learns, {real} dt)",
                [
                    f"const {real} weight = {weight};",
                    f"state->path_bound = {advance}(state->M, state->h, state->tau, {EFFORT},",
                    "    state->torque_rate, state->stop_ramp, weight, dt, state->path_bound,",
                    "    state->path);",
                    self._each(moved),
                    *turning.sum(
                        joints,
                        "state->path_q",
                        f"(state->path + {self._n * WAY})",
                        "state->target_q",
                    ),
                    "state->wanted = 1;",
                ],
                "Advance on the braking path.",
            ),
        ]

    def _begin_braking(self) -> list[str]:
        n, real = self._n, self._real
        kept = self._kernel(is_kept, 1, 1, 1, 0, 0)
        catch_up, unknown = self._kernel(caught_up, -4), self._kernel(unexplained, 1, -4, 2, 1)
        within = f"{self._number(NEAR)}, {self._number(ALIKE)}"
        v, a = self._n * SPEED, self._n * RATE
        copied = (
            f"state->path[{v} + i] = state->target_v[i]; state->path[{a} + i] = state->target_a[i];"
        )
        return block(
            f"static void guard_begin_braking({self._state})",
            [
                *self._start_where_seen(),
                "if (state->wanted) {",
                f"    {real} e[{n}], e_dot[{n}];",
                *self._difference("state->target_q", "state->seen_q", "e"),
                f"    {self._each('e_dot[i] = state->seen_v[i] - state->target_v[i];')}",
                f"    if ({kept}(e, e_dot, state->fastest, {within})) {{",
                f"        {self._each('state->path_q[i] = state->target_q[i];', size=self._nq)}",
                f"        {self._each(copied)}",
                "    }",
                "}",
                f"{real} load[{n}];",
                f"{catch_up}(state->recent);",
                f"{unknown}(state->seen_v, state->recent, state->M, load);",
                "guard_draw(state, load);",
            ],
            "Begin to brake where the arm was last seen, or at its target where that is near.",
        )

    def _brake_on(self) -> list[str]:
        n, real = self._n, self._real
        kept, unknown = (
            self._kernel(is_kept, 1, 1, 1, 0, 0),
            self._kernel(unexplained, 1, -4, 2, 1),
        )
        within = f"{self._number(LOST)}, {self._number(ASTRAY)}"
        slower = self._kernel(speed_left, -ROWS)
        faster, begin = self._kernel(is_faster, 1, -ROWS), self._kernel(begun, *[1] * 6)
        return block(
            f"static void guard_brake_on({self._state}, bool seen, "
            f"{self._pointers('q', 'v', 'M', 'h', 'g')}, {real} dt)",
            [
                "if (!state->placed) { return; }",
                "if (!state->under_way) { guard_begin_braking(state); }",
                "if (seen) {",
                "    guard_see(state, q, v, M, h, g);",
                "} else {",
                "    /* Of C v so much is left as the arm has become slower unseen. */",
                f"    const {real} left = {slower}(state->path);",
                f"    {self._each('state->h[i] = state->g[i] + left * state->turning[i];')}",
                "}",
                "guard_advance(state, seen, dt);",
                "if (!seen || !state->by_law) { return; }",
                f"{real} e[{n}], e_dot[{n}];",
                *self._difference("state->target_q", "state->seen_q", "e"),
                self._each("e_dot[i] = state->seen_v[i] - state->target_v[i];"),
                f"const bool keeps = {kept}(e, e_dot, state->fastest, {within});",
                f"if (keeps && !{faster}(state->seen_v, state->path)) {{ return; }}",
                "state->by_law = 0;",
                f"{real} load[{n}];",
                f"{unknown}(state->seen_v, state->recent, state->M, load);",
                "if (keeps) {",
                f"    {begin}(load, state->drive, state->load, state->inertia, state->last,",
                "        state->left);",
                "    return;",
                "}",
                *self._start_where_seen(),
                "guard_draw(state, load);",
                "guard_advance(state, false, dt);",
            ],
            "One tick of braking; anew, and without the law, where that lost the path.",
        )

    def _start_where_seen(self) -> list[str]:
        zero = self._number(0.0)
        return [
            self._each("state->path_q[i] = state->seen_q[i];", size=self._nq),
            self._each(
                f"state->path[{self._n * SPEED} + i] = state->seen_v[i]; "
                f"state->path[{self._n * RATE} + i] = {zero};"
            ),
        ]
