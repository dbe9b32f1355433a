"""`python -m tests.benchmarks.identification WHAT [ARM...]`: what identification is worth.

WHAT is one of

- `plants`: hidden plants, run by the robust law on encoders of 20 bits, torque with noise: error of
  the torque on another motion, base parameters within three standard deviations, time;
- `stress`: the stress suite with the nominal arm as its file says, and as it was identified;
- `solvers`: the semidefinite program beside log-Cholesky parameters, on the same logs.

Tables go into docs/identify.md.
"""

from __future__ import annotations

import sys
import time
from dataclasses import replace

import numpy as np
import pinocchio as pin
from scipy.optimize import least_squares

import fotsmc_pin as fp
from fotsmc_pin.arms.drive_size import drive_size
from fotsmc_pin.control import CONTROLLERS
from fotsmc_pin.control.model_terms import ModelTerms
from fotsmc_pin.evaluation.stress.cases import chosen_cases
from fotsmc_pin.evaluation.stress.judging import run_row
from fotsmc_pin.evaluation.stress.suite import law_maker
from fotsmc_pin.identification import consistent as sdp
from fotsmc_pin.identification.base_parameters import base_of
from fotsmc_pin.identification.filtering import chosen_width, joint_positions, smoothed
from fotsmc_pin.identification.fit import fit
from fotsmc_pin.identification.prior import body_sizes, nominal_belief
from fotsmc_pin.identification.regressor import Parameters, equations
from tests.identification import hidden

SEEDS = (0, 1)
CASE = "sine raw"
UNTOLD = ", friction not told"


def show(*cells):
    """Print a row of a table as soon as it is known."""
    sys.stdout.write("| " + " | ".join(cells) + " |\n")
    sys.stdout.flush()


def theta_of(arm):
    bodies = [body.toDynamicParameters() for body in [*arm.model.inertias][1:]]
    return np.concatenate([*bodies, arm.armature, arm.damping, arm.friction])


def excited(name, true, seed, law=None):
    """Return the log of 30 s of excitation in closed loop."""
    nominal = fp.load_arm(name)
    motion = fp.references.Excitation(nominal, seed=seed)
    return hidden.measured(hidden.run(name, true, motion, motion.duration, law), seed)


def plants(names):
    show(
        "arm",
        "seed",
        "torque error / noise",
        "averaged",
        "nominal averaged",
        "base parameters in 3 σ",
        "RMS of error / σ",
        "possible",
        "time (processor) [s]",
    )
    for name in names:
        nominal = fp.load_arm(name)
        for seed in SEEDS:
            true = hidden.hidden_plant(nominal, seed)
            log = excited(name, true, seed)
            other = hidden.run(name, true, hidden.swings(nominal, seed + 50, duration=10.0), 10.0)
            started, processor = time.perf_counter(), time.process_time()
            result = fp.identify([log], nominal)
            took, worked = time.perf_counter() - started, time.process_time() - processor
            result = fp.identify([log], nominal, validate=[hidden.measured(other, seed + 1)])
            (check,) = result.validation
            noise = hidden.TORQUE_NOISE * drive_size(true)
            average = noise * np.sqrt(hidden.DT / (2.0 * np.sqrt(np.pi) * 0.02))
            base = base_of(nominal, Parameters(nominal.nv)).matrix
            rows = result.base_parameters
            off = [
                (row.value - truth) / row.deviation
                for row, truth in zip(rows, base @ theta_of(true), strict=True)
            ]
            possible = all(
                sdp.can_exist(body.toDynamicParameters())
                for body in [*result.arm.model.inertias][1:]
            )
            cells = (
                name,
                f"{seed}",
                f"{np.max(check.error / noise):.2f}",
                f"{np.max(check.averaged_error / average):.2f}",
                f"{np.max(check.averaged_nominal_error / average):.0f}",
                f"{np.count_nonzero(np.abs(off) < 3)} of {len(off)}",
                f"{np.sqrt(np.mean(np.square(off))):.2f}",
                "yes" if possible else "no",
                f"{took:.1f} ({worked:.1f})",
            )
            show(*cells)


def untold(make):
    """Return a maker of the same law, which is not told the friction of its arm."""

    def made(arm, dt):
        law = make(arm, dt)
        law.use_terms(ModelTerms(arm.model))
        return law

    return made


