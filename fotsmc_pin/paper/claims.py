"""The paper's claims, each with a verdict that follows from `metrics.json` and nothing else."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fotsmc_pin.paper.claims_alone import CLAIMS_ALONE
from fotsmc_pin.paper.claims_compared import CLAIMS_COMPARED

if TYPE_CHECKING:
    from fotsmc_pin.paper.verdicts import Metrics, Verdict

CLAIMS = (*CLAIMS_ALONE, *CLAIMS_COMPARED)
"""The claims of sections 3, 4, 4.1 and 5."""


def judge(metrics: Metrics) -> list[Verdict]:
    """Return the verdict on every claim; `metrics` is the content of `metrics.json`."""
    return [claim.verdict(metrics) for claim in CLAIMS]
