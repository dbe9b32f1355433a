"""Plants that identification does not know, motions that show them, and logs of both."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.arms.drive_size import drive_size
from fotsmc_pin.identification import Log
from fotsmc_pin.references.limits import broken_limits
from fotsmc_pin.simulation.sensors import Encoder

ARMS = ("panda", "ur5", "kinova", "z1", "so100", "two_link")
DT = 1e-3
CALCULATED_DT = 4e-3
"""Period of logs that are calculated [s]."""
BITS = 20
TORQUE_NOISE = 0.005
"""Standard deviation of a torque reading over the effort limit."""


@dataclass(frozen=True, eq=False)
class Swings:
    """Sums of sinusoids in every joint, faded in and out, at random and inside the limits."""

    arm: fp.Arm
    center: np.ndarray
    amplitude: np.ndarray
    omega: np.ndarray
    phase: np.ndarray
    duration: float

    def __call__(self, t):
        q, v, a = self.at(np.array([float(t)]))
        return q[0], v[0], a[0]

    def at(self, t):
        fade, slope, bend = fades(t, self.duration)
        angle = self.omega * t[:, None, None] + self.phase
        x = np.sum(self.amplitude * np.sin(angle), axis=2)
        v = np.sum(self.amplitude * self.omega * np.cos(angle), axis=2)
        a = -np.sum(self.amplitude * self.omega**2 * np.sin(angle), axis=2)
        f, fd, fdd = (part[:, None] for part in (fade, slope, bend))
        moved = f * x
        q = np.array([self.arm.integrate(self.center, row) for row in moved])
        return q, fd * x + f * v, fdd * x + 2 * fd * v + f * a


def fades(t, duration, ramp=1.5):
    """Return a weight that rises from 0 to 1 and falls back, and its two derivatives."""
    u = np.clip(np.minimum(t, duration - t) / ramp, 0.0, 1.0)
    side = np.where(t < duration / 2, 1.0, -1.0) / ramp
    return (
        u**3 * (10 - 15 * u + 6 * u**2),
        side * 30 * u**2 * (1 - u) ** 2,
        60 * u * (1 - u) * (1 - 2 * u) / ramp**2,
    )


def swings(arm, seed, duration=30.0, share=0.5, harmonics=5):
    """Return such a motion that needs at most a share of the velocity and effort limits."""
    rng = np.random.default_rng([seed, 7])
    lower, upper = arm.lower_position_limit, arm.upper_position_limit
    low, high = np.maximum(lower, -2.5), np.minimum(upper, 2.5)
    center = 0.5 * (low + high) + 0.15 * (high - low) * rng.uniform(-1, 1, arm.nv)
    room = 0.8 * np.minimum(center - low, high - center)
    base = 2 * np.pi * 0.1
    omega = base * (np.arange(1, harmonics + 1) + rng.uniform(-0.3, 0.3, (arm.nv, harmonics)))
    amplitude = rng.uniform(0.3, 1.0, (arm.nv, harmonics)) / omega
    phase = rng.uniform(0, 2 * np.pi, (arm.nv, harmonics))
    amplitude *= (room / amplitude.sum(axis=1))[:, None]
    speed = (amplitude * omega).sum(axis=1)
    amplitude *= np.minimum(1.0, share * np.minimum(arm.velocity_limit, 4.0) / speed)[:, None]
    for _ in range(12):
        q = arm.from_joint_positions(center)
        motion = Swings(arm, q, amplitude, omega, phase, duration)
        if not broken_limits(
            arm, motion, duration=duration, samples=300, effort_share=max(share, 0.6)
        ):
            break
        amplitude, center = (
            0.8 * amplitude,
            0.8 * center + 0.2 * arm.to_joint_positions(arm.neutral),
        )
    return motion


def hidden_plant(arm, seed, payload=None):
    """Return an arm that differs from its file in everything that is to be found out."""
    rng = np.random.default_rng([seed, 3])
    size = drive_size(arm)
    rated = 0.05 * sum(body.mass for body in [*arm.model.inertias][1:])
    held = rng.uniform(0.0, rated) if payload is None else payload
    return fp.perturb(
        arm,
        mass_scale=fp.Uniform(0.7, 1.4),
        inertia_scale=fp.Uniform(0.8, 1.25),
        com_shift=fp.Uniform(0.0, 0.02),
        payload=fp.Payload(mass=held, com=rng.uniform(-0.05, 0.05, 3)),
        armature=size / rng.uniform(100.0, 400.0, arm.nv),
        friction=np.minimum(size / 20.0, 1.0) * rng.uniform(0.2, 0.8, arm.nv),
        damping=np.minimum(size / 20.0, 1.0) * rng.uniform(0.1, 0.5, arm.nv),
        seed=seed,
    )


def run(name, true, motion, duration=30.0, law=None):
    """Return a run of a law that knows the nominal arm only, on an encoder of 20 bits."""
    nominal = fp.load_arm(name, armature="rotors") if law is None else None
    controller = fp.RobustFONFTSM(nominal, dt=DT) if law is None else law
    return fp.simulate(
        true,
        controller,
        motion,
        duration,
        sensor=Encoder(true, DT, bits=BITS),
        integrator="semi-implicit",
        substeps=2,
    )


def measured(rec, seed, noise=TORQUE_NOISE, bits=BITS):
    """Return the log that a robot would have written of a run, and its torque without noise."""
    arm = rec.arm
    rng = np.random.default_rng([seed, 11])
    sensor = Encoder(arm, DT, bits=bits)
    q, v = zip(*(sensor(t, q, v) for t, q, v in zip(rec.t, rec.q, rec.v, strict=True)), strict=True)
    spread = noise * drive_size(arm)
    tau = rec.tau + spread * rng.standard_normal(rec.tau.shape)
    return Log(
        t=rec.t, q=np.array(q), v=np.array(v), tau=tau, joint_names=arm.joint_names, source="test"
    )


def calculated(
    true, motion, seed=0, duration=30.0, noise=TORQUE_NOISE, bits=BITS, dt=CALCULATED_DT
):
    """Return the log of an arm that follows a motion exactly: inverse dynamics, and friction."""
    rng = np.random.default_rng([seed, 11])
    t = np.arange(0.0, duration, dt)
    q, v, a = motion.at(t)
    tau = np.array([true.inverse_dynamics(*row) for row in zip(q, v, a, strict=True)])
    tau += true.damping * v + true.friction * np.sign(v)
    tau += noise * drive_size(true) * rng.standard_normal(tau.shape)
    step = 2 * np.pi / 2**bits
    x = step * np.round(np.array([true.to_joint_positions(row) for row in q]) / step)
    read = np.array([true.from_joint_positions(row) for row in x])
    speed = np.gradient(np.unwrap(x, axis=0), dt, axis=0)
    return Log(t=t, q=read, v=speed, tau=tau, joint_names=true.joint_names, source="calculated")
