"""What a claim is, and what a verdict on it says."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    Metrics = Mapping[str, Any]
    Finding = tuple[str, str, str]

HOLDS, PARTLY, FAILS = "yes", "partly", "no"


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """The verdict on a claim.

    Attributes:
        where: where it is printed.
        claim: what it says.
        printed: the printed value.
        measured: the measured value.
        word: whether it holds: yes, partly or no.
        why: the reason in plain words.
    """

    where: str
    claim: str
    printed: str
    measured: str
    word: str
    why: str


@dataclass(frozen=True, kw_only=True)
class Claim:
    """A claim of the paper and the rule that judges it from the metrics."""

    where: str
    claim: str
    printed: str
    judge: Callable[[Metrics], Finding]

    def verdict(self, metrics: Metrics) -> Verdict:
        """Judge the claim: (measured, word, why) from the metrics alone."""
        measured, word, why = self.judge(metrics)
        return Verdict(
            where=self.where,
            claim=self.claim,
            printed=self.printed,
            measured=measured,
            word=word,
            why=why,
        )


def word(holds: bool) -> str:
    """Return yes or no."""
    return HOLDS if holds else FAILS


def seconds(value: float | str) -> str:
    """Return a time as text; infinity, also as it stands in JSON, is "never"."""
    return "never" if value == "inf" or math.isinf(float(value)) else f"{float(value):.2f} s"


def as_markdown(verdicts: list[Verdict]) -> str:
    """Return the verdicts as a page of text."""
    lines = [
        "# What the paper claims, and what was measured",
        "",
        "Two-link case, 1 kHz, the paper's gains with the readings of the `paper` preset. Every",
        "verdict follows from the numbers in `metrics.json`.",
        "",
    ]
    for verdict in verdicts:
        lines += [
            f"## {verdict.where}: {verdict.claim}",
            "",
            f"- printed: {verdict.printed}",
            f"- measured: {verdict.measured}",
            f"- holds: **{verdict.word}**: {verdict.why}.",
            "",
        ]
    return "\n".join(lines)
