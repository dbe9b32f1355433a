"""Runs made up in a moment, and where their pages and pictures are kept."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import fotsmc_pin as fp

if TYPE_CHECKING:
    from collections.abc import Callable

OUTPUT = Path(__file__).parents[2] / "test-output" / "view"


def made_up(arm: fp.Arm, *, duration: float = 4.0, dt: float = 1e-3, **parts: Any) -> fp.Recording:
    """Return a recording in which `arm` swings on and its error dies out; no simulation is run."""
    t = np.arange(round(duration / dt) + 1) * dt
    rate = 0.8 + 0.2 * np.arange(arm.nv)
    swing = 0.35 * np.sin(np.outer(t, rate))
    error = 0.3 * np.exp(-2.0 * t)[:, None] * np.cos(np.arange(arm.nv))
    start = arm.to_joint_positions(arm.neutral)
    limit = np.where(np.isfinite(arm.effort_limit), arm.effort_limit, 50.0)
    made = {
        "t": t,
        "q": np.array([arm.from_joint_positions(p) for p in start + swing + error]),
        "v": rate * 0.35 * np.cos(np.outer(t, rate)),
        "q_d": np.array([arm.from_joint_positions(p) for p in start + swing]),
        "v_d": rate * 0.35 * np.cos(np.outer(t, rate)),
        "e": error,
        "e_dot": -2.0 * error,
        "tau": 0.6 * limit * np.cos(np.outer(t, rate)),
        "signals": {"s": 10.0 * error, "b_hat": np.outer(t, np.ones(2))},
        "arm": arm,
        "metadata": {"controller": "MadeUp", "dt": dt},
    }
    return fp.Recording(**(made | parts))


@pytest.fixture(scope="session")
def make_recording() -> Callable[..., fp.Recording]:
    return made_up


@pytest.fixture(scope="session")
def two_link() -> fp.Recording:
    return made_up(fp.load_arm("two_link_true"))


@pytest.fixture(scope="session")
def output() -> Path:
    """Folder in which pages and pictures are kept for the eye."""
    OUTPUT.mkdir(parents=True, exist_ok=True)
    return OUTPUT
