"""Runs made up in a moment, and where their pages and pictures are kept."""

from __future__ import annotations

import html
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import fotsmc_pin as fp

if TYPE_CHECKING:
    from collections.abc import Callable

GANTRY = """<robot name="gantry">
<link name="rail"/><link name="bridge">{body}</link><link name="wrist">{body}</link>
<joint name="slide" type="prismatic"><parent link="rail"/><child link="bridge"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1" effort="400" velocity="1"/></joint>
<joint name="turn" type="revolute"><parent link="bridge"/><child link="wrist"/><axis xyz="0 0 1"/>
<origin xyz="0 0.2 -0.3"/><limit lower="-2" upper="2" effort="30" velocity="2"/></joint>
</robot>"""
BODY = """<inertial><mass value="2"/>
<inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><box size="0.2 0.1 0.1"/></geometry></visual>"""

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
def gantry(tmp_path_factory) -> fp.Recording:
    """Return a run of an arm with a prismatic joint, in metres, and a revolute one, in radians."""
    file = tmp_path_factory.mktemp("gantry") / "gantry.urdf"
    file.write_text(GANTRY.format(body=BODY))
    return made_up(fp.load_arm(file), duration=2.0)


@pytest.fixture(scope="session")
def text_of() -> Callable[[str], str]:
    """Return what tells the words of a report, without styles and tags."""

    def text(page: str) -> str:
        page = re.sub(r"<style>.*?</style>", "", outside_the_frame(page), flags=re.DOTALL)
        return html.unescape(re.sub(r"<[^>]+>", "\n", page))

    return text


def outside_the_frame(page: str) -> str:
    """Return the report's own markup: a quoted attribute holds the page in the frame."""
    return re.sub(r'srcdoc="[^"]*"', "", page)


@pytest.fixture(scope="session")
def output() -> Path:
    """Folder in which pages and pictures are kept for the eye."""
    OUTPUT.mkdir(parents=True, exist_ok=True)
    return OUTPUT
