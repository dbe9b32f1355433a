"""The arms known by name: those bundled here, in example-robot-data, in robot_descriptions."""

from __future__ import annotations

import importlib
import importlib.util
import os
import sys
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from fotsmc_pin.checks import did_you_mean
from fotsmc_pin.errors import ArmNotFoundError

BUNDLED = {"two_link": "two_link_nominal.urdf", "two_link_true": "two_link_true.urdf"}

# Where example-robot-data keeps the fixed-base arms, below its folder of robots.
EXAMPLE_ROBOTS = {
    "panda": "panda_description/urdf/panda.urdf",
    "ur3": "ur_description/urdf/ur3_robot.urdf",
    "ur5": "ur_description/urdf/ur5_robot.urdf",
    "ur10": "ur_description/urdf/ur10_robot.urdf",
    "kinova": "kinova_description/robots/kinova.urdf",
    "xarm7": "xarm_description/urdf/xarm7.urdf",
    "z1": "z1_description/urdf/z1.urdf",
    "talos_arm": "talos_data/robots/talos_left_arm.urdf",
    "so100": "so_arm_description/urdf/so100.urdf",
    "so101": "so_arm_description/urdf/so101.urdf",
    "asr_twodof": "asr_twodof_description/urdf/TwoDofs.urdf",
    "finger_edu": "finger_edu_description/robots/finger_edu.urdf",
    "double_pendulum": "double_pendulum_description/urdf/double_pendulum.urdf",
    "double_pendulum_continuous": (
        "double_pendulum_description/urdf/double_pendulum_continuous.urdf"
    ),
    "double_pendulum_simple": "double_pendulum_description/urdf/double_pendulum_simple.urdf",
    "baxter": "baxter_description/urdf/baxter.urdf",
}


@dataclass(frozen=True, kw_only=True)
class Source:
    """Where an arm's URDF is.

    Attributes:
        path: the file.
        package_dirs: folders that hold the packages of its meshes.
        name: what to call the arm; None leaves it to the file.
    """

    path: Path
    package_dirs: tuple[str, ...] = ()
    name: str | None = None


def find_source(source: str | Path) -> Source:
    """Return where an arm's URDF is: a path is tried first, then the names.

    Raises:
        ArmNotFoundError: no such file and no such name.
    """
    path = Path(source).expanduser()
    if path.is_file():
        return Source(path=path)
    name = str(source)
    if isinstance(source, Path) or path.suffix or {"/", os.sep} & {*name}:
        what = "is a folder" if path.is_dir() else "does not exist"
        raise ArmNotFoundError(f"the file {name!r} {what}; give the path of a URDF file")
    found = _bundled(name) or _example_robot(name) or _robot_description(name)
    if found is None:
        raise ArmNotFoundError(
            f"no arm is called {name!r}; {did_you_mean(name, known_names())}known: "
            + f"{', '.join(known_names())}. "
            + _missing_data_hint()
            + "A file is given by its path, such as ./my.urdf"
        )
    return found


def known_names() -> tuple[str, ...]:
    """Return the names that load on this machine, robot_descriptions left out."""
    robots = example_robots_folder()
    if robots is None:
        return tuple(BUNDLED)
    return (*BUNDLED, *(name for name, file in EXAMPLE_ROBOTS.items() if (robots / file).is_file()))


def shared_folders() -> tuple[Path, ...]:
    """Return the folders in which packages of robots are installed: here and by ROS."""
    robots = example_robots_folder()
    found = [] if robots is None else [robots.parents[1]]
    for variable, inside in (("ROS_PACKAGE_PATH", "."), ("AMENT_PREFIX_PATH", "share")):
        folders = os.environ.get(variable, "").split(os.pathsep)
        found += [Path(folder) / inside for folder in folders if folder]
    return tuple(found)


def urdf_folder() -> Path:
    """Return the folder of bundled URDFs: in the package when installed, else beside it."""
    package = Path(__file__).resolve().parents[1]
    inside = package / "urdf"
    return inside if inside.is_dir() else package.parent / "urdf"


def example_robots_folder() -> Path | None:
    """Return the folder of example-robot-data's robots, None where it is not installed.

    The folder is found by the distribution's files; the loader package of the same name may be
    missing or pinned to other data.
    """
    inside = Path("share/example-robot-data/robots")
    prefixes = [Path(sys.prefix)]
    try:
        wheel = metadata.distribution("example-robot-data")
        prefixes.insert(0, Path(str(wheel.locate_file("cmeel.prefix"))))
    except metadata.PackageNotFoundError:
        pass
    return next((prefix / inside for prefix in prefixes if (prefix / inside).is_dir()), None)


def _bundled(name: str) -> Source | None:
    if name not in BUNDLED:
        return None
    return Source(path=urdf_folder() / BUNDLED[name], name=name)


def _example_robot(name: str) -> Source | None:
    robots = example_robots_folder()
    if robots is None:
        return None
    if name in EXAMPLE_ROBOTS:
        path = robots / EXAMPLE_ROBOTS[name]
    else:
        # Any other file of the package goes by its own name.
        path = next(iter(sorted(robots.glob(f"*/*/{name}.urdf"))), robots / name)
    if not path.is_file():
        return None
    return Source(path=path, package_dirs=(str(robots.parents[1]),), name=name)


def _robot_description(name: str) -> Source | None:
    if importlib.util.find_spec("robot_descriptions") is None:
        return None
    for module_name in (name, f"{name}_description"):
        full_name = f"robot_descriptions.{module_name}"
        if not module_name.isidentifier() or importlib.util.find_spec(full_name) is None:
            continue
        try:
            module = importlib.import_module(full_name)
        except Exception as error:  # Importing downloads the robot, and that fails in many ways.
            raise ArmNotFoundError(f"robot_descriptions cannot fetch {name!r}: {error}") from error
        if hasattr(module, "URDF_PATH"):
            package = Path(module.PACKAGE_PATH)
            repository = Path(getattr(module, "REPOSITORY_PATH", package))
            folders = tuple(str(folder) for folder in (package.parent, package, repository))
            return Source(path=Path(module.URDF_PATH), package_dirs=folders, name=name)
    return None


def _missing_data_hint() -> str:
    if example_robots_folder() is not None:
        return ""
    return "More come with: pip install example-robot-data. "
