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

HEADS = {"trials": TRIAL_HEAD, "held_out": HELD_OUT_HEAD}
"""Columns of both kinds of tables."""
KEYS = {"trials": 5, "held_out": 6}
"""How many of a line's first cells tell its run from all others."""
Key = tuple[str, ...]


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
        """Add everything to the archive, which loses nothing that it holds.

        Raises:
            RuntimeError: a run is stored already and has come out otherwise.
        """
        merged = {}
        for kind in HEADS:
            stored, ours = _archived_lines(archive, kind), self._lines(kind)
            other = _differing(kind, stored, ours)
            if other:
                raise RuntimeError(
                    f"{len(other)} runs of {self.folder} are stored already and came out otherwise "
                    f"there, the first: {','.join(other[0])}; take its file away, or the archive's"
                )
            merged[kind] = {
                file: stored.get(file, {}) | ours.get(file, {}) for file in stored | ours
            }
        for kind, head in HEADS.items():
            text = io.StringIO()
            csv.writer(text, lineterminator="\n").writerow(head)
            for file in sorted(merged[kind]):
                text.writelines(f"{line}\n" for line in merged[kind][file].values())
            with replacing(archive / f"{kind}.csv.xz") as stream:
                stream.write(
                    lzma.compress(text.getvalue().encode(), preset=9 | lzma.PRESET_EXTREME)
                )

    def unpack(self, archive: Path = ARCHIVE) -> None:
        """Write what the archive holds into the folder's files, so that a study goes on from it.

        Raises:
            FileExistsError: the folder has files of a study already; none is touched then.
        """
        if any(self.folder.glob("*.csv")):
            raise FileExistsError(f"{self.folder} has runs already; name an empty folder")
        for kind in HEADS:
            for file, lines in _archived_lines(archive, kind).items():
                text = "".join(f"{line}\n" for line in lines.values())
                with replacing(self.folder / file) as stream:
                    stream.write(text.encode())

    def against(self, archive: Path = ARCHIVE) -> str:
        """Return what tells whether runs of the folder came out as the archive holds them."""
        told = []
        for kind in HEADS:
            stored, ours = _archived_lines(archive, kind), self._lines(kind)
            for file in sorted(stored.keys() & ours.keys()):
                both = len(stored[file].keys() & ours[file].keys())
                other = len(_differing(kind, {file: stored[file]}, {file: ours[file]}))
                told.append(
                    f"{file}: {both} runs in both, {both - other} the same to the last digit"
                )
        return "".join(f"{line}\n" for line in told) or "no run is in both\n"

    def _lines(self, kind: str) -> dict[str, dict[Key, str]]:
        return {
            path.name: _keyed(kind, _whole_lines(path))
            for path in sorted(self.folder.glob(f"*.{kind}.csv"))
        }

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


def _archived_lines(archive: Path, kind: str) -> dict[str, dict[Key, str]]:
    """Return the lines of an archive, by the files that they came from."""
    path = archive / f"{kind}.csv.xz"
    found: dict[str, dict[Key, str]] = {}
    if path.exists():
        text = lzma.decompress(path.read_bytes()).decode()
        for key, line in _keyed(kind, text.splitlines()[1:]).items():
            search = Search(key[0], key[1], key[2] == "1", int(key[3]))
            found.setdefault(f"{search.file}.{kind}.csv", {})[key] = line
    return found


def _keyed(kind: str, lines: Iterable[str]) -> dict[Key, str]:
    lines = [*lines]
    cells = csv.reader(lines)
    return {tuple(row[: KEYS[kind]]): line for row, line in zip(cells, lines, strict=True)}


def _differing(
    kind: str, stored: Mapping[str, dict[Key, str]], ours: Mapping[str, dict[Key, str]]
) -> list[Key]:
    """Return the runs that both have, and that are not the same."""
    return [
        key
        for file, lines in ours.items()
        for key, line in lines.items()
        if stored.get(file, {}).get(key, line) != line
    ]


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
