"""`python -m tests.benchmarks.identification_figaroh`: one log of a Panda, by us and by figaroh.

It needs figaroh 1.0 (`pip install figaroh`). figaroh is given the same positions and torques, a
Butterworth filter of 10 Hz in place of its default of 2 Hz, weighted least squares and its fit with
possible bodies (`physical_fit`), and what it finds is judged on another motion as ours is.
"""

from __future__ import annotations

import re
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.arms.drive_size import drive_size
from fotsmc_pin.identification.base_parameters import BODY
from fotsmc_pin.identification.consistent import can_exist
from fotsmc_pin.identification.filtering import (
    averaging,
    averaging_times,
    joint_positions,
    smoothed,
)
from fotsmc_pin.identification.regressor import (
    MOSTLY_STILL,
    SLACK,
    Parameters,
    at_rest,
    body_columns,
    own_columns,
)
from fotsmc_pin.identification.torque import late_torque, rms_of
from tests.benchmarks.identification import excited, show
from tests.identification import hidden

WIDTH = 0.02
ZEROS = [0.0] * 7
CONFIGURATION = """
version: "2.0"
robot:
  name: panda
  properties:
    joints: {{active_joints: {joints}}}
    mechanics:
      friction_coefficients: {{viscous: {zeros}, static: {zeros}}}
      actuator_inertias: {zeros}
      joint_offsets: {zeros}
    coupling: {{has_coupled_wrist: false}}
tasks:
  identification:
    type: identification
    problem:
      use_joint_torques: true
      model_components: {{friction: true, actuator_inertia: true, joint_offset: false}}
    signal_processing:
      sampling_frequency: 1000.0
      cutoff_frequency: 10.0
      filter_params: {{nbutter: 4, f_butter: 10, med_fil: 5, f_sample: 1000}}
    select_stage: physical_fit
    physical_fit: {{enabled: true}}
"""


def by_figaroh(arm, log):
    """Return the parameters (p,) that figaroh finds."""
    from figaroh.identification.base_identification import BaseIdentification
    from figaroh.tools.load_robot import load_robot

    class Panda(BaseIdentification):
        def load_trajectory_data(self, data_source=None):
            return {
                "timestamps": log.t,
                "positions": log.q,
                "velocities": None,
                "accelerations": None,
                "torques": log.tau,
            }

    with tempfile.TemporaryDirectory() as folder:
        urdf, configuration = Path(folder) / "panda.urdf", Path(folder) / "panda.yaml"
        shapes = re.compile(r"<(visual|collision)\b.*?</\1>", re.S)
        urdf.write_text(shapes.sub("", arm.urdf))
        configuration.write_text(CONFIGURATION.format(joints=[*arm.joint_names], zeros=ZEROS))
        robot = load_robot(str(urdf), package_dirs=folder, isFext=False, loader="figaroh")
        work = Panda(robot, str(configuration))
        work.identif_config |= {"act_idxq": [*range(arm.nq)], "act_idxv": [*range(arm.nv)]}
        work.initialize()
        work.solve(decimate=True, decimation_factor=20, plotting=False, wls=True)
    found = dict(zip(work.selected.names, work.selected.values, strict=True))
    names = [f"{symbol}_{joint}" for joint in arm.joint_names for symbol in BODY]
    names += [f"{kind}_{joint}" for kind in ("Ia", "fv", "fs") for joint in arm.joint_names]
    return np.array([float(found[name]) for name in names])


def judged(arm, theta, log, shift):
    """Return the largest error over noise on a log: sample by sample, and averaged."""
    parameters, noise = Parameters(arm.nv), hidden.TORQUE_NOISE * drive_size(arm)
    piece = smoothed(log.t, joint_positions(arm, log.q), log.tau)
    own = own_columns(piece, 1.0)
    tau = body_columns(arm, piece.x, piece.v, piece.a) @ theta[: 10 * arm.nv]
    tau += sum(own[name] * theta[parameters.groups[name]] for name in parameters.own)
    resting = at_rest(piece)
    plain = np.where(resting, np.nan, late_torque(piece, shift) - tau)
    at = averaging_times(piece, WIDTH, SLACK)
    matrix = averaging(at, piece.t, WIDTH)
    left = averaging(at + shift, piece.t, WIDTH) @ piece.tau - matrix @ tau
    averaged = np.where(matrix @ resting.astype(float) < MOSTLY_STILL, left, np.nan)
    gain = np.sqrt(piece.dt / (2.0 * np.sqrt(np.pi) * WIDTH))
    return np.max(rms_of(plain) / noise), np.sqrt(np.mean((rms_of(averaged) / noise / gain) ** 2))


def main():
    arm = fp.load_arm("panda")
    true = hidden.hidden_plant(arm, 0)
    log = excited("panda", true, 0)
    other = hidden.measured(
        hidden.run("panda", true, hidden.swings(arm, 50, duration=10.0), 10.0), 1
    )
    fp.identify(log, arm)  # Imports and compiled code are not to count.
    started = time.process_time()
    result = fp.identify(log, arm, validate=other)
    middle = time.process_time()
    theirs = by_figaroh(arm, log)
    took = (middle - started, time.process_time() - middle)
    shift = result.validation[0].delay
    show("program", "largest torque error / noise", "averaged, RMS", "possible", "time [s]")
    for name, theta, seconds in zip(("ours", "figaroh"), (result.theta, theirs), took, strict=True):
        plain, averaged = judged(arm, theta, other, shift)
        possible = sum(can_exist(theta[10 * k : 10 * k + 10]) for k in range(arm.nv))
        show(name, f"{plain:.3f}", f"{averaged:.3f}", f"{possible} of {arm.nv}", f"{seconds:.1f}")
    sys.stdout.write(f"the time of ours includes the validation; {log!r}\n")


if __name__ == "__main__":
    main()
