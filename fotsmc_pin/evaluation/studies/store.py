"""`Store`: the finished runs of studies in one SQLite file, each there as soon as it is done."""

from __future__ import annotations

import json
import sqlite3
from typing import TYPE_CHECKING, Any

from fotsmc_pin.errors import StudyError
from fotsmc_pin.evaluation.studies.result import Row

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable
    from types import TracebackType

    from fotsmc_pin.evaluation.studies.planned_runs import PlannedRun

FORMAT = 2

TABLES = """
CREATE TABLE IF NOT EXISTS runs (
    key TEXT PRIMARY KEY,
    run TEXT NOT NULL,
    parameters TEXT NOT NULL,
    seed INTEGER NOT NULL,
    error TEXT,
    seconds REAL NOT NULL,
    finished TEXT NOT NULL DEFAULT CURRENT_TIMESTAMP
) STRICT;
CREATE TABLE IF NOT EXISTS metrics (
    key TEXT NOT NULL REFERENCES runs,
    name TEXT NOT NULL,
    value REAL,
    PRIMARY KEY (key, name)
) STRICT, WITHOUT ROWID;
"""
FROM_FORMAT_1 = """
BEGIN;
ALTER TABLE figures RENAME TO metrics;
PRAGMA user_version = 2;
COMMIT;
"""


class Store:
    """Finished runs, each under the digest of its `PlannedRun`.

    One process writes; any number may read meanwhile.

    Each run is one transaction of SQLite in write-ahead mode: whatever kills the process, all
    runs written before are there. Keep the file on a local disk, not on a network share.

    Tables: `runs`, a row each, with the parameters as JSON and the error of a failed run; and
    `metrics`, a row for each metric of a run, ready for SQL; NULL stands for not a number.
    """

    def __init__(self, path: str | os.PathLike[str] | None) -> None:
        """Open the store at `path`, or one in memory for None; one of format 1 becomes one of 2.

        Raises:
            StudyError: the file is no store of studies, or one of another version.
        """
        self._name = ":memory:" if path is None else str(path)
        try:
            self._database = sqlite3.connect(self._name)
            self._database.execute("PRAGMA journal_mode = WAL")
            self._database.execute("PRAGMA synchronous = NORMAL")
            (found,) = self._database.execute("PRAGMA user_version").fetchone()
            if found == 1:
                self._database.executescript(FROM_FORMAT_1)
            elif found not in (0, FORMAT):
                raise StudyError(f"{path}: store format {found}, this version reads 1 and {FORMAT}")
            self._database.executescript(TABLES)
            self._database.execute(f"PRAGMA user_version = {FORMAT}")
        except sqlite3.Error as error:
            raise StudyError(
                f"{path}: not a store of studies, or not writable ({error})"
            ) from error

    def __enter__(self) -> Store:
        """Return the store."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the file."""
        self._database.close()

    def finished(self, *, failed: bool = True) -> set[str]:
        """Return the keys of all runs that are there; `failed`: also of those that failed."""
        query = "SELECT key FROM runs" + ("" if failed else " WHERE error IS NULL")
        return {key for (key,) in self._database.execute(query)}

    def write(self, run: str, planned: PlannedRun, row: Row) -> None:
        """Write one run, whole or not at all; it replaces an earlier one of the same plan."""
        key = planned.key(run)
        parameters = json.dumps(dict(planned.parameters))
        with self._database:
            self._database.execute("DELETE FROM metrics WHERE key = ?", (key,))
            self._database.execute(
                "INSERT OR REPLACE INTO runs (key, run, parameters, seed, error, seconds)"
                " VALUES (?, ?, ?, ?, ?, ?)",
                (key, run, parameters, planned.seed, row.error, row.seconds),
            )
            self._database.executemany(
                "INSERT INTO metrics VALUES (?, ?, ?)",
                [(key, name, value) for name, value in row.metrics.items()],
            )

    def read(self, keys: Iterable[str]) -> list[Row]:
        """Return the runs of these keys, in their order; those that are not there are left out."""
        return [row for key in keys for row in self._read(key)]

    def _read(self, key: str) -> list[Row]:
        query = "SELECT parameters, seed, error, seconds FROM runs WHERE key = ?"
        rows: list[tuple[Any, ...]] = self._database.execute(query, (key,)).fetchall()
        metrics = self._database.execute("SELECT name, value FROM metrics WHERE key = ?", (key,))
        values = {name: float("nan") if value is None else value for name, value in metrics}
        return [
            Row(
                parameters=json.loads(parameters),
                seed=seed,
                metrics=values,
                error=error,
                seconds=seconds,
            )
            for parameters, seed, error, seconds in rows
        ]
