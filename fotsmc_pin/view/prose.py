"""Markdown as HTML that may stand in a page: no markup of the text's own, and nothing to fetch."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from markdown_it import MarkdownIt


def prose(text: str, *, top: int = 2) -> str:
    """Return Markdown (CommonMark and tables) as HTML.

    HTML in the text is escaped. Links and images stay the characters that they are written with:
    a report fetches nothing.

    Args:
        text: what to show.
        top: level of heading that `#` becomes.
    """
    parser = _parser()
    tokens = parser.parse(text)
    for number, token in enumerate(tokens):
        if token.type in ("heading_open", "heading_close"):
            token.tag = f"h{min(int(token.tag[1]) + top - 1, 6)}"
        elif token.type == "th_open":
            token.attrs = {"scope": "col"}
        elif token.type == "td_open":
            token.attrs = {}  # The page's style aligns numbers.
            if tokens[number - 1].type == "tr_open":  # A row's first cell names the row.
                token.tag = tokens[number + 2].tag = "th"
                token.attrs = {"scope": "row"}
    html: str = parser.renderer.render(tokens, parser.options, {})
    opened, _, closed = scrolling("Table", "<table>|</table>").partition("|")
    return html.replace("<table>", opened).replace("</table>", closed)


@cache
def _parser() -> MarkdownIt:
    from markdown_it import MarkdownIt

    parser = MarkdownIt("commonmark", {"html": False}).enable("table")
    return parser.disable(["link", "image", "autolink", "reference"])


def scrolling(label: str, table: str) -> str:
    """Let a wide table scroll on its own, by keyboard too."""
    return f'<div class="wide" role="group" aria-label="{label}" tabindex="0">{table}</div>'
