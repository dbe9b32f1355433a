"""Ctrl-C in the middle of a run: what was recorded is not lost."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from fotsmc_pin.errors import RunInterrupted

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from fotsmc_pin.simulation.recording import Recording


@contextmanager
def kept_on_interrupt(recording: Callable[[], Recording]) -> Iterator[None]:
    """Let an interrupt of the block carry what was recorded until then.

    Raises:
        RunInterrupted: in place of a plain `KeyboardInterrupt`.
    """
    try:
        yield
    except KeyboardInterrupt as stop:
        raise RunInterrupted(recording()) from stop
