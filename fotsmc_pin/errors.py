"""Every error that the library raises on purpose.

Each is a `FotsmcError` and also the builtin that a caller would guess (`ValueError`, ...), says
what to do, and carries the data that its message mentions as attributes.
"""

from __future__ import annotations

from typing import Any


class FotsmcError(Exception):
    """Base of all errors raised on purpose."""


class ArgumentError(FotsmcError, ValueError):
    """An argument of the public API is unusable.

    Attributes:
        argument: name of the argument.
        value: what was given.
        remedy: what to give instead.
    """

    def __init__(self, argument: str, value: Any, remedy: str) -> None:
        self.argument, self.value, self.remedy = argument, value, remedy
        shown = repr(value)
        if len(shown) > 200:
            shown = shown[:200] + "..."
        super().__init__(f"{argument} = {shown}: {remedy}")

    def __reduce__(self) -> tuple[type[ArgumentError], tuple[str, Any, str]]:
        """Rebuild from the parts, so that the error can be pickled."""
        return type(self), (self.argument, self.value, self.remedy)


class MeasurementError(ArgumentError):
    """A measurement or reference handed to a tick is not finite or has the wrong shape."""


class DeclarationError(FotsmcError, TypeError):
    """The declarations of a control law contradict each other; raised when its class is defined."""


class TranslationError(FotsmcError, ValueError):
    """A kernel contains what is not translated to C; the message names file, line and construct."""


class ArmNotFoundError(FotsmcError, FileNotFoundError):
    """There is no arm of this name, and no file at this path."""


class UrdfError(FotsmcError, ValueError):
    """A URDF cannot be used: what is wrong, where, and what to do."""


class MissingDependencyError(FotsmcError, ImportError):
    """An optional package is needed; the message gives the command that installs it."""


class OutputExistsError(FotsmcError, FileExistsError):
    """The target holds a result already and overwriting was not asked for."""


class RecordingError(FotsmcError, ValueError):
    """A file is not a recording of this library, or one that is damaged."""


class LogError(FotsmcError, ValueError):
    """A robot's log cannot be read, or is not what it should be: what, where, and the remedy.

    Attributes:
        kind: "motion" (too little), "columns" (missing, swapped), "degrees", "sign", "gravity"
            (from another direction) or "gravity-free" (torque that leaves gravity to the robot); of
            files "file" (not a log), "units", "clock" or "torque" (what it means is unknown, or
            mixed).
    """

    def __init__(self, kind: str, message: str) -> None:
        self.kind = kind
        super().__init__(message)

    def __reduce__(self) -> tuple[type[LogError], tuple[str, str]]:
        """Rebuild from the parts, so that the error can be pickled."""
        return type(self), (self.kind, str(self))


class StudyError(FotsmcError, ValueError):
    """A file is not a store of runs, or the runs of a study cannot be made."""


class DivergenceError(FotsmcError, ArithmeticError):
    """The speed of a simulated joint exceeded every reasonable bound.

    Attributes:
        time: when [s].
        joint: name of the first such joint.
        recording: everything recorded up to that time; its `divergence` tells time and joint.
    """

    def __init__(self, message: str, time: float, joint: str, recording: Any) -> None:
        self.time, self.joint, self.recording = time, joint, recording
        # The recording is often kept without the error, and its report is to say so first.
        metadata = getattr(recording, "metadata", None)
        if metadata is not None:
            metadata["divergence"] = {"time": float(time), "joint": joint}
        super().__init__(message)

    def __reduce__(self) -> tuple[type[DivergenceError], tuple[str, float, str, Any]]:
        """Rebuild from the parts, so that the error can be pickled."""
        return type(self), (str(self), self.time, self.joint, self.recording)


class RunInterrupted(KeyboardInterrupt):
    """A simulation was stopped by Ctrl-C; a `KeyboardInterrupt` like any other, and no `Exception`.

    Attributes:
        recording: everything recorded up to then.
    """

    def __init__(self, recording: Any) -> None:
        self.recording = recording
        super().__init__("the simulation was interrupted; what was recorded is in `.recording`")
