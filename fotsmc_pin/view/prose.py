"""The little Markdown that this library writes, as HTML: headings, lists, paragraphs, emphasis."""

from __future__ import annotations

import html
import re


def prose(text: str, *, top: int = 2) -> str:
    """Return `text` as HTML, everything in it escaped.

    Known are headings (`#`), bullet lists (`-`), paragraphs, `**strong**` and `` `code` ``.

    Args:
        text: what to show.
        top: level of heading that `#` becomes.
    """
    blocks = re.split(r"\n\s*\n", text.strip())
    return "\n".join(part for block in blocks for part in _block(block.strip(), top))


def _block(block: str, top: int) -> list[str]:
    lines = block.splitlines()
    heading = re.match(r"(#+)\s+(.*)", lines[0]) if lines else None
    if heading:
        level = min(len(heading[1]) + top - 1, 6)
        rest = "\n".join(lines[1:]).strip()
        return [f"<h{level}>{_inline(heading[2])}</h{level}>", *(_block(rest, top) if rest else [])]
    if lines and lines[0].startswith("- "):
        items = re.split(r"^- ", block, flags=re.MULTILINE)[1:]
        return ["<ul>", *(f"<li>{_inline(' '.join(item.split()))}</li>" for item in items), "</ul>"]
    return [f"<p>{_inline(' '.join(lines))}</p>"] if lines else []


def _inline(text: str) -> str:
    escaped = html.escape(text)
    escaped = re.sub(r"`([^`]+)`", r"<code>\1</code>", escaped)
    return re.sub(r"\*\*(.+?)\*\*", r"<strong>\1</strong>", escaped)
