"""Dead links of a built site: references of every page, held against files and anchors."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import dataclass, field
from html.parser import HTMLParser
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit

if TYPE_CHECKING:
    from pathlib import Path

REFERRING = {"href", "src", "poster", "data-src"}
TEXT = ("script", "style")


class Page(HTMLParser):
    """What a page refers to, and the anchors that it offers."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.references: list[str] = []
        self.anchors: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name == "id" or (tag == "a" and name == "name"):
                self.anchors.add(value or "")
            elif name in REFERRING and value is not None:
                self.references.append(value)


@dataclass
class Links:
    """Counts of what was followed, and what leads nowhere."""

    pages: int = 0
    inside: int = 0
    anchors: int = 0
    outside: Counter[str] = field(default_factory=Counter)
    dead: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        return (
            f"{self.pages} pages, {self.inside} links inside, of which {self.anchors} to anchors, "
            f"{len(self.outside)} addresses outside (not followed), {len(self.dead)} dead"
        )


def follow(site: Path) -> Links:
    """Follow each link of each page of `site`, and each entry of its search, inside of the site."""
    pages = {path.resolve(): Page(path.read_text("utf-8")) for path in site.rglob("*.html")}
    links = Links(pages=len(pages))
    for path, page in sorted(pages.items()):
        for reference in page.references:
            _follow(site, path, reference, pages, links)
    for entry in _found_by_search(site):
        _follow(site, (site / "search").resolve(), entry, pages, links)
    return links


def _found_by_search(site: Path) -> list[str]:
    """Return the addresses, from the site's root, in the index of an offline search."""
    index = site / "search/search_index.js"
    if not index.is_file():
        return []
    text = index.read_text("utf-8")
    return [entry["location"] for entry in json.loads(text[text.index("{") :])["docs"]]


def _follow(site: Path, path: Path, reference: str, pages: dict[Path, Page], links: Links) -> None:
    parts = urlsplit(reference)
    if parts.scheme in ("data", "javascript", "mailto", "blob"):
        return
    if parts.scheme or parts.netloc:
        links.outside[reference] += 1
        return
    links.inside += 1
    place = unquote(parts.path)
    if not place:
        target = path
    elif place.startswith("/"):  # The page for what is not found stands anywhere.
        target = site.resolve() / place.lstrip("/")
    else:
        target = path.parent / place
    target = target.resolve()
    if target.is_dir():
        target /= "index.html"
    anchor = unquote(parts.fragment)
    where = path.relative_to(site.resolve())
    if not target.is_file():
        links.dead.append(f"{where}: {reference}: no such file")
    elif anchor and target in pages:
        links.anchors += 1
        if anchor not in pages[target].anchors:
            links.dead.append(f"{where}: {reference}: no such anchor")
