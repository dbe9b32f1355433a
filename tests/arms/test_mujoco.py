"""A second opinion: MuJoCo, loading the written URDF, moves as the arm does."""

import xml.etree.ElementTree as ET

import mujoco
import numpy as np
import pytest

import fotsmc_pin as fp
from fotsmc_pin.references import Sinusoid


class MujocoArm:
    """An arm in MuJoCo, its states in the order of the joints here.

    MuJoCo reads neither armature from a URDF nor inertias of exactly zero: the one is set, the
    other raised to 1e-14 kg·m². Joint friction is left to the caller, as Pinocchio does.
    """

    def __init__(self, arm, urdf):
        robot = ET.fromstring(urdf)
        for link in robot.findall("link"):
            for shape in (*link.findall("visual"), *link.findall("collision")):
                link.remove(shape)
        compiler = {"boundinertia": "1e-14", "balanceinertia": "false", "fusestatic": "true"}
        ET.SubElement(ET.SubElement(robot, "mujoco"), "compiler", compiler)
        self.model = mujoco.MjModel.from_xml_string(ET.tostring(robot, encoding="unicode"))
        self.data = mujoco.MjData(self.model)
        self.arm = arm
        names = [self.model.joint(number).name for number in range(self.model.njnt)]
        self.order = [arm.joint_names.index(name) for name in names]
        self.model.dof_armature[:] = arm.armature[self.order]
        self.model.dof_damping[:] = 0.0
        self.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        mujoco.mj_setConst(self.model, self.data)

    def acceleration(self, q, v, tau):
        """Joint accelerations, (nv,)."""
        self.data.qpos[:] = self.arm.to_joint_positions(q)[self.order]
        self.data.qvel[:] = v[self.order]
        self.data.qfrc_applied[:] = tau[self.order]
        mujoco.mj_forward(self.model, self.data)
        a = np.empty(self.arm.nv)
        a[self.order] = self.data.qacc
        return a


@pytest.fixture
def written(tmp_path):
    def write(arm):
        return arm.write_urdf(tmp_path / "true.urdf").read_text()

    return write


CASES = ["panda", "ur5", "xarm7", "kinova", "z1", "talos_arm", "ur10", "so101", "baxter"]


@pytest.mark.parametrize("name", CASES)
def test_accelerations_agree(name, written):
    arm = fp.perturb(
        fp.load_arm(name), mass_scale=1.3, com_shift=0.01, payload=2.0, armature=0.1, seed=3
    )
    assert_accelerations_agree(arm, MujocoArm(arm, written(arm)))


@pytest.mark.parametrize("payload", [0.0, 2.0])
@pytest.mark.parametrize("name", ["two_link", "two_link_true"])
def test_accelerations_of_the_two_link_case_agree(name, payload, written):
    arm = fp.perturb(fp.load_arm(name), payload=payload)
    assert_accelerations_agree(arm, MujocoArm(arm, written(arm)))


def assert_accelerations_agree(arm, other):
    rng = np.random.default_rng(6)
    for _ in range(50):
        q = arm.random_configuration(rng)
        v, tau = rng.normal(size=arm.nv), 10.0 * rng.normal(size=arm.nv)
        ours, theirs = arm.forward_dynamics(q, v, tau), other.acceleration(q, v, tau)
        assert np.abs(ours - theirs).max() < 1e-8 * np.abs(ours).max()


def test_a_closed_loop_on_mujoco_tracks_as_on_pinocchio(written):
    """The same law and plant, once integrated here and once by MuJoCo's own RK4."""
    nominal = fp.load_arm("panda")
    true = fp.perturb(nominal, mass_scale=1.1, damping=0.0, friction=0.0)
    reference = Sinusoid.inside_limits(nominal)
    duration, dt = 2.0, 1e-3

    def law():
        return fp.AdaptiveFONFTSM(nominal, dt=dt, preset="practical")

    ours = fp.simulate(true, law(), reference, duration=duration)

    plant, controller = MujocoArm(true, written(true)), law()
    plant.model.opt.timestep = dt
    plant.model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    plant.data.qpos[:] = true.to_joint_positions(reference(0.0)[0])[plant.order]
    errors = []
    for tick in range(len(ours.t)):
        q = np.empty(true.nv)
        v = np.empty(true.nv)
        q[plant.order], v[plant.order] = plant.data.qpos, plant.data.qvel
        q_d, v_d, a_d = reference(tick * dt)
        tau = controller.update(q, v, q_d, v_d, a_d)
        errors.append(true.difference(q_d, q))
        plant.data.qfrc_applied[:] = tau[plant.order]
        mujoco.mj_step(plant.model, plant.data)

    tail = len(errors) // 2
    rms_ours, rms_theirs = rms(ours.e[tail:]), rms(np.array(errors)[tail:])
    assert rms_theirs < 5e-3
    assert rms_theirs == pytest.approx(rms_ours, rel=0.05)


def rms(errors):
    return float(np.sqrt(np.mean(np.sum(errors**2, axis=1))))
