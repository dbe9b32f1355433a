"""A step of an arm with friction and elastic joints, both taken implicitly.

A joint can stand still, a light one stays stable, and a stiff spring may be shorter than the step.
With `v` the speeds of the links at the end of a step of `h` seconds and `ω` those of the motors,
which are the same where a joint is rigid,

    M (v - v₀) = h (τ_d - C v₀ - G + s),              M without the rotors of elastic joints,
    B (ω - ω₀) = h (τ - s - D ω) + p,                 B the rotors' inertia,
    h s = h K δ₀ + h D_s (ω - v) + h²/4 K (ω - v - ω₀ + v₀),     δ = θ - q the springs' deflection,
    p_j = -h F_j sign ω_j,      |p_j| ≤ h F_j where ω_j = 0.

A rigid joint has `τ` on the link and its rotor in `M`, and friction at `v`. The term in `h²` makes
the step of a spring that of the implicit midpoint rule, seen from half a step off: it is stable for
any stiffness and neither adds nor takes energy in the long run. `F` follows Stribeck's curve,

    F = F_c (1 + (ratio - 1) exp(-(ω₀ / v_s)²)),

at the speed from which the step starts, so that a joint at rest breaks away at `ratio F_c`.

The solution is unique, because the equations are those of the least of a convex function. If one
knows which joints slide and which way, they are linear: the guess is that of the last step, one
factorisation solves them, and the answer shows whether the guess was right. If not, the speeds move
towards that answer until some joint would begin or end to slide, and a sweep of Gauss-Seidel, each
joint exactly, makes the next guess. Both lower the convex function, so that no guess comes twice.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fotsmc_pin.compiled import kernel

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


GUESSES = 50
"""Most guesses in a step; a handful is what random states of real arms need."""
ROUNDING = 1e-12
"""Share of the dry friction by which a resting joint may be pushed beyond it."""

# Rows of the table of joints: what they are, their state, and what a step needs on the way.
DAMPING, FRICTION, STICTION, STRIBECK, ROTOR, STIFFNESS, SPRING_DAMPING = range(7)
DEFLECTION, MOTOR_SPEED, SLIDES = range(7, 10)
LEVEL, PUSH, COUPLING, MOTOR_MASS, MOTOR_PUSH, SPEED, MOVES, ADDED, PIVOT = range(10, 19)
TABLE_ROWS = 19


@kernel
def slide(
    h: float,
    mass: Array,
    bias: Array,
    torque: Array,
    push: Array,
    v: Array,
    factor: Array,
    x: Array,
) -> None:
    """Move the speeds and the springs' deflections over a step.

    Args:
        h: length of the step [s].
        mass: `M` (nv, nv), without the rotors of elastic joints.
        bias: `C v + G` (nv,).
        torque: `τ` of the motors (nv,) [N·m, N].
        push: `τ_d`, which acts on the links (nv,).
        v: speed of the links (nv,); overwritten.
        factor: room for a factorisation (nv, nv).
        x: the table of joints (TABLE_ROWS, nv).
    """
    prepare(h, mass, bias, torque, push, v, x)
    right = False
    for guess in range(GUESSES):
        solve(h, mass, factor, x)
        right = is_right(mass, x)
        if right:
            break
        if guess > 0:
            approach(v, x)
        sweep(h, mass, v, x)
    for j in range(v.size):
        if right:
            v[j] = x[SPEED, j]
        if x[STIFFNESS, j] > 0.0:
            free = x[MOTOR_PUSH, j] + x[COUPLING, j] * v[j]
            x[MOTOR_SPEED, j] = shrunk(free, x[LEVEL, j]) / x[MOTOR_MASS, j]
            x[DEFLECTION, j] += h * (x[MOTOR_SPEED, j] - v[j])
        else:
            x[MOTOR_SPEED, j] = v[j]


@kernel
def prepare(
    h: float, mass: Array, bias: Array, torque: Array, push: Array, v: Array, x: Array
) -> None:
    """Write what the step's equations need: impulses that push, springs, levels of friction."""
    for j in range(v.size):
        impulse = h * (push[j] - bias[j])
        for k in range(v.size):
            impulse += mass[j, k] * v[k]
        rotor, stiffness, omega = x[ROTOR, j], x[STIFFNESS, j], x[MOTOR_SPEED, j]
        if stiffness > 0.0:
            quarter = 0.25 * h * h * stiffness
            spring = h * stiffness * x[DEFLECTION, j] - quarter * (omega - v[j])
            x[COUPLING, j] = h * x[SPRING_DAMPING, j] + quarter
            x[MOTOR_MASS, j] = rotor + x[COUPLING, j] + h * x[DAMPING, j]
            x[MOTOR_PUSH, j] = rotor * omega + h * torque[j] - spring
            x[PUSH, j] = impulse + spring
        else:
            x[PUSH, j] = impulse + h * torque[j]
            omega = v[j]
        level = x[FRICTION, j]
        if x[STICTION, j] > 1.0:
            ratio = omega / x[STRIBECK, j]
            level *= 1.0 + (x[STICTION, j] - 1.0) * math.exp(-ratio * ratio)
        x[LEVEL, j] = h * level


