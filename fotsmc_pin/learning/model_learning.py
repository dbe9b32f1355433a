"""`ModelLearning`: any controller, with a model that is learnt while the arm moves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from fotsmc_pin import checks
from fotsmc_pin.compiled import specialized
from fotsmc_pin.control.saved_state import part, present, with_prefix
from fotsmc_pin.copying import SharesNothing
from fotsmc_pin.learning.estimator import WINDOW, JointRows
from fotsmc_pin.learning.learned_terms import LearnedTerms
from fotsmc_pin.learning.parameters import Beliefs, Layout, Prior, first_beliefs
from fotsmc_pin.learning.tick import learn

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from fotsmc_pin.control import Controller
    from fotsmc_pin.types import Array

MIDDLE = 1
"""Tick of a window whose configuration stands for it."""


class ModelLearning(SharesNothing):
    def __init__(self, controller, *, prior=None, delay=1, feed_forward=True, in_loop=True, rng=(0.27,2.5), noise=3e-3, floor=3e-4):
        self.controller, self.arm, self.dt = controller, controller.arm, controller.dt
        self.prior = Prior() if prior is None else prior
        self.delay = checks.count("delay", delay, at_least=0)
        self.feed_forward, self.in_loop = feed_forward, in_loop
        arm, model = self.arm, self.arm.model
        n = arm.nv
        self.layout = Layout(n, stribeck=self.prior.stribeck is not None)
        size = np.where(np.isfinite(arm.effort_limit), arm.effort_limit, 100.0)
        self._size = size
        self._first = np.vstack([first_beliefs(arm, self.prior, self.layout, size), np.zeros(self.layout.size)])
        frame = model.frames[model.getFrameId(arm.tool_frame, pin.FrameType.BODY)]
        p = frame.placement.translation
        unit = lambda c: pin.Inertia(1.0, c, np.zeros((3, 3))).toDynamicParameters()
        rows = [model.inertias[i].toDynamicParameters() for i in range(1, n + 1)]
        rows.append(unit(p))
        for k in range(3):
            d = np.zeros(3); d[k] = 1.0
            rows.append(0.5 * (unit(p + d) - unit(p - d)))
        rows.append(np.concatenate([p, np.zeros(7)]))
        self._bodies = np.array(rows)
        self._settings = np.array([0.0, 0.0, 0.0, frame.parentJoint - 1, *rng, self.prior.stribeck_velocity])
        self._noise=(noise*size)**2; self._floor=(floor*size)**2
        c = n + 7 + (self.layout.size - 4 * n - 4) // n
        self._clock = self._settings.copy()
        self._sent = np.zeros((self.delay + 1, n))
        self._joint_table = np.zeros((len(JointRows._fields), n))
        self._belief_table = self._first.copy()
        self._P = np.zeros((self.layout.size,) * 2)
        self._Y = np.zeros((n, c))
        self._middle = np.zeros(arm.nq)
        self._dynamic = np.zeros(10)
        self._link()
        self.reset()

    def _link(self):
        model = self.arm.model
        self._b = Beliefs(*self._belief_table[:7])
        self._x = JointRows(*self._joint_table)
        self.terms = LearnedTerms(model, self._b.used, self._settings[6], feed_forward=self.feed_forward, in_loop=self.in_loop)
        self.controller.use_terms(self.terms)
        self._data = model.createData()
        self._model = model
        self._inertias = self.terms.learned.inertias
        n = self.arm.nv
        self._armature = self.terms.learned.armature
        self._rotors = self._b.used[n + 4 : 2 * n + 4]
        c = self.controller
        self._reg = self._data.jointTorqueRegressor
        self._arguments = (c.joints.tau, c.joints.v, self._clock, self._sent, self._joint_table, self._belief_table, self._P, self._Y, self._reg, self._bodies, self._dynamic)
        self._code = specialized(learn, self.dt, *self._arguments)

    def reset(self):
        self.controller.reset()
        self._clock[:] = self._settings
        self._sent[:] = 0
        self._joint_table[:] = 0
        self._x.idle[:] = 1.0
        self._x.noise[:] = self._noise
        self._x.least_noise[:] = self._floor
        self._belief_table[:] = self._first
        self._P[:] = np.diag(self._b.deviation**2)
        self._Y[:] = 0
        self._ticks = 0
        self._write_model()

    def _write_model(self):
        from fotsmc_pin.learning.trust import body
        n=self.arm.nv
        for i in range(n):
            body(i, n, int(self._settings[3]), self._bodies[n+4], self._bodies, self._b.used, self._dynamic)
            self._inertias[i+1] = pin.Inertia.FromDynamicParameters(self._dynamic)
        self._armature[:] = self._rotors

    def update(self, q, v, q_d, v_d, a_d, dt=None):
        c = self.controller
        tau = c.update(q, v, q_d, v_d, a_d, dt)
        k = self._ticks
        phase = k % WINDOW
        if phase == 0:
            if k:
                pin.computeJointTorqueRegressor(self._model, self._data, self._middle, self._x.mean_speed, self._x.acceleration)
        elif phase == MIDDLE:
            self._middle[:] = c.q
        self._code(self.dt if dt is None else dt, *self._arguments)
        if phase:
            self._inertias[1 + (k - k // WINDOW) % tau.size] = pin.Inertia.FromDynamicParameters(self._dynamic)
            self._armature[:] = self._rotors
        self._ticks = k + 1
        return tau

    @property
    def gains(self): return self.controller.gains
    @property
    def signals(self):
        return self.controller.signals | dict(theta=self._b.estimate.copy(), stds=np.sqrt(np.diag(self._P)), used=self._b.used.copy(), noise=np.sqrt(self._x.noise), learning=self._x.learning.copy(), unexplained=self._x.unexplained.copy())
