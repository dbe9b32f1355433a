"""A wrench at a frame: `Jᵀ F` by hand, the work that it does, and the same push in MuJoCo."""

import math
import xml.etree.ElementTree as ET

import mujoco
import numpy as np
import pinocchio as pin
import pytest

import fotsmc_pin as fp
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.references import Hold
from fotsmc_pin.simulation import Wrench, simulate
from fotsmc_pin.simulation.wrench import WrenchesOnArm

FIRST, SECOND = 1.0, 0.85
"""Lengths of the two-link arm's links [m]."""


def energy(arm, q, v):
    """Kinetic and potential energy, the motors' own included [J]."""
    data = arm.model.createData()
    potential = pin.computePotentialEnergy(arm.model, data, np.asarray(q))
    return float(0.5 * v @ arm.mass_matrix(q) @ v + potential)


def at_the_joints(arm, wrench, q, t=0.5):
    """What a wrench is at the joints of an arm at `q`, (nv,)."""
    torque = np.zeros(arm.nv)
    WrenchesOnArm(arm, [wrench]).add_to(torque, t, np.array(q))
    return torque


def planar(q, fx, fz, m):
    """Torques of the two-link arm under a force (fx, fz) at the tool and a torque about -y."""
    s1, s12, c1, c12 = math.sin(q[0]), math.sin(q[0] + q[1]), math.cos(q[0]), math.cos(q[0] + q[1])
    x, z = FIRST * c1 + SECOND * c12, FIRST * s1 + SECOND * s12
    return [x * fz - z * fx + m, SECOND * (c12 * fz - s12 * fx) + m]


@pytest.mark.parametrize("q", [(0.0, 0.0), (0.4, -1.1), (-2.0, 2.9)])
def test_the_two_link_arm_by_hand(arms, q):
    arm = arms["two_link"]
    fx, fz, m = 7.0, -3.0, 2.0
    world = Wrench(start=0.0, duration=1.0, force=(fx, 5.0, fz), torque=(0.0, -m, 0.0))
    assert at_the_joints(arm, world, q) == pytest.approx(planar(q, fx, fz, m))
    local = Wrench(start=0.0, duration=1.0, force=(fx, 5.0, fz), torque=(0, -m, 0), axes="local")
    s, c = math.sin(sum(q)), math.cos(sum(q))
    turned = planar(q, c * fx - s * fz, s * fx + c * fz, m)
    assert at_the_joints(arm, local, q) == pytest.approx(turned)


def test_a_wrench_at_another_link_moves_only_the_joints_before_it(arms):
    arm = arms["two_link"]
    wrench = Wrench(start=0.0, duration=1.0, torque=(0.0, -2.0, 0.0), frame="link1")
    np.testing.assert_allclose(at_the_joints(arm, wrench, [0.0, 0.0]), [2.0, 0.0])


@pytest.mark.parametrize("axes", ["world", "local"])
def test_power_at_the_frame_is_power_at_the_joints(arm, axes):
    """With `V` the frame's velocity by differences of its pose, `F·V = τ·v`."""
    rng = np.random.default_rng(3)
    q, v = arm.integrate(arm.neutral, rng.normal(size=arm.nv)), rng.normal(size=arm.nv)
    wrench = Wrench(
        start=0, duration=1, force=rng.normal(size=3), torque=rng.normal(size=3), axes=axes
    )
    before, after = (arm.tool_pose(arm.integrate(q, s * 1e-6 * v)) for s in (-0.5, 0.5))
    here = arm.tool_pose(q).rotation if axes == "local" else np.eye(3)
    speed = here.T @ (after.translation - before.translation) / 1e-6
    turn = here.T @ pin.log3(after.rotation @ before.rotation.T) / 1e-6
    power = np.dot(wrench.force, speed) + np.dot(wrench.torque, turn)
    assert at_the_joints(arm, wrench, q) @ v == pytest.approx(power, rel=1e-6)


