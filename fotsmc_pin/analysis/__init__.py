"""Judging a run: metrics, and the bounds that theory gives."""

from fotsmc_pin.analysis.metrics import Summary, summarize

__all__ = ["Summary", "summarize"]
