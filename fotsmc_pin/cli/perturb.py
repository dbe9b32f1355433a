"""`fotsmc perturb`: a second URDF, for the true plant, made from the first."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

import typer

from fotsmc_pin.cli.output import Force, plain_console, result_file
from fotsmc_pin.errors import ArgumentError

if TYPE_CHECKING:
    from fotsmc_pin.arms.random_numbers import Number

Default = TypeVar("Default", float, None)
HOW = "number, low:high to draw, or name=number; may be repeated"


def perturb_command(
    file: Annotated[str, typer.Argument(help="A URDF file, or a name that `fotsmc arms` lists.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="The URDF to write.")],
    mass_scale: Annotated[list[str] | None, typer.Option(help=f"Of links: {HOW}.")] = None,
    inertia_scale: Annotated[list[str] | None, typer.Option(help=f"Of links: {HOW}.")] = None,
    com_shift: Annotated[
        list[str] | None, typer.Option(help=f"Length of random direction [m]: {HOW}.")
    ] = None,
    payload: Annotated[str, typer.Option(help="Mass [kg]: number, or low:high to draw.")] = "0",
    payload_frame: Annotated[
        str | None, typer.Option(help="Link that carries it; the tool frame by default.")
    ] = None,
    friction: Annotated[list[str] | None, typer.Option(help=f"Of joints [N·m]: {HOW}.")] = None,
    damping: Annotated[list[str] | None, typer.Option(help=f"Of joints [N·m·s]: {HOW}.")] = None,
    armature: Annotated[
        list[str] | None,
        typer.Option(help=f"Of joints [kg·m²]: {HOW}; rotors estimates what is missing."),
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Where draws come from.")] = None,
    lock: Annotated[
        list[str] | None, typer.Option(help="Joint to fix, name or pattern; may be repeated.")
    ] = None,
    keep: Annotated[
        list[str] | None, typer.Option(help="Only joint to leave free; may be repeated.")
    ] = None,
    package_dir: Annotated[
        list[Path] | None, typer.Option(help="Where package:// begins; may be repeated.")
    ] = None,
    force: Force = False,
) -> None:
    """Write a URDF whose masses, friction or payload differ: the plant that a model misses."""
    from fotsmc_pin.arms import Payload, load_arm, perturb

    target = result_file(out, force=force)
    rotors = armature == ["rotors"]
    arm = load_arm(
        file,
        lock=lock or None,
        keep=keep or None,
        package_dirs=package_dir or (),
        armature="rotors" if rotors else None,
    )
    true = perturb(
        arm,
        mass_scale=_values("--mass-scale", mass_scale, 1.0),
        inertia_scale=_values("--inertia-scale", inertia_scale, 1.0),
        com_shift=_values("--com-shift", com_shift, 0.0),
        payload=Payload(mass=_number("--payload", payload), frame=payload_frame),
        friction=_values("--friction", friction, None),
        damping=_values("--damping", damping, None),
        armature=None if rotors else _values("--armature", armature, None),
        seed=seed,
    )
    true.write_urdf(target)
    console = plain_console()
    for line in (*arm.notes, *(true.changes or ("nothing changed",))):
        console.print(f"  {line}", highlight=False)
    console.print(f"Written to {target}.", highlight=False)


def _values(
    option: str, given: list[str] | None, default: Default
) -> Number | dict[str, Number] | Default:
    """Return one number for all, or a mapping by name, of options such as `link7=0.9:1.1`."""
    if not given:
        return default
    if len(given) == 1 and "=" not in given[0]:
        return _number(option, given[0])
    named: dict[str, Number] = {}
    for item in given:
        name, equals, value = item.rpartition("=")
        if not equals:
            raise ArgumentError(option, item, "write name=number when giving several")
        named[name] = _number(option, value)
    return named


def _number(option: str, text: str) -> Number:
    from fotsmc_pin.arms import Uniform

    try:
        low, colon, high = text.partition(":")
        return Uniform(float(low), float(high)) if colon else float(text)
    except ValueError as error:
        if isinstance(error, ArgumentError):
            raise
        raise ArgumentError(option, text, "write a number, or low:high to draw one") from None
