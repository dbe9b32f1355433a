"""What happens in the middle of a run of `fotsmc simulate`: `--event` and `--wrench`, as typed."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

from fotsmc_pin.checks import did_you_mean
from fotsmc_pin.cli.values import number
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.cli.plant_options import PlantOptions
    from fotsmc_pin.simulation import Wrench

EVENT_FORM = "write TIME:option=value, such as 3:payload=2"
WRENCH_FORM = "write START:DURATION:FX,FY,FZ, such as 3:0.5:50,0,0; then maybe ,TX,TY,TZ and @LINK"
VECTORS = (3, 6)
"""How many numbers a wrench has: a force, or a force and a torque."""


def events(
    given: Sequence[str], plant: PlantOptions, make: Callable[[PlantOptions], Arm], duration: float
) -> dict[float, Arm]:
    """Return what the true arm becomes, and when, of options such as `3:payload=2`.

    Each event replaces a value of the options that made the true arm; it holds until another one.

    Args:
        given: what was typed.
        plant: the options of the true arm at the start.
        make: makes the true arm of options.
        duration: of the run [s].

    Raises:
        ArgumentError: a text of another form, an unknown option, or a time outside the run.
    """
    typed = sorted(((*_event(text, duration), text) for text in given), key=lambda event: event[0])
    arms = {}
    for time, changed, text in typed:
        plant = replace(plant, **changed)
        try:
            arms[time] = make(plant)
        except ArgumentError as error:
            raise _about("--event", text, error) from error
    return arms


def _event(text: str, duration: float) -> tuple[float, dict[str, Any]]:
    """Return the time [s] and the changed option of an event."""
    when, colon, what = text.partition(":")
    name, equals, value = what.partition("=")
    if not colon or not equals:
        raise ArgumentError("--event", text, EVENT_FORM)
    time = _numbers("--event", text, when, EVENT_FORM)[0]
    if not 0.0 < time < duration:
        remedy = f"the time is not within the run, above 0 and below {duration:g} s"
        raise ArgumentError("--event", text, remedy)
    from fotsmc_pin.cli.plant_options import PlantOptions

    known = {f.name.replace("_", "-"): f for f in fields(PlantOptions) if f.name != "seed"}
    field = known.get(name.strip().lstrip("-").replace("_", "-"))
    if field is None or field.name == "payload_frame":
        known.pop("payload-frame")
        remedy = f"{did_you_mean(name, known)}it can change {', '.join(known)}"
        raise ArgumentError("--event", text, remedy)
    try:
        number(name, value)
    except ArgumentError as error:
        raise _about("--event", text, error) from error
    return time, {field.name: value if field.name == "payload" else [value]}


def wrenches(given: Sequence[str], arm: Arm, duration: float) -> list[Wrench]:
    """Return the wrenches of options such as `3:0.5:50,0,0`.

    Args:
        given: what was typed.
        arm: the true arm.
        duration: of the run [s].

    Raises:
        ArgumentError: a text of another form, an unknown link, or a time after the run.
    """
    return [_wrench(text, arm, duration) for text in given]


def _wrench(text: str, arm: Arm, duration: float) -> Wrench:
    from fotsmc_pin.simulation import Wrench

    numbers, _, frame = text.partition("@")
    parts = numbers.split(":")
    if len(parts) != len(("start", "duration", "vector")):
        raise ArgumentError("--wrench", text, WRENCH_FORM)
    start, lasts, vector = (_numbers("--wrench", text, part, WRENCH_FORM) for part in parts)
    if len(start) != 1 or len(lasts) != 1 or len(vector) not in VECTORS:
        raise ArgumentError("--wrench", text, WRENCH_FORM)
    if start[0] >= duration:
        raise ArgumentError("--wrench", text, f"the run ends at {duration:g} s, before it begins")
    try:
        wrench = Wrench(
            start=start[0],
            duration=lasts[0],
            force=vector[:3],
            torque=vector[3:] or (0.0, 0.0, 0.0),
            frame=frame or None,
        )
        wrench.frame_id(arm)
    except ArgumentError as error:
        raise _about("--wrench", text, error) from error
    return wrench


def _about(option: str, text: str, error: ArgumentError) -> ArgumentError:
    """Return an error of something inside of an option's text as one of the option."""
    return ArgumentError(option, text, f"{error.argument}: {error.remedy}")


def _numbers(option: str, text: str, part: str, form: str) -> list[float]:
    try:
        return [float(word) for word in part.split(",")]
    except ValueError:
        raise ArgumentError(option, text, form) from None
