"""What a type checker must accept and refuse; mypy reads this file and nobody runs it.

A line that should be wrong carries a `type: ignore` for its very error. Where the checker no longer
sees the error, it reports the comment as unused, and the check fails.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import fotsmc_pin as fp

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


def right(arm: fp.Arm) -> None:
    law = fp.RobustFONFTSM(arm, 1e-3, alpha=0.3, A=[25.0] * arm.nv, theta=12.0, anti_windup=True)
    alpha: float = law.gains.alpha
    theta: Array = law.gains.theta
    switching: str = fp.LinearSMC(arm, 1e-3, preset="sign", switching="tanh").gains.switching
    print(alpha, theta, switching, fp.AdaptiveFONFTSM(arm, 1e-3, upsilon_0=0.1).gains.upsilon_0)


def wrong(arm: fp.Arm) -> None:
    fp.RobustFONFTSM(arm, 1e-3, thet=12.0)  # type: ignore[call-arg]
    fp.RobustFONFTSM(arm, 1e-3, alpha="half")  # type: ignore[arg-type]
    fp.RobustFONFTSM(arm, 1e-3, anti_windup=0.5)  # type: ignore[arg-type]
    fp.LinearSMC(arm, 1e-3, switching="signum")  # type: ignore[arg-type]
    fp.FONFTSM(arm, 1e-3, upsilon_0=0.1)  # type: ignore[call-arg]
    fp.ComputedTorque(arm, 1e-3, kp=[1.0, 2.0], kd=None)  # type: ignore[arg-type]
    fp.ComputedTorque(arm, 1e-3).gains.kq  # type: ignore[attr-defined]
