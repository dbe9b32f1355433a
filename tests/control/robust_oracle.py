"""`RobustFONFTSM` written once more, in plain numpy and streaming operators, one idea a method."""

import numpy as np

from fotsmc_pin.fractional import FractionalDerivative, FractionalIntegral

DT = 1e-3
ZERO_AT_THE_START = (
    *("z", "y", "u", "d", "mean_d", "delta", "rest", "J", "T", "e_smooth", "u_smooth", "e_moved"),
    *("u_moved", "e_stuck", "slips", "allowed", "kept", "stuck", "held"),
    *("swings", "peak", "moved", "aa", "tt", "ta", "last_a", "step", "added", "way", "way_speed"),
)


def sig(x, power):
    return np.abs(x) ** power * np.sign(x)


def low_pass(x, target, rate):
    """Implicit Euler of `ẋ = rate (target - x)`."""
    return (x + rate * DT * target) / (1.0 + rate * DT)


class RobustOracle:
    """The law as its docstring states it; call it with one tick's terms, get the torque."""

    def __init__(self, g, n, effort_limit=np.inf):
        self.effort_limit = effort_limit
        factor = g.bandwidth * min(1.0, 1.44e-3 / DT)
        surface = factor ** (1.0 + g.alpha)
        self.g = g
        self.A, self.lam, self.theta = g.A * surface, g.lam * surface, g.theta * factor
        self.b, self.phi = g.integral * factor ** (3.0 + g.alpha), g.boundary_layer * surface
        self.K, self.floor_rate = g.observer * factor, g.floor_rate * factor
        self.home_rate = g.approach_rate * factor
        options = {"order": g.alpha, "dt": DT, "tempering": g.tempering * factor}
        self.derivative = FractionalDerivative(**options).stream(n)
        self.integral = FractionalIntegral(**options).stream(n)
        for name in ZERO_AT_THE_START:
            setattr(self, name, np.zeros(n))
        self.last_e_dot = None
        self.a_band, self.tau_band = np.zeros((3, n)), np.zeros((3, n))

    def __call__(self, x):
        self.missed = np.zeros_like(x.e)
        self.lead(x)
        if self.last_e_dot is not None:
            self.look_back(x)
        self.last_v, self.last_e_dot, self.last_behind_dot = x.v, x.e_dot, self.behind_dot
        still = np.exp(-((x.v_d / 0.02) ** 2) - (x.a_d / 0.2) ** 2)
        self.rest = low_pass(self.rest, still, 30.0)
        S, w = self.reach(x)
        a = self.led_a_d - self.integral.update(w)
        self.torque(x, a)
        self.watch(x, self.tau - x.h0, np.diag(x.M0) + self.J + self.delta)
        idle = self.rest * (1.0 - self.kept)
        bounded = (S / self.phi) / (1.0 + (S / self.phi) ** 2)
        self.z = self.z + DT * ((1.0 - idle) * self.b * bounded - 20.0 * idle * self.z)
        self.z = self.z * (1.0 - self.rest * self.stuck)
        haste = np.maximum(6e-4 / np.maximum(np.abs(self.e_smooth), 1.5e-4), 1.0)
        pace = np.where(self.held > 0.0, 0.0, np.where(self.stuck > 0.0, haste, 1.0))
        self.step = DT * ((1.0 - self.rest) + self.rest * pace) * (a - self.led_a_d)
        return self.tau

    def torque(self, x, a):
        """What is beyond the model is a torque of its own, and only changes are added to it."""
        u, y = self.u + (a - self.last_a) + self.missed, self.y
        self.y = low_pass(y, u, self.floor_rate)
        before = self.added + self.missed
        self.added = low_pass(before, 0.0, self.K / 1500.0)
        self.T = (
            self.T
            + x.M0 @ (before - self.added)
            + self.J * (u - self.u)
            + self.delta * (self.y - y)
        )
        self.u, self.last_a = u, a
        tau = x.inverse_dynamics(a + self.added) + self.T
        still = self.rest * self.held * (x.h0 + self.u_smooth - tau)
        self.T = self.T + 20.0 * DT * still
        self.tau = tau + still

    def lead(self, x):
        """Beyond a small error, a point leads the joint home and waits for it."""
        speed, rate = self.g.approach, self.home_rate
        width, most = speed / rate, 0.08 * speed / rate
        error = np.clip(x.e - self.way, -most, most)
        self.way = np.where(np.abs(x.e - self.way) > most, x.e - error, self.way)
        on_the_way = self.way != 0.0
        waiting = np.where(error * self.way > 0.0, (error / most) ** 2, 0.0)
        spare = np.maximum(self.effort_limit - np.abs(x.h0), 0.1 * self.effort_limit)
        stops = np.sqrt(0.6 * spare / np.diag(x.M0)) * np.sqrt(np.maximum(np.abs(self.way), 1e-99))
        led = np.minimum(speed * np.abs(self.way) / np.sqrt(self.way**2 + width**2), stops)
        wanted = -(1.0 - waiting) * led * np.sign(self.way)
        follows = (error / most) ** 2 + ((x.e_dot - self.way_speed) / (rate * most)) ** 2
        before = self.way_speed
        self.way_speed = np.where(on_the_way, low_pass(before, wanted, 3.6 * rate), before)
        self.led_a_d = x.a_d + (self.way_speed - before) / DT
        self.way = self.way + np.where(on_the_way, DT * self.way_speed, 0.0)
        arrived = (np.abs(self.way) < 1e-6) & (np.abs(self.way_speed) < 1e-4)
        self.way, self.way_speed = (np.where(arrived, 0.0, y) for y in (self.way, self.way_speed))
        self.behind, self.behind_dot = x.e - self.way, x.e_dot - self.way_speed
        share = np.where(on_the_way, np.maximum(1.0 - follows, 0.0), 1.0)
        self.met_at = self.behind + share * self.way

    def reach(self, x):
        """The surface and the integrand of the fractional integral."""
        g = self.g
        bend = 1.0 / np.sqrt(1.0 + (self.behind / g.reach) ** 2)
        near = bend * self.behind
        S = self.derivative.update(self.behind_dot) + self.A * near + self.lam * sig(near, g.power)
        slope = self.A + self.lam * g.power * np.abs(near) ** (g.power - 1.0)
        return S, self.theta * (S + sig(S, g.mu)) + slope * bend**3 * self.behind_dot + self.z

    def look_back(self, x):
        """What the last tick did: disturbance, floor, rotors."""
        g, accelerated = self.g, (x.v - self.last_v) / DT
        inertia = x.M0 + np.diag(self.J)
        lacking = self.tau - inertia @ accelerated - x.h0
        self.d = low_pass(self.d, -lacking, 15.0)
        far = (self.met_at / 0.02) ** 2
        self.mean_d = self.mean_d + DT * (1.0 + 15.0 * far / (1.0 + far)) * (self.d - self.mean_d)
        met = np.maximum(np.abs(self.d - self.mean_d) - 0.05 * np.diag(x.M0), 0.0)
        target = np.minimum(g.floor_share * met, g.floor_limit)
        rate = np.where(target > self.delta, 3.0 / (1.0 + far), 0.15)
        self.delta = self.delta + DT * rate * (target - self.delta)
        self.search(x, lacking, (x.e_dot - self.last_e_dot) / DT)
        self.missed = self.K * (self.step - (self.behind_dot - self.last_behind_dot))

    def search(self, x, lacking, acceleration):
        """Inertia from oscillation and braking: least squares of torque on acceleration."""
        g = self.g
        for band, value in ((self.a_band, acceleration), (self.tau_band, lacking)):
            band[0] = low_pass(band[0], value, 60.0)
            band[1] = low_pass(band[1], band[0], 60.0)
            band[2] = low_pass(band[2], band[1], 8.0)
        moved, torque = self.a_band[1] - self.a_band[2], self.tau_band[1] - self.tau_band[2]
        self.aa = low_pass(self.aa, moved * moved, 4.0)
        self.tt = low_pass(self.tt, torque * torque, 4.0)
        self.ta = low_pass(self.ta, torque * moved, 4.0)
        alike = np.abs(self.ta) > 0.7 * np.sqrt(self.aa * self.tt)
        oscillates = (self.aa > 0.3**2) & alike
        turned = moved * self.moved < 0.0
        self.peak = np.maximum(self.peak, np.abs(moved))
        wide = self.peak > 0.5 * np.sqrt(self.aa)
        counted = np.where(turned, np.where(wide, self.swings + 1.0, 0.0), self.swings)
        self.swings = np.where(oscillates, counted, 0.0)
        self.peak = np.where(turned, 0.0, self.peak)
        brakes = (self.way != 0.0) & (x.e_dot * self.a_band[0] < 0.0) & (g.rotor_doubt > self.J)
        led = oscillates & brakes & (self.ta > 0.92 * np.sqrt(self.aa * self.tt))
        for i in np.flatnonzero(oscillates & (self.swings > 4) | led):
            upward = (5.0 if led[i] else 0.8) / (1.0 + (x.e[i] / 0.2) ** 2)
            pace = upward if self.ta[i] > 0.0 else 20.0
            wanted = self.J[i] + pace * DT * self.ta[i] / self.aa[i]
            more = np.clip(wanted, 0.0, g.rotor_limit[i]) - self.J[i]
            self.J[i] += more
            self.tau_band[:, i] -= more * self.a_band[:, i]
            self.tt[i] += more * (more * self.aa[i] - 2.0 * self.ta[i])
            self.ta[i] -= more * self.aa[i]
        self.moved = moved

    def watch(self, x, push, inertia):
        """Joints that friction holds near their goal, and those that have been exact all along."""
        self.e_smooth = low_pass(self.e_smooth, x.e, 100.0)
        self.u_smooth = low_pass(self.u_smooth, push, 20.0)
        for i in range(push.size):
            moving = self.rest[i] < 0.5
            if moving:
                self.e_stuck[i] = self.slips[i] = self.allowed[i] = 0.0
            self.kept[i] = 1.0 if moving else self.kept[i] * (abs(x.e[i]) <= 1e-5)
            if moving or abs(self.e_smooth[i] - self.e_moved[i]) > 3e-5:
                self.e_moved[i], self.u_moved[i] = self.e_smooth[i], self.u_smooth[i]
                self.stuck[i] = self.held[i] = 0.0
                continue
            pushed = abs(self.u_smooth[i] - self.u_moved[i]) > 0.3 * inertia[i]
            if pushed and not (self.held[i] or self.kept[i]):
                self.sticks(i)

    def sticks(self, i):
        self.stuck[i] = 1.0
        error, before = self.e_smooth[i], self.e_stuck[i]
        if error * before < 0.0:
            self.slips[i] += 1
            if self.slips[i] >= 8:
                self.allowed[i] = min(1.1 * min(abs(error), abs(before)), 2e-3)
        self.e_stuck[i], self.u_moved[i] = error, self.u_smooth[i]
        self.held[i] = abs(error) < max(1.5e-4, self.allowed[i])
