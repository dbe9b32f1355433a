"""`export_html`: runs of an arm as one file that any browser opens, offline."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal, TypeAlias

from fotsmc_pin.checks import choice, finite_number
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.files import write_text
from fotsmc_pin.progress import Progress, reporting
from fotsmc_pin.simulation import Recording
from fotsmc_pin.view.about_run import diverged_runs, lead, payloads, run_facts
from fotsmc_pin.view.document import Shot, document, shots_of
from fotsmc_pin.view.marks import marks_of
from fotsmc_pin.view.pack import Pack
from fotsmc_pin.view.page import facts_list, page
from fotsmc_pin.view.palette import (
    GHOST_COLOR,
    GREY,
    PAYLOAD_COLOR,
    PUSH_COLOR,
    RUN_COLORS,
)

Recordings: TypeAlias = (
    Recording | str | PathLike[str] | Sequence[Recording] | Mapping[str, Recording]
)
"""A recording, the path of a saved one, several, or several by name."""


OVERLAID_AT_MOST = 2
"""More arms than this in one place hide each other."""


def export_html(
    rec: Recordings,
    path: str | PathLike[str],
    *,
    title: str | None = None,
    ghost: bool = True,
    paths: Literal["growing", "whole", "off"] = "growing",
    layout: Literal["auto", "overlay", "side by side"] = "auto",
    quality: Literal["compact", "full"] = "compact",
    rate: float = 60.0,
    speed: float = 1.0,
    loop: bool = True,
    play: bool = True,
    signals: Sequence[str] | None = None,
    theme: Literal["auto", "light", "dark"] = "auto",
    progress: Progress = False,
) -> Path:
    """Write an animation of one or several runs into a single HTML file.

    The page holds the arm, its reference as a translucent ghost, the paths of the tool and of the
    reference, and plots of error, torque with its limits and sliding variable that are tied to the
    animation. Of a task it shows the axes of the frame and of its reference, and the error between
    the two. It needs no server and no network, neither to be written nor to be seen. Several
    runs are coloured and named, and can be shown and hidden one by one. The same input gives the
    same file.

    Args:
        rec: a recording or the path of a saved one; a list of recordings, or a dict from names to
            recordings.
        path: file to write, whole or not at all; missing folders are made.
        title: heading of the page; None names the arm.
        ghost: whether the reference shows at the start.
        paths: whether the tool's paths grow with time, are shown whole, or not at all.
        layout: whether several arms stand in one place or next to each other; "auto" puts two runs
            of one arm in one place, and others next to each other. Where arms in one place
            coincide, the first run's is seen.
        quality: "compact" thins fine meshes so that the file stays small; "full" keeps every
            triangle, and the pictures that COLLADA meshes bear.
        rate: frames per second of the run [1/s]; long runs get fewer.
        speed: seconds of the run shown in one second.
        loop: whether to start again at the end.
        play: whether to play when the page opens; a reader who asked the system for reduced
            motion has to press play.
        signals: names of the recorded signals to plot; None takes "s" where there is one, and of a
            task "pose_error".
        theme: "light", "dark", or "auto" to follow the reader's system.
        progress: True shows a bar on standard error; a callable is told the fraction done.

    Returns:
        The path that was written.

    Raises:
        ArgumentError: nothing to show, an unknown option or signal, or a run without samples.
        RecordingError: a path that holds no recording.
        MissingDependencyError: meshcat is not installed.
        OSError: the file cannot be written.
    """
    recordings = named_recordings(rec)
    options = {
        "ghost": bool(ghost),
        "paths": choice("paths", paths, ("growing", "whole", "off")),
        "speed": finite_number("speed", speed, above=0.0),
        "loop": bool(loop),
        "play": bool(play),
        "theme": choice("theme", theme, ("auto", "light", "dark")),
        "quality": choice("quality", quality, ("compact", "full")),
        "signals": _known_signals(signals, recordings),
    }
    choice("layout", layout, ("auto", "overlay", "side by side"))
    joints = {recording.arm.joint_names for recording in recordings.values()}
    apart = len(joints) > 1 or len(recordings) > OVERLAID_AT_MOST
    with reporting(progress, f"Writing {Path(path).name}") as report:
        shots = shots_of(
            recordings,
            rate=finite_number("rate", rate, above=0.0, at_most=1000.0),
            quality=quality,
            side_by_side=layout == "side by side" or (layout == "auto" and apart),
        )
        report(0.6)
        pack = Pack()
        held = document(shots, options, pack)
        report(0.8)
        write_text(path, page(held, pack.text(), _texts(recordings, shots, title)))
        report(1.0)
    return Path(path)


def _texts(
    recordings: Mapping[str, Recording], shots: Sequence[Shot], title: str | None
) -> dict[str, str]:
    """Return the words of a page around its numbers."""
    units = [unit for recording in recordings.values() for unit in recording.arm.position_units]
    efforts = [unit for recording in recordings.values() for unit in recording.arm.effort_units]
    return {
        "generator": "fotsmc_pin",
        "title": title or " and ".join(dict.fromkeys(r.arm.name for r in recordings.values())),
        "subtitle": " · ".join(recordings),
        "error_unit": _heading("", units),
        "torque_unit": _heading("Torque", efforts)
        if "rad" in units
        else _heading("Force", efforts),
        "notice": _notice(recordings),
        "key": _key(shots),
        "facts": _about(recordings),
    }


def named_recordings(rec: Recordings) -> dict[str, Recording]:
    """Return runs by name; unnamed ones are called after their controllers, and numbered if equal.

    Raises:
        ArgumentError: there is no run, or one without samples.
        RecordingError: a path that holds no recording.
    """
    if isinstance(rec, (str, PathLike)):
        rec = Recording.load(rec)
    several: Any = [rec] if isinstance(rec, Recording) else rec
    if not isinstance(several, (Mapping, Sequence)) or not several:
        raise ArgumentError("rec", rec, "give at least one recording")
    for recording in several.values() if isinstance(several, Mapping) else several:
        if not isinstance(recording, Recording):
            raise ArgumentError("rec", recording, "give a Recording, a list or a dict of them")
        if len(recording.t) < 1:
            raise ArgumentError("rec", recording.arm, "this recording has no samples")
    if isinstance(several, Mapping):
        return {str(name): recording for name, recording in several.items()}
    recordings: dict[str, Recording] = {}
    for recording in several:
        name = base = run_name(recording)
        number = 2
        while name in recordings:
            name, number = f"{base} ({number})", number + 1
        recordings[name] = recording
    return recordings


def run_name(recording: Recording) -> str:
    """Return what to call a run: its controller, else its arm."""
    return str(recording.metadata.get("controller") or recording.arm.name)


def _known_signals(
    signals: Sequence[str] | None, recordings: Mapping[str, Recording]
) -> list[str] | None:
    if signals is None:
        return None
    for name in signals:
        for recording in recordings.values():
            if name not in recording.signals:
                known = ", ".join(recording.signals) or "none"
                raise ArgumentError("signals", name, f"recorded are: {known}")
    return list(signals)


def _heading(what: str, units: Sequence[str]) -> str:
    """Return a heading with its unit; with two units, each value tells its own."""
    found = [*dict.fromkeys(units)]
    return f"{what} [{found[0]}]" if len(found) == 1 else what


def _key(shots: Sequence[Shot]) -> str:
    """Return the legend of the 3D view as HTML; it tells payloads and what happens too."""
    entries = [
        (color, "line", ", ".join([shot.name, *(payloads(shot.recording.arm) if several else ())]))
        for several in [len(shots) > 1]
        for shot, color in zip(shots, RUN_COLORS * len(shots), strict=False)
    ]
    if len(shots) == 1:
        entries += [(PAYLOAD_COLOR, "dot", words) for words in payloads(shots[0].recording.arm)]
    entries.append((GHOST_COLOR, "line", "reference"))
    for mark in marks_of(shot.recording for shot in shots):
        changes = (PAYLOAD_COLOR, "dot") if mark.words.startswith("payload") else (GREY, "bar")
        entries.append((*(changes if mark.end is None else (PUSH_COLOR, "line")), mark.told))
    return "".join(
        f'<li><i class="{shape}" style="background:{color}"></i>{html.escape(words)}</li>'
        for color, shape, words in entries
    )


def _notice(recordings: Mapping[str, Recording]) -> str:
    """Return, as HTML, which runs diverged."""
    lines = [
        (f"{name}: " if len(recordings) > 1 else "") + words
        for name, words in diverged_runs(recordings)
    ]
    return f'<p class="warning" role="alert">{html.escape(" ".join(lines))}</p>' if lines else ""


def _about(recordings: Mapping[str, Recording]) -> str:
    return facts_list(
        [
            (name if len(recordings) > 1 else "", lead(recording), run_facts(recording))
            for name, recording in recordings.items()
        ]
    )
