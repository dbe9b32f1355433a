"""`simulate`: the closed loop of reference, controller and plant, one tick after the other."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.errors import ArgumentError, DivergenceError
from fotsmc_pin.simulation.plant import Plant
from fotsmc_pin.simulation.recording import Recording

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.simulation.plant import Disturbance

    Array = NDArray[np.float64]
    Reference = Callable[[float], tuple[Array, Array, Array]]
    Sensor = Callable[[float, Array, Array], tuple[Array, Array]]
    Actuator = Callable[[float, Array], Array]


class Law(Protocol):
    """All that the simulation knows of a controller."""

    dt: float

    def update(self, q: Array, v: Array, q_d: Array, v_d: Array, a_d: Array) -> Array:
        """Return the torque of one tick."""
        ...

    def reset(self) -> None:
        """Forget every tick."""
        ...


def simulate(
    arm: Arm,
    controller: Law,
    reference: Reference,
    duration: float,
    *,
    q0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    disturbance: Disturbance | None = None,
    sensor: Sensor | None = None,
    actuator: Actuator | None = None,
    substeps: int = 1,
    integrator: str = "rk4",
    record_every: int = 1,
    progress: bool | Callable[[float], None] = False,
) -> Recording:
    """Run `controller` against the true `arm` from time 0.

    Each tick of `controller.dt` the state is measured, the controller updated and its torque held
    until the next tick (zero-order hold). The controller, the sensor and the actuator are reset at
    the start.

    Args:
        arm: the true arm; its effort limits, friction and damping act.
        controller: anything with `dt`, `update` and `reset`; its `signals` are recorded if it has any.
        reference: `t -> (q_d, v_d, a_d)`, shapes (nq,), (nv,), (nv,).
        duration: simulated time [s].
        q0: configuration at the start (nq,); the reference's by default.
        v0: velocity at the start (nv,); the reference's by default.
        disturbance: `t -> (nv,)`, torque added at the joints [N·m, N], evaluated at every stage.
        sensor: `(t, q, v) -> (q, v)`, what the controller is told of the true state.
        actuator: `(t, tau) -> tau`, what becomes of the controller's torque.
        substeps: integration steps in a tick.
        integrator: "rk4" or "semi-implicit".
        record_every: ticks from one recorded row to the next.
        progress: True shows a bar on the terminal; a callable is told the fraction done.

    Returns:
        The recording. Its last row is at `duration`, or the last recorded tick before.

    Raises:
        ArgumentError: an argument is unusable.
        DivergenceError: a joint left every reasonable bound; it carries the recording so far.
    """
    dt = checks.finite_number("controller.dt", controller.dt, above=0.0)
    duration = checks.finite_number("duration", duration, at_least=dt)
    stride = checks.count("record_every", record_every)
    q_start, v_start, _ = _checked_reference(arm, reference)
    plant = Plant(
        arm,
        q_start if q0 is None else checks.finite_vector("q0", q0, arm.nq),
        v_start if v0 is None else checks.finite_vector("v0", v0, arm.nv),
        dt=dt,
        substeps=substeps,
        integrator=integrator,
        disturbance=_checked_disturbance(arm, disturbance),
    )
    for part in (controller, sensor, actuator):
        reset = getattr(part, "reset", None)
        if reset is not None:
            reset()

    ticks = round(duration / dt) + 1
    rows = _Rows(arm, (ticks - 1) // stride + 1, getattr(controller, "signals", {}))
    started = time.perf_counter()

    def recording() -> Recording:
        options = {"duration": duration, "substeps": substeps, "integrator": integrator}
        took = time.perf_counter() - started
        return rows.recording(_metadata(controller, reference, options, took))

    with _reporter(progress) as report:
        for k in range(ticks):
            t = k * dt
            q_d, v_d, a_d = reference(t)
            q, v = (plant.q, plant.v) if sensor is None else sensor(t, plant.q, plant.v)
            tau = controller.update(q, v, q_d, v_d, a_d)
            if actuator is not None:
                tau = actuator(t, tau)
            if k % stride == 0:
                rows.add(t, plant, q_d, v_d, controller)
            applied, lost = plant.hold(t, tau, dt)
            if k % stride == 0:
                rows.tau[rows.filled - 1] = applied
            if lost >= 0:
                joint = arm.joint_names[lost]
                raise DivergenceError(
                    f"the simulation diverged at t = {t + dt:.4g} s: joint {joint!r} reached "
                    f"{plant.v[lost]:.3g} {arm.position_units[lost]}/s; try more substeps, a shorter "
                    "tick, or lower gains",
                    t + dt,
                    joint,
                    recording(),
                )
            if k % 256 == 0:
                report(k / ticks)
        report(1.0)
    return recording()


class _Rows:
    """The recording while it grows."""

    def __init__(self, arm: Arm, size: int, signals: dict[str, Array]) -> None:
        self.arm, self.filled = arm, 0
        self.t = np.zeros(size)
        self.q, self.q_d = np.zeros((size, arm.nq)), np.zeros((size, arm.nq))
        self.v, self.v_d = np.zeros((size, arm.nv)), np.zeros((size, arm.nv))
        self.tau = np.zeros((size, arm.nv))
        self.signals = {name: np.zeros((size, np.size(value))) for name, value in signals.items()}

    def add(self, t: float, plant: Plant, q_d: Array, v_d: Array, controller: Law) -> None:
        k = self.filled
        self.t[k], self.q[k], self.v[k], self.q_d[k], self.v_d[k] = t, plant.q, plant.v, q_d, v_d
        if self.signals:
            for name, value in controller.signals.items():  # type: ignore[attr-defined]
                self.signals[name][k] = value
        self.filled += 1

    def recording(self, metadata: dict[str, Any]) -> Recording:
        n = self.filled
        e = np.array([self.arm.difference(*row) for row in zip(self.q_d[:n], self.q[:n], strict=True)])
        return Recording(
            t=self.t[:n],
            q=self.q[:n],
            v=self.v[:n],
            q_d=self.q_d[:n],
            v_d=self.v_d[:n],
            e=e.reshape(n, self.arm.nv),
            ed=self.v[:n] - self.v_d[:n],
            tau=self.tau[:n],
            signals={name: rows[:n] for name, rows in self.signals.items()},
            arm=self.arm,
            metadata=metadata,
        )


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


def _checked_disturbance(arm: Arm, disturbance: Disturbance | None) -> Disturbance | None:
    if disturbance is not None:
        checks.finite_vector("disturbance", disturbance(0.0), arm.nv)
    return disturbance


def _metadata(
    controller: Law, reference: Reference, options: dict[str, Any], took: float
) -> dict[str, Any]:
    gains = getattr(controller, "gains", None)
    return {
        "controller": type(controller).__name__,
        "preset": getattr(controller, "preset", None),
        "gains": gains.as_dict() if hasattr(gains, "as_dict") else {},
        "nominal_arm": getattr(getattr(controller, "arm", None), "name", None),
        "dt": controller.dt,
        "reference": getattr(reference, "__name__", type(reference).__name__),
        **options,
        "wall_time": took,
        "versions": {
            "python": platform.python_version(),
            **{name: version(name) for name in ("fotsmc_pin", "pin", "numpy", "numba")},
        },
    }


class _reporter:  # noqa: N801 - reads as a function
    """Context in which progress is shown, told to a callable, or dropped."""

    def __init__(self, progress: bool | Callable[[float], None]) -> None:
        self._progress = progress
        self._bar: Any = None

    def __enter__(self) -> Callable[[float], None]:
        if callable(self._progress):
            return self._progress
        if not self._progress:
            return lambda fraction: None
        from rich.progress import Progress

        self._bar = Progress(transient=True)
        self._bar.start()
        task = self._bar.add_task("simulating", total=1.0)
        return lambda fraction: self._bar.update(task, completed=fraction)

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()
