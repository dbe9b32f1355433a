"""Every law in C against Python, tick by tick, over the stress suite and the two-link case.

`python -m tests.export.replay [ARM...] [--laws LAW...] [--cases CASE...] [--duration SECONDS]
[--learn]` runs each case of the stress suite in Python, repeats all its ticks in C with the same
numbers, and prints for each run

- the largest error of a torque vector over its size, and over the run's largest torque;
- the same two for C against itself, where the last bit of every measurement and every entry of the
  model is changed at random: what rounding alone may do;
- in how many ticks the error over the vector is above 1e-12, the first of them, and the largest
  ratio of the error to the change by a last bit in these, both as the largest within ten ticks;

and at the end the worst of each law. With `--learn` the laws are in a `ModelLearning`, and the C
has the terms of the arm that it learns itself.
"""

import argparse
import copy
import tempfile
import time
import warnings

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.control import CONTROLLERS
from fotsmc_pin.evaluation.stress.cases import chosen_cases
from fotsmc_pin.paper import two_link

from .compiled_c import STRICT, CompiledC, Inputs, LearningC

EXACT = 1e-12
ARMS = ("two_link", "panda", "ur3", "ur5", "ur10", "kinova", "xarm7", "z1", "so100", "asr_twodof")
HEAD = (
    "arm, case, law, preset: ticks, error over vector, over largest torque; by a last bit over "
    "vector, over largest torque; ticks beyond, first, ratio there"
)


class Watched:
    """A controller that keeps what each of its ticks was given, the terms of its model included."""

    def __init__(self, law):
        self.law, self.dt, self.arm, self.rows = law, law.dt, law.arm, []
        self.bare = getattr(law, "controller", law)

    def __getattr__(self, name):
        return getattr(self.law, name)

    def reset(self):
        self.law.reset()
        self.rows.clear()

    def update(self, q, v, q_d, v_d, a_d, dt=None):
        tau = self.law.update(q, v, q_d, v_d, a_d, dt)
        terms = self.bare._terms
        given = (q, v, q_d, v_d, a_d, terms.M, terms.h)
        period = self.dt if dt is None else dt
        self.rows.append((*(np.array(x, dtype=float) for x in given), period, tau))
        return tau

    @property
    def inputs(self):
        *given, dt, tau = (np.array(column) for column in zip(*self.rows, strict=True))
        return Inputs(*given, given[-1], dt, tau)


class Compiler:
    """Compiles each exported program once."""

    def __init__(self):
        self._folder, self._made = tempfile.TemporaryDirectory(), {}

    def __call__(self, law):
        law.reset()
        bare = getattr(law, "controller", law)
        numbers = [*bare.effective_gains().as_dict().values(), *bare.state, law.arm.effort_limit]
        kind = CompiledC if law is bare else LearningC
        if kind is LearningC:
            numbers += [law._whole, law._beliefs, law._bodies]
        key = (type(bare), law.arm.name, law.dt, *(str(np.array(x).tolist()) for x in numbers))
        if key not in self._made:
            place = tempfile.mkdtemp(dir=self._folder.name)
            self._made[key] = kind(law, place, flags=STRICT)
        self._made[key].init()
        return self._made[key]


def by_a_last_bit(inputs):
    """Return inputs with the last bit of each measurement and entry of the model changed."""
    rng, changed = np.random.default_rng(0), copy.copy(inputs)
    for name in ("q", "v", "q_d", "v_d", "a_d", "M", "h"):
        numbers = getattr(inputs, name)
        towards = np.where(rng.random(numbers.shape) < 0.5, -np.inf, np.inf)
        setattr(changed, name, np.where(numbers != 0.0, np.nextafter(numbers, towards), 0.0))
    return changed


