"""Clean environments for release checks, and commands whose time is told."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
TAIL = 25
"""Lines of a command that failed that are shown."""
STEPS: list[tuple[str, float]] = []
"""Commands that passed, and the seconds that each took."""


class CheckError(Exception):
    """A command ended with another code than 0."""


def run(words, cwd, shown=None, **variables):
    """Run a command in a folder, say what it was and how long it took, and return its output.

    Args:
        words: the command.
        cwd: the folder.
        shown: what it is called; None for its words.
        variables: of the environment, besides those that there are.

    Raises:
        CheckError: with the end of its output.
    """
    started = time.perf_counter()
    done = subprocess.run(
        [str(word) for word in words],
        cwd=cwd,
        env=os.environ | {name: str(value) for name, value in variables.items()},
        capture_output=True,
        text=True,
        check=False,
    )
    text = done.stdout + done.stderr
    name = shown or " ".join(str(word) for word in words)
    verdict = "passed" if done.returncode == 0 else f"FAILED with code {done.returncode}"
    took = time.perf_counter() - started
    say(f"{name}: {verdict} in {took:.0f} s")
    if done.returncode:
        raise CheckError("\n".join(text.splitlines()[-TAIL:]))
    STEPS.append((name, took))
    return text


def say(text):
    """Print a line at once."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def interpreter(version):
    """Return the path of a Python of this version on this machine, or None.

    Looked for on the path and among the versions of pyenv and uv, whose own `python3.x` on the path
    runs only where that version is the one in use.
    """
    folders = os.environ["PATH"].split(os.pathsep)
    for kept in (".pyenv/versions", ".local/share/uv/python"):
        folders += sorted(str(path) for path in (Path.home() / kept).glob("*/bin"))
    probe = ["-c", "import sys; print('%d.%d' % sys.version_info[:2])"]
    for folder in folders:
        found = shutil.which(f"python{version}", path=folder)
        if found:
            told = subprocess.run([found, *probe], capture_output=True, text=True, check=False)
            if told.returncode == 0 and told.stdout.strip() == version:
                return found
    return None


def environment(folder, python=sys.executable, shown=None):
    """Make an environment and return its folder of programs."""
    run([python, "-m", "venv", folder], ROOT, shown or f"environment of {Path(python).name}")
    return folder / "bin"


def clean_copy(folder):
    """Copy what Git has of the checkout, without what is not committed, into a folder."""
    archive = folder.with_suffix(".tar")
    run(["git", "archive", "-o", archive, "HEAD"], ROOT, "copy of the last commit")
    shutil.unpack_archive(archive, folder)
    archive.unlink()
    return folder
