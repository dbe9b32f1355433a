"""What an arm looks like: its visual shapes, with meshes read only when asked for."""

from __future__ import annotations

import copy
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import pinocchio as pin

from fotsmc_pin.arms.markup import urdf_text

if TYPE_CHECKING:
    import xml.etree.ElementTree as ET
    from collections.abc import Iterable, Sequence

    from fotsmc_pin.arms.tree import UrdfTree


def visual_model(
    tree: UrdfTree, model: pin.Model, package_dirs: Sequence[str]
) -> pin.GeometryModel:
    """Return the visual shapes of an arm, without the meshes that cannot be found.

    Warns:
        UserWarning: names each mesh that is not there.
    """
    robot = copy.deepcopy(tree.robot)
    for link in robot.findall("link"):
        for visual in link.findall("visual"):
            mesh = visual.find("geometry/mesh")
            if mesh is not None and find_mesh(mesh.get("filename", ""), package_dirs) is None:
                link.remove(visual)
                warnings.warn(
                    f"{tree.origin}: mesh {mesh.get('filename')!r} of link {link.get('name')!r} "
                    "is not there, drawn without it (dynamics are not affected); "
                    "package_dirs says where packages are",
                    UserWarning,
                    stacklevel=2,
                )
    return pin.buildGeomFromUrdfString(
        model, urdf_text(robot), pin.GeometryType.VISUAL, package_dirs=list(package_dirs)
    )


def find_mesh(address: str, package_dirs: Sequence[str]) -> Path | None:
    """Return the file of a mesh address as written in a URDF, None where there is none."""
    scheme, separator, rest = address.partition("://")
    if not separator:
        candidates = [Path(address)]
    elif scheme == "file":
        candidates = [Path(rest)]
    elif scheme in ("package", "model"):
        candidates = [Path(folder) / rest for folder in package_dirs]
    else:
        candidates = []
    return next((path for path in candidates if path.is_file()), None)


def anchor_meshes(robot: ET.Element, folder: Path) -> None:
    """Make relative mesh addresses absolute: they are relative to the folder of the URDF."""
    for mesh in robot.iter("mesh"):
        address = mesh.get("filename", "")
        if address and "://" not in address and not Path(address).is_absolute():
            mesh.set("filename", str((folder / address).resolve()))


def package_folders(robot: ET.Element, folders: Iterable[Path]) -> list[str]:
    """Return those of the folders that hold a package which the meshes of a URDF name."""
    packages = {
        address.removeprefix("package://").split("/")[0]
        for mesh in robot.iter("mesh")
        if (address := mesh.get("filename", "")).startswith("package://")
    }
    return [
        str(folder)
        for folder in folders
        if any((folder / package).is_dir() for package in packages)
    ]
