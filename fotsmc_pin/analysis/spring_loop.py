"""`behind_springs`: a `SpringObserver` and its law as one linear law, one per joint."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fotsmc_pin.analysis.linearization import LinearLaw
from fotsmc_pin.analysis.sampled_loop import Joint
from fotsmc_pin.control.rows import named_rows
from fotsmc_pin.control.spring_model import SpringRows, SpringState, observe

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.control import SpringObserver
    from fotsmc_pin.types import Array

STATES = ("v", "impulse", "deflection", "speed", "load", "lasting")
"""What the observer remembers of a joint that turns on its own."""


def behind_springs(
    observer: SpringObserver, laws: Sequence[LinearLaw], joints: Sequence[int] | None
) -> tuple[LinearLaw, ...]:
    """Return the laws as seen from the links, each with the joint that the observer takes it for.

    The states are the law's, the observer's and the torques on their way. The observer's matrices
    are read off its own compiled tick, at unit states and inputs; it is linear, so this is exact.

    Args:
        observer: the observer.
        laws: the laws that it wraps, one for each of `joints`.
        joints: indices of the joints; all if None.
    """
    arm = observer.arm
    inertia = np.diag(arm.mass_matrix(arm.neutral))
    wanted = range(arm.nv) if joints is None else joints
    return tuple(
        _behind_spring(observer, j, float(inertia[j]), law)
        for j, law in zip(wanted, laws, strict=True)
    )


def _behind_spring(observer: SpringObserver, j: int, inertia: float, law: LinearLaw) -> LinearLaw:
    if np.isinf(observer.joint_stiffness[j]):
        return law
    rotor = float(observer.rotor[j]) / inertia
    link = 1.0 - float(observer.arm.armature[j]) / inertia
    joint = Joint(
        mass=rotor + link,
        rotor=rotor / (rotor + link),
        stiffness=float(observer.joint_stiffness[j]) / inertia,
        damping=float(observer.joint_damping[j]) / inertia,
        link_side=True,
    )
    if not observer.observed[j]:
        return LinearLaw(A=law.A, B=law.B, C=law.C, D=law.D, dt=law.dt, joint=joint)
    F, G, H, E = _observer(observer.joint_constants(j), inertia, link, law.dt)
    n, s, way = len(law.A), len(F), observer.delay + 1
    size = n + s + way
    # What the law is given, (e_m, ė_m), of all states and of (e, ė).
    given, through = np.zeros((2, size)), np.array([[1.0, 0.0], [0.0, 0.0]])
    given[:, n : n + s], given[:, -1] = H, E[:, 0]
    through[:, 1] += E[:, 1]
    A, B = np.zeros((size, size)), np.zeros((size, 2))
    A[:n] = law.B @ given
    A[:n, :n] += law.A
    B[:n] = law.B @ through
    A[n : n + s, n : n + s], A[n : n + s, -1], B[n : n + s, 1] = F, G[:, 0], G[:, 1]
    C, D = law.D @ given, law.D @ through
    C[:n] += law.C
    A[n + s], B[n + s] = C, D
    for k in range(1, way):
        A[n + s + k, n + s + k - 1] = 1.0
    return LinearLaw(A=A, B=B, C=C, D=D, dt=law.dt, joint=joint)


def _observer(
    constants: Array, inertia: float, link: float, dt: float
) -> tuple[Array, Array, Array, Array]:
    """Return `F`, `G`, `H`, `E` of `x⁺ = F x + G (τ, v)`, `lead = H x + E (τ, v)`.

    Torques are in units of the joint's nominal inertia, as accelerations.

    Args:
        constants: rows of `SpringRows` of the joint (9,).
        inertia: nominal inertia of the joint.
        link: share of it on the link's side.
        dt: period of a tick [s].
    """
    table = np.array(constants).reshape(-1, 1)
    x = named_rows(table, SpringRows)
    for row in (x.rotor, x.stiffness, x.damping):
        row /= inertia
    for row in (x.to_deflection, x.to_speed):
        row *= inertia
    state, later = np.zeros((2, len(SpringState._fields), 1))
    lead, still, mass = np.zeros((2, 1)), np.zeros(1), np.array([[link]])
    before, after = named_rows(state, SpringState), named_rows(later, SpringState)
    before.ticks[:] = 1.0
    moved, leads = [], []
    n = len(STATES)
    for unit in np.eye(n + 2):
        for name, value in zip(STATES, unit, strict=False):
            getattr(before, name)[:] = value
        observe(dt, mass, still, unit[n + 1 :], unit[n : n + 1], table, state, later, lead)
        moved.append([getattr(after, name)[0] for name in STATES])
        leads.append(lead[:, 0].copy())
    both, out = np.array(moved).T, np.array(leads).T
    return both[:, :n], both[:, n:], out[:, :n], out[:, n:]
