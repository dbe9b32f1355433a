"""`progress=` means the same everywhere: silent unless asked, and then on standard error alone."""

import inspect
import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest

import fotsmc_pin as fp
from fotsmc_pin.evaluation.stress import ablate, best_pid, run_random_scenarios, stress_scenario
from fotsmc_pin.evaluation.stress.judging import run_row
from fotsmc_pin.evaluation.stress.scenario import DT
from fotsmc_pin.evaluation.tuning import Span, minimize, tune
from fotsmc_pin.paper import two_link
from fotsmc_pin.paper.reproduce import reproduce
from fotsmc_pin.progress import reporting

SHORT = 0.02


def law(arm):
    return fp.ComputedTorque(arm, DT)


def hold(arm, progress):
    fp.simulate(arm, law(arm), fp.references.Hold(arm), 1.0, progress=progress)


def ablation(arm, progress):
    scenario = stress_scenario(arm)
    ablate(lambda law, label: run_row(scenario, law, label, SHORT), arm, DT, progress=progress)


CALLS = {
    "simulate": hold,
    "study": lambda arm, p: fp.study(cost, grid={"x": [1.0, 2.0]}, jobs=1, progress=p),
    "stress": lambda arm, p: fp.stress([arm], ["LinearSMC"], duration=SHORT, progress=p),
    "run_random_scenarios": lambda arm, p: run_random_scenarios(arm, 2, duration=SHORT, progress=p),
    "ablate": ablation,
    "best_pid": lambda arm, p: best_pid(stress_scenario(arm), trials=2, duration=SHORT, progress=p),
    "minimize": lambda arm, p: minimize(
        lambda x: x["x"],
        {"x": Span(low=0.0, high=1.0, logarithmic=False)},
        start={"x": 0.5},
        trials=3,
        progress=p,
    ),
    "two_link.run": lambda arm, p: two_link.run(duration=SHORT, progress=p),
}


def cost(parameters, seed):
    return {"tail_rms_error": parameters["x"]}


@pytest.mark.parametrize("name", sorted(CALLS))
def test_a_callable_is_told_the_fraction_up_to_one_and_all_is_quiet(name, two_link_arm, capfd):
    told = []
    CALLS[name](two_link_arm, told.append)
    CALLS[name](two_link_arm, False)
    assert told == sorted(told)
    assert told[-1] == 1.0
    assert capfd.readouterr() == ("", "")


@pytest.fixture(scope="module")
def two_link_arm():
    return fp.load_arm("two_link")


@pytest.mark.parametrize(
    "function",
    [
        *(fp.simulate, fp.study, fp.stress, run_random_scenarios, ablate, best_pid),
        *(minimize, tune, reproduce, two_link.run),
    ],
)
def test_every_long_call_declares_it_alike(function):
    parameter = inspect.signature(function).parameters["progress"]
    assert (parameter.annotation, parameter.default) == ("Progress", False)


def test_the_fraction_is_dropped_when_nobody_asks():
    with reporting(False, "nothing") as report:
        assert report(0.5) is None


def test_a_bar_shows_on_the_terminal_of_standard_error_and_leaves_standard_output_alone():
    program = (
        "import fotsmc_pin as fp\n"
        "arm = fp.load_arm('two_link')\n"
        "def reference(t):\n"
        "    if t == 0.5: print('said by the user', flush=True)\n"
        "    return arm.neutral, arm.neutral, arm.neutral\n"
        "fp.simulate(arm, fp.ComputedTorque(arm, 1e-3), reference, 1.0, progress=True)\n"
        "print('done')\n"
    )
    ours, theirs = pty.openpty()
    environment = os.environ | {"PYTHONPATH": str(Path(fp.__file__).parents[1]), "TERM": "xterm"}
    command = [sys.executable, "-c", program]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=theirs, env=environment) as run:
        os.close(theirs)
        shown = b""
        while True:
            try:
                piece = os.read(ours, 4096)
            except OSError:  # The other end is closed.
                break
            if not piece:
                break
            shown += piece
        printed = run.stdout.read().decode()
    os.close(ours)
    assert run.returncode == 0, shown
    assert "ComputedTorque, two_link" in shown.decode()
    assert printed == "said by the user\ndone\n"


def test_a_bar_writes_nothing_into_a_log_file(two_link_arm, capfd):
    hold(two_link_arm, True)
    assert capfd.readouterr() == ("", "")
