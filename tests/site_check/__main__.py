"""`python -m tests.site_check`: what a reader of the site meets, before a release.

Builds the site strictly, follows its links and anchors, opens every page in a browser without
network on a laptop and on a phone, light and dark, runs axe on it, and takes a picture of its first
screen into `test-output/site`. Ends with 1 where a link is dead, or axe has a serious or critical
finding, or a page complains, is wider than the screen, or asks for a network. Look at the pictures.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

from tests.site_check.browser import SCREENS, look_at
from tests.site_check.links import follow

ROOT = Path(__file__).parents[2]
SITE = ROOT / "site"
OUT = ROOT / "test-output/site"


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.site_check", description=__doc__)
    parser.add_argument("--built", action="store_true", help="take the site that was built last")
    parser.add_argument("--screen", action="append", choices=SCREENS, help="only on this screen")
    parser.add_argument("pages", nargs="*", help="look at these pages only: index.html")
    asked = parser.parse_args()
    OUT.mkdir(parents=True, exist_ok=True)
    if not asked.built:
        start = time.monotonic()
        subprocess.run(
            [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet"],
            cwd=ROOT,
            env=os.environ | {"NO_MKDOCS_2_WARNING": "1"},
            check=True,
        )
        print(f"build: strict, {time.monotonic() - start:.0f} s")
    links = follow(SITE)
    print("\n".join([f"links: {links}", *links.dead]), flush=True)
    pages = [SITE / name for name in asked.pages] or sorted(SITE.rglob("*.html"))
    start = time.monotonic()
    screens = asked.screen or [*SCREENS]
    findings = look_at(pages, SITE, OUT, screens, lambda text: print(text, flush=True))
    print(f"pages: {findings}, {time.monotonic() - start:.0f} s; pictures in {OUT}")
    kinds = {"dead links": links.dead, "grave": findings.grave, "mild": findings.mild}
    report = "\n".join(line for kind, lines in kinds.items() for line in (f"# {kind}", *lines))
    (OUT / "findings.txt").write_text(report + "\n", "utf-8")
    return 1 if links.dead or findings.grave else 0


if __name__ == "__main__":
    sys.exit(main())
