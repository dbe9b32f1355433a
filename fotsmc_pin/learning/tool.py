"""Dynamic parameters of the links, and of a payload per unit of its mass and moments."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

if TYPE_CHECKING:
    from fotsmc_pin.arms import Arm
    from fotsmc_pin.types import Array


def tool_link(arm: Arm) -> int:
    """Return the index of the link that carries the tool, from 0."""
    return int(_tool(arm).parentJoint) - 1


def unit_bodies(arm: Arm) -> Array:
    """Return ten dynamic parameters in each row, in Pinocchio's order, (4 nv + 5, 10).

    First the nominal links; then a payload's per kilogram of a point mass in the tool frame and per
    kilogram metre of first moment along each axis of its link's frame; then the same moments of
    each link, all to first order; last, in its first three entries, the place of the tool in its
    link [m].
    """
    inertias = [*arm.model.inertias][1:]
    place = np.array(_tool(arm).placement.translation)
    rows = [inertia.toDynamicParameters() for inertia in inertias]
    rows += [_point(place), *_moments(place)]
    for inertia in inertias:
        rows += _moments(np.array(inertia.lever))
    return np.array([*rows, [*place, *np.zeros(7)]])


def _tool(arm: Arm) -> pin.Frame:
    return arm.model.frames[arm.model.getFrameId(arm.tool_frame, pin.FrameType.BODY)]


def _moments(place: Array) -> list[Array]:
    """Dynamic parameters per kilogram metre by which a mass at `place` is moved, three rows."""
    return [0.5 * (_point(place + axis) - _point(place - axis)) for axis in np.eye(3)]


def _point(place: Array) -> Array:
    """Dynamic parameters of 1 kg in one point."""
    parameters: Array = pin.Inertia(1.0, place, np.zeros((3, 3))).toDynamicParameters()
    return parameters
