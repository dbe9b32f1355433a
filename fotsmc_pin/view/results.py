"""What a folder of results holds: runs, numbers, claims and figures, as `fotsmc` writes them."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fotsmc_pin.analysis import summarize
from fotsmc_pin.errors import RecordingError
from fotsmc_pin.simulation import Recording

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping


@dataclass(frozen=True, kw_only=True, eq=False)
class Results:
    """A folder of results, read.

    Attributes:
        folder: where it lies.
        runs: recordings by the names of their files, the endings left off.
        summaries: metrics of each run by name; more runs than were recorded, where a comparison
            kept only the metrics.
        titles: what to call a run of `summaries`, where its name alone says too little.
        claims: text of `claims.md`, empty where there is none.
        comparison: text of `comparison.md`, empty where there is none.
        pictures: figures in SVG.
    """

    folder: Path
    runs: Mapping[str, Recording]
    summaries: Mapping[str, Mapping[str, Any]]
    titles: Mapping[str, str]
    claims: str
    comparison: str
    pictures: tuple[Path, ...]


def read_results(folder: str | os.PathLike[str]) -> Results:
    """Read a folder that `fotsmc simulate`, `fotsmc reproduce` or a comparison has written.

    Raises:
        RecordingError: the folder holds no run, or a damaged one, or a damaged `metrics.json`.
        FileNotFoundError: there is no such folder.
    """
    place = Path(folder)
    files = sorted(path for path in place.iterdir() if path.is_file())
    runs = {path.stem: Recording.load(path) for path in files if path.suffix == ".npz"}
    if not runs:
        raise RecordingError(f"{folder}: holds no run; give the folder that a command wrote")
    metrics = _metrics(place / "metrics.json")
    several = metrics.get("runs", {})
    summaries: dict[str, Mapping[str, Any]] = dict(several)
    if not several:
        summaries = {name: summarize(rec).as_dict() for name, rec in runs.items()}
        if len(runs) == 1:
            summaries[next(iter(runs))] |= metrics  # type: ignore[operator]
    return Results(
        folder=place,
        runs=runs,
        summaries=summaries,
        titles=metrics.get("experiments", {}),
        claims=_text(place / "claims.md"),
        comparison=_text(place / "comparison.md"),
        pictures=tuple(path for path in files if path.suffix == ".svg"),
    )


def _metrics(path: Path) -> dict[str, Any]:
    if not path.is_file():
        return {}
    try:
        metrics = json.loads(path.read_text("utf-8"))
    except ValueError as error:
        raise RecordingError(f"{path}: damaged ({error})") from error
    if not isinstance(metrics, dict) or not isinstance(metrics.get("runs", {}), dict):
        raise RecordingError(f"{path}: not a file of metrics by name")
    return metrics


def _text(path: Path) -> str:
    """Return the file's text without its title, empty where there is no such file."""
    text = path.read_text("utf-8") if path.is_file() else ""
    return re.sub(r"\A# .*\n", "", text)
