"""`simulate`: the closed loop of reference, controller and plant, one tick after the other."""

from __future__ import annotations

import platform
import time
from functools import cache, partial
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.arms import demand_arm
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.progress import reporting
from fotsmc_pin.simulation.changing_plant import ChangingPlant
from fotsmc_pin.simulation.disturbances import sorted_out
from fotsmc_pin.simulation.events import checked_events
from fotsmc_pin.simulation.faults import NOTHING, Tick, divergence, fault_of
from fotsmc_pin.simulation.interrupt import kept_on_interrupt
from fotsmc_pin.simulation.memory import demand_memory
from fotsmc_pin.simulation.plant import Plant
from fotsmc_pin.simulation.pose_values import first_pose, follows_poses, pose_values, start_of
from fotsmc_pin.simulation.recorder import Recorder
from fotsmc_pin.simulation.reference_values import reference_values
from fotsmc_pin.simulation.sensors import torque_reader

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.progress import Progress
    from fotsmc_pin.simulation.disturbances import Disturbances
    from fotsmc_pin.simulation.recording import Recording
    from fotsmc_pin.types import Actuator, Array, PoseReference, Reference, Sensor


CHUNK = 256
"""Ticks whose reference is evaluated at once."""


@runtime_checkable
class Law(Protocol):
    """What the simulation uses of a controller."""

    dt: float

    def update(
        self, q: Array, v: Array, q_d: Any, v_d: Any, a_d: Any, /, dt: float | None = None
    ) -> Array:
        """Return the torque of one tick."""
        ...

    def reset(self) -> None:
        """Forget every tick."""
        ...


