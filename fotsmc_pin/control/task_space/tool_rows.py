"""Names for the numbers of a task that are not joints'."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from fotsmc_pin.types import Array


class ToolRows(NamedTuple):
    """Rows of six numbers about the tool, of which errors use the first `m`.

    Attributes:
        V_d: twist that is asked for, in the axes of the asked pose.
        A_d: its derivative.
        V: twist of the tool, in its own axes.
        bias: `J̇ v`.
        V_t: twist of the point's tool, in its own axes.
        bias_t: `J̇ v` there.
        A_t: derivative of `V_t`.
        led: twist of the reference, carried to the tool.
        led_rate: its derivative.
        nu: twist of the tool against the reference.
        e: error.
        e_dot: its rate.
        beta: what accelerates the error while the joints do not.
        given_up: error of the point's tool from what is asked.
        error: error of the tool from what is asked.
        scale: factors that make each direction a way.
        x: scratch.
        f: scratch.
    """

    V_d: Array
    A_d: Array
    V: Array
    bias: Array
    V_t: Array
    bias_t: Array
    A_t: Array
    led: Array
    led_rate: Array
    nu: Array
    e: Array
    e_dot: Array
    beta: Array
    given_up: Array
    error: Array
    scale: Array
    x: Array
    f: Array


class Numbers(NamedTuple):
    """Single numbers of a task, each in a row of its own.

    Attributes:
        rate: `ω`, at which the point closes its error [1/s].
        posture_rate: `ω_p` [1/s].
        threshold: `σ_0` [m].
        kept: smallest share of a direction that the law keeps.
        kept_t: the same of the point.
        begun: whether there was a tick.
    """

    rate: Array
    posture_rate: Array
    threshold: Array
    kept: Array
    kept_t: Array
    begun: Array
