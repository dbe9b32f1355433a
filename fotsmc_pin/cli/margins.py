"""`fotsmc margins`: what the loop of a law bears, and what an arm asks of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fotsmc_pin.cli.arm_options import ArmName, ArmOptions
from fotsmc_pin.cli.groups import with_groups
from fotsmc_pin.cli.law_options import LawOptions
from fotsmc_pin.cli.output import Force, plain_console, plain_table, result_folder, say, show_table
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.files import write_json

if TYPE_CHECKING:
    from rich.table import Table

    from fotsmc_pin.analysis import InertiaRatios, Margins
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.control import Controller

ROTORS = (400.0, 200.0, 100.0, 50.0)
"""Effort limits over rotor inertias that geared arms have [rad/s²]."""
SIDES = ("motor", "link")
SHARE = 0.8
"""Share of the largest bandwidth that is proposed: on a whole arm springs shake each other."""
OBSERVED = " side, with a SpringObserver"


@dataclass(frozen=True, kw_only=True)
class _Asked:
    """A true arm, in words and in a few of them, and the ratios that it asks for."""

    words: str
    short: str
    ratios: InertiaRatios


@with_groups
def margins_command(
    arm: ArmName,
    *,
    arm_options: ArmOptions,
    law: LawOptions,
    dt: Annotated[float, typer.Option(help="Period of a tick [s].")] = 1e-3,
    delay: Annotated[int, typer.Option(help="Ticks by which the torque comes late.")] = 1,
    true: Annotated[
        str | None,
        typer.Option("--true", help="URDF of a true arm, to compare its inertia."),
    ] = None,
    rotors: Annotated[
        bool,
        typer.Option("--rotors", help="Compare with true rotors of effort limit / 400 to / 50."),
    ] = False,
    stiffness: Annotated[
        list[str] | None,
        typer.Option(
            help="Stiffness of elastic joints [N·m/rad, N/m]: number or name=number; says the "
            "largest bandwidth. Needs an armature.",
            metavar="VALUE",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder for margins.json and margins.png.")
    ] = None,
    force: Force = False,
) -> None:
    """Compute what a law's loop bears: inertia, delay, noise, springs; nothing is simulated."""
    from fotsmc_pin.analysis import margins

    nominal = arm_options.load(arm)
    controller = law.make(nominal, dt)
    folder = None if out is None else result_folder(out, force=force)
    found = margins(controller, delay)
    loops = {"in motion" if _has_rest(controller) else type(controller).__name__: found}
    if _has_rest(controller):
        loops["at rest"] = margins(_with(controller, integral=0.0), delay)
    asked = _asked(nominal, true, rotors, arm_options)
    bandwidths = {} if stiffness is None else _bandwidths(controller, stiffness, delay)

    show_table(
        f"{type(controller).__name__}, {nominal.name}, {1e3 * dt:.4g} ms, delay {delay} tick(s)",
        [row for name, loop in loops.items() for row in _facts(name, loop, len(loops))],
    )
    plain_console().print(_noise(nominal, found))
    for one in asked:
        say(_verdict(loops, one, nominal))
    for side, value in bandwidths.items():
        place = side if side.endswith(OBSERVED) else f"{side} side"
        say(f"Encoders on the {place}: {_bandwidth_words(value, controller, side)}")
    if folder is not None:
        _write(folder, loops, asked, bandwidths)
        say(f"The figure is kept in {folder / 'margins.png'}.")


def _has_rest(controller: Controller[Any]) -> bool:
    """Whether the law switches an integral off where its reference rests."""
    from fotsmc_pin.control import RobustFONFTSM

    return isinstance(controller, RobustFONFTSM) and bool((controller.gains.integral > 0.0).any())


def _with(controller: Controller[Any], **changes: Any) -> Controller[Any]:
    gains = controller.gains
    given = {name: getattr(gains, name) for name in gains.__dataclass_fields__}
    return type(controller)(controller.arm, controller.dt, **{**given, **changes})


def _facts(name: str, found: Margins, loops: int) -> list[tuple[str, str]]:
    tick = 1e3 * found.laws[0].dt
    late = "without bound"
    if math.isfinite(found.delay_margin):
        late = f"{found.delay_margin:.2g} more ticks ({found.delay_margin * tick:.2g} ms)"
    damping = "no mode oscillates"
    if found.damping < 1.0:
        damping = f"ratio {found.damping:.2g} at {found.damping_rate:.3g} rad/s at least"
    rows = [
        ("true inertia", f"bears {_range(found)} times the nominal one"),
        ("delay margin", late),
        ("sensitivity", f"{found.sensitivity:.3g} at most (2 is a common bound)"),
        ("damping", damping),
        ("slowest mode", f"decays at {found.slowest:.3g} 1/s"),
    ]
    return [(f"{what}, {name}" if loops > 1 else what, value) for what, value in rows]


def _range(found: Margins) -> str:
    from fotsmc_pin.analysis.margins import HEAVIEST, LIGHTEST

    low = f"{found.lowest:.3g}" if found.lowest > LIGHTEST else f"less than {LIGHTEST:g}"
    high = f"{found.highest:.3g}" if found.highest < HEAVIEST else f"more than {HEAVIEST:g}"
    return f"{low} to {high}"


def _noise(arm: Arm, found: Margins) -> Table:
    table = plain_table("Torque noise per noise of the sensors (RMS, white)")
    table.add_column("joint", no_wrap=True)
    for heading in ("of position", "of velocity"):
        table.add_column(heading, justify="right")
    for row, name in enumerate(arm.joint_names):
        effort, unit = arm.effort_units[row], arm.position_units[row]
        table.add_row(
            name,
            f"{found.position_noise[row]:.3g} {effort}/{unit}",
            f"{found.velocity_noise[row]:.3g} {effort}·s/{unit}",
        )
    return table


