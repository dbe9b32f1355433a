"""Laws of mechanics and of numerics that the plant obeys, whatever the arm."""

import xml.etree.ElementTree as ET

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from fotsmc_pin.arms import perturb
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import simulate

ORDERS = {"rk4": 4.0, "semi-implicit": 1.0}


def start(arm, speed=1.0):
    rng = np.random.default_rng(5)
    q0 = arm.integrate(arm.neutral, rng.uniform(-0.5, 0.5, arm.nv))
    return {"q0": q0, "v0": speed * rng.uniform(-1.0, 1.0, arm.nv)}


def energies(rec):
    """Kinetic energy, the motors' own included, and potential energy of each row [J]."""
    model = rec.arm.model
    data = model.createData()
    return np.array(
        [
            0.5 * v @ rec.arm.mass_matrix(q) @ v + pin.computePotentialEnergy(model, data, q)
            for q, v in zip(rec.q, rec.v, strict=True)
        ]
    )


def travelled(rec):
    """Tangent step from each row to the next, (N-1, nv)."""
    pairs = zip(rec.q[:-1], rec.q[1:], strict=True)
    return np.array([rec.arm.difference(one, other) for one, other in pairs])


def test_a_free_arm_keeps_its_energy(arm, held):
    rec = simulate(arm, held(arm, 1e-3), Hold(arm), 0.5, **start(arm), substeps=4)
    energy = energies(rec)
    data = arm.model.createData()
    potential = [pin.computePotentialEnergy(arm.model, data, q) for q in rec.q]
    assert np.abs(energy - energy[0]).max() < 1e-6 * np.ptp(potential)


def test_a_driven_arm_gains_the_work_that_the_torque_does(arm, held):
    torque = 0.02 * np.minimum(arm.effort_limit, 100.0)
    rec = simulate(arm, held(arm, 1e-3, torque), Hold(arm), 0.3, **start(arm, 0.3), substeps=4)
    work = np.cumsum(np.einsum("ki,ki->k", rec.tau[:-1], travelled(rec)))
    gained = energies(rec)[1:] - energies(rec)[0]
    np.testing.assert_allclose(gained, work, atol=1e-6 * np.abs(work).max())


@pytest.mark.parametrize("integrator", ORDERS)
def test_damping_and_friction_take_energy_and_never_give(arm, held, integrator):
    lightest = np.diag(arm.mass_matrix(arm.neutral)).min()
    rough = perturb(arm, damping=10.0 * lightest, friction=2.0 * lightest)
    rec = simulate(
        rough, held(rough, 1e-3), Hold(rough), 0.3, **start(arm), integrator=integrator, substeps=4
    )
    energy = energies(rec)
    step = np.abs(np.diff(energies(simulate_frictionless(arm, held, integrator)))).max()
    assert np.diff(energy).max() < 1.5 * step + 1e-9
    lost = energy[0] - energy[-1]
    speed = 0.5 * (rec.v[:-1] + rec.v[1:])
    rub = rough.damping * speed**2 + rough.friction * np.abs(speed)
    assert lost == pytest.approx(1e-3 * rub.sum(), rel=0.01 if integrator == "rk4" else 0.1)


def simulate_frictionless(arm, held, integrator):
    return simulate(
        arm, held(arm, 1e-3), Hold(arm), 0.3, **start(arm), integrator=integrator, substeps=4
    )


@pytest.mark.parametrize("integrator", ORDERS)
def test_the_error_falls_with_the_declared_order(arm, held, integrator):
    def end(steps, **options):
        whole = 0.16
        rec = simulate(arm, held(arm, whole / steps), Hold(arm), whole, **start(arm), **options)
        return rec.q[-1], rec.v[-1]

    q, v = end(16, substeps=64, integrator="rk4")
    errors = []
    for steps in (16, 32, 64):
        q_end, v_end = end(steps, integrator=integrator)
        errors.append(np.linalg.norm([*arm.difference(q, q_end), *(v_end - v)]))
    order = -np.polyfit(np.log([16, 32, 64]), np.log(errors), 1)[0]
    assert order == pytest.approx(ORDERS[integrator], abs=0.35)