def cases_of(name, cases, duration):
    """Return what to run with an arm: name, nominal arm, period and a function that runs."""
    arm = fp.load_arm(name)
    if name == "two_link" and "all" in cases:
        seconds = 10.0 if duration is None else duration
        yield "paper", two_link.nominal_arm(), 1e-3, lambda c: two_link.run(c, duration=seconds)
    for case in chosen_cases(cases):
        if not case.suits(arm):
            continue
        scenario = case.scenario_of(arm)
        seconds = scenario.course.duration if duration is None else duration
        yield (
            case.label,
            scenario.arm,
            scenario.dt,
            lambda c, s=scenario, end=seconds: s.run(c, min(end, s.course.duration)),
        )


def compare(controller, run, compiled):
    """Return what is printed of a run."""
    log = Watched(controller)
    try:
        run(log)
    except fp.errors.FotsmcError as error:
        if not log.rows:
            return None, f"did not run: {error}"
    inputs = log.inputs
    c = compiled(log.law)
    repeat = c.follow if isinstance(c, LearningC) else c.replay
    tau, status = repeat(inputs)
    c.init()
    moved, _ = repeat(by_a_last_bit(inputs))
    size = np.linalg.norm(inputs.tau, axis=1)
    error, change = (np.linalg.norm(tau - x, axis=1) for x in (inputs.tau, moved))
    numbers = []
    for apart in (error, change):
        numbers += [(apart / np.maximum(size, 1e-300)).max(), (apart / size.max()).max()]
    beyond = np.flatnonzero(error > EXACT * size)
    first = beyond[0] if beyond.size else "-"
    ratio = 0.0
    if beyond.size:
        near = [
            np.lib.stride_tricks.sliding_window_view(np.pad(x, 10), 21).max(axis=1)
            for x in (error, change)
        ]
        ratio = (near[0][beyond] / np.maximum(near[1][beyond], 1e-300)).max()
    bad = f", statuses {set(status.tolist())}" if status.any() else ""
    shown = ", ".join(f"{x:.1e}" for x in numbers)
    told = f"{len(size)} ticks, {shown}; {beyond.size}, {first}, {ratio:.1f}{bad}"
    return (len(size), *numbers, beyond.size, ratio, status.any()), told


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("arms", nargs="*", default=ARMS)
    parser.add_argument("--laws", nargs="*", default=[*CONTROLLERS])
    parser.add_argument("--cases", nargs="*", default=["all"])
    parser.add_argument("--duration", type=float, help="longest time of a run [s]")
    parser.add_argument("--learn", action="store_true", help="with what learns the model")
    chosen = parser.parse_args()
    warnings.simplefilter("ignore")
    print(HEAD)
    compiled, began, found = Compiler(), time.perf_counter(), {}
    for name in chosen.arms:
        for label, arm, dt, run in cases_of(name, chosen.cases, chosen.duration):
            for law in (CONTROLLERS[word] for word in chosen.laws):
                for preset in law.presets:
                    controller = law(arm, dt, preset=preset)
                    if chosen.learn:
                        controller = fp.ModelLearning(controller)
                    numbers, told = compare(controller, run, compiled)
                    print(f"{name}, {label}, {law.__name__}, {preset}: {told}", flush=True)
                    if numbers:
                        found.setdefault(f"{law.__name__} {preset}", []).append(numbers)
    print(f"\nWorst of each law, after {time.perf_counter() - began:.0f} s:")
    for law, rows in found.items():
        ticks, *worst = np.array(rows, dtype=float).T
        vector, peak, bit, bit_peak, _, ratio, bad = (column.max() for column in worst)
        runs, beyond = len(rows), int((worst[0] > EXACT).sum())
        print(
            f"{law}: {runs} runs, {ticks.sum():.0f} ticks, {vector:.1e}, {peak:.1e}; {bit:.1e}, "
            f"{bit_peak:.1e}; {beyond} runs beyond, ratio {ratio:.1f}{', STATUS' * bool(bad)}"
        )


if __name__ == "__main__":
    main()
