"""Recordings of every law, short and rough, and the compiled C of each."""

import warnings
from functools import cache

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control import CONTROLLERS, PaperConditionWarning
from fotsmc_pin.references import Sinusoid

from .compiled_c import CompiledC, LearningC, Logged

DT = 1e-3
CASES = [(law, [*law.presets][-1]) for law in CONTROLLERS.values()]
CASES += [(CONTROLLERS[name], "sign") for name in ("SuperTwistingSMC", "FractionalSwitchingSMC")]
CASES += [(CONTROLLERS["AdaptiveFONFTSM"], "paper")]
ARMS = ("two_link", "kinova", "panda")
"""Two joints, continuous joints, seven joints; the laws take turns."""


@cache
def arm_named(name):
    return fp.load_arm(name)


def make(law, arm, preset=None, **gains):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PaperConditionWarning)
        return law(arm, DT, preset=preset, **gains)


def rough_run(controller, ticks=260, seed=0):
    """Drive a controller through a motion with noise, jumps, saturation and measured periods."""
    arm, rng = controller.arm, np.random.default_rng(seed)
    reference = Sinusoid.inside_limits(arm, ramp=0.1)
    log = Logged(controller)
    log.reset()
    e, e_dot = rng.normal(0.0, 0.05, arm.nv), np.zeros(arm.nv)
    t = 0.0
    for k in range(ticks):
        measured = k % 5 in (1, 2)
        dt = DT * rng.uniform(0.6, 1.6) if measured else None
        t += DT if dt is None else dt
        q_d, v_d, a_d = reference(t)
        if k == ticks // 2:
            e, e_dot = rng.normal(0.0, 0.5, arm.nv), rng.normal(0.0, 1.0, arm.nv)
        e = 0.98 * e + 1e-5 * rng.normal(size=arm.nv)
        e_dot = 0.97 * e_dot + 1e-3 * rng.normal(size=arm.nv) - 0.2 * e
        log.update(arm.integrate(q_d, e), v_d + e_dot, q_d, v_d, a_d, dt)
    return log.inputs


@pytest.fixture(scope="session")
def compiled(tmp_path_factory):
    """Return the compiled C of a controller, made once."""
    made = {}

    def compiled(controller, **options):
        guarded = isinstance(controller, fp.Safeguard)
        inner = controller.controller if guarded else controller
        more = ()
        if guarded:
            more = (controller._lead.duration, controller.stop_ramp, controller.compensates)
        learns = isinstance(inner, fp.ModelLearning)
        if learns:
            more += (inner._in_loop, inner._feeds, inner.prior.stribeck)
        key = (repr(inner), guarded, *more, *options.items())
        if key not in made:
            kind = LearningC if learns else CompiledC
            made[key] = kind(controller, tmp_path_factory.mktemp("c"), **options)
        made[key].init()
        return made[key]

    return compiled


def worst(tau, inputs):
    """Return the largest error of a torque vector over the size of the vector."""
    size = np.linalg.norm(inputs.tau, axis=1)
    return float((np.linalg.norm(tau - inputs.tau, axis=1) / np.maximum(size, 1e-9)).max())
