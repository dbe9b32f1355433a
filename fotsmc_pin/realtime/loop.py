"""`run_realtime`: a fixed-rate loop against a robot, or a plant that runs in wall-clock time.

This is the template to copy: read, update, write, sleep until the next tick, and stop safely.
"""

from __future__ import annotations

import gc
import signal
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin import checks
from fotsmc_pin.realtime.clock import Clock
from fotsmc_pin.realtime.robot import declared
from fotsmc_pin.realtime.run import Run, RunRecorder
from fotsmc_pin.realtime.timing import Timing, percentiles

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterator

    from fotsmc_pin.control import Safeguard
    from fotsmc_pin.realtime.robot import Robot
    from fotsmc_pin.types import Array, PoseReference, Reference


def run_realtime(
    controller: Safeguard,
    robot: Robot,
    reference: Reference | PoseReference,
    duration: float,
    *,
    stop_time: float = 1.0,
    record: str | os.PathLike[str] | None = None,
    observe: Callable[[float, Array, Array, Array], None] | None = None,
) -> Run:
    """Run a controller at its rate against a robot, in wall-clock time.

    Each tick is due at a multiple of `controller.dt` since the start, so that delays do not
    add up; a tick that comes so late that others were due too replaces them. Where the robot paces
    the loop, a tick begins when its `read` returns. The controller is told the measured period, and
    what the robot's drives add, so that what is written is the rest.

    Ctrl-C, and SIGTERM, begin the safe stop of the controller, which is given `stop_time` before
    the loop ends; so does the end of the run, and so does any exception during it, which is raised
    after the stop. The last torque is that of the safe stop.

    Args:
        controller: a controller in its `Safeguard`.
        robot: what is read and written.
        reference: `t -> (q_d, v_d, a_d)`; `t -> (T, V, A)` where the controller follows poses.
        duration: how long to follow the reference [s].
        stop_time: how long the safe stop is run at the end [s].
        record: a file `.npz` for the recording, which is written as the run goes on:
            `Recording.load` reads it also where the program died.
        observe: called with `t, q, v, tau` after each torque was written; it must be quick.

    Returns:
        The recording of the run, and its timing.

    Raises:
        ArgumentError: a duration that is not above 0, or a robot that does not declare what its
            drives add and who keeps the clock.
    """
    controller.compensates, paced = declared(robot)
    dt = controller.dt
    checks.finite_number("duration", duration, at_least=dt)
    checks.finite_number("stop_time", stop_time, at_least=0.0)
    controller.reset()
    clock = Clock(dt, paced=paced)
    size = clock.most_ticks(duration + stop_time)
    latency, compute = np.zeros(size), np.zeros(size)
    recorder = RunRecorder(controller, robot, reference, duration, size=size, path=record)
    ticks = 0
    began_to_stop: float | None = None
    failure: BaseException | None = None
    with _signals_stop(controller), _no_garbage_collection():
        clock.start()
        while ticks < size:
            t = clock.await_tick(keeps_time=failure is not None)
            if began_to_stop is None and (controller.stopped is not None or t >= duration):
                controller.stop("the end of the run")
                began_to_stop = t
            if began_to_stop is not None and t >= began_to_stop + stop_time:
                break
            if clock.is_too_fast(ticks):
                controller.stop(f"the robot ticks faster than the controller's dt of {dt:g} s")
            try:
                q, v = robot.read()
                t = clock.note_read()
                target = reference(min(t, duration))
                before = time.perf_counter()
                wanted, rate, change = target
                period = clock.period if ticks else None
                tau = controller.update(q, v, wanted, rate, change, dt=period)
                compute[ticks] = time.perf_counter() - before
                robot.write(controller.sent)
                latency[ticks] = clock.latency()
                recorder.write_row(t, clock.period, q, v, target, tau)
                if observe is not None:
                    observe(t, q, v, tau)
            except Exception as error:
                if failure is not None:
                    raise
                failure = error
                controller.stop(f"{type(error).__name__}: {error}")
            ticks += 1
            clock.end_tick()
    timing = Timing(
        ticks=ticks,
        missed=clock.missed,
        latency=percentiles(latency[:ticks]),
        compute=percentiles(compute[:ticks]),
        period=clock.now / max(ticks - 1, 1),
        stopped=controller.stopped,
    )
    recording = recorder.recording(timing)
    if failure is not None:
        raise failure
    return Run(recording=recording, timing=timing)


@contextmanager
def _signals_stop(controller: Safeguard) -> Iterator[None]:
    """Let Ctrl-C and SIGTERM begin a safe stop, where signals can be caught at all."""

    def begin(number: int, _: object) -> None:
        controller.stop(signal.Signals(number).name)

    try:
        before = {
            number: signal.signal(number, begin) for number in (signal.SIGINT, signal.SIGTERM)
        }
    except ValueError:  # Not the main thread: its owner catches the signals.
        yield
        return
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def _no_garbage_collection() -> Iterator[None]:
    """Collect now and not while the loop runs."""
    gc.collect()
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()
