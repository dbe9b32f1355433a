"""A law in a `Safeguard` in C: soft start, limits, watchdog and safe stop around the bare law."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fotsmc_pin.control.safety.braking_kernels import ROWS
from fotsmc_pin.export.bare import BareLaw
from fotsmc_pin.export.dialect import comment
from fotsmc_pin.export.guard_tick import GuardTick
from fotsmc_pin.export.layout import STATUSES, assigned, block
from fotsmc_pin.export.names import GRAVITY, GUARDED_INIT, GUARDED_RESET, RESULT, STOP, STOPS

if TYPE_CHECKING:
    from fotsmc_pin.control import Safeguard
    from fotsmc_pin.export.program import Program

FLAGS = {
    "started": "whether the reference was led into",
    "placed": "whether the arm was seen",
    "wanted": "whether there is a target",
    "has_sent": "whether there was a torque",
    "under_way": "whether a braking path is drawn",
    "by_law": "whether the law may follow it",
}
"""Truth values that live on, with their meanings."""


class GuardedLaw:
    """Writes a law in a safeguard.

    Attributes:
        bare: the law.
        names: how its parts are called; what is public is the safeguard's.
    """

    def __init__(self, guard: Safeguard, program: Program) -> None:
        self.bare = BareLaw(guard.controller, program, wrapped=True)
        self.names, self.guard, self.program = self.bare.names, guard, program
        self.dialect, self.arm = program.dialect, guard.arm
        self._n = guard.arm.nv
        self._tick = GuardTick(guard, self.bare, program)
        self._functions, self._update = self._tick.functions(), self._tick.tick()

    @property
    def meanings(self) -> list[tuple[str, str]]:
        """The status codes of a tick, with what each means."""
        return [*STATUSES, *STOPS]

    @property
    def roots(self) -> list[str]:
        """Translated functions that are called from outside of the translation."""
        return [*self.bare.roots, *self._tick.roots]

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
            f"{real} stop_ramp; /* least time in which a safe stop brakes [s] */",
            f"{real} fastest{vector} /* speed at which a safe stop begins [rad/s, m/s] */",
            f"{real} torque_rate{vector} /* largest rate of the torque [N*m/s, N/s] */",
            f"{real} drive{vector} /* size of each joint's drive [N*m, N] */",
        ]
        if self._tick.adds_friction:
            members += [
                f"{real} friction{vector} /* Coulomb friction [N*m, N] */",
                f"{real} damping{vector} /* viscous friction [N*m*s/rad, N*s/m] */",
                f"{real} friction_width; /* speed over which it turns its sign [rad/s, m/s] */",
            ]
        members.append("/* What lives on from tick to tick: */")
        for name, (size, note) in self._remembered.items():
            members.append(f"{real} {name}{f'[{size}]' if size else ''}; /* {note} */")
        members += [f"int {name}; /* {note} */" for name, note in FLAGS.items()]
        members.append("int stopped; /* status: why a safe stop is on */")
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
        init, reset, stop, update = (head for head, _ in self.public())
        asked = [f"guard_begin_stop(state, {self.names.status('STOPPED')}, 1);"]
        return [
            *self.bare.functions(),
            *self._functions,
            *block(reset, self._reset_lines(), "Begin anew."),
            *block(init, self._init_lines(), "Fill in gains and limits."),
            *block(stop, asked, "Stop."),
            *block(update, self._update, "One tick: see the header."),
        ]

    @property
    def _remembered(self) -> dict[str, tuple[int, str]]:
        """Numbers and vectors that live on, with their sizes (0 for a number) and meanings."""
        n, nq = self._n, self.arm.nq
        return {
            "t": (0, "since the start [s]"),
            "offset": (n, "from the reference at the start [rad, m]"),
            "offset_dot": (n, "its rate [rad/s, m/s]"),
            "tau": (n, "last torque, what the drives add included [N*m, N]"),
            "sent": (n, "what of it is to be commanded [N*m, N]"),
            "recent": (4 * n, "averages of the last torques beyond h, of velocities, and of both"),
            "lag": (n, "how far the torque is behind for its rate [N*m, N]"),
            "seen_q": (nq, "where the arm was last seen [rad, m]"),
            "seen_v": (n, "its velocity there [rad/s, m/s]"),
            "M": (n * n, "mass matrix there [kg*m^2, kg]"),
            "h": (n, "C v + g there [N*m, N]"),
            "g": (n, "gravity there [N*m, N]"),
            "turning": (n, "C v there [N*m, N]"),
            "target_q": (nq, "what is followed [rad, m]"),
            "target_v": (n, "its velocity [rad/s, m/s]"),
            "target_a": (n, "its acceleration [rad/s^2, m/s^2]"),
            "path_q": (nq, "where the path of a safe stop began [rad, m]"),
            "path": (ROWS * n, "its joints' numbers, row by row"),
            "path_bound": (0, "way of the joint that moves farthest on it [rad, m]"),
            "load": (n, "what the brake bears beside the model [N*m, N]"),
            "inertia": (n, "what it moves beside the model [kg*m^2, kg]"),
            "last": (n, "last error of its velocity [rad/s, m/s]"),
            "left": (n, "from the path's end to where it came to rest [rad, m]"),
        }

    def _init_lines(self) -> list[str]:
        guard, dialect = self.guard, self.dialect
        values: dict[str, Any] = {
            "soft_start": guard._lead.duration,
            "watchdog": guard.watchdog,
            "stop_ramp": guard.stop_ramp,
            "fastest": guard._fastest,
            "torque_rate": guard._rate,
            "drive": guard._stop.brake.drive,
        }
        if guard._friction is not None and self._tick.adds_friction:
            ahead = guard._friction
            values |= {"friction": ahead.friction, "damping": ahead.damping}
            values["friction_width"] = ahead.width
        lines = ["law_init(&state->law);"]
        for name, value in values.items():
            lines += assigned(f"state->{name}", value, dialect)
        return [*lines, f"{self.names.prefix}_reset(state);"]

    def _reset_lines(self) -> list[str]:
        zero = self.dialect.number(0.0)
        sizes = {name: size for name, (size, _) in self._remembered.items()}
        lines = ["law_reset(&state->law);"]
        lines += [f"state->{name} = {zero};" for name, size in sizes.items() if not size]
        for size in sorted({*sizes.values()} - {0}):
            names = [name for name in sizes if sizes[name] == size]
            cleared = [f"    state->{name}[i] = {zero};" for name in names]
            lines += [f"for (int i = 0; i < {size}; i++) {{", *cleared, "}"]
        lines += [f"state->{name} = {int(name == 'by_law')};" for name in FLAGS]
        return [*lines, f"state->stopped = {self.names.status('OK')};"]
