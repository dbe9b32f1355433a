"""An independent solver of Coulomb friction in a step, for comparison: slow, plain and long-winded.

It iterates on the impulses of friction with the inverse of the mass matrix, as the solver under
test does not.
"""

import numpy as np


def speeds_with_friction(h, mass, free, friction, damping, sweeps=20_000, tolerance=1e-14):
    """Return `v = v_free + M⁻¹ p`, with `p = -h (D v + F sign v)` and `|p| ≤ h F` at rest."""
    inverse = np.linalg.inv(mass)
    v, impulse = np.array(free), np.zeros(len(free))
    for _ in range(sweeps):
        moved = 0.0
        for j in range(len(v)):
            own = inverse[j, j]
            alone = v[j] - own * impulse[j]
            slip = max(abs(alone) - h * friction[j] * own, 0.0) / (1.0 + h * damping[j] * own)
            new = (np.copysign(slip, alone) - alone) / own
            change, impulse[j] = new - impulse[j], new
            v += inverse[:, j] * change
            moved = max(moved, abs(own * change))
        if moved < tolerance * (1.0 + np.abs(v).max()):
            return v
    raise AssertionError("the oracle did not converge")
