"""How objects show themselves in a notebook: as the HTML that the package `view` makes of them."""

from __future__ import annotations

from importlib import import_module

from fotsmc_pin.errors import MissingDependencyError


def page_of(thing: object) -> str | None:
    """Return what a notebook shows of `thing` as HTML; None where a library for it is missing.

    A notebook calls `_repr_html_` of an arm, a controller, a recording or a summary, and all of
    these lie below `view`. It is looked up by name, and only when a notebook asks.
    """
    try:
        html: str = import_module("fotsmc_pin.view.notebook").shown(thing)
    except MissingDependencyError:
        return None
    return html
