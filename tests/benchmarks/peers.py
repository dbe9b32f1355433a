"""Computed torque on the Panda at 1 kHz in other programs: one function of a tick for each.

Each evaluates inverse dynamics of the reference's acceleration plus PD, applies it, and takes one
step of its plant. All but Robotics Toolbox read the same URDF, without meshes.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import numpy as np

DT, KP, KD = 1e-3, 400.0, 40.0


def at(wanted, k):
    """Row `k` of a reference that was evaluated beforehand, as `simulate` does it; then from 0."""
    k %= len(wanted[0]) - 1
    return wanted[0][k], wanted[1][k], wanted[2][k]


def position_after(wanted, k):
    """Position that is wanted once `k` ticks are done."""
    return wanted[0][(k - 1) % (len(wanted[0]) - 1) + 1]


def bare_urdf(arm):
    """The arm's URDF without shapes, which no dynamics needs."""
    robot = ET.fromstring(arm.urdf)
    for link in robot.findall("link"):
        for shape in (*link.findall("visual"), *link.findall("collision")):
            link.remove(shape)
    return ET.tostring(robot, encoding="unicode")


def mujoco_tick(arm, wanted, integrator):
    import mujoco

    robot = ET.fromstring(bare_urdf(arm))
    compiler = {"boundinertia": "1e-14", "balanceinertia": "false", "fusestatic": "true"}
    ET.SubElement(ET.SubElement(robot, "mujoco"), "compiler", compiler)
    model = mujoco.MjModel.from_xml_string(ET.tostring(robot, encoding="unicode"))
    model.opt.timestep = DT
    model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    mujoco.mj_setConst(model, data := mujoco.MjData(model))
    thinking = mujoco.MjData(model)
    data.qpos[:] = wanted[0][0]
    k = 0

    def tick():
        nonlocal k
        q_d, v_d, a_d = at(wanted, k)
        thinking.qpos[:], thinking.qvel[:] = data.qpos, data.qvel
        thinking.qacc[:] = a_d - KD * (data.qvel - v_d) - KP * (data.qpos - q_d)
        mujoco.mj_inverse(model, thinking)
        data.qfrc_applied[:] = thinking.qfrc_inverse
        mujoco.mj_step(model, data)
        k += 1

    return tick, lambda: data.qpos - position_after(wanted, k)


def drake_tick(arm, wanted):
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.systems.analysis import Simulator

    plant = MultibodyPlant(DT)
    text = re.sub(r"<limit[^>]*/>", "", bare_urdf(arm))
    Parser(plant).AddModelsFromString(text, "urdf")
    plant.WeldFrames(plant.world_frame(), plant.GetBodyByName(arm.tree.root).body_frame())
    plant.Finalize()
    simulator = Simulator(plant)
    context = simulator.get_mutable_context()
    thinking = plant.CreateDefaultContext()
    port = plant.get_applied_generalized_force_input_port()
    port.FixValue(context, np.zeros(arm.nv))
    plant.SetPositions(context, wanted[0][0])
    simulator.Initialize()
    forces = multibody_forces(plant)
    k = 0

    def tick():
        nonlocal k
        q_d, v_d, a_d = at(wanted, k)
        q, v = plant.GetPositions(context), plant.GetVelocities(context)
        plant.SetPositions(thinking, q)
        plant.SetVelocities(thinking, v)
        plant.CalcForceElementsContribution(thinking, forces)
        a = a_d - KD * (v - v_d) - KP * (q - q_d)
        port.FixValue(context, plant.CalcInverseDynamics(thinking, a, forces))
        k += 1
        simulator.AdvanceTo(k * DT)

    return tick, lambda: plant.GetPositions(context) - position_after(wanted, k)


def multibody_forces(plant):
    from pydrake.multibody.tree import MultibodyForces

    return MultibodyForces(plant)


def toolbox_tick(arm, wanted):
    """Its own Panda, as it reads no inertias from a URDF that its compiled `rne` could use."""
    import roboticstoolbox as rtb

    robot = rtb.models.DH.Panda()
    q, v = np.array(wanted[0][0]), np.zeros(arm.nv)
    k = 0

    def tick():
        nonlocal k, q, v
        q_d, v_d, a_d = at(wanted, k)
        tau = robot.rne(q, v, a_d - KD * (v - v_d) - KP * (q - q_d))
        v = v + DT * robot.accel(q, v, tau)
        q = q + DT * v
        k += 1

    return tick, lambda: q - position_after(wanted, k)