def simulate(
    arm: Arm,
    controller: Law,
    reference: Reference | PoseReference,
    duration: float,
    *,
    q0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    disturbance: Disturbances = None,
    events: Mapping[float, Arm] | None = None,
    sensor: Sensor | None = None,
    actuator: Actuator | None = None,
    substeps: int = 1,
    integrator: str | None = None,
    encoder: str = "motor",
    end_stops: bool = False,
    record_every: int = 1,
    jitter: float = 0.0,
    seed: int = 0,
    progress: Progress = False,
) -> Recording:
    """Run `controller` against the true `arm` from time 0.

    Each tick of `controller.dt` the state is measured, the controller updated and its torque held
    until the next tick (zero-order hold). The controller, the sensor and the actuator are reset at
    the start.

    Args:
        arm: the true arm; its effort limits, friction and damping act.
        controller: anything with `dt`, `update` and `reset`; its `signals`, if any, are
            recorded, and the metadata take its name from its `label`, and from its `about` what
            else it says of itself.
        reference: `t -> (q_d, v_d, a_d)`, shapes (nq,), (nv,), (nv,); a function of time alone,
            which is evaluated for some ticks ahead, unless it `is_live`. Where it has a method `at`
            that takes many times (N,) and returns (N, nq), (N, nv), (N, nv), that is called. For a
            controller that follows poses, such as `TaskSpace`, it is `t -> (T, V, A)`.
        duration: simulated time [s].
        q0: configuration at the start (nq,); the reference's by default. Of poses it is that
            reference's `q_start`, or has to be given.
        v0: velocity at the start (nv,); the reference's by default.
        disturbance: `t -> (nv,)`, torque added at the joints [N·m, N], evaluated at every stage; or
            a `Wrench`, a push at a frame; or a list of both, which add up.
        events: `{time: arm}`, what the plant becomes at these times [s], such as `perturb(arm,
            payload=2.0)` where it picks something up: dynamics, friction, springs and rotors change
            at the first step of the integrator at or after the time. The arms have the joints and
            effort limits of `arm`. Position and velocity go on without a step: a payload is taken
            on at the speed that the tool has. At another speed there would be an impact, which is
            the grasp's affair and not the payload's, and an arm grasps at the speed of the thing.
        sensor: `(t, q, v) -> (q, v)`, from the true state to what the controller measures, which
            the recording keeps as `q_measured` and `v_measured`. Where it, or a part of a `Chain`,
            has a `measure_torque(t, tau)`, such as `TorqueSensor`, what that returns at each tick
            is kept as `tau_measured`; no controller is told.
        actuator: `(t, tau) -> tau`, from the controller's torque to what the drives apply.
        substeps: integration steps in a tick.
        integrator: "rk4" or "semi-implicit"; by default "rk4", unless the arm has Coulomb friction
            or damping too strong for explicit steps.
        encoder: side of an elastic joint's spring on which position and speed are measured, "motor"
            or "link"; `sensor` is given what the encoders see. On a rigid joint they are the same.
        end_stops: True gives each joint a stiff, damped stop at both ends of its range; the signal
            "end_stop" is the torque of the stops. Without, joints turn on beyond their ranges.
        record_every: ticks from one recorded row to the next.
        jitter: share of a period by which a tick may come early or late, below 0.5; above 0 the
            controller is told the measured period, as `update(..., dt=...)`.
        seed: of the jitter.
        progress: True shows a bar on standard error; a callable is told the fraction done.

    Returns:
        The recording. Its last row is at `duration`, or the last recorded tick before.

    Raises:
        ArgumentError: an argument is unusable; or the reference, disturbance, sensor, controller or
            actuator returned in mid-run what is not finite or has the wrong shape. It names the
            part and the time.
        UrdfError: a joint of the arm moves no inertia.
        DivergenceError: a joint left every reasonable bound; it says which one left first, and
            carries the recording so far.
        RunInterrupted: Ctrl-C; a `KeyboardInterrupt` that carries the recording so far.
    """
    demand_arm(arm)
    checks.instance("controller", controller, Law, "give a controller, as a law's class makes it")
    dt = checks.finite_number("controller.dt", controller.dt, above=0.0)
    checks.choice("encoder", encoder, ("motor", "link"))
    duration = checks.finite_number("duration", duration, at_least=dt)
    stride = checks.count("record_every", record_every)
    demand_memory(arm, duration, dt, stride)
    poses = follows_poses(controller)
    checked = first_pose if poses else _checked_reference
    q_start, v_start = checked(arm, reference)[:2]
    push, wrenches = sorted_out(arm, disturbance, duration)
    changes = checked_events(arm, events, duration)
    build = partial(ChangingPlant, events=changes) if changes else Plant
    plant = build(
        arm,
        start_of(arm, q0, q_start),
        v_start if v0 is None else checks.finite_vector("v0", v0, arm.nv),
        dt=dt,
        substeps=substeps,
        integrator=integrator,
        disturbance=push,
        wrenches=wrenches,
        end_stops=end_stops,
    )
    for part in (controller, sensor, actuator):
        reset = getattr(part, "reset", None)
        if reset is not None:
            reset()

    ticks = round(duration / dt) + 1
    clock = _clock(dt, ticks, jitter, seed)
    read_torque = torque_reader(sensor)
    readings: tuple[str, ...] = ("q_measured", "v_measured") if sensor is not None else ()
    readings += ("tau_measured",) if read_torque is not None else ()
    recorder = Recorder(
        arm, plant, controller, instants=clock[:-1], stride=stride, readings=readings
    )
    on_motors, shapes = plant.is_elastic and encoder == "motor", ((arm.nq,), (arm.nv,))
    measured = commanded = driven = felt = NOTHING
    read: tuple[Array, ...] = ()
    lost = -1
    started = time.perf_counter()

    def recording() -> Recording:
        options: dict[str, Any] = {
            "duration": duration,
            "substeps": substeps,
            "integrator": plant.integrator,
        }
        options["gravity"] = arm.base_gravity.tolist()
        if plant.is_elastic:
            options["encoder"] = encoder
        took = time.perf_counter() - started
        told = run_metadata(controller, reference, options, took)
        return recorder.recording(told, events=changes, wrenches=wrenches)

    title = f"{_label(controller)}, {arm.name}"
    with reporting(progress, title) as report, kept_on_interrupt(recording):
        ahead = 1 if getattr(reference, "is_live", False) else CHUNK
        for first in range(0, ticks, ahead):
            report(first / ticks)
            instants = clock[first : min(first + ahead, ticks)]
            wanted: Any
            if poses:
                wanted = pose_values(reference, instants)
            else:
                wanted = reference_values(reference, instants, arm)
                recorder.write_reference(first, *wanted[:2])
            rows = zip(instants.tolist(), *wanted, strict=True)
            for k, (t, q_d, v_d, a_d) in enumerate(rows, first):
                period = dt if jitter == 0.0 else clock[k + 1] - t
                try:
                    q, v = plant.encoders() if on_motors else (plant.q, plant.v)
                    if sensor is not None:
                        measured = sensor(t, q, v)
                        q, v = measured
                        if np.shape(q) != shapes[0] or np.shape(v) != shapes[1]:
                            raise ValueError(measured)
                        read = (q, v)
                    if jitter > 0.0 and k > 0:
                        tau = controller.update(q, v, q_d, v_d, a_d, dt=t - clock[k - 1])
                    else:
                        tau = controller.update(q, v, q_d, v_d, a_d)
                    commanded = tau
                    if actuator is not None:
                        driven = tau = actuator(t, tau)
                    plant.load(t, tau)
                    if read_torque is not None:
                        felt = read_torque(t, plant.tau)
                        if np.shape(felt) != shapes[1]:
                            raise ValueError(felt)
                        read = (q, v, felt)
                    if k % stride == 0:
                        recorder.write_row(*read)
                    lost = plant.hold(t, period)
                    if lost < 0:
                        continue
                    cause = None
                except (TypeError, ValueError) as error:
                    cause = error
                tick = Tick(t, (q_d, v_d, a_d), measured, commanded, driven, felt)
                fault = fault_of(tick, arm, push, plant.stage_times(t, period), poses=poses)
                if fault is not None:
                    raise fault from cause
                if cause is not None:
                    raise cause
                raise divergence(arm, recording(), t + period, lost, plant.v)
        report(1.0)
    return recording()


