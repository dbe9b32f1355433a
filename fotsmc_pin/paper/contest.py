"""The comparison of section 4.1 under equal conditions: same case, same limits, same search effort.

Every law is tuned by the same search, with the same number of trials and the same seed, to make
`∫ t ‖e‖ dt` small, twice:

- matched in peak torque: none above what the proposed law takes with the paper's gains;
- matched in torque variation as well: no more than `VARIATION` while tracking, for which laws with
  a sign take a saturation.

So nobody wins by force, and nobody is hand-crippled.
"""

from __future__ import annotations

import json
import warnings
from dataclasses import dataclass, field
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from fotsmc_pin.analysis import summarize
from fotsmc_pin.control import CONTROLLERS, PaperConditionWarning
from fotsmc_pin.errors import DivergenceError
from fotsmc_pin.paper import two_link
from fotsmc_pin.tuning import Tuned, search_gains

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from fotsmc_pin.control import Controller
    from fotsmc_pin.simulation import Recording

PEAK = 365.0
"""Largest torque in both matches [N·m]; the paper's gains take 362."""
VARIATION = 100.0
"""Largest torque variation over the last half in the second match [N·m/s]; the reference and the
printed disturbance cannot be followed with less than about 10."""
TUNING_DURATION = 5.0
TRIALS = 200
SEED = 0
FAILED = 1e6

PEAK_MATCH, VARIATION_MATCH = "peak", "variation"
MATCHES = (PEAK_MATCH, VARIATION_MATCH)


@dataclass(frozen=True, kw_only=True)
class Contestant:
    """A law with the options that it keeps while its numbers are tuned.

    Attributes:
        name: in tables.
        law: name in `CONTROLLERS`.
        match: one of `MATCHES`.
        start: options and gains from which the search starts.
    """

    name: str
    law: str
    match: str
    start: Mapping[str, Any] = field(default_factory=dict)

    @property
    def representative(self) -> bool:
        """Whether the law stands for one whose source could not be found."""
        return CONTROLLERS[self.law].representative

    def controller(self, gains: Mapping[str, Any]) -> Controller:
        """Return the law on the nominal arm, from its first preset with these gains."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PaperConditionWarning)
            return CONTROLLERS[self.law](two_link.nominal_arm(), two_link.DT, **gains)


def contestants() -> list[Contestant]:
    """Every law in both matches; then the proposed law with its order held, the ablation of α."""
    entries = []
    for match in MATCHES:
        for name, law in CONTROLLERS.items():
            entries.append(Contestant(name=name, law=name, match=match, start=_options(law, match)))
        entries += [
            Contestant(
                name=f"AdaptiveFONFTSM, α = {alpha:g}",
                law="AdaptiveFONFTSM",
                match=match,
                start=_options(CONTROLLERS["AdaptiveFONFTSM"], match) | {"alpha": alpha},
            )
            for alpha in (0.0, 0.1, 0.3)
        ]
    return entries


def _options(law: type[Controller], match: str) -> dict[str, Any]:
    names = law.Gains.__dataclass_fields__
    if match == VARIATION_MATCH and names.get("switching") is not None:
        return {"switching": "saturation"}
    return {}


def cost(contestant: Contestant, gains: Mapping[str, Any]) -> float:
    """`∫ t ‖e‖ dt` over the first seconds [rad·s²], and a large price where a limit is exceeded."""
    try:
        rec = two_link.run(contestant.controller(gains), duration=TUNING_DURATION, substeps=1)
    except DivergenceError:
        return FAILED
    summary = summarize(rec)
    excess = max(summary.peak_torque / PEAK - 1.0, 0.0)
    if contestant.match == VARIATION_MATCH:
        excess += max(summary.tail_torque_variation / VARIATION - 1.0, 0.0)
    return summary.itae + (1.0 + excess if excess > 0.0 else 0.0) * 10.0


def tune(contestant: Contestant, *, trials: int = TRIALS, seed: int = SEED) -> Tuned:
    """Search the contestant's gains on the case itself."""
    return search_gains(
        CONTROLLERS[contestant.law],
        lambda gains: cost(contestant, gains),
        start=contestant.start,
        hold=set(contestant.start),
        trials=trials,
        seed=seed,
    )


def stored_gains() -> dict[str, dict[str, dict[str, Any]]]:
    """Return the gains that `python -m fotsmc_pin.paper.tune` found: match -> name -> outcome."""
    text = files("fotsmc_pin.paper").joinpath("tuned_gains.json").read_text(encoding="utf-8")
    outcomes: dict[str, dict[str, dict[str, Any]]] = json.loads(text)["matches"]
    return outcomes


def run_contest(
    report: Callable[[float], None], entries: Iterable[Contestant] | None = None
) -> dict[str, dict[str, Recording]]:
    """Run every contestant with its stored gains: match -> name -> recording."""
    gains = stored_gains()
    entries = [
        entry
        for entry in (contestants() if entries is None else entries)
        if entry.name in gains[entry.match]
    ]
    recordings: dict[str, dict[str, Recording]] = {match: {} for match in MATCHES}
    for k, entry in enumerate(entries):
        law = entry.controller(gains[entry.match][entry.name]["gains"])
        recordings[entry.match][entry.name] = two_link.run(law, substeps=2)
        report((k + 1) / len(entries))
    return recordings
