"""`LearnedTerms`: the terms of a model that changes while the arm moves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from fotsmc_pin.compiled import specialized
from fotsmc_pin.control.model_terms import ModelTerms
from fotsmc_pin.learning.parameters import shared_columns
from fotsmc_pin.learning.trust import add_friction

if TYPE_CHECKING:
    from fotsmc_pin.control.rows import Joints
    from fotsmc_pin.types import Array


class LearnedTerms(ModelTerms):
    """`M0` and `h0 = C0 v + G0` of what was learnt, and with them what is fed forward.

    What is fed forward stands in `h0`, so that a law's torque limits, memories and observers know
    of it:

        h0 = C v + G + F(v_d)                                      the learnt model in the loop
        h0 = C0 v + G0 + F(v_d) + Δ(q, v_d, a_d)                   the nominal model in the loop

    with the friction `F` and the torque `Δ` that the learnt model needs beyond the nominal one.

    Attributes:
        learned: the learnt model; its inertias and armature are written from outside.
    """

    def __init__(
        self,
        nominal: pin.Model,
        used: Array,
        direction: Array,
        fall: float,
        *,
        feed_forward: bool,
        in_loop: bool,
    ) -> None:
        """Copy the nominal model.

        Args:
            nominal: the arm's model, which stays as it is.
            used: live parameters that are used (p,).
            direction: live direction of the friction (nv,).
            fall: speed at which friction falls, where that is learnt [rad/s, m/s].
            feed_forward: whether friction, or friction and `Δ`, are added.
            in_loop: whether the loop has the learnt model.
        """
        self.learned = nominal.copy()
        super().__init__(self.learned if in_loop else nominal)
        self._nominal = nominal
        self._learned_data, self._nominal_data = self.learned.createData(), nominal.createData()
        self._feeds, self._differs = feed_forward, feed_forward and not in_loop
        self._used, self._direction, self._fall = used, direction, fall
        self._add_friction = specialized(add_friction, used, direction, used, fall, self.h)
        self._bodies, self._armature = self.learned.inertias, self.learned.armature
        rotors = shared_columns(nominal.nv)
        self._rotors = used[rotors : rotors + nominal.nv]

    def evaluate(self, q: Array, joints: Joints) -> None:
        """Write the terms at the configuration `q` (nq,) and the velocity of `joints`."""
        super().evaluate(q, joints)
        if self._feeds:
            self._add_friction(joints.v_d, self._direction, self._used, self._fall, self.h)
        if self._differs:
            ahead = (q, joints.v_d, joints.a_d)
            self.h += pin.rnea(self.learned, self._learned_data, *ahead)
            self.h -= pin.rnea(self._nominal, self._nominal_data, *ahead)

    def friction(self, joints: Joints) -> Array:
        """Return the friction that the wanted speed will meet, (nv,)."""
        torque = np.zeros(joints.v_d.size)
        self._add_friction(joints.v_d, self._direction, self._used, self._fall, torque)
        return torque

    def write(self, link: int, dynamic: Array) -> None:
        """Write ten dynamic parameters into a link of the learnt model."""
        self._bodies[link + 1] = pin.Inertia.FromDynamicParameters(dynamic)

    def write_rotors(self) -> None:
        """Write the armature that is used into the learnt model."""
        self._armature[:] = self._rotors
