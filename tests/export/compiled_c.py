"""Exported controllers, compiled and called: a tick at a time or a whole recording at once."""

import ctypes
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pinocchio as pin

import fotsmc_pin as fp
from fotsmc_pin.control.arguments import LARGEST

WARNINGS = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
STRICT = (*WARNINGS, "-O2")
UNDEFINED = (*WARNINGS, "-O0", "-fsanitize=undefined", "-fno-sanitize-recover=all")
"""What C does not define ends the process; not optimised, which takes four times as long."""
EXACT = "-ffp-contract=off"
"""Products and sums are rounded one by one, so that numbers can be compared to the last bits."""

SHIM = """
#include <stddef.h>
#include "{prefix}.h"

size_t shim_size(void);
const {real} *shim_sent(const {prefix}_state *state);
void shim_replay(
    {prefix}_state *state, int ticks, const {real} *q, const {real} *v, const {real} *q_d,
    const {real} *v_d, const {real} *a_d, const {real} *M, const {real} *h, {g_type}
    const {real} *dt, {real} *tau, int *status);

size_t shim_size(void) {{ return sizeof({prefix}_state); }}

const {real} *shim_sent(const {prefix}_state *state) {{ return state->{sent}; }}

void shim_replay(
    {prefix}_state *state, int ticks, const {real} *q, const {real} *v, const {real} *q_d,
    const {real} *v_d, const {real} *a_d, const {real} *M, const {real} *h, {g_type}
    const {real} *dt, {real} *tau, int *status) {{
    (void)g;
    for (int k = 0; k < ticks; k++) {{
        status[k] = {prefix}_update(
            state, q + {nq} * k, v + {n} * k, q_d + {nq} * k, v_d + {n} * k, a_d + {n} * k,
            M + {n} * {n} * k, h + {n} * k, {g} dt[k], tau + {n} * k);
    }}
}}
"""


def compile_shared(sources, target, *flags, compiler="gcc"):
    """Compile C into a shared library."""
    shared = [] if "-c" in flags else ["-fPIC", "-shared"]
    command = [
        compiler,
        *flags,
        *shared,
        *map(str, sources),
        "-o",
        str(target),
        "-lm",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert not done.returncode, done.stderr[:4000]
    return target


@dataclass
class Inputs:
    """What the ticks of a run were given, one row each, and the torque that they gave."""

    q: np.ndarray
    v: np.ndarray
    q_d: np.ndarray
    v_d: np.ndarray
    a_d: np.ndarray
    M: np.ndarray
    h: np.ndarray
    g: np.ndarray
    dt: np.ndarray
    tau: np.ndarray


def terms(arm, law, q, v):
    """Return `M`, `h` and `g` as a caller of C computes them."""
    if not (np.isfinite(q).all() and np.isfinite(v).all()):
        bad = np.full(arm.nv, np.nan)
        return np.full((arm.nv, arm.nv), np.nan), bad, bad
    model, data = arm.model, arm.model.createData()
    seen, speed = np.clip(q, -LARGEST, LARGEST), np.clip(v, -LARGEST, LARGEST)
    M = pin.crba(model, data, seen).copy()
    h = pin.nonLinearEffects(model, data, seen, speed).copy()
    return M, h, pin.computeGeneralizedGravity(model, data, seen).copy()


class Logged:
    """A controller that keeps what each of its ticks was given."""

    def __init__(self, law):
        self.law, self.dt, self.arm = law, law.dt, law.arm
        self.rows = []

    def __getattr__(self, name):
        return getattr(self.law, name)

    def reset(self):
        self.law.reset()
        self.rows.clear()

    def update(self, q, v, q_d, v_d, a_d, dt=None):
        tau = self.law.update(q, v, q_d, v_d, a_d, dt)
        period = self.dt if dt is None else dt
        M, h, g = terms(self.arm, self.bare, q, v)
        row = (q, v, q_d, v_d, a_d, M, h, g, period, tau)
        self.rows.append([np.array(x, dtype=float) for x in row])
        return tau

    @property
    def bare(self):
        """The law without its safeguard."""
        return getattr(self.law, "controller", self.law)

    @property
    def inputs(self):
        return Inputs(*(np.array(column) for column in zip(*self.rows, strict=True)))


class CompiledC:
    """An exported controller, compiled into a shared library."""

    def __init__(self, controller, folder, *, single=False, flags=UNDEFINED, compiler="gcc"):
        self.arm = controller.arm
        self.header, self.source = fp.export_c(controller, folder, single=single)
        self.prefix = self.header.stem
        self.real = np.float32 if single else np.float64
        shim = Path(folder) / "shim.c"
        real = "float" if single else "double"
        words = {"prefix": self.prefix, "real": real, "g_type": f"const {real} *g,"}
        guarded = isinstance(controller, fp.Safeguard)
        words["sent"] = "sent" if guarded else "joints.tau"
        words["g"] = f"g + {self.arm.nv} * k," if guarded else ""
        shim.write_text(SHIM.format(n=self.arm.nv, nq=self.arm.nq, **words), encoding="utf-8")
        library = Path(folder) / f"{self.prefix}.so"
        compile_shared([self.source, shim], library, *flags, EXACT, compiler=compiler)
        self.code = ctypes.CDLL(str(library))
        self.code.shim_size.restype = ctypes.c_size_t
        self.size = self.code.shim_size()
        self.state = ctypes.create_string_buffer(self.size)
        self.init()

    def init(self):
        getattr(self.code, f"{self.prefix}_init")(self.state)

    def reset(self):
        getattr(self.code, f"{self.prefix}_reset")(self.state)

    @property
    def sent(self):
        """What the last tick of a guarded law commands."""
        self.code.shim_sent.restype = ctypes.POINTER(np.ctypeslib.as_ctypes_type(self.real))
        return np.array(self.code.shim_sent(self.state)[: self.arm.nv])

    def replay(self, inputs):
        """Return the torques and the status codes of all ticks."""
        n, ticks = self.arm.nv, len(inputs.q)
        tau = np.zeros((ticks, n), self.real)
        status = np.zeros(ticks, np.intc)
        names = ("q", "v", "q_d", "v_d", "a_d", "M", "h", "g", "dt")
        given = [np.ascontiguousarray(getattr(inputs, name), self.real) for name in names]
        pointers = [ctypes.c_void_p(array.ctypes.data) for array in (*given, tau, status)]
        self.code.shim_replay(self.state, ctypes.c_int(ticks), *pointers)
        return tau, status

    def update(self, q, v, q_d, v_d, a_d, M, h, g, dt):
        """Return the torque and the status of one tick."""
        row = (q, v, q_d, v_d, a_d, M, h, g, dt)
        one = Inputs(*(np.array([x], dtype=self.real) for x in row), None)
        tau, status = self.replay(one)
        return tau[0], int(status[0])