def stress(names, laws=None):
    show("arm", "law", "nominal [mrad]", "identified [mrad]", "variation before", "after")
    (case,) = chosen_cases(CASE)
    makers = {law.__name__: law_maker(law) for law in CONTROLLERS.values()}
    makers |= {f"{name}{UNTOLD}": untold(make) for name, make in makers.items()}
    for name in names:
        arm = fp.load_arm(name)
        scenario = case.scenario_of(arm)
        # The robot's own controller followed the motion; ours is the one to be improved.
        motion = fp.references.Excitation(arm)
        log = hidden.calculated(scenario.true, motion, duration=motion.duration, dt=2e-3)
        result = fp.identify([log], scenario.arm)
        known = replace(scenario, arm=result.arm)
        rows = {}
        for label, make in makers.items():
            if laws and label not in laws:
                continue
            if label.endswith(UNTOLD):  # The nominal arm has none: the run is that before.
                before = rows[label.removesuffix(UNTOLD)]
            else:
                before = run_row(scenario, make(scenario.arm, scenario.dt), label)
            rows[label] = before
            after = run_row(known, make(known.arm, known.dt), label)
            show(
                name,
                label,
                f"{1e3 * before.tail_rms_error:.3g}",
                f"{1e3 * after.tail_rms_error:.3g}",
                f"{before.torque_variation:.3g}",
                f"{after.torque_variation:.3g}",
            )


def solvers(names):
    show("arm", "SDP: half χ²", "[ms]", "log-Cholesky", "[ms]", "evaluations", "impossible before")
    for name in names:
        nominal = fp.load_arm(name)
        true = hidden.hidden_plant(nominal, 0)
        log = hidden.calculated(true, hidden.swings(nominal, 0), 0)
        parameters = Parameters(nominal.nv)
        piece = smoothed(log.t, joint_positions(nominal, log.q), log.tau)
        system = equations(nominal, piece, parameters, chosen_width([piece]), 0.05)
        belief, sizes = nominal_belief(nominal, parameters), body_sizes(nominal)
        linear = fit([system], belief)
        to_belief = np.linalg.inv(linear.factor)
        precision = to_belief.T @ linear.precision @ to_belief

        def misfit(theta, linear=linear, precision=precision):
            away = theta - linear.theta
            return 0.5 * away @ precision @ away

        started = time.process_time()
        ours = sdp.consistent(linear, parameters, belief.mean, sizes)
        middle = time.process_time()
        theirs, evaluations = log_cholesky(linear, precision, parameters, belief.mean)
        bodies = [linear.theta[parameters.body(k)] for k in range(nominal.nv)]
        show(
            name,
            f"{misfit(ours):.3g}",
            f"{1e3 * (middle - started):.0f}",
            f"{misfit(theirs):.3g}",
            f"{1e3 * (time.process_time() - middle):.0f}",
            f"{evaluations}",
            f"{sum(not sdp.can_exist(body) for body in bodies)} of {nominal.nv}",
        )


def log_cholesky(linear, precision, parameters, start):
    """Return the same fit in log-Cholesky parameters, by SciPy with the analytic Jacobian."""
    bodies = parameters.joints
    weight = np.linalg.cholesky(precision).T
    lower = np.full(parameters.size, -np.inf)
    lower[10 * bodies :] = 0.0
    first = np.maximum(linear.theta, 1e-9)
    for k in range(bodies):
        first[parameters.body(k)] = to_log_cholesky(start[parameters.body(k)])

    def theta_at(phi):
        theta = phi.copy()
        for k in range(bodies):
            place = parameters.body(k)
            theta[place] = pin.LogCholeskyParameters(phi[place]).toDynamicParameters()
        return theta

    def slope(phi):
        table = weight.copy()
        for k in range(bodies):
            place = parameters.body(k)
            jacobian = pin.LogCholeskyParameters(phi[place]).calculateJacobian()
            table[:, place] = weight[:, place] @ jacobian
        return table

    with np.errstate(all="ignore"):
        found = least_squares(
            lambda phi: np.nan_to_num(weight @ (theta_at(phi) - linear.theta), nan=1e6),
            first,
            slope,
            bounds=(lower, np.full(parameters.size, np.inf)),
            x_scale="jac",
            max_nfev=300,
        )
    return theta_at(found.x), found.nfev


def to_log_cholesky(dynamic):
    """Return the log-Cholesky parameters (10,) of a body that can exist."""
    pseudo = sdp.pseudo_inertia(dynamic)
    # Cholesky's factor of the matrix read backwards, read backwards, is the upper one.
    upper = np.linalg.cholesky(pseudo[::-1, ::-1])[::-1, ::-1]
    alpha = np.log(upper[3, 3])
    upper = upper / upper[3, 3]
    above = (upper[0, 1], upper[1, 2], upper[0, 2], *upper[:3, 3])
    return np.array([alpha, *np.log(np.diag(upper)[:3]), *above])


TABLES = {"plants": plants, "stress": stress, "solvers": solvers}

if __name__ == "__main__":
    what, *names = sys.argv[1:]
    TABLES[what](names or hidden.ARMS)
