"""Runs the examples while the site is built, and puts what they write into its gallery.

An example runs again only when it or the library has changed.
"""

from __future__ import annotations

import hashlib
import logging
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files

ROOT = Path(__file__).parents[2]
CACHE = ROOT / "out" / "gallery"
EXAMPLES = ("quickstart", "two_link", "own_urdf", "own_controller", "compare", "panda_payload")
SHOWN = (".html", ".svg")

log = logging.getLogger("mkdocs.plugins.gallery")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add what every example writes as `gallery/<example>/...`."""
    for name in EXAMPLES:
        for path in sorted(results_of(name).iterdir()):
            if path.suffix in SHOWN:
                uri = f"gallery/{name}/{path.name}"
                files.append(File.generated(config, uri, abs_src_path=str(path)))
    return files


def results_of(name: str) -> Path:
    """Return the folder of an example's results; run it where they are missing or outdated."""
    example = ROOT / "examples" / f"{name}.py"
    place = CACHE / f"{name}-{_digest(example)}"
    if not place.is_dir():
        log.info("Running %s", example.relative_to(ROOT))
        with tempfile.TemporaryDirectory(dir=_made(CACHE)) as trial:
            done = subprocess.run(
                [sys.executable, str(example)],
                cwd=trial,
                capture_output=True,
                text=True,
                check=False,
            )
            if done.returncode != 0:
                raise PluginError(f"{example} failed:\n{done.stderr}")
            (folder,) = (Path(trial) / "out").iterdir()
            folder.rename(place)
    return place


def _made(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _digest(example: Path) -> str:
    digest = hashlib.sha256(example.read_bytes())
    for path in sorted((ROOT / "fotsmc_pin").rglob("*")):
        if path.suffix in (".py", ".js", ".css", ".html"):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
