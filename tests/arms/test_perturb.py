"""Perturbed arms keep their promises: the same dynamics from the written file, real inertias."""

import numpy as np
import pytest

from fotsmc_pin.arms import load_arm, perturb


def worst_difference(one, other, states=20, seed=0):
    rng = np.random.default_rng(seed)
    worst = 0.0
    for _ in range(states):
        q, v, tau = one.random_configuration(rng), rng.normal(size=one.nv), rng.normal(size=one.nv)
        a, b = one.forward_dynamics(q, v, tau), other.forward_dynamics(q, v, tau)
        worst = max(worst, np.abs(a - b).max() / max(1.0, np.abs(a).max()))
    return worst


@pytest.mark.parametrize("name", ["two_link", "panda", "kinova", "baxter"])
def test_written_urdf_loads_to_the_same_dynamics(tmp_path, name):
    true = perturb(
        load_arm(name),
        mass_scale=1.3,
        payload=2.0,
        com_shift=0.01,
        armature=0.1,
        friction=0.2,
        damping=0.3,
        seed=4,
    )
    again = load_arm(true.write_urdf(tmp_path / "true.urdf"))
    assert worst_difference(true, again) < 1e-10
    for what in ("friction", "damping", "armature", "effort_limit"):
        np.testing.assert_array_equal(getattr(true, what), getattr(again, what))
