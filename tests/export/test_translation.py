"""What the translator takes, what it refuses, and what it writes."""

import math
import os
import subprocess
import sys
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control.law import (
    Array,
    Controller,
    Gains,
    advance,
    flag,
    inverse_dynamics,
    kernel,
    option,
    per_joint,
    rows,
    scalar,
    sig,
)
from fotsmc_pin.errors import TranslationError
from fotsmc_pin.export.dialect import Dialect
from fotsmc_pin.export.program import Program
from fotsmc_pin.export.values import Array as CArray
from fotsmc_pin.export.values import Root, Scalar

from .compiled_c import STRICT, compile_shared
from .conftest import DT, arm_named, rough_run, worst

MODES = ("plain", "square")
SMALL = 1e-3


@dataclass(frozen=True, kw_only=True, eq=False)
class UsersGains(Gains):
    """Gains of a user's law.

    Attributes:
        kp: stiffness */ that tries to end a comment.
        mode: what the integral does.
        damped: whether there is damping.
        alpha: order of the memory.
    """

    kp: Array = per_joint(100.0, "1/s²")
    mode: str = option("square", MODES)
    damped: bool = flag(True)
    alpha: float = scalar(0.5)


class UsersState(NamedTuple):
    z: Array
    η: Array


class UsersWork(NamedTuple):
    a: Array
    excess: Array
    slow: Array


@kernel
def bounded(x: float, low: float, high: float) -> float:
    """Within two bounds; uses what kernels of a user may use."""
    k = 0
    while True:
        k += 1
        if k > 3:
            break
        if k == 2:
            continue
    if not low <= x <= high or k != 4:
        return low if x < low else high
    return x


@kernel
def both(x: float, y: float) -> tuple[float, float]:
    x, y = y, x
    return x, y


