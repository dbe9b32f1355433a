"""What a folder of results holds: runs, metrics, tables and figures, as `fotsmc` writes them."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fotsmc_pin.analysis import summarize_by_unit
from fotsmc_pin.errors import RecordingError
from fotsmc_pin.evaluation.studies import StudyResult
from fotsmc_pin.evaluation.studies.store import Store
from fotsmc_pin.simulation import Recording

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

STUDY, STRESS = "study.sqlite", "stress.json"
TEXTS = {
    "claims.md": "Claims",
    "comparison.md": "Comparison",
    "stress.md": "Stress suite",
    "front.md": "Front of the search",
    "margins.md": "Margins",
}
"""Texts in a folder that a report shows, and what it calls them."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Results:
    """A folder of results, read.

    Attributes:
        folder: where it lies.
        runs: recordings by the names of their files, the endings left off.
        summaries: metrics of each run by name and by the unit of the joints' position, "rad" or
            "m"; more runs than were recorded, where a comparison kept only the metrics.
        titles: what to call a run of `summaries`, where its name alone says too little.
        texts: what `TEXTS` names, by heading.
        pictures: figures, in SVG where there is one, else PNG.
        study: the runs of a study, or None.
        stress: the rows of `stress.json`.
    """

    folder: Path
    runs: Mapping[str, Recording]
    summaries: Mapping[str, Mapping[str, Mapping[str, Any]]]
    titles: Mapping[str, str]
    texts: Mapping[str, str]
    pictures: tuple[Path, ...]
    study: StudyResult | None
    stress: tuple[Mapping[str, Any], ...]


def read_results(folder: str | os.PathLike[str]) -> Results:
    """Read a folder that a command has written, or one of saved runs.

    Raises:
        RecordingError: the folder holds no result, or a damaged one, or a damaged `metrics.json`
            or `stress.json`.
        StudyError: a damaged store of a study.
        FileNotFoundError: there is no such folder.
    """
    place = Path(folder)
    files = sorted(path for path in place.iterdir() if path.is_file())
    runs = {path.stem: Recording.load(path) for path in files if path.suffix == ".npz"}
    metrics = _json(place / "metrics.json", "runs", dict)
    texts = {name: text for file, name in TEXTS.items() if (text := _text(place / file))}
    study = _study(place / STUDY)
    stress = _json(place / STRESS, "rows", list).get("rows", [])
    if not (runs or study or stress or texts):
        raise RecordingError(f"{folder}: holds no run; give the folder that a command wrote")
    return Results(
        folder=place,
        runs=runs,
        summaries=_summaries(runs, metrics),
        titles=metrics.get("experiments", {}),
        texts=texts,
        pictures=tuple(path for path in files if _is_picture(path)),
        study=study,
        stress=tuple(stress),
    )


def _summaries(
    runs: Mapping[str, Recording], metrics: Mapping[str, Any]
) -> dict[str, dict[str, Mapping[str, Any]]]:
    """Return the metrics on disk where a comparison wrote them, else those of the recordings.

    A file of one run adds what the recording alone does not tell, such as errors of the tool.
    """
    if metrics.get("runs"):
        return {name: {"rad": summary} for name, summary in metrics["runs"].items()}
    found: dict[str, dict[str, Mapping[str, Any]]] = {
        name: {unit: part.as_dict() for unit, part in summarize_by_unit(rec).items()}
        for name, rec in runs.items()
    }
    if len(runs) == 1 and metrics:
        (kinds,) = found.values()
        unit, first = next(iter(kinds.items()))
        kinds[unit] = {**metrics, **first} if len(kinds) > 1 else {**first, **metrics}
    return found


def _study(path: Path) -> StudyResult | None:
    if not path.is_file():
        return None
    with Store(path) as store:
        rows = store.read(sorted(store.finished()))
    return StudyResult(tuple(rows)) if rows else None


def _is_picture(path: Path) -> bool:
    return path.suffix == ".svg" or (
        path.suffix == ".png" and not path.with_suffix(".svg").exists()
    )


def _json(path: Path, key: str, kind: type) -> dict[str, Any]:
    if not path.is_file():
        return {}
    try:
        found = json.loads(path.read_text("utf-8"))
    except ValueError as error:
        raise RecordingError(f"{path}: damaged ({error})") from error
    if not isinstance(found, dict) or not isinstance(found.get(key, kind()), kind):
        raise RecordingError(f"{path}: not a file of metrics by name")
    return found


def _text(path: Path) -> str:
    """Return the file's text without its title, empty where there is no such file."""
    text = path.read_text("utf-8") if path.is_file() else ""
    return re.sub(r"\A# .*\n", "", text)
