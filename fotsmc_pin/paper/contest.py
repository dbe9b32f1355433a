"""The comparison of section 4.1 under equal conditions: same case, same limits, same search effort.

Every law is tuned by the same search, with the same number of trials and the same seed, to make
`∫ t ‖e‖ dt` small, in two matches:

- `peak`: no torque above what the proposed law takes with the paper's gains;
- `variation`: that, and no more torque variation than the case allows while tracking. Laws with a
  sign use a saturation instead.

So no law wins by more torque, and none is put at a disadvantage by hand. The real arms have the
second match only.
"""

from __future__ import annotations

import json
import warnings
from dataclasses import dataclass, field, replace
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np
from joblib import Parallel, delayed

from fotsmc_pin.analysis import summarize
from fotsmc_pin.control import CONTROLLERS, PaperConditionWarning, TickWarning
from fotsmc_pin.errors import DivergenceError
from fotsmc_pin.evaluation.tuning import Tuned, search_gains
from fotsmc_pin.paper.cases import CASES

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from fotsmc_pin.control import Controller
    from fotsmc_pin.simulation import Recording

TUNING_DURATION = 5.0
TRIALS = {"two_link": 100, "panda": 50, "ur5": 50}
SEED = 0
FAILED = 1e6
PRICE = 10.0
"""Added to the cost, at the least, where a limit is exceeded: more than any run that keeps them."""

PEAK, VARIATION = "peak", "variation"
ABLATION = (0.0, 0.1, 0.3)
"""Orders at which the proposed law is tuned again, to show what the fractional order gains."""


@dataclass(frozen=True, kw_only=True)
class Contestant:
    """A law in a match, with the options that it keeps while its numbers are tuned.

    Attributes:
        name: in tables.
        law: name in `CONTROLLERS`.
        case: name in `CASES`.
        match: `PEAK` or `VARIATION`.
        start: what the search leaves as it is.
    """

    name: str
    law: str
    case: str
    match: str
    start: Mapping[str, Any] = field(default_factory=dict)

    @property
    def key(self) -> str:
        """Name under which the tuned gains are stored."""
        return f"{self.case}/{self.match}/{self.name}"

    @property
    def representative(self) -> bool:
        """Whether the law stands for one whose source could not be found."""
        return CONTROLLERS[self.law].representative

    def controller(self, gains: Mapping[str, Any]) -> Controller:
        """Return the law on the case's nominal arm, with these gains."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PaperConditionWarning)
            warnings.simplefilter("ignore", TickWarning)  # A search goes to the edge.
            return CONTROLLERS[self.law](CASES[self.case].nominal(), 1e-3, **gains)

    def run(self, gains: Mapping[str, Any], duration: float | None = None) -> Recording:
        """Simulate the law with these gains."""
        case = CASES[self.case]
        return case.run(self.controller(gains), duration or case.duration)


def contestants() -> list[Contestant]:
    """Every law in every match, and the proposed law with its order held: the ablation of `α`."""
    matches = [("two_link", PEAK), *((case, VARIATION) for case in CASES)]
    entries = []
    for case, match in matches:
        for name, law in CONTROLLERS.items():
            start = _options(law, case, match)
            entries.append(Contestant(name=name, law=name, case=case, match=match, start=start))
    proposed = CONTROLLERS["AdaptiveFONFTSM"]
    for match in (PEAK, VARIATION):
        for alpha in ABLATION:
            start = {**_options(proposed, "two_link", match), "alpha": alpha}
            entry = Contestant(
                name=f"AdaptiveFONFTSM, α = {alpha:g}",
                law="AdaptiveFONFTSM",
                case="two_link",
                match=match,
                start=start,
            )
            entries.append(entry)
    return entries


def _options(law: type[Controller], case: str, match: str) -> dict[str, Any]:
    """Start of a search: no sign where torque variation counts, `M0` outside on real arms, PID."""
    options: dict[str, Any] = {}
    names = law.Gains.__dataclass_fields__
    if match == VARIATION and "switching" in names:
        options["switching"] = "saturation"
    if case != "two_link" and "practical" in law.presets:
        options = {**law.presets["practical"], **options}
    return {**law.presets.get("pid", {}), **options}


def cost(entry: Contestant, gains: Mapping[str, Any]) -> float:
    """`∫ t ‖e‖ dt` over the first seconds [rad·s²], and a penalty where a limit is exceeded."""
    case = CASES[entry.case]
    try:
        summary = summarize(entry.run(gains, TUNING_DURATION))
    except DivergenceError:
        return FAILED
    excess = max(summary.peak_torque / case.peak_torque - 1.0, 0.0)
    if entry.match == VARIATION:
        excess += max(summary.tail_torque_variation / case.torque_variation - 1.0, 0.0)
    return summary.itae + (PRICE * (1.0 + excess) if excess > 0.0 else 0.0)


def tune_contestant(entry: Contestant) -> Tuned:
    """Search the contestant's gains on the case itself; never worse than its own defaults."""
    held = {name for name in entry.start if name == "alpha" and entry.name != entry.law}
    found = search_gains(
        CONTROLLERS[entry.law],
        lambda gains: cost(entry, gains),
        start=_found_by_law(entry) | dict(entry.start),
        hold=held,
        trials=TRIALS[entry.case],
        seed=SEED,
    )
    untouched = cost(entry, entry.start)
    if untouched <= found.cost:
        return replace(found, gains=dict(entry.start), cost=untouched)
    return found


def _found_by_law(entry: Contestant) -> dict[str, Any]:
    """Gains that the law works out from the arm where none are given, averaged over the joints."""
    law = CONTROLLERS[entry.law]
    names = [name for name, gain in law.Gains.__dataclass_fields__.items() if gain.default is None]
    gains = entry.controller(entry.start).gains
    found = {name: getattr(gains, name) for name in names}
    return {name: float(np.exp(np.log(gain).mean())) for name, gain in found.items() if gain.all()}


def stored_gains() -> dict[str, dict[str, Any]]:
    """Return what `python -m fotsmc_pin.paper.tune` found, by contestant's key."""
    text = files("fotsmc_pin.paper").joinpath("tuned_gains.json").read_text(encoding="utf-8")
    outcomes: dict[str, dict[str, Any]] = json.loads(text)["outcomes"]
    return outcomes


def run_contest(report: Callable[[float], None]) -> dict[str, Recording]:
    """Run every contestant that was tuned: key -> recording."""
    tuned = stored_gains()
    entries = [entry for entry in contestants() if entry.key in tuned]
    runs = Parallel(n_jobs=2, return_as="generator")(
        delayed(entry.run)(tuned[entry.key]["gains"]) for entry in entries
    )
    recordings = {}
    for k, (entry, recording) in enumerate(zip(entries, runs, strict=True)):
        recordings[entry.key] = recording
        report((k + 1) / len(entries))
    return recordings
