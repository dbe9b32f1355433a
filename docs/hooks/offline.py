"""Holds the built site to working from disk: nothing is fetched from elsewhere."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from mkdocs.exceptions import PluginError

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig

FETCHED_BY_PAGES = re.compile(
    r"<(?:script|link|img|iframe|source|video|audio)\b[^>]*?\b(?:src|href)=[\"']?(?:https?:)?//[^\"'>\s]+"
)
FETCHED_BY_STYLES = re.compile(r"(?:url\(|@import)\s*[\"']?(?:https?:)?//[^\"')\s]+")


def on_post_template(output_content: str, template_name: str, config: MkDocsConfig) -> str:
    """Leave out the page for what is not found: it needs a server, and its address beforehand."""
    return "" if template_name == "404.html" else output_content


def on_post_build(config: MkDocsConfig) -> None:
    """Stop the build if a page or a style names another server to fetch from."""
    site = Path(config.site_dir)
    for path in sorted(site.rglob("*")):
        kind = {".html": FETCHED_BY_PAGES, ".css": FETCHED_BY_STYLES}.get(path.suffix)
        # The gallery's pages are held to it by the tests of the view, in a browser.
        if kind is None or (site / "gallery") in path.parents:
            continue
        found = kind.search(path.read_text("utf-8"))
        if found:
            raise PluginError(f"{path.relative_to(site)} would fetch: {found[0]}")