@pytest.mark.parametrize(
    ("integrator", "substeps", "off"), [("rk4", 4, 1e-7), ("semi-implicit", 64, 1e-2)]
)
def test_the_energy_gained_is_the_work_of_the_force(arm, held, integrator, substeps, off):
    """A force that keeps its direction does `F·Δx`, whatever the way."""
    force = np.array([6.0, -3.0, 9.0])
    push = Wrench(start=0.0, duration=1.0, force=force)
    options = {"integrator": integrator, "substeps": substeps}
    rec = simulate(arm, held(arm, 1e-3), Hold(arm), 0.3, disturbance=push, **options)
    ends = [arm.tool_pose(q).translation for q in (rec.q[0], rec.q[-1])]
    work = force @ (ends[1] - ends[0])
    gained = energy(arm, rec.q[-1], rec.v[-1]) - energy(arm, rec.q[0], rec.v[0])
    assert abs(work) > 0.05
    assert gained == pytest.approx(work, rel=off)


@pytest.mark.parametrize("rise", [0.0, 0.05])
def test_it_acts_for_its_time_only(arms, held, rise):
    """The momentum that a torque about the axis gives is its area; before and after, none."""
    arm = fp.load_arm("two_link", gravity=(0.0, 0.0, 0.0))
    push = Wrench(start=0.1, duration=0.2, torque=(0.0, -3.0, 0.0), rise=rise)
    rec = simulate(arm, held(arm, 1e-3), Hold(arm), 0.5, disturbance=push)
    before, after = rec.t < 0.1 - 1e-9, rec.t > 0.3 - 1e-9
    assert not rec.v[before].any()
    momentum = np.array([(arm.mass_matrix(q) @ v)[0] for q, v in zip(rec.q, rec.v, strict=True)])
    np.testing.assert_allclose(
        momentum[after], 3.0 * (0.2 - rise), rtol=1e-3 if rise == 0 else 1e-6
    )
    assert momentum[int(0.2 / 1e-3)] == pytest.approx(0.5 * momentum[-1], rel=1e-2)


def test_the_edges_of_a_wrench():
    push = Wrench(start=1.0, duration=1.0, rise=0.25)
    shares = [push.share(t) for t in (0.9, 1.0, 1.125, 1.25, 1.5, 1.75, 1.875, 2.0, 2.1)]
    np.testing.assert_allclose(shares, [0, 0, 0.5, 1, 1, 1, 0.5, 0, 0], atol=1e-6)
    sharp = Wrench(start=0.3, duration=0.1)
    assert [sharp.share(t) for t in (0.299, 3 * 0.1, 0.35, 0.1 * 4)] == [0.0, 1.0, 1.0, 0.0]


ROUGH = {
    "rk4": {},
    "semi-implicit": {},
    "friction": {"friction": 0.02, "damping": 0.02},
    "springs": {"joint_stiffness": 2e4, "armature": 0.1},
}


@pytest.mark.parametrize("kind", ROUGH)
def test_a_torque_about_the_axes_is_the_same_as_at_the_joints(held, kind):
    """On the two-link arm `τ = (m, m)` everywhere, so a function of time says the same."""
    arm = fp.load_arm("two_link")
    arm = fp.perturb(arm, **ROUGH[kind]) if ROUGH[kind] else arm
    options = {"integrator": "rk4" if kind == "rk4" else "semi-implicit", "substeps": 3}
    at_frame = Wrench(start=0.0, duration=1.0, torque=(0.0, -40.0, 0.0))
    one = simulate(arm, held(arm, 1e-3), Hold(arm), 0.3, disturbance=at_frame, **options)
    both = lambda t: np.full(2, 40.0)  # noqa: E731
    other = simulate(arm, held(arm, 1e-3), Hold(arm), 0.3, disturbance=both, **options)
    np.testing.assert_allclose(one.q, other.q, rtol=0, atol=1e-12)
    assert np.abs(one.q[-1] - one.q[0]).max() > 0.02


