"""Linear algebra of mass matrices, against NumPy's."""

import numpy as np
import pytest

from fotsmc_pin.control.small_matrices import cholesky, invert, solve

RNG = np.random.default_rng(0)
ROOT = RNG.normal(size=(7, 7))
M, B = ROOT @ ROOT.T + 0.1 * np.eye(7), RNG.normal(size=7)


@pytest.mark.parametrize("in_place", [False, True])
def test_equations_of_a_mass_matrix_are_solved(in_place):
    given, found, inverse = M.copy(), B.copy(), np.zeros((7, 7))
    factor = given if in_place else np.zeros((7, 7))
    cholesky(given, factor)
    solve(factor, found)
    assert found == pytest.approx(np.linalg.solve(M, B), rel=1e-9)
    invert(factor, inverse)
    assert inverse @ M == pytest.approx(np.eye(7), abs=1e-10)