def _clock(dt: float, ticks: int, jitter: float, seed: int) -> Array:
    """Return the times of all ticks and of the end of the last one, (ticks + 1,) [s]."""
    clock = dt * np.arange(ticks + 1, dtype=np.float64)
    share = checks.finite_number("jitter", jitter, at_least=0.0, below=0.5)
    if share > 0.0:
        rng = np.random.default_rng(checks.count("seed", seed, at_least=0))
        clock[1:] += share * dt * rng.uniform(-1.0, 1.0, ticks)
    return clock


def _checked_reference(arm: Arm, reference: Reference) -> tuple[Array, Array, Array]:
    try:
        q_d, v_d, a_d = reference(0.0)
    except (TypeError, ValueError) as error:
        raise ArgumentError(
            "reference", reference, f"give a callable t -> (q_d, v_d, a_d); at t = 0: {error}"
        ) from error
    return (
        checks.finite_vector("reference q_d", q_d, arm.nq),
        checks.finite_vector("reference v_d", v_d, arm.nv),
        checks.finite_vector("reference a_d", a_d, arm.nv),
    )


def _label(controller: Law) -> str:
    """Return what a controller calls itself, or its class is called."""
    return str(getattr(controller, "label", type(controller).__name__))


def run_metadata(
    controller: Law, reference: Reference, options: dict[str, Any], took: float
) -> dict[str, Any]:
    """Return how a run is made, in plain data: law, gains, period, versions."""
    gains: Any = getattr(controller, "gains", None)
    return {
        "controller": _label(controller),
        "preset": getattr(controller, "preset", None),
        "gains": gains.as_dict() if hasattr(gains, "as_dict") else {},
        "nominal_arm": getattr(getattr(controller, "arm", None), "name", None),
        "dt": controller.dt,
        "reference": getattr(reference, "__name__", type(reference).__name__),
        **options,
        **getattr(controller, "about", {}),
        "wall_time": took,
        "versions": {
            "python": platform.python_version(),
            **_versions(),
        },
    }


@cache
def _versions() -> dict[str, str]:
    return {name: version(name) for name in ("fotsmc_pin", "pin", "numpy", "numba")}
