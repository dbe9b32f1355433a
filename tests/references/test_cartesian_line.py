"""`CartesianLine`: the tool stays on the line, the joints inside their limits."""

import sys

import numpy as np
import pinocchio as pin
import pytest

from fotsmc_pin.arms import load_arm
from fotsmc_pin.errors import ArgumentError, MissingDependencyError
from fotsmc_pin.references import CartesianLine

pytest.importorskip("pink", reason="the extra 'ik' is not installed")

START = {
    "panda": [0.0, -0.5, 0.0, -2.2, 0.0, 1.8, 0.8],
    "ur5": [0.0, -1.2, 1.5, -0.5, 1.5, 0.0],
    "kinova": [0.0, 2.9, 1.3, 4.2, 1.4, 0.0],
}


def tool(arm, q):
    data = arm.model.createData()
    pin.framesForwardKinematics(arm.model, data, q)
    return data.oMf[arm.tool_frame_id].copy()


@pytest.mark.parametrize("name", ["panda", "ur5", "kinova"])
def test_the_tool_keeps_to_the_line_and_its_orientation(name, assert_exact_derivatives):
    arm = load_arm(name)
    q = arm.from_joint_positions(START[name])
    way = np.array([0.05, 0.1, -0.05])
    line = CartesianLine.along(arm, way, q=q)
    start = tool(arm, q)
    for share in np.linspace(0, 1, 37):
        place = tool(arm, line(share * line.duration)[0])
        moved = place.translation - start.translation
        along = way @ moved / (way @ way)
        assert -1e-9 < along < 1 + 1e-9
        assert np.linalg.norm(moved - along * way) <= line.deviation + 1e-7
        assert np.linalg.norm(pin.log3(start.rotation.T @ place.rotation)) < 1e-5
    end = tool(arm, line(line.duration)[0]).translation
    np.testing.assert_allclose(end, start.translation + way, atol=1e-7)
    assert line.deviation < 1e-6
    times = np.linspace(0.05, 0.95, 9) * line.duration
    assert_exact_derivatives(arm, line, times, tolerance=1e-4)


def test_a_planar_arm_moves_in_its_plane_alone():
    arm = load_arm("two_link")
    line = CartesianLine.along(arm, [-0.4, 0.0, 0.2], q=[1.0, 1.5], duration=3.0)
    assert line.duration == 3.0
    assert line.deviation < 1e-6
    with pytest.raises(ArgumentError, match="gets no farther"):
        CartesianLine.along(arm, [0.0, 0.3, 0.0], q=[1.0, 1.5])


def test_out_of_reach_says_how_far_it_gets():
    arm = load_arm("panda")
    with pytest.raises(ArgumentError, match=r"no farther than 0\.\d+ of 3 m"):
        CartesianLine.along(arm, [3.0, 0.0, 0.0], q=START["panda"])


def test_too_little_time_says_which_limit_breaks():
    arm = load_arm("panda")
    with pytest.raises(ArgumentError, match="would reach a velocity"):
        CartesianLine.along(arm, [0.0, 0.3, 0.0], q=START["panda"], duration=0.05)


def test_a_missing_package_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "pink", None)
    with pytest.raises(MissingDependencyError, match="pip install pin-pink daqp"):
        CartesianLine.along(load_arm("panda"), [0.1, 0.0, 0.0])
