"""`learning_figure`: what was known of an arm over time, and how well."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.learning import recorded_estimates
from fotsmc_pin.view.curves import thinned_curves
from fotsmc_pin.view.figures import REFERENCE
from fotsmc_pin.view.learning_tables import unit_of
from fotsmc_pin.view.marks import mark_axes
from fotsmc_pin.view.palette import BLUE, GREY
from fotsmc_pin.view.style import label_time, new_figure, paper_style

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fotsmc_pin.learning import Estimate
    from fotsmc_pin.simulation import Recording

ROW_HEIGHT = 0.82
TITLE_SIZE, LABEL_SIZE, TICK_SIZE = 6.0, 6.5, 6.0
POINTS_AT_MOST = 500
"""Panels are small and many: a vector file shall stay small too."""
BAND = 2.0
"""Standard deviations to either side that a band shows."""
PAYLOAD = ("mass", "first moment x", "first moment y", "first moment z")
TITLES = {
    "link_scale": "mass, inertia",
    "link_moment": "moments x, y, z",
    "damping": "viscous",
    "friction": "Coulomb",
    "stribeck": "breakaway",
}
"""What a column is headed by, where it is not called like its group; short, for narrow panels."""
BAND_ALPHA = (0.2, 0.1)
"""Of a band that has its panel for itself, and of one of three."""
DASHES = ("-", (0, (4, 1.5)), (0, (1, 1)))
"""Lines of x, y and z."""


def learning_figure(recording: Recording, joints: Sequence[int] | None = None) -> Figure:
    """What was learnt, with bands of two standard deviations: the payload, then a row per joint.

    A row shows a joint's own parameters and those of the link behind it. A parameter that is known
    at the end is blue, one that the motion did not tell is grey; a dashed line is its nominal
    value. The axes are scaled to the estimate and its band at the end, so that the band of the
    beginning may leave them.

    Args:
        recording: a run of `ModelLearning`.
        joints: which joints; None takes all.

    Raises:
        ArgumentError: nothing was learnt in this run.
    """
    estimates = recorded_estimates(recording)
    if estimates is None:
        raise ArgumentError("rec", recording, "its controller learnt nothing; wrap ModelLearning")
    own = [name for name in dict.fromkeys(row.group for row in estimates) if name != "payload"]
    payload = estimates.group("payload")
    chosen = range(recording.arm.nv) if joints is None else joints
    rows, columns = 1 + len(chosen), max(len(own), len(payload))
    figure, axes = new_figure(rows, columns, width="page", row_height=ROW_HEIGHT)
    with paper_style():
        for k, row in enumerate(payload):
            _draw(axes[0, k], recording, row, k)
            _title(axes[0, k], PAYLOAD[k], row)
        axes[0, 0].set_ylabel("payload", fontsize=LABEL_SIZE)
        for line, joint in zip(axes[1:], chosen, strict=True):
            name = recording.arm.joint_names[joint].replace("$", r"\$")
            line[0].set_ylabel(name, fontsize=LABEL_SIZE)
        for column, group in enumerate(own):
            units: list[str] = []
            found = estimates.group(group)
            each = len(found) // recording.arm.nv
            for line, joint in zip(axes[1:], chosen, strict=True):
                for k, row in enumerate(found[each * joint : each * (joint + 1)]):
                    _draw(
                        line[column],
                        recording,
                        row,
                        each * joint + k,
                        DASHES[k] if each == 3 else None,
                    )
                if not units or units[-1] != row.unit:
                    _title(line[column], TITLES.get(group, group), row)
                units.append(row.unit)
        panels: list[Axes] = [*axes.flat]
        for panel in panels:
            if not panel.lines:
                panel.set_visible(False)
            panel.tick_params(labelsize=TICK_SIZE)
            panel.yaxis.get_offset_text().set_fontsize(TICK_SIZE)
        figure.align_ylabels(axes[:, 0])
        _legend(figure)
        label_time(axes)
        mark_axes(axes, [recording])
    return figure


def _legend(figure: Figure) -> None:
    """Say what the colours are, below the figure: what happens in the run is told above it."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [
        (Patch(color=BLUE, alpha=0.2), Line2D([], [], color=BLUE)),
        (Patch(color=GREY, alpha=0.2), Line2D([], [], color=GREY)),
        Line2D([], [], **REFERENCE),
    ]
    words = ["estimate ± 2 standard deviations", "not told by the motion", "nominal"]
    figure.legend(handles, words, loc="outside lower center", ncols=3, fontsize=LABEL_SIZE)


def _draw(axes: Axes, recording: Recording, row: Estimate, column: int, dashes: Any = None) -> None:
    """Draw one parameter with its band; the panel is scaled to what all in it came to."""
    value = recording.signals[row.group][:, column]
    doubt = BAND * recording.signals[f"{row.group}_deviation"][:, column]
    t, curves = thinned_curves(
        recording.t, np.stack([value, value - doubt, value + doubt], axis=1), POINTS_AT_MOST
    )
    color = BLUE if row.known else GREY
    others = [*axes.get_ylim()] if axes.lines else []
    axes.fill_between(
        t,
        curves[:, 1],
        curves[:, 2],
        color=color,
        alpha=BAND_ALPHA[dashes is not None],
        linewidth=0,
    )
    axes.axhline(row.first_value, **(REFERENCE | {"linewidth": 0.6}))
    axes.plot(t, curves[:, 0], color=color, linewidth=0.9, linestyle=dashes or "-")
    seen = [row.first_value, value.min(), value.max(), value[-1] - doubt[-1], value[-1] + doubt[-1]]
    room = 0.08 * (max(seen) - min(seen)) or 1.0
    low, high = min([min(seen) - room, *others]), max([max(seen) + room, *others])
    axes.set_xlim(float(t[0]), float(t[-1]) if t[-1] > t[0] else float(t[0]) + 1.0)
    axes.set_ylim(low, high)


def _title(axes: Axes, quantity: str, row: Estimate) -> None:
    axes.set_title(f"{quantity} [{unit_of(row)}]", fontsize=TITLE_SIZE, loc="left", pad=3)
