"""Where trials and held-out runs are kept: a file per search while it goes on, then an archive.

A line is written as soon as its run is done, so that a study that is killed loses one run. The
archive holds all of them as two tables with named columns.
"""

from __future__ import annotations

import csv
import io
import lzma
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from fotsmc_pin.files import replacing
from tests.benchmarks.fractional_order.configurations import GAINS
from tests.benchmarks.fractional_order.runs import Outcome

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

ROOT = Path(__file__).parents[3]
ARCHIVE = ROOT / "docs/data/fractional_order"
"""Folder of `trials.csv.xz` and `held_out.csv.xz`."""
OUTCOME = ("error [rad]", "torque variation [N·m/s]", "peak torque [N·m]", "share of limit")
TRIAL_HEAD = ("problem", "configuration", "learning", "seed", "trial", *GAINS, *OUTCOME)
HELD_OUT_HEAD = ("problem", "configuration", "learning", "seed", "trial", "setting", *OUTCOME)


class Search(NamedTuple):
    """What tells one search from another; as seed of what is not searched, 0."""

    problem: str
    configuration: str
    learning: bool
    seed: int

    @property
    def file(self) -> str:
        """Name of its files."""
        words = [self.problem, self.configuration, "learning" if self.learning else "", self.seed]
        return "-".join(str(word).replace(" ", "_").replace("'", "") for word in words if word)

    def cells(self) -> list[str]:
        """Return it as the first cells of a line."""
        return [self.problem, self.configuration, str(int(self.learning)), str(self.seed)]


class Trial(NamedTuple):
    """Gains, and what they came to in the setting of their search."""

    gains: Mapping[str, float]
    outcome: Outcome


@dataclass
class Results:
    """All that was run.

    Attributes:
        trials: of each search, in their order.
        held_out: outcome by trial and setting, of each search.
    """

    trials: dict[Search, list[Trial]] = field(default_factory=lambda: defaultdict(list))
    held_out: dict[Search, dict[tuple[int, int], Outcome]] = field(
        default_factory=lambda: defaultdict(dict)
    )


class Store:
    """Files of a study under way, in one folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)

    def add_trial(self, search: Search, number: int, trial: Trial) -> None:
        """Keep a trial."""
        gains = [_text(trial.gains.get(name)) for name in GAINS]
        self._add(search, "trials", [*search.cells(), str(number), *gains, *_cells(trial.outcome)])

    def add_held_out(self, search: Search, trial: int, setting: int, outcome: Outcome) -> None:
        """Keep a run in a held-out setting."""
        cells = [*search.cells(), str(trial), str(setting), *_cells(outcome)]
        self._add(search, "held_out", cells)

    def of(self, search: Search) -> Results:
        """Return what there is of one search."""
        results = Results()
        for kind in ("trials", "held_out"):
            _read(results, kind, _whole_lines(self._path(search, kind)))
        return results

    def pack(self, archive: Path = ARCHIVE) -> None:
        """Write everything into the archive."""
        for kind, head in (("trials", TRIAL_HEAD), ("held_out", HELD_OUT_HEAD)):
            text = io.StringIO()
            csv.writer(text, lineterminator="\n").writerow(head)
            for path in sorted(self.folder.glob(f"*.{kind}.csv")):
                text.writelines(f"{line}\n" for line in _whole_lines(path))
            with replacing(archive / f"{kind}.csv.xz") as stream:
                stream.write(
                    lzma.compress(text.getvalue().encode(), preset=9 | lzma.PRESET_EXTREME)
                )

    def _path(self, search: Search, kind: str) -> Path:
        return self.folder / f"{search.file}.{kind}.csv"

    def _add(self, search: Search, kind: str, cells: list[str]) -> None:
        path = self._path(search, kind)
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerow(cells)
        _drop_broken_line(path)
        with path.open("a", encoding="utf-8") as stream:
            stream.write(text.getvalue())


def load(archive: Path = ARCHIVE) -> Results:
    """Return what an archive holds."""
    results = Results()
    for kind in ("trials", "held_out"):
        text = lzma.decompress((archive / f"{kind}.csv.xz").read_bytes()).decode()
        _read(results, kind, text.splitlines()[1:])
    return results


def _read(results: Results, kind: str, lines: Iterable[str]) -> None:
    for problem, configuration, learning, seed, trial, *cells in csv.reader(lines):
        search = Search(problem, configuration, learning == "1", int(seed))
        outcome = Outcome(*(float(cell) for cell in cells[-len(OUTCOME) :]))
        if kind == "trials":
            named = zip(GAINS, cells, strict=False)
            gains = {name: float(cell) for name, cell in named if cell}
            results.trials[search].append(Trial(gains, outcome))
        else:
            results.held_out[search][int(trial), int(cells[0])] = outcome


def _cells(outcome: Outcome) -> Iterator[str]:
    return (_text(value) for value in outcome)


def _text(value: float | None) -> str:
    return "" if value is None else repr(float(value)).removesuffix(".0")


def _whole_lines(path: Path) -> list[str]:
    """Return the lines of a file but one that was cut off."""
    if not path.exists():
        return []
    return path.read_text("utf-8").split("\n")[:-1]


def _drop_broken_line(path: Path) -> None:
    """Take away what a killed study left of its last line."""
    if path.exists():
        data = path.read_bytes()
        if data and not data.endswith(b"\n"):
            with path.open("r+b") as stream:
                stream.truncate(data.rfind(b"\n") + 1)
