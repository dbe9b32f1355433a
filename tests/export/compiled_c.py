"""Exported controllers, compiled and called: a tick at a time or a whole recording at once."""

import ctypes
import os
import subprocess
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
import pinocchio as pin

import fotsmc_pin as fp
from fotsmc_pin.control.arguments import LARGEST

STRICT = ("-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
SANITIZERS = os.environ.get("FOTSMC_SANITIZERS", "undefined")
CHECKED = ("-std=c99", "-O0", f"-fsanitize={SANITIZERS}", "-fno-sanitize-recover=all")
"""What C does not define ends the process. Without optimization nothing of it is optimized away,
and it compiles in a fifth of the time."""
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
    shared, libraries = ([], []) if "-c" in flags else (["-fPIC", "-shared"], ["-lm"])
    command = [
        compiler,
        *flags,
        *shared,
        *map(str, sources),
        "-o",
        str(target),
        *libraries,
    ]
    # What a run of the tests under a sanitizer loads first is not for the compiler.
    env = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=env)
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

    def part(self, start, stop=None):
        """Return some of the ticks."""
        return Inputs(*(getattr(self, field.name)[start:stop] for field in fields(self)))


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
    """An exported controller: optimized, without a warning, and as a library that is called.

    The library is that of the sanitizers unless `flags` say otherwise.
    """

    def __init__(self, controller, folder, *, single=False, flags=CHECKED, compiler="gcc"):
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
        self.object = compile_shared([self.source], Path(folder) / "strict.o", *STRICT, "-c")
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


class LearningC(CompiledC):
    """An exported controller that learns: Pinocchio gives it what a robot's program would."""

    def __init__(self, controller, folder, **options):
        super().__init__(controller, folder, **options)
        self.due, self.give, self.learned = (
            getattr(self.code, f"{self.prefix}_{name}")
            for name in ("regressor_due", "give_regressor", "learned_model")
        )
        guarded = isinstance(controller, fp.Safeguard)
        learner = controller.controller if guarded else controller
        self.in_loop, self.feeds = learner._in_loop, learner._feeds
        model = self.arm.model
        self.model, self.data, self.nominal = model.copy(), model.createData(), model.createData()

    def believe(self):
        """Take over the learnt arm, as it is after a tick."""
        links, armature = np.zeros((self.arm.nv, 10)), np.zeros(self.arm.nv)
        self.learned(self.state, *pointers(links, armature))
        for k, dynamic in enumerate(links):
            self.model.inertias[k + 1] = pin.Inertia.FromDynamicParameters(dynamic)
        self.model.armature[:] = armature
        return links, armature

    def regressor(self):
        """Return the regressor that is due, if any is."""
        q, v, a = np.zeros(self.arm.nq), np.zeros(self.arm.nv), np.zeros(self.arm.nv)
        if not self.due(self.state, *pointers(q, v, a)):
            return None
        found = pin.computeJointTorqueRegressor(self.arm.model, self.nominal, q, v, a)
        return np.ascontiguousarray(found)

    def terms(self, q, v, v_d, a_d):
        """Return `M`, `h` and `g` for a tick, of the learnt arm where the law is closed with it."""
        nominal = terms(self.arm, None, q, v)
        seen, speed = np.clip(q, -LARGEST, LARGEST), np.clip(v, -LARGEST, LARGEST)
        if not self.in_loop:
            M, h, g = nominal
            if self.feeds and np.isfinite(h).all():
                h = h + pin.rnea(self.model, self.data, seen, v_d, a_d)
                h -= pin.rnea(self.arm.model, self.nominal, seen, v_d, a_d)
            return M, h, g
        if not np.isfinite(nominal[0]).all():
            return nominal
        M = pin.crba(self.model, self.data, seen).copy()
        return M, pin.nonLinearEffects(self.model, self.data, seen, speed).copy(), nominal[2]

    def follow(self, inputs):
        """Return the torques and status codes of all ticks, with its own learnt model."""
        self.believe()
        found = []
        for q, v, q_d, v_d, a_d, dt in zip(
            inputs.q, inputs.v, inputs.q_d, inputs.v_d, inputs.a_d, inputs.dt, strict=True
        ):
            regressor = self.regressor()
            if regressor is not None:
                assert self.give(self.state, *pointers(regressor)) == 0
            found.append(self.update(q, v, q_d, v_d, a_d, *self.terms(q, v, v_d, a_d), dt))
            self.believe()
        tau, status = zip(*found, strict=True)
        return np.array(tau), np.array(status)


def pointers(*arrays):
    """Return pointers to the numbers of contiguous arrays."""
    return [ctypes.c_void_p(array.ctypes.data) for array in arrays]