@kernel
def solve(h: float, mass: Array, factor: Array, x: Array) -> None:
    """Write the speeds of the links where each joint slides, or not, as guessed.

    The factorisation is `L D Lᵀ`; a rigid joint at rest has a row of the identity in it.
    """
    n, moving = mass.shape[0], 0
    for j in range(n):
        slides = x[SLIDES, j] != 0.0 or x[LEVEL, j] == 0.0
        friction = x[LEVEL, j] * x[SLIDES, j]
        elastic = x[STIFFNESS, j] > 0.0
        x[MOVES, j] = 1.0 if slides or elastic else 0.0
        if not elastic:
            x[ADDED, j] = h * x[DAMPING, j]
            x[SPEED, j] = x[MOVES, j] * (x[PUSH, j] - friction)
        else:
            share = x[COUPLING, j] / x[MOTOR_MASS, j] if slides else 0.0
            x[ADDED, j] = x[COUPLING, j] * (1.0 - share)
            x[SPEED, j] = x[PUSH, j] + share * (x[MOTOR_PUSH, j] - friction)
        moving += 1 if x[MOVES, j] > 0.0 else 0
    if moving > 0:
        factorise(mass, factor, x)
        for i in range(n):
            for k in range(i):
                x[SPEED, i] -= factor[i, k] * x[SPEED, k]
        for i in range(n - 1, -1, -1):
            x[SPEED, i] /= x[PIVOT, i]
            for k in range(i + 1, n):
                x[SPEED, i] -= factor[k, i] * x[SPEED, k]


@kernel
def factorise(mass: Array, factor: Array, x: Array) -> None:
    """Write `L` below the diagonal of `factor` and `D` into the table."""
    for i in range(mass.shape[0]):
        moves = x[MOVES, i] > 0.0
        for j in range(i):
            entry = mass[i, j] if moves and x[MOVES, j] > 0.0 else 0.0
            for k in range(j):
                entry -= factor[i, k] * factor[j, k] * x[PIVOT, k]
            factor[i, j] = entry / x[PIVOT, j]
        pivot = mass[i, i] + x[ADDED, i] if moves else 1.0
        for k in range(i):
            pivot -= factor[i, k] * factor[i, k] * x[PIVOT, k]
        x[PIVOT, i] = pivot


@kernel
def is_right(mass: Array, x: Array) -> bool:
    """Return whether each joint slides the way that was guessed, or is held where it rests."""
    n = mass.shape[0]
    for j in range(n):
        level, slides = x[LEVEL, j], x[SLIDES, j]
        if level == 0.0:
            continue
        if x[STIFFNESS, j] > 0.0:
            free = x[MOTOR_PUSH, j] + x[COUPLING, j] * x[SPEED, j]
            if slides != 0.0:
                if slides * free < level * (1.0 - ROUNDING):
                    return False
                continue
        elif slides != 0.0:
            if slides * x[SPEED, j] < 0.0:
                return False
            continue
        else:
            free = x[PUSH, j]
            for k in range(n):
                free -= mass[j, k] * x[SPEED, k]
        if not abs(free) <= level * (1.0 + ROUNDING):
            return False
    return True


@kernel
def approach(v: Array, x: Array) -> None:
    """Move `v` towards the speeds of the last guess as far as no joint changes its way to slide."""
    share = 1.0
    for j in range(v.size):
        level, slides, speed = x[LEVEL, j], x[SLIDES, j], x[SPEED, j]
        if level == 0.0:
            continue
        if x[STIFFNESS, j] > 0.0:
            here = x[MOTOR_PUSH, j] + x[COUPLING, j] * v[j]
            there = x[MOTOR_PUSH, j] + x[COUPLING, j] * speed
            edge = level * slides if slides != 0.0 else math.copysign(level, there)
            crosses = slides * there < level if slides != 0.0 else abs(there) > level
            if crosses and here != there:
                share = min(share, max((edge - here) / (there - here), 0.0))
        elif slides * speed < 0.0:
            share = min(share, v[j] / (v[j] - speed))
    for j in range(v.size):
        v[j] += share * (x[SPEED, j] - v[j])


@kernel
def sweep(h: float, mass: Array, v: Array, x: Array) -> None:
    """Better the speeds `v`, one joint after the other, each exactly; guess who slides by them."""
    n = v.size
    for j in range(n):
        rest = x[PUSH, j]
        for k in range(n):
            if k != j:
                rest -= mass[j, k] * v[k]
        if x[STIFFNESS, j] > 0.0:
            own, coupling = mass[j, j] + x[COUPLING, j], x[COUPLING, j]
            free = x[MOTOR_PUSH, j] + coupling * rest / own
            omega = shrunk(free, x[LEVEL, j]) / (x[MOTOR_MASS, j] - coupling * coupling / own)
            v[j] = (rest + coupling * omega) / own
        else:
            omega = shrunk(rest, x[LEVEL, j]) / (mass[j, j] + h * x[DAMPING, j])
            v[j] = omega
        x[SLIDES, j] = 0.0 if omega == 0.0 else math.copysign(1.0, omega)


@kernel
def shrunk(value: float, level: float) -> float:
    """Return `value` moved towards zero by `level`, and not beyond."""
    return math.copysign(max(abs(value) - level, 0.0), value)
