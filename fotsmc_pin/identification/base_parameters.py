"""Base parameters: what any motion of an arm can tell of its parameters, and what none can.

Torque depends on fewer numbers than the arm has: a first link that only turns about a vertical axis
shows one moment of inertia and no mass. Base parameters are as many sums of parameters as torque
depends on, found from random motions of the arm by an orthogonal factorisation of the regressor
(Gautier, Journal of Robotic Systems, 1991).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.identification.regressor import body_columns

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.identification.regressor import Parameters
    from fotsmc_pin.types import Array

SAMPLES = 200
NEGLIGIBLE, DEPENDENT = 1e-8, 1e-6
"""Share in a sum that is no share; part of a column, over it, that others explain no further."""
BODY = ("m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
"""Symbols of a body's parameters."""
UNITS = ("kg", *["kg·m"] * 3, *["kg·m²"] * 6)
ROTARY = {"armature": "kg·m²", "damping": "N·m·s/rad"}
SLIDING = {"armature": "kg", "damping": "N·s/m"}
OWN = {
    "armature": "armature",
    "damping": "viscous",
    "friction": "Coulomb",
    "offset": "offset",
    "stribeck": "Stribeck",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Base:
    """The base parameters of an arm, `b` of them: `β = B θ`.

    Attributes:
        matrix: `B` (b, p).
        names: what each is the sum of.
        units: of each.
        without_effect: parameters that torque never depends on.
        together: for each base parameter of several parameters, these.
    """

    matrix: Array
    names: tuple[str, ...]
    units: tuple[str, ...]
    without_effect: tuple[str, ...]
    together: tuple[tuple[str, ...], ...]


def base_of(arm: Arm, parameters: Parameters) -> Base:
    """Return the base parameters of an arm; gravity as the arm feels it."""
    n, rng = arm.nv, np.random.default_rng(0)
    x = np.array([arm.to_joint_positions(arm.random_configuration(rng)) for _ in range(SAMPLES)])
    v, a = 2.0 * rng.standard_normal((SAMPLES, n)), 5.0 * rng.standard_normal((SAMPLES, n))
    table = np.zeros((SAMPLES, n, parameters.size))
    table[:, :, : 10 * n] = body_columns(arm, x, v, a)
    own = {
        "armature": a,
        "damping": v,
        "friction": np.sign(v),
        "offset": np.ones_like(v),
        "stribeck": np.sign(v) * np.exp(-(v**2)),
    }
    for name in parameters.own:
        for j in range(n):
            table[:, j, parameters.groups[name].start + j] = own[name][:, j]
    flat = table.reshape(-1, parameters.size)
    # The first in this order stand for themselves and the later ones are added to them: each
    # joint's own, then the bodies from the base on, and masses last, since a mass is felt as a
    # moment of the body that carries it.
    bodies = np.arange(10 * n).reshape(n, 10)
    order = np.r_[10 * n : parameters.size, bodies[:, 1:].ravel(), bodies[:, 0]]
    return _base(flat, order, names_of(arm, parameters), units_of(arm, parameters))


def _base(flat: Array, order: np.ndarray, names: list[str], units: list[str]) -> Base:
    scale = np.linalg.norm(flat, axis=0)
    silent = scale < NEGLIGIBLE * scale.max()
    basis = np.zeros((len(flat), 0))
    chosen: list[int] = []
    for column in order:
        if silent[column]:
            continue
        rest = flat[:, column] / scale[column]
        for _ in range(2):
            rest = rest - basis @ (basis.T @ rest)
        length = float(np.linalg.norm(rest))
        if length > DEPENDENT:
            basis = np.column_stack([basis, rest / length])
            chosen.append(int(column))
    triangular = basis.T @ flat
    matrix = np.linalg.solve(triangular[:, chosen], triangular)
    matrix[np.abs(matrix) < NEGLIGIBLE] = 0.0
    matrix[:, silent] = 0.0
    described, together = [], []
    for row, first in zip(matrix, chosen, strict=True):
        others = [int(k) for k in np.flatnonzero(row) if k != first]
        terms = [names[first], *(_term(row[k], names[k]) for k in others)]
        described.append(" ".join(terms))
        if others:
            together.append(tuple(names[k] for k in (first, *others)))
    return Base(
        matrix=np.asarray(matrix, dtype=np.float64),
        names=tuple(described),
        units=tuple(units[k] for k in chosen),
        without_effect=tuple(names[k] for k in np.flatnonzero(silent)),
        together=tuple(together),
    )


def _term(factor: float, name: str) -> str:
    sign, size = ("-" if factor < 0.0 else "+"), abs(factor)
    return f"{sign} {name}" if abs(size - 1.0) < 1e-6 else f"{sign} {size:.4g}·{name}"


def names_of(arm: Arm, parameters: Parameters) -> list[str]:
    """Return the name of every parameter (p,): symbol, and number of its body or joint from 1."""
    names = [f"{symbol}{k + 1}" for k in range(arm.nv) for symbol in BODY]
    return names + [f"{OWN[name]}{k + 1}" for name in parameters.own for k in range(arm.nv)]


def units_of(arm: Arm, parameters: Parameters) -> list[str]:
    """Return the unit of every parameter (p,)."""
    units = [*UNITS] * arm.nv
    for name in parameters.own:
        for position, effort in zip(arm.position_units, arm.effort_units, strict=True):
            units.append((SLIDING if position == "m" else ROTARY).get(name, effort))
    return units
