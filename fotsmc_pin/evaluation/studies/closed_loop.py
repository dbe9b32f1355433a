"""`ClosedLoop`: the run that most studies repeat, an arm under a controller that misjudges it."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, fields, replace
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.analysis import Summary, summarize
from fotsmc_pin.arms import Arm, load_arm, perturb
from fotsmc_pin.control import CONTROLLERS
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.learning import ModelLearning
from fotsmc_pin.references import Sinusoid
from fotsmc_pin.simulation import simulate

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from fotsmc_pin.control import Controller
    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.types import Reference


GAIN = "gains."
DELAY = 0
"""Ticks from a torque to the drive: it acts at once."""


@dataclass(frozen=True, kw_only=True)
class ClosedLoop:
    """One closed loop: `run(parameters, seed)` simulates it and returns its `Summary`.

    A study's parameters are names of these fields, or `gains.` and the name of a gain, and take
    their place. Perturbations speak `perturb`'s language: a number for the whole arm, or a
    `Uniform` or a mapping by link, drawn from the run's seed.

    Attributes:
        arm: the arm that the controller believes in, or its name.
        controller: name of the control law.
        preset: its set of gains; its first one by default.
        gains: single gains that differ from the preset.
        dt: period of a tick [s].
        duration: simulated time [s].
        substeps: integration steps in a tick.
        integrator: "rk4" or "semi-implicit"; by default what the damping bears.
        start_error: start error of every joint [rad, m].
        mass_scale: factor on the true masses and inertias.
        inertia_scale: factor on the true rotational inertias.
        com_shift: shift of the true centres of mass [m].
        payload: mass at the true tool frame [kg].
        friction: true Coulomb friction by joint [N·m, N]; the arm's own by default.
        damping: true viscous friction by joint [N·m·s/rad, N·s/m]; the arm's own by default.
        learn: whether the controller learns its model while the arm moves (`ModelLearning`).
        reference: makes the reference of an arm; sinusoids inside its limits by default.
    """

    arm: Arm | str
    controller: str = "RobustFONFTSM"
    preset: str | None = None
    gains: Mapping[str, Any] = field(default_factory=dict)
    dt: float = 1e-3
    duration: float = 10.0
    substeps: int = 1
    integrator: str | None = None
    start_error: float = 0.0
    mass_scale: Any = 1.0
    inertia_scale: Any = 1.0
    com_shift: Any = 0.0
    payload: Any = 0.0
    friction: Any = None
    damping: Any = None
    learn: bool = False
    reference: Callable[[Arm], Reference] = Sinusoid.inside_limits

    def __post_init__(self) -> None:
        """Refuse a controller or an arm that is none before a thousand runs do."""
        checks.instance("arm", self.arm, (Arm, str), "give an arm, or what load_arm takes")
        checks.choice("controller", self.controller, [*CONTROLLERS])

    def __call__(self, parameters: Mapping[str, Any], seed: int) -> Summary:
        """Return what the run with these parameters comes to."""
        return summarize(self.record(parameters, seed))

    def record(self, parameters: Mapping[str, Any], seed: int) -> Recording:
        """Return the whole run with these parameters: the same as the study saw, bit for bit.

        Raises:
            ArgumentError: an unknown parameter or an unusable value.
            DivergenceError: the simulation diverged.
        """
        return self.having(parameters)._record(seed)

    def having(self, parameters: Mapping[str, Any]) -> ClosedLoop:
        """Return the closed loop with these fields and gains in place of its own."""
        known = [f.name for f in fields(self)]
        gains = dict(self.gains)
        changed: dict[str, Any] = {}
        for name, value in parameters.items():
            if name.startswith(GAIN):
                gains[name.removeprefix(GAIN)] = value
            elif name in known:
                changed[name] = value
            else:
                near = get_close_matches(name, known, 1)
                hint = f"did you mean {near[0]}? " if near else ""
                remedy = f"{hint}the parameters are {', '.join(known)} and {GAIN}<name>"
                raise ArgumentError(name, value, remedy)
        return replace(self, **{"gains": gains, **changed})

    def check(self, parameters: Mapping[str, Any]) -> None:
        """Refuse parameters with which no run could start: names, gains, perturbations, numbers.

        Raises:
            ArgumentError: naming the parameter, its value and the remedy.
            ArmNotFoundError: an unknown arm.
        """
        loop = self.having(parameters)
        arm = loop._nominal
        dt = checks.finite_number("dt", loop.dt, above=0.0)
        checks.finite_number("duration", loop.duration, at_least=dt)
        checks.finite_number("start_error", loop.start_error)
        checks.count("substeps", loop.substeps)
        checks.instance("learn", loop.learn, bool, "give true or false")
        if loop.integrator is not None:
            checks.choice("integrator", loop.integrator, ("rk4", "semi-implicit"))
        law = CONTROLLERS[loop.controller]
        preset = checks.choice("preset", loop.preset or next(iter(law.presets)), [*law.presets])
        law.Gains.resolve(arm, dt, law.presets[preset], loop.gains)
        loop._true(arm, seed=0)

    @property
    def identity(self) -> str:
        """Everything that the outcome depends on, as text."""
        parts = {f.name: getattr(self, f.name) for f in fields(self)}
        arm, reference = self.arm, self.reference
        parts["arm"] = arm.to_dict() if isinstance(arm, Arm) else [arm, _arm(arm).urdf]
        parts["reference"] = getattr(reference, "__qualname__", repr(reference))
        return json.dumps(parts, sort_keys=True, default=repr)

    @property
    def _nominal(self) -> Arm:
        return self.arm if isinstance(self.arm, Arm) else _arm(self.arm)

    def _true(self, arm: Arm, seed: int) -> Arm:
        return perturb(
            arm,
            mass_scale=self.mass_scale,
            inertia_scale=self.inertia_scale,
            com_shift=self.com_shift,
            payload=self.payload,
            friction=self.friction,
            damping=self.damping,
            seed=seed,
        )

    def _record(self, seed: int) -> Recording:
        arm = self._nominal
        true = self._true(arm, seed)
        law = CONTROLLERS[self.controller](arm, self.dt, preset=self.preset, **self.gains)
        reference = _reference(self.reference, arm)
        q_start, _, _ = reference(0.0)
        return simulate(
            true,
            self._learning(law) if self.learn else law,
            reference,
            self.duration,
            q0=arm.integrate(q_start, np.full(arm.nv, self.start_error)),
            substeps=self.substeps,
            integrator=self.integrator,
        )

    def _learning(self, law: Controller) -> ModelLearning:
        """Let a law learn its model; what its loop bears is computed once for all draws."""
        gains = json.dumps(dict(self.gains), default=lambda value: np.asarray(value).tolist())
        bears = _bears(self._nominal, self.dt, self.controller, self.preset, gains)
        return ModelLearning(law, delay=DELAY, bears=bears)


@lru_cache(maxsize=8)
def _bears(
    arm: Arm, dt: float, controller: str, preset: str | None, gains: str
) -> tuple[float, float]:
    law = CONTROLLERS[controller](arm, dt, preset=preset, **json.loads(gains))
    return ModelLearning(law, delay=DELAY).bears


@lru_cache(maxsize=8)
def _reference(make: Callable[[Arm], Reference], arm: Arm) -> Reference:
    return make(arm)


def _arm(name: str) -> Arm:
    """Return the arm of this name or file; a file that was edited since is read again."""
    try:
        file = Path(name).stat()
    except OSError:
        return _loaded(name, None)
    return _loaded(name, (file.st_mtime_ns, file.st_size))


@lru_cache(maxsize=8)
def _loaded(name: str, state: tuple[int, int] | None) -> Arm:
    return load_arm(name)
