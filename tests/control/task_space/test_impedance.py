"""`CartesianImpedance`: the spring that was asked for, and a wall that nothing bounces off."""

import xml.etree.ElementTree as ET

import mujoco
import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.control.task_space.impedance_law import ImpedanceLaw
from fotsmc_pin.references import PoseHold

DT = 1e-3
READY = np.array([0.0, 0.5, 0.0, -1.4, 0.0, 1.0, 0.0])
STIFFNESS = np.array([800.0, 400.0, 600.0, 40.0, 30.0, 50.0])


@pytest.mark.parametrize("options", [{}, {"inertia": [4.0, 4.0, 4.0, 0.2, 0.2, 0.2]}])
@pytest.mark.parametrize("direction", [0, 2, 4])
def test_the_tool_is_as_stiff_as_asked(seven, direction, options):
    target = seven.tool_pose(READY)
    push = np.zeros(6)
    push[direction] = 10.0 if direction < 3 else 1.0
    wrench = fp.Wrench(
        start=0.2, duration=9.0, force=push[:3], torque=push[3:], axes="local", rise=0.1
    )
    ctl = fp.CartesianImpedance(seven, DT, stiffness=STIFFNESS, **options)
    true = fp.perturb(seven, mass_scale=1.0)
    rec = fp.simulate(true, ctl, PoseHold(pose=target), 2.5, q0=READY, disturbance=wrench)
    yielded = rec.signals["pose_error"][-1]
    assert push[direction] / yielded[direction] == pytest.approx(STIFFNESS[direction], rel=0.02)
    along = rec.signals["pose_error"][:, direction]
    assert along.max() < 1.05 * along[-1]


def test_modes_are_damped_by_their_ratio():
    """Without contact the loop is `Λ ë + D ė + K e = 0`: its eigenvalues have the ratio."""
    body = fp.TaskSpace(fp.load_arm("ur5"), DT).law.arm
    law = ImpedanceLaw(body, DT, stiffness=STIFFNESS, damping_ratio=0.7)
    rng = np.random.default_rng(0)
    Lambda = rng.normal(size=(6, 6))
    Lambda = Lambda @ Lambda.T + np.eye(6)

    class Terms:
        M, h = Lambda, np.zeros(6)

        def evaluate(self, q, joints):
            """Stay."""

    law.use_terms(Terms())
    law.joints.effort_limit[:] = np.inf
    zero = np.zeros(6)
    forces = [law.update(zero, unit, zero, zero, zero) for unit in np.eye(6)]
    D = -np.array(forces).T
    np.testing.assert_allclose(D, D.T, atol=1e-9)
    block = np.block(
        [
            [np.zeros((6, 6)), np.eye(6)],
            [-np.linalg.solve(Lambda, np.diag(STIFFNESS)), -np.linalg.solve(Lambda, D)],
        ]
    )
    roots = np.linalg.eigvals(block)
    np.testing.assert_allclose(-roots.real / np.abs(roots), 0.7, atol=1e-6)


def walled(arm, top):
    """The arm in MuJoCo with a ball at its tool over a stiff floor at the height `top`."""
    robot = ET.fromstring(arm.urdf)
    for link in robot.findall("link"):
        for shape in (*link.findall("visual"), *link.findall("collision")):
            link.remove(shape)
    ball = ET.SubElement(robot.find("link[@name='tool0']"), "collision")
    ET.SubElement(ET.SubElement(ball, "geometry"), "sphere", radius="0.01")
    ET.SubElement(ET.SubElement(robot, "mujoco"), "compiler", fusestatic="true")
    spec = mujoco.MjSpec.from_string(ET.tostring(robot, encoding="unicode"))
    floor = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[2.0, 2.0, 0.1])
    floor.pos = [0.0, 0.0, top - 0.1]
    for geom in spec.geoms:
        geom.solref, geom.solimp = [0.004, 1.0], [0.95, 0.99, 0.001, 0.5, 2.0]
    model = spec.compile()
    model.opt.timestep = 5e-4
    return model, mujoco.MjData(model)


def test_nothing_bounces_off_a_stiff_wall(seven):
    target = seven.tool_pose(READY)
    height = float(target.translation[2])
    model, data = walled(seven, height - 0.03)
    data.qpos[:] = READY
    # The ball, 1 cm in radius, meets the floor 2 cm down; the tool is asked to go on to 6 cm.
    ctl = fp.CartesianImpedance(seven, DT, stiffness=[600.0] * 3 + [40.0] * 3)
    stored, forces, speeds = [], [], []
    for k in range(4000):
        below = pin.SE3(target.rotation, target.translation - [0.0, 0.0, min(0.06, 1e-4 * k)])
        tau = ctl.update(data.qpos.copy(), data.qvel.copy(), below, np.zeros(6), np.zeros(6))
        data.qfrc_applied[:] = tau
        for _ in range(2):
            mujoco.mj_step(model, data)
        seen = ctl.law.joints
        energy = 0.5 * seen.e_dot @ ctl._mobility @ seen.e_dot
        stored.append(energy + 0.5 * seen.e @ (ctl.gains.stiffness * seen.e))
        speeds.append(float(np.linalg.norm(seen.v[:3])))
        force = np.zeros(6)
        if data.ncon:
            mujoco.mj_contactForce(model, data, 0, force)
        forces.append(force[0])
    # At rest on the floor, with the force of the spring, and no energy that came from nowhere.
    assert max(speeds[-500:]) < 1e-3
    assert forces[-1] == pytest.approx(600.0 * (0.06 - 0.02), rel=0.02)
    after = np.array(stored[1500:])
    assert np.diff(after).max() < 1e-4
