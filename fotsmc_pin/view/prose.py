"""The little Markdown that this library writes, as HTML: headings, lists, tables, paragraphs."""

from __future__ import annotations

import html
import re


def prose(text: str, *, top: int = 2) -> str:
    """Return `text` as HTML, everything in it escaped.

    Known are headings (`#`), bullet lists (`-`), tables (`|`), paragraphs, `**strong**` and
    `` `code` ``.

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
    if len(lines) > 1 and re.fullmatch(r"[|:\- ]+", lines[1]):
        return [scrolling("Table", _table([_cells(line) for line in (lines[0], *lines[2:])]))]
    return [f"<p>{_inline(' '.join(lines))}</p>"] if lines else []


def _cells(line: str) -> list[str]:
    return [_inline(cell.strip()) for cell in line.strip().strip("|").split("|")]


def _table(rows: list[list[str]]) -> str:
    head = "".join(f'<th scope="col">{cell}</th>' for cell in rows[0])
    body = "".join(
        f'<tr><th scope="row">{first}</th>{"".join(f"<td>{cell}</td>" for cell in others)}</tr>'
        for first, *others in rows[1:]
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def scrolling(label: str, table: str) -> str:
    """Let a wide table scroll on its own, by keyboard too."""
    return f'<div class="wide" role="group" aria-label="{label}" tabindex="0">{table}</div>'


def _inline(text: str) -> str:
    escaped = html.escape(text)
    escaped = re.sub(r"`([^`]+)`", r"<code>\1</code>", escaped)
    return re.sub(r"\*\*(.+?)\*\*", r"<strong>\1</strong>", escaped)
