"""What `fotsmc simulate --learn` leaves and prints: estimates, their figure, and the learnt arm."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from fotsmc_pin.cli.output import plain_console, plain_table, say

if TYPE_CHECKING:
    from pathlib import Path

    from fotsmc_pin.control import Controller
    from fotsmc_pin.learning import Estimates, ModelLearning
    from fotsmc_pin.simulation import Recording


def keep_learnt(rec: Recording, controller: Controller[Any] | ModelLearning, folder: Path) -> None:
    """Write and tell what a controller learnt in a run; do nothing of one that learns nothing.

    The folder gets `estimates.md`, `estimates.json`, the figure `estimates.png` and the learnt arm,
    `learned.urdf`.
    """
    from fotsmc_pin import plot
    from fotsmc_pin.files import write_json, write_text
    from fotsmc_pin.learning import ModelLearning
    from fotsmc_pin.view.learning_tables import learning_markdown

    if not isinstance(controller, ModelLearning):
        return
    estimates = controller.estimates()
    rows = [asdict(row) | {"known": row.known} for row in estimates]
    write_json(folder / "estimates.json", {"estimates": rows})
    write_text(folder / "estimates.md", learning_markdown(estimates))
    plot(rec, folder / "estimates.png", kind="estimates")
    arm = folder / "learned.urdf"
    controller.learned_arm().write_urdf(arm)
    _show(estimates, rec)
    say(f"The learnt arm is kept in {arm}; run it as the nominal one, or inspect it.")


def _show(estimates: Estimates, rec: Recording) -> None:
    from fotsmc_pin.view.learning_tables import HEAD, known_lines, noticed, untold

    lines = known_lines(estimates)
    if lines:
        table = plain_table("What was learnt, ± one standard deviation")
        for name in HEAD:
            table.add_column(name, justify="right" if name in ("learnt", "nominal") else "left")
        for line in lines:
            table.add_row(*line)
        plain_console().print(table)
    else:
        say("Nothing is known of the arm that was not known before.")
    if times := noticed(rec):
        say(f"The payload was found to be another at {times}.")
    if missing := untold(estimates):
        say(missing)