class UsersLaw(Controller[UsersGains]):
    """A law of one's own."""

    Gains, State, Work = UsersGains, UsersState, UsersWork
    streams: ClassVar = {
        "memory": lambda g, dt: fp.FractionalIntegral(order=g.alpha, dt=dt, scheme="quadratic")
    }

    def start(self):
        self.state.z[:] = 0.25

    @staticmethod
    @kernel
    def tick(
        dt: float, table: Array, M0: Array, h0: Array, memory: Array, memory_memory: Array
    ) -> None:
        x, g, m, w = rows(table, UsersGains, UsersState, UsersWork)
        n = x.e.size
        advance(memory, memory_memory, x.e, dt, w.slow)
        part = np.zeros((2, n))
        total = 0.0
        for value in x.e:
            total += value**2
        for i in range(n - 1, -1, -1):
            part[0, i], part[1, i] = both(x.e[i], x.e_dot[i])
            damping = 20.0 * part[0, i] if g.damped else 0.0
            m.η[i] = m.z[i] = bounded(m.z[i] + dt * sig(x.e[i], 0.5), -1.0, 1.0)
            if g.mode == 1 and i % 2 == 0:
                m.z[i] *= 1.0 - SMALL * (i // 2 + 1)
            push = math.atan2(total, 1.0) + min(total, 1.0, 0.5) + m.η[i] + w.slow[i]
            w.a[i] = x.a_d[i] - g.kp[i] * part[1, i] - damping - push * math.pi
        inverse_dynamics(M0, h0, w.a, x.effort_limit, x.tau, w.excess)


def test_a_users_law_needs_no_more_work(compiled):
    controller = UsersLaw(arm_named("kinova"), DT)
    inputs = rough_run(controller, ticks=120)
    tau, status = compiled(controller).replay(inputs)
    assert not status.any()
    assert worst(tau, inputs) < 1e-12


@kernel
def prints(x: float) -> float:
    print(x)  # noqa: T201
    return x


@kernel
def counts_down(x: float) -> float:
    y = 1
    y = x
    return y  # noqa: RET504


@kernel
def recursive(x: float) -> float:
    return recursive(x - 1.0) if x > 0.0 else x


@kernel
def whole_arrays(x: Array) -> None:
    x[:] = x + x


@kernel
def a_list(x: Array) -> float:
    return sum([value for value in x])  # noqa: C416


@kernel
def out_of_bounds(x: Array) -> float:
    return x[3]


@kernel  # noqa: RET503
def falls_through(x: float) -> float:
    if x > 0.0:
        return x


@kernel
def unknown_library(x: float) -> float:
    return np.sinc(x)


def python(x):
    return x


@kernel
def calls_python(x: float) -> float:
    return python(x)


REFUSED = {
    prints: "print",
    counts_down: "real becomes int",
    recursive: "calls itself",
    whole_arrays: "arrays",
    a_list: "ListComp",
    out_of_bounds: "index 3 of 3",
    falls_through: "return",
    unknown_library: "np.sinc",
    calls_python: "@kernel",
}


@pytest.mark.parametrize("function", REFUSED, ids=lambda f: f.__name__)
def test_what_is_not_known_is_refused_with_its_place(function):
    takes_array = function in (whole_arrays, a_list, out_of_bounds)
    value = CArray("x", (3,), Root()) if takes_array else Scalar("real", "x")
    with pytest.raises(TranslationError) as error:
        Program(Dialect()).function(function, [value], caller=None, node=None)
    text = str(error.value)
    assert REFUSED[function] in text
    first = function.py_func.__code__.co_firstlineno
    path, line, _ = text.split(":", 2)
    assert path == __file__
    assert first < int(line) <= first + 4


def test_a_controller_that_is_none_is_refused(tmp_path):
    with pytest.raises(fp.errors.ArgumentError, match="controller"):
        fp.export_c("RobustFONFTSM", tmp_path)


def test_the_files_are_the_same_in_every_process(tmp_path):
    code = (
        "import fotsmc_pin as fp, sys; "
        "law = fp.ModelLearning(fp.RobustFONFTSM(fp.load_arm('two_link'), 1e-3)); "
        "fp.export_c(fp.Safeguard(law), sys.argv[1])"
    )
    here = fp.export_c(
        fp.Safeguard(fp.ModelLearning(fp.RobustFONFTSM(arm_named("two_link"), DT))), tmp_path
    )
    seed = "1" if os.environ.get("PYTHONHASHSEED") != "1" else "2"
    env, there = os.environ | {"PYTHONHASHSEED": seed}, tmp_path / "there"
    subprocess.run([sys.executable, "-c", code, str(there)], check=True, env=env)
    for path in here:
        assert path.read_bytes() == (there / path.name).read_bytes()


@pytest.mark.parametrize("law", [fp.AdaptiveFONFTSM, fp.RobustFONFTSM])
def test_it_is_small_and_asks_for_no_memory(law, tmp_path):
    guard = fp.Safeguard(law(arm_named("panda"), DT, preset=[*law.presets][-1]))
    header, source = fp.export_c(guard, tmp_path)
    state = tmp_path / "state.c"
    refused = "char small[sizeof(fotsmc_panda_state) < 12 * 1024 ? 1 : -1];"
    state.write_text(f'#include "{header.name}"\n{refused}\n', encoding="utf-8")
    compile_shared([state], tmp_path / "state.o", *STRICT, "-c")
    target = compile_shared([source], tmp_path / "law.o", *STRICT, "-c")
    sizes = subprocess.run(["size", target], check=True, capture_output=True, text=True).stdout
    text, data, bss = (int(word) for word in sizes.splitlines()[1].split()[:3])
    assert text < 36 * 1024
    assert data == bss == 0
    symbols = subprocess.run(["nm", target], check=True, capture_output=True, text=True).stdout
    asked = {line.split()[-1] for line in symbols.splitlines() if " U " in line}
    assert asked <= {"pow", "exp", "sqrt", "tgamma", "hypot", "tanh", "memset", "memcpy"}, asked
    public = {line.split()[-1] for line in symbols.splitlines() if " T " in line}
    assert public == {f"fotsmc_panda_{name}" for name in ("init", "reset", "stop", "update")}


def test_the_header_tells_names_units_and_equations(compiled):
    c = compiled(fp.RobustFONFTSM(arm_named("two_link"), DT))
    text = c.header.read_text("utf-8")
    for words in ("[rad/s²]", "τ = M0 (a + b) + T", fp.__version__, "row by row", "joint1"):
        assert words in text
