"""A maker of small robots, for tests that need one of a kind."""

from pathlib import Path

import numpy as np
import pytest

INERTIA = (
    '<inertial><origin xyz="0.2 0 0.01" rpy="0.3 0 0"/><mass value="{mass}"/>'
    '<inertia ixx="0.01" ixy="0.001" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial>'
)
LIMIT = '<limit lower="-2" upper="2" effort="40" velocity="3"/>'


class Maker:
    """Writes URDF files into a folder from parts."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def link(self, name, mass=1.0, extra=""):
        return f'<link name="{name}">{INERTIA.format(mass=mass)}{extra}</link>'

    def joint(self, name, parent, child, kind="revolute", axis="0 1 0", extra=LIMIT):
        return (
            f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="0.4 0 0" rpy="0.1 0.2 0.3"/><axis xyz="{axis}"/>{extra}</joint>'
        )

    def file(self, *parts, name="made.urdf", head=""):
        path = self.folder / name
        body = "\n".join(parts)
        text = f'{head}<robot name="made">\n<link name="base"/>\n{body}\n</robot>\n'
        path.write_text(text, encoding="utf-8")
        return path

    def chain(self, *kinds, extra=LIMIT, tail=()):
        """A chain of links on joints of the given kinds."""
        parts, parent = [], "base"
        for number, kind in enumerate(kinds, 1):
            axis = "0 1 0" if number % 2 else "0 0.6 0.8"
            parts.append(self.link(f"link{number}"))
            name = f"joint{number}"
            parts.append(self.joint(name, parent, f"link{number}", kind, axis, extra))
            parent = f"link{number}"
        return self.file(*parts, *tail)


@pytest.fixture
def made(tmp_path):
    return Maker(tmp_path)


@pytest.fixture
def worst_difference():
    """Largest difference of two arms' accelerations over random states, relative."""

    def measure(one, other, states=20):
        rng = np.random.default_rng(0)
        worst = 0.0
        for _ in range(states):
            q = one.random_configuration(rng)
            v, tau = rng.normal(size=one.nv), rng.normal(size=one.nv)
            a, b = one.forward_dynamics(q, v, tau), other.forward_dynamics(q, v, tau)
            worst = max(worst, np.abs(a - b).max() / max(1.0, np.abs(a).max()))
        return worst

    return measure
