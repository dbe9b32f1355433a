"""Bring your own URDF: look at what was understood of it, then track a path through waypoints.

Run it with the path of a URDF, or without one to use the small arm below, which has no meshes.
"""

import sys
from pathlib import Path

import numpy as np

import fotsmc_pin as fp
from fotsmc_pin.files import write_text

LINK = """
  <link name="{name}"><inertial><origin xyz="0 0 {com}"/><mass value="{mass}"/>
    <inertia ixx="{i}" iyy="{i}" izz="0.002" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
JOINT = """
  <joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>
    <origin xyz="0 0 {height}"/><axis xyz="{axis}"/>
    <limit lower="-2.5" upper="2.5" effort="{effort}" velocity="3"/></joint>"""


def small_arm() -> str:
    """Return the URDF of an arm with three joints: base, shoulder and elbow."""
    text = '<robot name="small_arm">\n  <link name="base"/>'
    for name, com, mass, i in (
        ("column", 0.10, 2.0, 0.01),
        ("upper", 0.15, 1.5, 0.012),
        ("fore", 0.12, 1.0, 0.006),
    ):
        text += LINK.format(name=name, com=com, mass=mass, i=i)
    for name, parent, child, height, axis, effort in (
        ("turn", "base", "column", 0.05, "0 0 1", 30),
        ("shoulder", "column", "upper", 0.20, "0 1 0", 30),
        ("elbow", "upper", "fore", 0.30, "0 1 0", 15),
    ):
        text += JOINT.format(
            name=name, parent=parent, child=child, height=height, axis=axis, effort=effort
        )
    return text + "\n</robot>\n"


def main(out: Path = Path("out/own_urdf"), urdf: Path | None = None) -> fp.Recording:
    """Load `urdf`, inspect it, and simulate a path through four waypoints."""
    if urdf is None:
        urdf = out / "small_arm.urdf"
        write_text(urdf, small_arm())

    nominal = fp.load_arm(urdf, armature=0.02)  # Motors' inertia, which few URDFs state.
    found = fp.inspect_arm(nominal)
    print(f"{nominal.name}: {nominal.nv} joints, {found.total_mass:.2f} kg")
    for joint, share in zip(nominal.joint_names, found.gravity_share, strict=True):
        print(f"  {joint}: gravity takes up to {100 * share:.0f} % of the effort limit")
    for line in (*nominal.notes, *found.warnings):
        print(f"  {line}")

    true = fp.perturb(nominal, mass_scale=fp.Uniform(0.9, 1.3), friction=0.3, seed=1)
    centre = nominal.to_joint_positions(nominal.neutral)
    swing = np.outer([0.0, 1.0, -1.0, 0.0], np.full(nominal.nv, 0.5))
    waypoints = [nominal.from_joint_positions(centre + step) for step in swing]
    reference = fp.references.MinimumJerk.through(
        nominal, np.array(waypoints), velocity_limit=1.0, acceleration_limit=4.0
    )
    controller = fp.RobustFONFTSM(nominal, dt=1e-3)
    rec = fp.simulate(true, controller, reference, reference.duration)

    print(f"largest error: {1e3 * fp.summarize(rec).max_error:.1f} mrad")
    rec.save(out / "run.npz")
    fp.export_html(rec, out / "own_urdf.html", title="An arm without meshes")
    print(f"Open {out / 'own_urdf.html'} in a browser.")
    return rec


if __name__ == "__main__":
    main(urdf=Path(sys.argv[1]) if len(sys.argv) > 1 else None)
