"""Runs the examples and the paper's case while the site is built, and adds what they write to it.

Each runs again only when it or the library has changed.
"""

from __future__ import annotations

import hashlib
import logging
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files

ROOT = Path(__file__).parents[2]
CACHE = ROOT / "out" / "site"
EXAMPLES = (
    *("quickstart", "two_link", "own_urdf", "own_controller", "compare", "panda_payload"),
    *("pick_and_drop", "hold_still", "identify_arm", "rehearsal", "c_in_the_loop"),
    "tilted_circle",
)
AT_ONCE = 2
"""So many examples run at the same time: each is one process that keeps one core busy."""

SHOWN = (".html", ".svg", ".md")

COMMANDS: dict[str, list[list[str]]] = {
    **{f"gallery/{name}": [[str(ROOT / f"examples/{name}.py")]] for name in EXAMPLES},
    "paper": [
        ["-m", "fotsmc_pin", "reproduce", "--out", "out/paper"],
        ["-m", "fotsmc_pin", "report", "out/paper", "--title", "The paper's two-link case"],
    ],
}
"""Folders of the site, and the Python commands that fill them."""

log = logging.getLogger("mkdocs.plugins.gallery")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add what every command writes to the site."""
    with ThreadPoolExecutor(AT_ONCE) as pool:
        results = dict(zip(COMMANDS, pool.map(results_of, COMMANDS), strict=True))
    for folder, place in results.items():
        for path in sorted(place.iterdir()):
            if path.suffix in SHOWN:
                uri = f"{folder}/{path.name}"
                files.append(File.generated(config, uri, abs_src_path=str(path)))
    return files


def results_of(folder: str) -> Path:
    """Return the results for a folder of the site; make them where they are missing."""
    place = CACHE / f"{folder.replace('/', '-')}-{_digest(COMMANDS[folder])}"
    if not place.is_dir():
        CACHE.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=CACHE) as trial:
            for command in COMMANDS[folder]:
                _run(command, Path(trial))
            (results,) = (Path(trial) / "out").iterdir()
            results.rename(place)
    return place


def _run(command: list[str], folder: Path) -> None:
    log.info("Running %s", " ".join(command))
    done = subprocess.run(
        [sys.executable, *command],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        raise PluginError(f"{' '.join(command)} failed:\n{done.stderr}")


def _digest(commands: list[list[str]]) -> str:
    """Return a digest of all that the results follow from."""
    digest = hashlib.sha256(repr(commands).encode())
    for argument in (argument for command in commands for argument in command):
        if argument.endswith(".py"):
            digest.update(Path(argument).read_bytes())
    for path in sorted((*(ROOT / "fotsmc_pin").rglob("*"), *(ROOT / "urdf").iterdir())):
        if path.suffix in (".py", ".js", ".css", ".html", ".urdf", ".json"):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
