from pathlib import Path

import pytest

import fotsmc_pin as fp

SEVEN_JOINTS = Path(__file__).parent / "seven_joints.urdf"


@pytest.fixture(scope="session")
def ur5():
    return fp.load_arm("ur5")


@pytest.fixture(scope="session")
def seven():
    return fp.load_arm(SEVEN_JOINTS)
