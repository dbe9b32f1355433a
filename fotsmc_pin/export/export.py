"""`export_c`: a controller as two files of C99."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from fotsmc_pin.control import Controller, Safeguard
from fotsmc_pin.errors import ArgumentError
from fotsmc_pin.export.files import Files
from fotsmc_pin.files import write_text
from fotsmc_pin.learning import ModelLearning

if TYPE_CHECKING:
    import os


def export_c(
    controller: Controller | ModelLearning | Safeguard,
    folder: str | os.PathLike[str],
    *,
    single: bool = False,
) -> tuple[Path, Path]:
    """Write a controller as C99, for loops in hard real time.

    The C is translated from the law's own kernels, also those of a law that a user wrote. It needs
    `math.h` alone, allocates nothing and keeps everything in a struct of the caller. The same
    controller gives the same files, byte for byte.

    Args:
        controller: a control law, a `ModelLearning` around one, or a `Safeguard` around either; it
            stays as it is, and what it has learnt so far stays here.
        folder: where the files go: `fotsmc_<arm>.h` and `fotsmc_<arm>.c`.
        single: write `float` in place of `double`, for processors that have no other.

    Returns:
        The header and the program.

    Raises:
        ArgumentError: what is given, or what it wraps, is no such controller, or a task; an arm has
            a joint of several axes; a learner in single precision; a `Safeguard` has `Limits`,
            which need Pinocchio's collision models and a solver.
        TranslationError: a kernel contains what is not translated; the message names the place.
    """
    inner: Any = controller
    for wrapper in (Safeguard, ModelLearning):
        if isinstance(inner, wrapper):
            inner = inner.controller
    if getattr(inner, "follows_poses", False):
        remedy = (
            "a task stays in Python: its tick needs the kinematics of the arm twice and a search "
            "for eigenvalues, which are not translated; export the law at the joints, and give it "
            "what `resolved` says"
        )
        raise ArgumentError("controller", inner, remedy)
    if not isinstance(inner, Controller):
        remedy = "give a control law, alone, in a ModelLearning, or either of these in a Safeguard"
        name = controller if inner is controller else f"{type(inner).__name__} inside"
        raise ArgumentError("controller", name, remedy)
    if isinstance(controller, Safeguard) and controller.limits is not None:
        remedy = (
            "a Safeguard with limits stays in Python, as they need Pinocchio's distances and a "
            "quadratic program at each tick: export it without limits, and let the robot's own "
            "controller keep joint ends and speeds"
        )
        raise ArgumentError("controller", controller, remedy)
    files = Files(controller, single=single)
    source, header = files.source(), files.header()
    paths = Path(folder) / f"{files.prefix}.h", Path(folder) / f"{files.prefix}.c"
    for path, text in zip(paths, (header, source), strict=True):
        write_text(path, text)
    return paths
