"""A Panda moved by C: the law is exported, compiled, and its C takes the law's place in the loop.

The same motion is run with the law in Python, and both torques are compared. Needs a C compiler.
"""

import ctypes
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pinocchio as pin

import fotsmc_pin as fp
from fotsmc_pin.references import Sinusoid


class InC:
    """A law that computes each tick in its own C, behind the interface of a controller."""

    label = "RobustFONFTSM in C"

    def __init__(self, law: fp.Controller, folder: Path) -> None:
        self.dt, self.model = law.dt, law.arm.model
        self.data, self.tau = self.model.createData(), np.zeros(law.arm.nv)
        header, source = fp.export_c(law, folder)
        self.prefix = header.stem
        size = folder / "size.c"  # The caller owns the state, so it asks how large that is.
        state = f"sizeof({self.prefix}_state)"
        size.write_text(f'#include "{header.name}"\nunsigned long size(void) {{ return {state}; }}')
        library = folder / "law.so"
        command = [shutil.which("cc") or "gcc", "-std=c99", "-O2", "-fPIC", "-shared"]
        subprocess.run([*command, str(source), str(size), "-o", str(library), "-lm"], check=True)
        self.code = ctypes.CDLL(str(library.resolve()))
        self.state = ctypes.create_string_buffer(self.code.size())
        self.size = len(re.findall(r"\n", source.read_text()))
        self.reset()

    def reset(self) -> None:
        """Begin anew."""
        self.code[f"{self.prefix}_init"](self.state)

    def update(self, q, v, q_d, v_d, a_d, dt=None):  # type: ignore[no-untyped-def]
        """Compute one tick: `M` and `h` by Pinocchio, the law by its C."""
        M = pin.crba(self.model, self.data, q)
        h = pin.nonLinearEffects(self.model, self.data, q, v)
        given = [np.ascontiguousarray(x, float) for x in (q, v, q_d, v_d, a_d, M, h)]
        period = ctypes.c_double(self.dt if dt is None else dt)
        arrays = [ctypes.c_void_p(x.ctypes.data) for x in (*given, self.tau)]
        tick = self.code[f"{self.prefix}_update"]
        if tick(self.state, *arrays[:-1], period, arrays[-1]) != 0:
            raise RuntimeError("the C refused a tick")
        return self.tau.copy()


def main(out: Path = Path("out/c_in_the_loop"), duration: float = 6.0) -> fp.Recording:
    """Run the law in C and in Python for `duration` [s], and make the page."""
    arm = fp.load_arm("panda")
    true = fp.perturb(arm, mass_scale=1.3, payload=1.0, friction=0.3)
    law, reference = fp.RobustFONFTSM(arm, dt=1e-3), Sinusoid.inside_limits(arm)
    q0 = arm.integrate(reference(0.0)[0], np.full(arm.nv, 0.1))
    in_c = InC(law, out)
    rec = fp.simulate(true, in_c, reference, duration, q0=q0)
    python = fp.simulate(true, law, reference, duration, q0=q0)
    apart = np.abs(rec.tau - python.tau).max()
    print(f"{in_c.size} lines of C, {len(in_c.state)} bytes of state")
    print(f"torques of C and Python differ by {apart:.1e} N·m at most")
    page = fp.export_html(rec, out / "c_in_the_loop.html", title="A Panda moved by C")
    print(f"Open {page} in a browser.")
    return rec


if __name__ == "__main__":
    main()