def test_wrenches_and_functions_add_up(arms, held):
    arm = arms["panda"]
    push = Wrench(start=0.02, duration=0.05, force=(20.0, 0.0, 5.0), rise=0.01)
    half = Wrench(start=0.02, duration=0.05, force=(10.0, 0.0, 2.5), rise=0.01)
    hum = lambda t: np.full(7, math.sin(40.0 * t))  # noqa: E731
    rest = lambda t: 2.0 * hum(t)  # noqa: E731
    one = simulate(arm, held(arm, 1e-3), Hold(arm), 0.1, disturbance=[push, lambda t: 3.0 * hum(t)])
    other = simulate(arm, held(arm, 1e-3), Hold(arm), 0.1, disturbance=(half, hum, half, rest))
    np.testing.assert_allclose(one.q, other.q, rtol=0, atol=1e-12)
    assert one.wrenches == (push,)
    assert other.wrenches == (half, half)


def test_mujoco_is_pushed_the_same_way(arms, held):
    """`xfrc_applied` acts at a body's centre of mass, in the axes of the world."""
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
    body = model.body("link2").id
    push = Wrench(
        start=0.0, duration=2.0, force=(-30.0, 4.0, 60.0), torque=(1.0, -5.0, 2.0), frame="link2"
    )
    rec = simulate(
        arm, held(arm, 1e-3), Hold(arm), 1.0, q0=[1.0, 1.5], v0=[0.5, -1.0], disturbance=push
    )
    data.qpos[:], data.qvel[:] = rec.q[0], rec.v[0]
    worst = 0.0
    for q, v in zip(rec.q, rec.v, strict=True):
        # The moment about the centre of mass goes with the state: compare what both accelerate to.
        data.qpos[:], data.qvel[:] = q, v
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        arm_of_force = data.xpos[body] - data.xipos[body]
        data.xfrc_applied[body, :3] = push.force
        data.xfrc_applied[body, 3:] = np.add(push.torque, np.cross(arm_of_force, push.force))
        mujoco.mj_forward(model, data)
        ours = arm.forward_dynamics(q, v, at_the_joints(arm, push, q))
        worst = max(worst, float(np.abs(data.qacc - ours).max()))
    assert worst < 1e-9
    assert np.abs(rec.q[-1] - rec.q[0]).max() > 0.3, "it did move"


@pytest.mark.parametrize(
    ("parts", "named", "remedy"),
    [
        ({"force": (1.0, 2.0)}, "force", "shape"),
        ({"force": (1.0, math.nan, 0.0)}, "force", "finite"),
        ({"torque": "up"}, "torque", "numbers"),
        ({"start": -0.1}, "start", "at least 0"),
        ({"duration": 0.0}, "duration", "above 0"),
        ({"rise": 0.3}, "rise", "at most 0.25"),
        ({"axes": "wrold"}, "axes", "did you mean world"),
    ],
)
def test_a_wrench_that_is_none(parts, named, remedy):
    with pytest.raises(ArgumentError, match=remedy) as caught:
        Wrench(**({"start": 0.0, "duration": 0.5, "force": (1.0, 0.0, 0.0)} | parts))
    assert caught.value.argument == named


@pytest.mark.parametrize(
    ("given", "named", "remedy"),
    [
        (
            Wrench(start=0, duration=1, frame="link3"),
            "frame",
            "did you mean link1|did you mean link2",
        ),
        (Wrench(start=2.0, duration=1.0), "disturbance", "the run ends at 0.1 s"),
        ([3.0], r"disturbance[0]", "give a callable"),
        (np.zeros(2), "disturbance", "give a callable"),
        ([lambda t: np.zeros(2), lambda t: np.zeros(3)], "disturbance[1]", "shape"),
    ],
)
def test_a_disturbance_that_is_none(arms, held, given, named, remedy):
    arm = arms["two_link"]
    with pytest.raises(ArgumentError, match=remedy) as caught:
        simulate(arm, held(arm, 1e-3), Hold(arm), 0.1, disturbance=given)
    assert caught.value.argument == named