def _asked(nominal: Arm, true: str | None, rotors: bool, options: ArmOptions) -> list[_Asked]:
    from fotsmc_pin.analysis import inertia_ratios
    from fotsmc_pin.arms import perturb
    from fotsmc_pin.cli.true_arm import load_true_arm

    asked = []
    if true is not None:
        loaded = load_true_arm(true, nominal, options)
        asked.append(
            _Asked(words=true, short=Path(true).name, ratios=inertia_ratios(loaded, nominal))
        )
    if rotors:
        for name, limit in zip(nominal.joint_names, nominal.effort_limit, strict=True):
            if not math.isfinite(limit):
                raise ArgumentError(
                    "--rotors", nominal.name, f"joint {name} has no effort limit; use --true"
                )
        for over in ROTORS:
            real = perturb(nominal, armature=nominal.effort_limit / over)
            words = f"true rotors of effort limit / {over:g}"
            short = f"rotors of limit / {over:g}"
            asked.append(_Asked(words=words, short=short, ratios=inertia_ratios(real, nominal)))
    return asked


def _verdict(loops: dict[str, Margins], asked: _Asked, nominal: Arm) -> str:
    """Say whether the loops bear what an arm asks for, and the remedy where they do not."""
    ratios = asked.ratios
    told = f"{asked.words}: asks for {ratios.lowest:.3g} to {ratios.highest:.3g}"
    light = [name for name, found in loops.items() if ratios.lowest <= found.lowest]
    heavy = [name for name, found in loops.items() if ratios.highest >= found.highest]
    if not light and not heavy:
        return f"{told}: inside."
    parts = []
    if heavy:
        row = nominal.joint_names.index(ratios.joint_highest)
        remedy = (
            "give its armature (--armature rotors)"
            if nominal.armature[row] == 0.0
            else f"give it more armature (--armature {ratios.joint_highest}=...)"
        )
        where = _where(heavy, loops)
        parts.append(f"too heavy at {ratios.joint_highest}{where}, {remedy}")
    if light:
        parts.append(
            f"too light at {ratios.joint_lowest}{_where(light, loops)}, "
            "lower the nominal inertia or armature there"
        )
    return f"{told}: {'; '.join(parts)}."


def _where(names: list[str], loops: dict[str, Margins]) -> str:
    return "" if len(names) == len(loops) else f" {' and '.join(names)}"


def _bandwidths(
    controller: Controller[Any], stiffness: list[str], delay: int
) -> dict[str, float | None]:
    from fotsmc_pin.analysis import largest_bandwidth
    from fotsmc_pin.arms import perturb
    from fotsmc_pin.arms.random_numbers import Uniform
    from fotsmc_pin.cli.values import values_by_name
    from fotsmc_pin.control import SpringObserver

    values: Any = values_by_name("--stiffness", stiffness, None)
    numbers = values.values() if isinstance(values, dict) else [values]
    if any(isinstance(value, Uniform) for value in numbers):
        raise ArgumentError("--stiffness", stiffness, "write numbers, not low:high")
    arm = controller.arm
    k = perturb(arm, joint_stiffness=values).joint_stiffness
    found: dict[str, float | None] = {}
    for side in SIDES:
        try:
            found[side] = largest_bandwidth(
                controller, k, rotor=arm.armature, encoder=side, delay=delay
            )
        except ArgumentError as error:
            if "no bandwidth" not in str(error):
                raise
            found[side] = None
    for side in SIDES:
        try:
            observer = SpringObserver(controller, k, encoder=side, delay=delay)
            found[f"{side}{OBSERVED}"] = largest_bandwidth(observer, delay=delay)
        except ArgumentError as error:
            if "no bandwidth" not in str(error):
                raise
            found[f"{side}{OBSERVED}"] = None
    return found


def _bandwidth_words(value: float | None, controller: Controller[Any], side: str) -> str:
    from fotsmc_pin.analysis import OBSERVED_SHARE

    share = OBSERVED_SHARE[side.split()[0]] if side.endswith(OBSERVED) else SHARE
    if value is None:
        return "no bandwidth is stable."
    given = controller.gains.bandwidth
    words = f"stable up to a bandwidth of {value:.3g}"
    if given <= share * value:
        return f"{words}; this one's {given:g} is inside."
    if given < value:
        return f"{words}: {given:g} is close, take --gain bandwidth={share * value:.2g}."
    return f"{words}: {given:g} is too fast, take --gain bandwidth={share * value:.2g}."


def _write(
    folder: Path,
    loops: dict[str, Margins],
    asked: list[_Asked],
    bandwidths: dict[str, float | None],
) -> None:
    from fotsmc_pin.view import margins_figure, save_figure

    folder.mkdir(parents=True, exist_ok=True)
    write_json(
        folder / "margins.json",
        {
            "loops": {name: _plain(found) for name, found in loops.items()},
            "asked": {
                one.words: {
                    name: getattr(one.ratios, name)
                    for name in ("lowest", "highest", "joint_lowest", "joint_highest")
                }
                for one in asked
            },
            "largest_bandwidth": bandwidths,
        },
    )
    save_figure(
        margins_figure(loops, {one.short: one.ratios for one in asked}), folder / "margins.png"
    )


def _plain(found: Margins) -> dict[str, Any]:
    """Return the numbers; null stands for a margin without bound."""
    names = [name for name in found.__dataclass_fields__ if name != "laws"]
    values = {name: getattr(found, name) for name in names}
    return {
        name: value.tolist() if hasattr(value, "tolist") else _finite(value)
        for name, value in values.items()
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
