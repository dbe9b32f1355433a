"""What a tool holds is weighed beside friction and rotors that nobody knows."""

import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.errors import LogError
from tests.identification import hidden

DURATION = 10.0


def rubbing(arm, seed):
    """Return the arm with friction and rotors that its file does not have."""
    rng = np.random.default_rng(seed)
    return fp.perturb(
        arm,
        friction=rng.uniform(0.2, 0.8, arm.nv),
        damping=rng.uniform(0.1, 0.5, arm.nv),
        armature=hidden.drive_size(arm) / rng.uniform(100.0, 400.0, arm.nv),
    )


def weighed(arm, true, mass, com, seed, **options):
    loaded = fp.perturb(true, payload=fp.Payload(mass=mass, com=com))
    motion = hidden.swings(arm, seed, duration=DURATION)
    log = hidden.calculated(loaded, motion, seed, duration=DURATION)
    return fp.identify_payload(log, arm, **options)


@pytest.mark.parametrize(("mass", "seed"), [(0.5, 1), (3.0, 2)])
def test_mass_and_centre_of_what_a_known_arm_holds(mass, seed):
    arm = fp.load_arm("panda")
    com = np.random.default_rng(seed).uniform(-0.1, 0.1, 3)
    found = weighed(arm, rubbing(arm, seed), mass, com, seed)
    assert found.mass == pytest.approx(mass, rel=0.02)
    assert np.linalg.norm(found.com - com) < 5e-3
    assert abs(found.mass - mass) < 3.0 * found.mass_deviation
    assert np.all(np.abs(found.com - com) < 3.0 * found.com_deviation + 1e-4)
    assert np.all(np.linalg.eigvalsh(found.inertia) > 0.0)
    masses = [body.mass for body in [*found.arm.model.inertias][1:]]
    assert sum(masses) - sum(body.mass for body in [*arm.model.inertias][1:]) == pytest.approx(
        found.mass
    )


def test_an_arm_that_nobody_knows_is_identified_empty_first():
    arm = fp.load_arm("panda")
    true = hidden.hidden_plant(arm, 5, payload=0.0)
    empty = hidden.calculated(true, hidden.swings(arm, 9), 5)
    com = np.array([0.03, -0.02, 0.06])
    found = weighed(arm, true, 1.0, com, 5, empty=empty)
    assert found.mass == pytest.approx(1.0, rel=0.02)
    assert np.linalg.norm(found.com - com) < 5e-3


def test_an_empty_hand_is_told():
    arm = fp.load_arm("ur5")
    motion = hidden.swings(arm, 3, duration=DURATION)
    log = hidden.calculated(rubbing(arm, 3), motion, 3, duration=DURATION)
    with pytest.raises(LogError, match="does not tell that anything is held"):
        fp.identify_payload(log, arm)
