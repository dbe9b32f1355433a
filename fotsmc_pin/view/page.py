"""The HTML file around a document: everything inside, nothing fetched."""

from __future__ import annotations

import html
import importlib.util
import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fotsmc_pin.errors import MissingDependencyError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

ASSETS = Path(__file__).parent / "assets"
SCRIPTS = ("data", "geometry", "pushes", "arms", "stage", "charts", "readout", "player", "main")


def page(document: Mapping[str, Any], arrays: str, texts: Mapping[str, str]) -> str:
    """Return the whole page.

    Args:
        document: what the page shows; see `fotsmc_pin.view.document`.
        arrays: the packed arrays that the document refers to.
        texts: `generator`, `title`, `subtitle`, `error_unit` and `torque_unit` as plain text;
            `notice`, `key` and `facts` as HTML.
    """
    markup = {"notice", "key", "facts"}
    parts = {name: text if name in markup else html.escape(text) for name, text in texts.items()}
    own = "\n".join((ASSETS / f"{name}.js").read_text("utf-8") for name in SCRIPTS)
    parts |= {
        "style": (ASSETS / "uPlot.min.css").read_text("utf-8")
        + (ASSETS / "page.css").read_text("utf-8"),
        "document": in_script(json.dumps(document, ensure_ascii=False, allow_nan=False)),
        "arrays": arrays,
        "scripts": "\n".join(
            f"<script>{_closed(script)}</script>"
            for script in (
                meshcat_script(),
                (ASSETS / "uPlot.iife.min.js").read_text("utf-8"),
                f'(() => {{\n"use strict";\n{own}}})();',
            )
        ),
    }
    template = (ASSETS / "page.html").read_text("utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match[1]], template)


def in_script(text: str) -> str:
    """Escape JSON so that no text in it can end the script element that holds it."""
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def facts_list(about: Sequence[tuple[str, str, Sequence[tuple[str, Sequence[str]]]]]) -> str:
    """Return what is known of the runs as folded HTML.

    Args:
        about: for each run its heading (empty for a run alone), a sentence, and names with words.
    """
    parts = [
        (f"<h2>{html.escape(name)}</h2>" if name else "")
        + f"<p>{html.escape(sentence)}</p><dl>"
        + "".join(
            f"<dt>{html.escape(key)}</dt><dd>{'<br>'.join(map(html.escape, words))}</dd>"
            for key, words in facts
        )
        + "</dl>"
        for name, sentence, facts in about
    ]
    title = "About this run" if len(about) == 1 else "About these runs"
    return f"<details><summary>{title}</summary>{''.join(parts)}</details>"


def meshcat_script() -> str:
    """Return Meshcat's packaged viewer, three.js included.

    Meshcat is found, not imported: importing it loads its server.

    Raises:
        MissingDependencyError: meshcat is not installed.
    """
    spec = importlib.util.find_spec("meshcat")
    for folder in (spec.submodule_search_locations or []) if spec else []:
        script = Path(folder) / "viewer" / "dist" / "main.min.js"
        if script.is_file():
            return script.read_text("utf-8")
    raise MissingDependencyError("meshcat's viewer is not there; run: pip install meshcat")


def _closed(script: str) -> str:
    """Keep a script's own strings from ending the element that holds it."""
    return re.sub(r"</(script)", r"<\\/\1", script, flags=re.IGNORECASE)
