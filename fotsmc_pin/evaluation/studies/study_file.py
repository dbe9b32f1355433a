"""A study as a TOML file: what is run, the grid, and the draws."""

from __future__ import annotations

import tomllib
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fotsmc_pin import checks
from fotsmc_pin.arms import Uniform
from fotsmc_pin.errors import StudyError
from fotsmc_pin.evaluation.studies.closed_loop import ClosedLoop

if TYPE_CHECKING:
    import os

TABLES = {
    "study": ("repeats", "seed"),
    "run": tuple(f.name for f in fields(ClosedLoop) if f.name != "reference"),
}


def read_study(path: str | os.PathLike[str]) -> tuple[ClosedLoop, dict[str, Any]]:
    """Return what a file describes: the run, and the arguments `study` takes for it.

    The file has four tables. `[study]`: `repeats`, `seed`. `[run]`: fields of `ClosedLoop`.
    `[grid]`: lists of values. `[draws]`: lists of values, or `{ low = ..., high = ... }`. In all
    of them but the first, `{ low = ..., high = ... }` stands for a `Uniform`.

    Raises:
        StudyError: the file is not TOML, or a table or a name in it is unknown.
        ArgumentError: a value is unusable.
        FileNotFoundError: no such file.
    """
    try:
        tables = tomllib.loads(Path(path).read_text("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise StudyError(f"{path}: not a TOML file: {error}") from error
    for name in tables:
        checks.choice("table", name, (*TABLES, "grid", "draws"))
    for table, known in TABLES.items():
        for name in tables.get(table, {}):
            checks.choice(f"[{table}]", name, known)
    if "arm" not in tables.get("run", {}):
        raise StudyError(f'{path}: [run] needs an arm, such as arm = "panda"')
    run = ClosedLoop(**_with_uniforms(tables["run"]))
    arguments = {
        **tables.get("study", {}),
        "grid": tables.get("grid", {}),
        "draws": _with_uniforms(tables.get("draws", {})),
    }
    return run, arguments


def _with_uniforms(value: Any) -> Any:
    if isinstance(value, dict):
        if value.keys() == {"low", "high"}:
            return Uniform(value["low"], value["high"])
        return {name: _with_uniforms(item) for name, item in value.items()}
    return value
