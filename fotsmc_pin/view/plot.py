"""`plot`: one call from a run to a figure in a file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from fotsmc_pin.checks import choice
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.view import figures
from fotsmc_pin.view.export import named_recordings
from fotsmc_pin.view.learning_figure import learning_figure
from fotsmc_pin.view.style import save_figure

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from matplotlib.figure import Figure

    from fotsmc_pin.simulation import Recording
    from fotsmc_pin.view.export import Recordings

KINDS = ("overview", "tracking", "velocity", "torque", "signal", "estimates", "comparison")


def plot(
    rec: Recordings,
    path: str | os.PathLike[str],
    *,
    kind: Literal[
        "auto", "overview", "tracking", "velocity", "torque", "signal", "estimates", "comparison"
    ] = "auto",
    joints: Sequence[int] | None = None,
    signal: str = "s",
) -> list[Path]:
    """Draw a run, or several against each other, into a figure for a paper.

    Args:
        rec: a recording, or the path of a saved one; a list or dict of recordings for a
            comparison.
        path: file with the ending .svg, .png or .pdf; without one, an SVG and a PNG are written.
        kind: what to show. "overview": error, torque and sliding variable of all joints;
            "tracking": position, reference and error; "velocity"; "torque" with its limits;
            "signal": one signal of the controller; "estimates": what `ModelLearning` learnt of the
            arm over time, with bands of two standard deviations; "comparison": errors and torques
            of several runs. "auto" takes the overview for one run and the comparison for several.
        joints: numbers of the joints to show, from 0; None shows all. An overview shows all.
        signal: name of the signal for kind "signal".

    Returns:
        The files that were written.

    Raises:
        ArgumentError: nothing to draw, an unknown kind, joint, signal or ending; or estimates of a
            run in which nothing was learnt.
        RecordingError: a path that holds no recording.
        OSError: the file cannot be written.
    """
    recordings = named_recordings(rec)
    if kind == "auto":
        kind = "comparison" if len(recordings) > 1 else "overview"
    choice("kind", kind, KINDS)
    if len(recordings) > 1 and kind != "comparison":
        raise ArgumentError("kind", kind, "several recordings can only be compared")
    first = next(iter(recordings.values()))
    for recording in recordings.values():
        if recording.arm.nv != first.arm.nv:
            raise ArgumentError("rec", recording.arm, "compare arms with equally many joints")
    for joint in joints or ():
        if not 0 <= joint < first.arm.nv:
            raise ArgumentError("joints", joint, f"give numbers from 0 to {first.arm.nv - 1}")
    if kind == "signal" and signal not in first.signals:
        known = ", ".join(first.signals) or "none"
        raise ArgumentError("signal", signal, f"recorded are: {known}")
    return save_figure(_figure(recordings, kind, joints, signal), path)


def _figure(
    recordings: Mapping[str, Recording], kind: str, joints: Sequence[int] | None, signal: str
) -> Figure:
    first = next(iter(recordings.values()))
    if kind == "comparison":
        return figures.comparison_figure(recordings, joints)
    if kind == "overview":
        return figures.overview_figure(first)
    if kind == "signal":
        return figures.signal_figure(first, signal)
    by_kind = {
        "tracking": figures.tracking_figure,
        "velocity": figures.velocity_figure,
        "torque": figures.torque_figure,
        "estimates": learning_figure,
    }
    return by_kind[kind](first, joints)
