"""What must hold before a release: see `python -m tests.release check`."""

from __future__ import annotations

import re
import shutil
import tomllib
from pathlib import Path

from tests.release.environments import ROOT, STEPS, CheckError, clean_copy, environment, run, say


def check(folder, tests):
    """Build a source and a binary package from the last commit, and use them as strangers do.

    Args:
        folder: where everything is made; it is to be empty.
        tests: words for pytest; none runs all tests.

    Raises:
        CheckError: at the first step that does not hold.
    """
    version = agreed_version()
    say(f"version {version} in the package, CITATION.cff and CHANGELOG.md")
    source = clean_copy(folder / "checkout")
    tools = environment(folder / "tools", shown="environment of the tools")
    run([tools / "pip", "install", "-q", "build", "twine"], folder, "build tools")
    dist = folder / "dist"
    run([tools / "python", "-m", "build", "-o", dist, source], folder, "sdist and wheel")
    packages = [*dist.iterdir()]
    run([tools / "twine", "check", "--strict", *packages], folder, "metadata of both")
    (wheel,) = dist.glob("*.whl")
    (sdist,) = dist.glob("*.tar.gz")
    constraints = source / "constraints.txt"

    programs = environment(folder / "user", shown="environment of the user")
    words = [programs / "pip", "install", "-q", "-c", constraints, f"{wheel}[robots]"]
    run(words, folder, "wheel installed")
    shutil.rmtree(source)  # From here on nothing may need the checkout.
    empty = folder / "elsewhere"
    empty.mkdir()
    told = run([programs / "fotsmc", "--version"], empty, "fotsmc --version")
    if version not in told:
        raise CheckError(f"fotsmc --version says {told!r}, not {version}")
    run([programs / "fotsmc", "reproduce", "--out", "two_link"], empty, "fotsmc reproduce")
    pages = [*empty.glob("two_link/*.html")]
    if not pages:
        raise CheckError("fotsmc reproduce left no page")

    shutil.unpack_archive(sdist, folder / "unpacked")
    (unpacked,) = (folder / "unpacked").iterdir()
    shutil.move(unpacked / "fotsmc_pin", folder / "unused")  # Tests shall meet the wheel.
    words = [programs / "pip", "install", "-q", "-c", unpacked / "constraints.txt"]
    run([*words, f"{wheel}[test]"], folder, "test dependencies installed")
    # `-m` puts the folder on the path, also in processes that tests start.
    words = [programs / "python", "-m", "pytest", "-q", "-n", "2", *tests]
    told = run(words, unpacked, "tests of the sdist on the wheel")
    say("\n| step | time [s] |\n| --- | ---: |")
    for name, took in STEPS:
        say(f"| {name} | {took:.0f} |")
    say("\n" + told.strip().splitlines()[-1].strip("= "))


def agreed_version():
    """Return the version, which stands in the package alone and is repeated for readers.

    Raises:
        CheckError: CITATION.cff or the newest heading of CHANGELOG.md says another one.
    """
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    source = ROOT / project["tool"]["hatch"]["version"]["path"]
    version = _first(r'__version__ = "(.*)"', source)
    for found in (
        _first(r"(?m)^version: (.*)$", ROOT / "CITATION.cff"),
        _first(r"(?m)^## (\d\S*)", ROOT / "CHANGELOG.md"),
    ):
        if found != version:
            raise CheckError(f"{source.name} says version {version}, a page for readers {found}")
    return version


def _first(pattern, path):
    found = re.search(pattern, Path(path).read_text("utf-8"))
    if found is None:
        raise CheckError(f"{path}: nothing like {pattern}")
    return found[1]
