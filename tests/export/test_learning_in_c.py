"""What learns in C learns what Python's does: the same torque, from models of its own."""

import subprocess

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import CONTROLLERS
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.learning import Prior
from fotsmc_pin.learning.estimator import WINDOW
from fotsmc_pin.references import Sinusoid

from .compiled_c import Logged, pointers
from .conftest import DT, arm_named, rough_run, worst

EXACT = 1e-12
OK, BAD_Q, BAD_MODEL, TOO_LATE = 0, 1, 7, 9
CASES = {
    "learnt model": ("RobustFONFTSM", "two_link", {}),
    "continuous joints": ("AdaptiveFONFTSM", "kinova", {"delay": 2}),
    "friction alone": ("TDEFONTSM", "two_link", {"prior": Prior(stribeck=0.3), "delay": 0}),
    "nominal in the loop": ("ComputedTorque", "two_link", {"in_loop": False}),
    "nothing used": ("LinearSMC", "two_link", {"in_loop": False, "feed_forward": False}),
    "seven joints": pytest.param(
        *("RobustFONFTSM", "panda", {"prior": Prior(stribeck=0.3)}), marks=pytest.mark.long
    ),
}


def learner(name="RobustFONFTSM", arm="two_link", **options):
    law = CONTROLLERS[name]
    bare = law(arm_named(arm), DT, preset=[*law.presets][-1])
    return fp.ModelLearning(bare, bears=(0.3, 3.0), **options)


@pytest.mark.parametrize(("name", "arm", "options"), CASES.values(), ids=CASES)
def test_it_learns_what_pythons_does(name, arm, options, compiled):
    controller = learner(name, arm, **options)
    inputs = rough_run(controller)
    c = compiled(controller)
    tau, status = c.follow(inputs)
    assert not status.any()
    assert worst(tau, inputs) < EXACT
    links, armature = c.believe()
    first = controller._bodies[: controller.arm.nv]
    assert np.abs(controller._written - first).max() > 1e-3
    assert np.allclose(links, controller._written, rtol=1e-9, atol=1e-12)
    assert np.allclose(armature, controller._terms.learned.armature, rtol=1e-9, atol=1e-12)
    c.reset()
    assert c.follow(inputs)[0].tobytes() == tau.tobytes()


def test_what_is_due_is_asked_for_and_needed(compiled):
    controller = learner()
    inputs = rough_run(controller, ticks=20)
    c = compiled(controller)
    rows = zip(inputs.q, inputs.v, inputs.q_d, inputs.v_d, inputs.a_d, inputs.dt, strict=True)
    due, tau = [], np.zeros(2)
    c.believe()
    for k, (*row, dt) in enumerate(rows):
        regressor, model = c.regressor(), c.terms(*row[:2], *row[3:])
        due.append(regressor is not None)
        if due[-1]:
            before = bytes(c.state)
            last, status = c.update(*row, *model, dt)
            assert (status, bytes(c.state)) == (BAD_MODEL, before)
            assert np.array_equal(last, tau)
            for bad in (np.nan, np.inf, 1e21):
                assert c.give(c.state, *pointers(np.where(regressor == 0.0, bad, 0.0))) == BAD_MODEL
                assert bytes(c.state) == before
            assert c.give(c.state, *pointers(regressor)) == OK
            assert c.regressor() is None
            before = bytes(c.state)
            blind = [np.full_like(row[0], np.nan), *row[1:]]
            assert c.update(*blind, *model, dt)[1] == BAD_Q
            assert bytes(c.state) == before
        tau, status = c.update(*row, *model, dt)
        assert status == OK
        assert np.linalg.norm(tau - inputs.tau[k]) < EXACT * np.linalg.norm(inputs.tau[k])
        c.believe()
    assert due == [bool(k) and k % WINDOW == 0 for k in range(20)]


@pytest.mark.parametrize("law", ["RobustFONFTSM", "TDEFONTSM"])
@pytest.mark.parametrize("stops", [False, True])
def test_a_safeguard_around_it(stops, law, compiled):
    """It learns from the torque that acts, limited in its rate, and so does the law observe it."""
    options = {"soft_start": 0.05, "torque_rate": 400.0, "stop_ramp": 0.05}
    guard = fp.Safeguard(learner(law), **options)
    reference, log = Sinusoid.inside_limits(guard.arm, ramp=0.1), Logged(guard)
    log.reset()
    for k in range(120):
        q_d, v_d, a_d = reference(k * DT)
        late = 0.05 if stops and k == 80 else None
        log.update(q_d + 0.01 * np.cos(0.1 * k), v_d + 0.01, q_d, v_d, a_d, late)
    c = compiled(fp.Safeguard(learner(law), **options))
    inputs = log.inputs
    tau, status = c.follow(inputs)
    first = 80 if stops else 120
    assert not status[:first].any()
    assert set(status[first:]) == ({TOO_LATE} if stops else set())
    assert worst(tau, inputs) < EXACT


def test_the_learner_is_small_and_asks_for_no_memory(compiled):
    c = compiled(learner("AdaptiveFONFTSM", "kinova", delay=2))
    sizes = subprocess.run(["size", c.object], check=True, capture_output=True, text=True).stdout
    text, data, bss = (int(word) for word in sizes.splitlines()[1].split()[:3])
    assert text < 48 * 1024
    assert data == bss == 0
    assert c.size < 48 * 1024
    symbols = subprocess.run(["nm", c.object], check=True, capture_output=True, text=True).stdout
    asked = {line.split()[-1] for line in symbols.splitlines() if " U " in line}
    assert not any("alloc" in name for name in asked)
    public = {line.split()[-1] for line in symbols.splitlines() if " T " in line}
    names = ("init", "reset", "update", "regressor_due", "give_regressor", "learned_model")
    assert public == {f"fotsmc_kinova_{name}" for name in names}


def test_the_header_names_each_parameter_and_its_unit(compiled):
    controller = learner("AdaptiveFONFTSM", "kinova", delay=2)
    text = compiled(controller).header.read_text("utf-8")
    for k, row in enumerate(controller.estimates()):
        assert f" {k} {row.group} {row.of}" in text
    for words in (
        "that learns its model",
        "computeJointTorqueRegressor",
        "[kg*m^2]",
        "M and h are",
    ):
        assert words in text


def test_what_cannot_be_exported_is_refused_by_name(tmp_path):
    with pytest.raises(ArgumentError, match=r"RobustFONFTSM \+ learning.*double precision"):
        fp.export_c(learner(), tmp_path, single=True)
    observed = fp.SpringObserver(learner().controller, 1e4)
    with pytest.raises(ArgumentError, match="SpringObserver"):
        fp.export_c(fp.Safeguard(observed), tmp_path)
    assert not any(tmp_path.iterdir())
