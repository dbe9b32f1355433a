"""Interpolating splines as piecewise polynomials."""

from __future__ import annotations

from math import factorial
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.interpolate import make_interp_spline

if TYPE_CHECKING:
    from numpy.typing import NDArray


def spline_pieces(
    t: NDArray[np.float64], x: NDArray[np.float64], *, degree: int, rest: bool
) -> NDArray[np.float64]:
    """Return the spline through samples as coefficients, (degree + 1, n - 1, columns).

    Args:
        t: times, (n,), increasing.
        x: samples, (n, columns).
        degree: 3 or 5; the spline has `degree - 1` continuous derivatives.
        rest: whether velocity (and acceleration, at degree 5) is zero at both ends; otherwise
            the ends are free (not-a-knot).
    """
    still = [(order, np.zeros(x.shape[1])) for order in range(1, (degree + 1) // 2)]
    # SciPy takes pairs of (order, value) for each end, which its type stubs do not know.
    ends: Any = (still, still) if rest else None
    spline = make_interp_spline(t, x, k=degree, bc_type=ends)
    # Taylor coefficients at the break points, since a not-a-knot spline has fewer pieces.
    powers = [spline(t[:-1], nu=order) / factorial(order) for order in range(degree + 1)]
    return np.stack(powers[::-1])
