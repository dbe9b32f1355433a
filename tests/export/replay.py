"""Every law in C against Python, tick by tick, over the stress suite and the two-link case.

`python -m tests.export.replay [ARM...] [--laws LAW...] [--duration SECONDS]` runs each case of the
stress suite in Python, repeats all its ticks in C with the same numbers, and prints for each law
and arm the largest error of a torque vector over its size and over the arm's largest torque, and
how many ticks passed before the first error above 1e-12.
"""

import argparse
import tempfile
import warnings

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.control import CONTROLLERS
from fotsmc_pin.evaluation.stress.cases import chosen_cases
from fotsmc_pin.paper import two_link

from .compiled_c import STRICT, CompiledC, Logged

EXACT = 1e-12
ARMS = ("two_link", "panda", "ur3", "ur5", "ur10", "kinova", "xarm7", "z1", "so100", "asr_twodof")


def cases_of(name, duration):
    """Return what to run with an arm: name, nominal arm, period and a function that runs."""
    arm = fp.load_arm(name)
    if name == "two_link":
        seconds = 10.0 if duration is None else duration
        yield "paper", two_link.nominal_arm(), 1e-3, lambda c: two_link.run(c, duration=seconds)
    for case in chosen_cases("all"):
        scenario = case.scenario_of(arm, duration=duration)
        yield case.label, scenario.arm, scenario.dt, scenario.run


def compare(law, preset, arm, dt, run):
    """Return ticks, error over the vector, error over the largest torque, first tick beyond."""
    log = Logged(law(arm, dt, preset=preset))
    try:
        run(log)
    except fp.errors.FotsmcError as error:
        if not log.rows:
            return f"did not run: {error}"
    inputs = log.inputs
    with tempfile.TemporaryDirectory() as folder:
        tau, status = CompiledC(log.law, folder, flags=STRICT).replay(inputs)
    size = np.linalg.norm(inputs.tau, axis=1)
    error = np.linalg.norm(tau - inputs.tau, axis=1)
    relative = error / np.maximum(size, 1e-300)
    beyond = np.flatnonzero(relative > EXACT)
    first = beyond[0] if beyond.size else "-"
    bad = f", statuses {set(status.tolist())}" if status.any() else ""
    peak = (error / size.max()).max()
    return f"{len(size)} ticks, {relative.max():.1e}, {peak:.1e}, {first}{bad}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("arms", nargs="*", default=ARMS)
    parser.add_argument("--laws", nargs="*", default=[*CONTROLLERS])
    parser.add_argument("--duration", type=float)
    chosen = parser.parse_args()
    warnings.simplefilter("ignore")
    print("arm, case, law, preset: ticks, error over vector, over largest torque, first beyond")
    for name in chosen.arms:
        for label, arm, dt, run in cases_of(name, chosen.duration):
            for law in (CONTROLLERS[word] for word in chosen.laws):
                for preset in law.presets:
                    told = compare(law, preset, arm, dt, run)
                    print(f"{name}, {label}, {law.__name__}, {preset}: {told}", flush=True)


if __name__ == "__main__":
    main()
