"""Warnings that point at the user's line, however deep in the library they arise."""

from __future__ import annotations

import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import FrameType

PACKAGE = str(Path(__file__).parent)


def warn_user(message: str, category: type[Warning], made: object = None) -> None:
    """Warn at the nearest line outside this package.

    Args:
        message: what is wrong, and what to do.
        category: class of the warning.
        made: an object under construction; constructors of a user's subclass of it count as inside.
    """
    frame = sys._getframe(1)
    while frame.f_back is not None and (_is_ours(frame) or _constructs(frame, made)):
        frame = frame.f_back
    where = frame.f_globals
    warnings.warn_explicit(
        message,
        category,
        filename=frame.f_code.co_filename,
        lineno=frame.f_lineno,
        module=where.get("__name__"),
        registry=where.setdefault("__warningregistry__", {}),
    )


def _is_ours(frame: FrameType) -> bool:
    return frame.f_code.co_filename.startswith(PACKAGE)


def _constructs(frame: FrameType, made: object) -> bool:
    code = frame.f_code
    if made is None or code.co_name != "__init__" or not code.co_varnames:
        return False
    return frame.f_locals.get(code.co_varnames[0]) is made
