"""Claims by comparison: section 4.1, and what the conclusion says of fractional order.

Every rival is judged as tuned by the same search under the same peak torque (`contest`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fotsmc_pin.paper.contest import PEAK, VARIATION
from fotsmc_pin.paper.verdicts import FAILS, HOLDS, PARTLY, Claim, seconds, word

if TYPE_CHECKING:
    from fotsmc_pin.paper.verdicts import Finding, Metrics

NEAR = 0.3
"""A time counts as near a printed one within this share of it."""
PROPOSED = "AdaptiveFONFTSM, α = 0.1"
"""The proposed law with the paper's order, its other gains tuned like every rival's."""
SIMILAR = 2.0
"""Two errors are similar within this factor."""


def _rival(m: Metrics, law: str, match: str = PEAK) -> dict[str, Any]:
    run: dict[str, Any] = m["contest"][f"two_link/{match}/{law}"]
    return run


def _told(name: str, run: Metrics) -> str:
    return (
        f"{name}: 10 mrad at {seconds(run['settling_time'])}, "
        f"{1e3 * run['tail_rms_error']:.3g} mrad RMS left, {run['peak_torque']:.0f} N·m at most"
    )


def _integer_order_time(m: Metrics) -> Finding:
    rival = _rival(m, "ContinuousTSM")
    measured = float(rival["settling_time"])
    return (
        _told("[45]", rival),
        word(abs(measured - 3.0) <= NEAR * 3.0),
        "the paper gives no gains for it; these are tuned under the proposed law's peak torque",
    )


def _second_order_time(m: Metrics) -> Finding:
    rival = _rival(m, "SuperTwistingSMC")
    return (
        _told("super-twisting", rival),
        word(float(rival["settling_time"]) > 6.0),
        "the law of [49] is not printed; a representative stands for it, tuned like the others",
    )


def _faster_and_more_accurate(m: Metrics, law: str, label: str) -> Finding:
    """Compare the proposed law with another in settling time and error left, in both matches."""
    told, won = [], []
    for match in (PEAK, VARIATION):
        own, rival = _rival(m, PROPOSED, match), _rival(m, law, match)
        told += [_told(f"proposed ({match})", own), _told(f"{label} ({match})", rival)]
        won += [
            float(own["settling_time"]) < float(rival["settling_time"]),
            own["tail_rms_error"] < rival["tail_rms_error"],
        ]
    return (
        "; ".join(told),
        HOLDS if all(won) else PARTLY if any(won) else FAILS,
        f"with equal search, under equal peak torque it is {_said(won[0], 'faster')} and "
        f"{_said(won[1], 'more accurate')}; under equal torque variation it is "
        f"{_said(won[2], 'faster')} and {_said(won[3], 'more accurate')}",
    )


def _against_integer_order(m: Metrics) -> Finding:
    return _faster_and_more_accurate(m, "ContinuousTSM", "[45]")


def _fractional_order(m: Metrics) -> Finding:
    return _faster_and_more_accurate(m, "AdaptiveFONFTSM, α = 0", "the same law with α = 0")


def _said(true: bool, quality: str) -> str:
    return quality if true else f"not {quality}"


def _against_second_order(m: Metrics) -> Finding:
    own, rival = _rival(m, PROPOSED), _rival(m, "SuperTwistingSMC")
    faster = float(own["settling_time"]) < float(rival["settling_time"])
    return (
        "; ".join((_told("proposed, tuned", own), _told("super-twisting", rival))),
        word(faster),
        "the second-order law settles "
        + ("later" if faster else "no later")
        + f" and keeps {1e3 * rival['tail_rms_error']:.3g} mrad",
    )


def _fractional_sign(m: Metrics) -> Finding:
    sign, rival = m["runs"]["paper"], _rival(m, "LinearSMC")
    return (
        f"torque variation {sign['tail_torque_variation']:.0f} N·m/s, against "
        f"{rival['tail_torque_variation']:.0f} of a linear surface with a pure sign",
        FAILS if sign["chattering"] > 0.1 else HOLDS,
        "an integral of order 0.1 passes nearly all of a sign that flips every tick: less "
        f"chattering, but {100 * sign['chattering']:.0f} % of the torque's power is above 20 Hz",
    )


def _model_free(m: Metrics) -> Finding:
    own, rival = (_rival(m, law, VARIATION) for law in (PROPOSED, "TDEFONTSM"))
    ratio = rival["tail_rms_error"] / own["tail_rms_error"]
    smooth = max(own["chattering"], rival["chattering"]) < 0.01
    similar = 1.0 / SIMILAR <= ratio <= SIMILAR
    return (
        "; ".join((_told("proposed", own), _told("model-free", rival))),
        HOLDS if similar and smooth else PARTLY if similar or smooth else FAILS,
        "the law of [50] is not printed; a representative stands for it. Tuned under the same "
        f"torque variation, with no sign in either, the errors left differ by a factor {ratio:.2g}",
    )


def _no_bounds_needed(m: Metrics) -> Finding:
    given, none = m["runs"]["paper"], m["runs"]["no_bounds"]
    kept = float(none["settling_time"]) < 1.2 * float(given["settling_time"])
    return (
        f"10 mrad at {seconds(none['settling_time'])} with B̂0 = B̂1 = 0 at the start, "
        f"{seconds(given['settling_time'])} with 5",
        word(kept),
        "the estimates rise by themselves within the first 0.2 s"
        if kept
        else "the start of the estimates matters",
    )


CLAIMS_COMPARED: tuple[Claim, ...] = (
    Claim(
        where="Section 4.1",
        claim="the integer-order terminal law [20] reaches in near 3 s",
        printed="3 s",
        judge=_integer_order_time,
    ),
    Claim(
        where="Section 4.1",
        claim="second-order sliding mode takes more than 6 s",
        printed="> 6 s",
        judge=_second_order_time,
    ),
    Claim(
        where="Section 4.1, Fig. 8, 9, Section 5",
        claim="the proposed law is faster and more accurate than the integer-order one",
        printed="< 1 s against 3 s",
        judge=_against_integer_order,
    ),
    Claim(
        where="Section 4.1",
        claim="the proposed law reaches before second-order sliding mode",
        printed="< 1 s against > 6 s",
        judge=_against_second_order,
    ),
    Claim(
        where="Section 4.1, Section 5",
        claim="it is the fractional order that makes tracking faster and more accurate",
        printed="in words",
        judge=_fractional_order,
    ),
    Claim(
        where="Section 4.1, after [34]",
        claim="a sign of fractional order attenuates chattering",
        printed="chatter-free",
        judge=_fractional_sign,
    ),
    Claim(
        where="Section 4.1, [50]",
        claim="the model-free law tracks alike, and both controls are chatter-free",
        printed="in words",
        judge=_model_free,
    ),
    Claim(
        where="Section 5",
        claim="adaptation makes the bounds of the uncertainty unnecessary",
        printed="in words",
        judge=_no_bounds_needed,
    ),
)
"""Claims that need the contest, in the order of the print."""
