"""The two-link URDFs are the paper's plant and model, by the file alone."""

import numpy as np
import pytest

from fotsmc_pin.arms import load_arm

LENGTHS = (1.0, 0.85)
ARMATURE, GRAVITY = 5.0, 9.81


def closed_form(masses, q, v):
    """M, C v and G of the equations of the paper, misprints put right."""
    (m1, m2), (l1, l2) = masses, LENGTHS
    (q1, q2), (v1, v2) = q, v
    coupling = m2 * l1 * l2
    m12 = m2 * l2**2 + coupling * np.cos(q2)
    mass = np.array(
        [
            [
                (m1 + m2) * l1**2 + m2 * l2**2 + 2 * coupling * np.cos(q2) + ARMATURE,
                m12,
            ],
            [m12, m2 * l2**2 + ARMATURE],
        ]
    )
    bias = coupling * np.sin(q2) * np.array([-(2 * v1 * v2 + v2**2), v1**2])
    g2 = m2 * l2 * GRAVITY * np.cos(q1 + q2)
    gravity = np.array([(m1 + m2) * l1 * GRAVITY * np.cos(q1) + g2, g2])
    return mass, bias, gravity


@pytest.mark.parametrize(
    ("name", "masses"), [("two_link", (0.4, 1.2)), ("two_link_true", (0.5, 0.5))]
)
def test_terms_equal_the_closed_form(name, masses):
    arm, rng = load_arm(name), np.random.default_rng(1)
    worst = 0.0
    for _ in range(1000):
        q, v = rng.uniform(-np.pi, np.pi, 2), rng.uniform(-5, 5, 2)
        mass, bias, gravity = closed_form(masses, q, v)
        worst = max(
            worst,
            abs(arm.mass_matrix(q) - mass).max(),
            abs(arm.coriolis(q, v) @ v - bias).max() / max(1.0, abs(bias).max()),
            abs(arm.gravity(q) - gravity).max(),
        )
    assert worst < 1e-12


def test_files_differ_in_masses_alone():
    model, true = load_arm("two_link"), load_arm("two_link_true")
    assert model.joint_names == true.joint_names == ("joint1", "joint2")
    for name in ("effort_limit", "armature", "lower_position_limit", "friction"):
        np.testing.assert_array_equal(getattr(model, name), getattr(true, name))
    np.testing.assert_array_equal(model.armature, [5.0, 5.0])
    assert np.isfinite(model.effort_limit).all()
