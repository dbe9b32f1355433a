"""What a recording tells of its run, in words: for pages, reports and notebooks."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from fotsmc_pin.arms.payload import payload_masses
from fotsmc_pin.view.marks import marks_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from fotsmc_pin.arms import Arm
    from fotsmc_pin.simulation import Recording

TOLD_APART = frozenset(
    (
        *("controller", "preset", "gains", "nominal_arm", "dt", "duration", "wall_time"),
        *("versions", "reference", "divergence", "learning"),
    )
)
"""Metadata that has words of its own; the rest is listed by name."""


def lead(rec: Recording) -> str:
    """Return what was run as one or two sentences."""
    told, arm = rec.metadata, rec.arm
    law = str(told.get("controller") or "An unknown controller")
    preset = f" (preset {told['preset']})" if told.get("preset") else ""
    period = f", every {1e3 * told['dt']:g} ms" if "dt" in told else ""
    seconds = f" for {float(rec.t[-1] - rec.t[0]):g} s" if len(rec) else ""
    along = f" along {spaced(told['reference'])}" if told.get("reference") else ""
    model = told.get("nominal_arm")
    belief = f" It computed with the model of {model}." if model and model != arm.name else ""
    if model and told.get("learning"):
        belief = f" It began with the model of {model} and learnt while the arm moved."
    return f"{law}{preset} moved {arm.name}{along}{seconds}{period}.{belief}"


def divergence_words(rec: Recording) -> str:
    """Return when a run was given up and by which joint; empty for a run that went to its end."""
    lost = rec.divergence
    if lost is None:
        return ""
    return f"This run diverged at t = {lost['time']:.4g} s: joint {lost['joint']} left first."


def run_facts(rec: Recording) -> list[tuple[str, list[str]]]:
    """Return names, and the words under each, of everything that is known of a run."""
    told, arm = rec.metadata, rec.arm
    joints = ", ".join(
        name if unit == "rad" else f"{name} (prismatic)"
        for name, unit in zip(arm.joint_names, arm.position_units, strict=True)
    )
    entries: list[tuple[str, Any]] = [
        ("diverged", divergence_words(rec)),
        ("true arm", f"{arm.name}, {counted(arm.nv, 'joint')}: {joints}"),
        ("changed in it", list(arm.changes)),
        ("on loading", list(arm.notes)),
        ("payload", [words.removeprefix("payload ") for words in payloads(arm)]),
        ("happens", [mark.told for mark in marks_of([rec])]),
        ("nominal arm", told.get("nominal_arm")),
        ("control law", told.get("controller")),
        ("preset", told.get("preset")),
        ("gains", [f"{name} = {plain(value)}" for name, value in told.get("gains", {}).items()]),
        ("learning", _learning(told)),
        ("reference", spaced(told.get("reference") or "")),
        ("period of a tick", f"{1e3 * told['dt']:g} ms" if "dt" in told else None),
        ("simulated time", f"{told['duration']:g} s" if "duration" in told else None),
        *((spaced(name), flat(told[name])) for name in told if name not in TOLD_APART),
        ("computing time", f"{told['wall_time']:.2f} s" if "wall_time" in told else None),
        ("versions", [f"{name} {text}" for name, text in told.get("versions", {}).items()]),
    ]
    return [
        (name, value if isinstance(value, list) else [str(value)])
        for name, value in entries
        if value not in (None, "", [], [""])
    ]


def _learning(told: Mapping[str, Any]) -> list[str]:
    """Return how a model was learnt: the delay that was stated, and what the loop was trusted with.

    What was learnt has a table of its own.
    """
    about = told.get("learning")
    if not about:
        return []
    lowest, highest = about["bears"]
    return [
        f"torque taken to act {counted(about['delay'], 'tick')} later",
        f"loop trusted with {lowest:.3g} to {highest:.3g} times the inertia that it works with",
    ]


def payloads(arm: Arm) -> list[str]:
    """Return the payloads that hang on an arm, with their masses."""
    return [f"payload {mass:.4g} kg" for mass in payload_masses(arm.tree).values()]


def counted(number: int, thing: str) -> str:
    """Return "one joint", "7 joints"."""
    return f"one {thing}" if number == 1 else f"{number} {thing}s"


def spaced(name: object) -> str:
    """Return a name of the program's as words: `MinimumJerk` and `record_every` with spaces."""
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", str(name).replace("_", " "))
    return words if words.isupper() else words[:1].lower() + words[1:]


def flat(value: Any) -> list[str]:
    """Return metadata of any depth as words."""
    if isinstance(value, dict):
        return [f"{spaced(name)} {' '.join(flat(item))}" for name, item in value.items()]
    return [plain(value)]


def plain(value: Any) -> str:
    """Return a number or a list of numbers as it is read; equal numbers once."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, (list, tuple)):
        if len(value) > 1 and all(item == value[0] for item in value):
            return f"{plain(value[0])} for each joint"
        return ", ".join(plain(item) for item in value)
    return str(value)


def diverged_runs(runs: Mapping[str, Recording]) -> Sequence[tuple[str, str]]:
    """Return name and words of the runs that diverged."""
    told = {name: divergence_words(rec) for name, rec in runs.items()}
    return [(name, words) for name, words in told.items() if words]
