"""`behind_springs`: a `SpringObserver` and its law as one linear law, one per joint."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fotsmc_pin.analysis.linearization import LinearLaw
from fotsmc_pin.analysis.sampled_loop import Joint
from fotsmc_pin.control.link_model import LinkRows, observe_links
from fotsmc_pin.control.rows import named_rows
from fotsmc_pin.control.spring_model import SpringRows, observe

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fotsmc_pin.control import SpringObserver
    from fotsmc_pin.types import Array


MOVES = 1e3
"""Speed of a motor that does not stand [rad/s]."""
FORGOTTEN = ("bias", "ticks", "smooth", "fastest")
"""What counts, the weight, which a joint that turns on its own does not have, and what tells a
motor that stands: the loop is that of a motor that moves."""


def behind_springs(
    observer: SpringObserver, laws: Sequence[LinearLaw], joints: Sequence[int] | None
) -> tuple[LinearLaw, ...]:
    """Return the laws as seen from the encoders, each with the joint that it is taken for.

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
        link_side=observer.encoder == "link",
    )
    if not observer.observed[j]:
        return LinearLaw(A=law.A, B=law.B, C=law.C, D=law.D, dt=law.dt, joint=joint)
    F, G, H, E = _observer(observer, j, inertia, link)
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
    observer: SpringObserver, j: int, inertia: float, link: float
) -> tuple[Array, Array, Array, Array]:
    """Return `F`, `G`, `H`, `E` of `x⁺ = F x + G (τ, v)`, `lead = H x + E (τ, v)`.

    Torques are in units of the joint's nominal inertia, as accelerations; `v` is what is measured.

    Args:
        observer: the observer.
        j: index of the joint.
        inertia: its nominal inertia.
        link: share of it on the link's side.
    """
    table = observer.joint_constants(j).reshape(-1, 1)
    names = observer.state_names
    state, later = np.zeros((2, len(names._fields), 1))
    lead, still, mass = np.zeros((2, 1)), np.zeros(1), np.array([[link]])
    before: Any = named_rows(state, names)
    after: Any = named_rows(later, names)
    on_links = observer.encoder == "link"
    x: Any = named_rows(table, SpringRows if on_links else LinkRows)
    tick: Any = observe if on_links else observe_links
    scratch = () if on_links else (np.zeros((1, 1)),)
    if on_links:
        for row in (x.to_deflection, x.to_speed):  # per impulse
            row *= inertia
    else:
        before.fastest[:] = MOVES
    for row in (x.rotor, x.stiffness, x.damping):
        row /= inertia
    before.ticks[:] = 1.0
    remembered = [name for name in names._fields if name not in FORGOTTEN]
    moved, leads = [], []
    n = len(remembered)
    for unit in np.eye(n + 2):
        for name, value in zip(remembered, unit, strict=False):
            getattr(before, name)[:] = value
        given = (mass, still, unit[n + 1 :], unit[n : n + 1], table, state, later, lead)
        tick(observer.dt, *given, *scratch)
        moved.append([getattr(after, name)[0] for name in remembered])
        leads.append(lead[:, 0].copy())
    both, out = np.array(moved).T, np.array(leads).T
    return both[:, :n], both[:, n:], out[:, :n], out[:, n:]