def test_substeps_and_shorter_ticks_are_the_same_under_a_held_torque(arm, held):
    torque = 0.02 * np.minimum(arm.effort_limit, 100.0)
    coarse = simulate(arm, held(arm, 0.02, torque), Hold(arm), 0.1, **start(arm), substeps=20)
    fine = simulate(arm, held(arm, 1e-3, torque), Hold(arm), 0.1, **start(arm))
    np.testing.assert_allclose(coarse.q, fine.q[::20], rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(coarse.v, fine.v[::20], rtol=1e-9, atol=1e-9)


def test_the_torque_is_held_between_ticks(arms, held):
    """A torque that follows the speed acts as it was at the tick, not as it would be since."""
    arm = arms["two_link"]
    brake = held(arm, 0.05, lambda q, v: -20.0 * v)
    rec = simulate(arm, brake, Hold(arm), 0.05, v0=[1.0, 0.0], substeps=50)
    constant = held(arm, 0.05, [-20.0, 0.0])
    same = simulate(arm, constant, Hold(arm), 0.05, v0=[1.0, 0.0], substeps=50)
    np.testing.assert_allclose(rec.q[1], same.q[1], rtol=1e-14)


def test_continuous_joints_turn_for_ever_on_the_unit_circle(arms, held):
    arm = arms["kinova"]
    spin = np.zeros(arm.nv)
    spin[-1] = 20.0
    wrist = held(arm, 1e-3, lambda q, v: arm.gravity(q) + 0.05 * (spin - v) - 0.5 * v * (spin == 0))
    rec = simulate(arm, wrist, Hold(arm), 1.5, v0=spin)
    assert rec.v[:, -1].mean() * 1.5 > 4 * np.pi, "it turned more than twice"
    assert np.abs(rec.e[:, -1]).max() <= np.pi + 1e-9
    radius = np.hypot(rec.q[:, -2], rec.q[:, -1])
    np.testing.assert_allclose(radius, 1.0, atol=1e-12)


class TestDisturbance:
    def test_is_asked_at_every_stage_of_every_step(self, arms, held):
        asked = []

        def disturbance(t):
            asked.append(round(t / 1e-3, 6))
            return np.zeros(2)

        arm = arms["two_link"]
        simulate(arm, held(arm, 4e-3), Hold(arm), 4e-3, disturbance=disturbance, substeps=2)
        assert set(asked) >= {0.0, 1.0, 2.0, 3.0, 4.0}

    def test_keeps_the_order_of_the_integrator(self, arms, held):
        """A hum of 100 Hz, four steps in a period: held over a step it would be lost."""
        arm = arms["two_link"]

        def hum(t):
            return np.array([0.0, 500.0 * np.sin(200.0 * np.pi * t)])

        def end(substeps):
            rec = simulate(
                arm, held(arm, 0.02), Hold(arm), 0.02, disturbance=hum, substeps=substeps
            )
            return rec.v[-1]

        exact = end(640)
        errors = [np.abs(end(substeps) - exact).max() for substeps in (10, 20, 40)]
        order = -np.polyfit(np.log([10, 20, 40]), np.log(errors), 1)[0]
        assert order == pytest.approx(4.0, abs=0.5)

    def test_acts_like_the_same_torque(self, arms, held):
        arm = arms["two_link"]
        torque = np.array([3.0, -1.0])
        driven = simulate(arm, held(arm, 1e-3, torque), Hold(arm), 0.1)
        pushed = simulate(arm, held(arm, 1e-3), Hold(arm), 0.1, disturbance=lambda t: torque)
        np.testing.assert_allclose(driven.q, pushed.q, rtol=1e-13)
        assert not pushed.tau.any(), "what is recorded is the motors' torque"


def test_torque_beyond_the_limits_is_cut_off_and_recorded_so(arms, held):
    arm = arms["panda"]
    rec = simulate(arm, held(arm, 1e-3, 1e4), Hold(arm), 0.005)
    np.testing.assert_array_equal(rec.tau, np.tile(arm.effort_limit, (6, 1)))


def test_mujoco_swings_the_same_way(arms, held):
    """A second opinion on the whole chain, from the URDF to the trajectory."""
    arm = arms["two_link"]
    robot = ET.fromstring(arm.urdf)
    for link in robot.findall("link"):
        for shape in (*link.findall("visual"), *link.findall("collision")):
            link.remove(shape)
    compiler = {"boundinertia": "1e-14", "balanceinertia": "false", "fusestatic": "true"}
    ET.SubElement(ET.SubElement(robot, "mujoco"), "compiler", compiler)
    model = mujoco.MjModel.from_xml_string(ET.tostring(robot, encoding="unicode"))
    model.dof_armature[:] = arm.armature
    model.opt.timestep, model.opt.integrator = 1e-3, mujoco.mjtIntegrator.mjINT_RK4
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    mujoco.mj_setConst(model, mujoco.MjData(model))
    data = mujoco.MjData(model)
    rec = simulate(arm, held(arm, 1e-3), Hold(arm), 1.0, q0=[1.0, 1.5], v0=[0.5, -1.0])
    data.qpos[:], data.qvel[:] = rec.q[0], rec.v[0]
    for q in rec.q:
        np.testing.assert_allclose(data.qpos, q, atol=1e-8)
        mujoco.mj_step(model, data)
    assert np.abs(rec.q[-1] - rec.q[0]).max() > 0.3, "it did swing"
