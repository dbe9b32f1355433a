"""`python -m tests.release check | matrix`: what is done before a release, with steps and times.

- `check` builds both packages from the last commit, checks their metadata, installs the wheel in a
  clean environment, and without the checkout runs `fotsmc reproduce` in an empty folder and the
  sdist's tests on the wheel.
- `matrix` runs tests in clean environments: each Python that is on this machine, with the lowest
  versions that `pyproject.toml` states (or the lowest of which that Python has wheels) and with the
  newest ones.

Words after `--` go to pytest, such as paths of tests.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from tests.release.check import check
from tests.release.environments import PYTHONS, CheckError, say
from tests.release.matrix import matrix


def main():
    parser = argparse.ArgumentParser(prog="python -m tests.release", description=__doc__)
    parser.add_argument("what", choices=("check", "matrix"))
    parser.add_argument("--python", action="append", choices=PYTHONS, help="only this version")
    parser.add_argument("--only", choices=("lowest", "newest"), help="only these dependencies")
    parser.add_argument("tests", nargs="*", help="words for pytest")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="fotsmc_release_") as name:
        try:
            if asked.what == "check":
                check(Path(name), asked.tests)
            else:
                ends = (asked.only,) if asked.only else ("lowest", "newest")
                matrix(Path(name), asked.tests, asked.python or PYTHONS, ends)
        except CheckError as failure:
            say(str(failure))
            sys.exit(1)


if __name__ == "__main__":
    main()
